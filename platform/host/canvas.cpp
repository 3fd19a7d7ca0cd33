#include "host/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "host/font.h"

namespace thimble::host {
namespace {

static_assert(sizeof(Rgb8) == 3);

Rgb8 pixel_of(const Picture& picture, std::int32_t x, std::int32_t y) {
  const std::uint8_t* at =
      picture.rgb + 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) +
                         static_cast<std::size_t>(x));
  return {at[0], at[1], at[2]};
}

void draw_magnified(Canvas* canvas, const Placement& placement, const Picture& picture, const Look& look) {
  const std::int32_t scale = placement.scale;
  const std::int32_t gap = gap_px(look, scale);
  if (scale == 1 && look.keeps_color) {  // the viewer's pictures, thirty a second
    const auto row = static_cast<std::size_t>(picture.width_px);
    for (std::int32_t y = 0; y < picture.height_px; ++y) {
      std::memcpy(canvas->row(placement.y_px + y) + placement.x_px,
                  picture.rgb + sizeof(Rgb8) * row * static_cast<std::size_t>(y), sizeof(Rgb8) * row);
    }
    return;
  }
  for (std::int32_t y = 0; y < picture.height_px; ++y) {
    Rgb8* const first = canvas->row(placement.y_px + y * scale) + placement.x_px;
    Rgb8* to = first;
    for (std::int32_t x = 0; x < picture.width_px; ++x) {
      to = std::fill_n(to, scale - gap, looks(look, pixel_of(picture, x, y)));
      to = std::fill_n(to, gap, look.gap);
    }
    for (std::int32_t line = 1; line < scale; ++line) {
      Rgb8* const copy = canvas->row(placement.y_px + y * scale + line) + placement.x_px;
      if (line < scale - gap) {
        std::copy(first, to, copy);
      } else {
        std::fill_n(copy, placement.width_px, look.gap);
      }
    }
  }
}

// Each screen pixel has the mean of the light of the picture's pixels that it covers. A channel's value
// stands for about its square in light, so that a bright dot on black stays bright.
void draw_reduced(Canvas* canvas, const Placement& placement, const Picture& picture, const Look& look) {
  const auto edge = [](std::int32_t i, std::int32_t from, std::int32_t to) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(i) * from / to);
  };
  for (std::int32_t y = 0; y < placement.height_px; ++y) {
    const std::int32_t y0 = edge(y, picture.height_px, placement.height_px);
    const std::int32_t y1 = std::max(y0 + 1, edge(y + 1, picture.height_px, placement.height_px));
    Rgb8* const to = canvas->row(placement.y_px + y) + placement.x_px;
    for (std::int32_t x = 0; x < placement.width_px; ++x) {
      const std::int32_t x0 = edge(x, picture.width_px, placement.width_px);
      const std::int32_t x1 = std::max(x0 + 1, edge(x + 1, picture.width_px, placement.width_px));
      std::uint64_t r = 0;
      std::uint64_t g = 0;
      std::uint64_t b = 0;
      for (std::int32_t v = y0; v < y1; ++v) {
        for (std::int32_t u = x0; u < x1; ++u) {
          const Rgb8 pixel = pixel_of(picture, u, v);
          r += unsigned{pixel.r} * pixel.r;
          g += unsigned{pixel.g} * pixel.g;
          b += unsigned{pixel.b} * pixel.b;
        }
      }
      const auto count = static_cast<unsigned>((y1 - y0) * (x1 - x0));
      const auto mean = [count](std::uint64_t sum) {
        return static_cast<std::uint8_t>(std::lround(std::sqrt(static_cast<double>(sum) / count)));
      };
      to[x] = looks(look, {mean(r), mean(g), mean(b)});
    }
  }
}

}  // namespace

void Canvas::resize(std::int32_t width, std::int32_t height) {
  width_px = std::max(width, 0);
  height_px = std::max(height, 0);
  pixels.assign(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), Rgb8{});
}

void Canvas::fill(std::int32_t x, std::int32_t y, std::int32_t width, std::int32_t height, Rgb8 color) {
  const std::int32_t left = std::clamp(x, 0, width_px);
  const std::int32_t right = std::clamp(x + width, left, width_px);
  const std::int32_t bottom = std::min(y + height, height_px);
  for (std::int32_t line = std::max(y, 0); line < bottom; ++line) {
    std::fill(row(line) + left, row(line) + right, color);
  }
}

Placement place(std::int32_t picture_width_px, std::int32_t picture_height_px, std::int32_t room_width_px,
                std::int32_t room_height_px, std::int32_t most_scale) {
  Placement placement;
  if (picture_width_px <= 0 || picture_height_px <= 0 || room_width_px <= 0 || room_height_px <= 0) {
    return placement;
  }
  placement.scale = std::min(room_width_px / picture_width_px, room_height_px / picture_height_px);
  if (most_scale > 0) {
    placement.scale = std::min(placement.scale, most_scale);
  }
  if (placement.scale > 0) {
    placement.width_px = picture_width_px * placement.scale;
    placement.height_px = picture_height_px * placement.scale;
  } else {
    const std::int64_t by_width = static_cast<std::int64_t>(picture_height_px) * room_width_px;
    const std::int64_t by_height = static_cast<std::int64_t>(picture_width_px) * room_height_px;
    const bool wide = by_width <= static_cast<std::int64_t>(room_height_px) * picture_width_px;
    placement.width_px = wide ? room_width_px : static_cast<std::int32_t>(by_height / picture_height_px);
    placement.height_px = wide ? static_cast<std::int32_t>(by_width / picture_width_px) : room_height_px;
    placement.width_px = std::max(placement.width_px, 1);
    placement.height_px = std::max(placement.height_px, 1);
  }
  placement.x_px = (room_width_px - placement.width_px) / 2;
  placement.y_px = (room_height_px - placement.height_px) / 2;
  return placement;
}

std::int32_t to_picture(std::int32_t screen, std::int32_t first, std::int32_t screen_size,
                        std::int32_t picture_size) {
  if (screen_size <= 0) {
    return 0;
  }
  const std::int64_t scaled = static_cast<std::int64_t>(screen - first) * picture_size;
  const std::int64_t quotient = scaled / screen_size;
  return static_cast<std::int32_t>(scaled < 0 && quotient * screen_size != scaled ? quotient - 1 : quotient);
}

void draw_picture(Canvas* canvas, const Placement& placement, const Picture& picture, const Look& look) {
  if (placement.width_px == 0) {
    return;
  }
  if (placement.scale > 0) {
    draw_magnified(canvas, placement, picture, look);
    return;
  }
  draw_reduced(canvas, placement, picture, look);
}

void draw_text(Canvas* canvas, std::int32_t x, std::int32_t y, std::int32_t scale, Rgb8 color,
               std::string_view text) {
  std::int32_t left = x;
  std::int32_t top = y;
  for (const char character : text) {
    if (character == '\n') {
      left = x;
      top += kGlyphHeightPx * scale;
      continue;
    }
    const Glyph& glyph = glyph_of(character);
    for (std::int32_t line = 0; line < kGlyphRows; ++line) {
      for (std::int32_t dot = 0; dot < kGlyphColumns; ++dot) {
        if ((glyph[static_cast<std::size_t>(line)] >> (kGlyphColumns - 1 - dot) & 1) != 0) {
          canvas->fill(left + dot * scale, top + line * scale, scale, scale, color);
        }
      }
    }
    left += kGlyphWidthPx * scale;
  }
}

std::string folded(std::string_view text, std::size_t columns) {
  std::string out;
  while (!text.empty()) {
    std::size_t end = std::min(text.find('\n'), text.size());
    std::size_t next = std::min(end + 1, text.size());
    if (end > columns) {
      const std::size_t blank = text.substr(0, columns + 1).rfind(' ');
      const bool has_words =
          blank != std::string_view::npos && text.find_first_not_of(' ') < blank;  // not of indents alone
      end = has_words ? text.find_last_not_of(' ', blank) + 1 : columns;
      next = has_words ? std::min(text.find_first_not_of(' ', blank), text.size()) : columns;
      out += text.substr(0, end);
      out += '\n';
    } else {
      out += text.substr(0, next);
    }
    text.remove_prefix(next);
  }
  return out;
}

TextSize text_size(std::string_view text) {
  TextSize size;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    size.columns = std::max(size.columns, static_cast<std::int32_t>(end));
    ++size.lines;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return size;
}

void CanvasScreen::keep(const Picture& picture) {
  const std::size_t bytes =
      3 * static_cast<std::size_t>(picture.width_px) * static_cast<std::size_t>(picture.height_px);
  rgb_.assign(picture.rgb, picture.rgb + bytes);
  picture_ = {rgb_.data(), picture.width_px, picture.height_px};
}

std::optional<Event> CanvasScreen::take_event() {
  if (events_.empty()) {
    return std::nullopt;
  }
  const Event event = events_.front();
  events_.pop_front();
  return event;
}

}  // namespace thimble::host
