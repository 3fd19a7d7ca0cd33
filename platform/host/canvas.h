/// What a screen draws on: a block of pixels, pictures placed on it, text in a small fixed font.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/look.h"
#include "host/screen.h"

namespace thimble::host {

/// Pixels, rows from the top.
struct Canvas {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::vector<Rgb8> pixels;

  void resize(std::int32_t width, std::int32_t height);
  Rgb8* row(std::int32_t y) {
    return pixels.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px);
  }
  /// Fills a rectangle, cut off at the canvas's edges.
  void fill(std::int32_t x, std::int32_t y, std::int32_t width, std::int32_t height, Rgb8 color);
};

/// Where a picture lies on a screen. `width_px` x `height_px` screen pixels from (`x_px`, `y_px`) on;
/// `scale` is the whole number of screen pixels a picture pixel, 0 when the picture is made smaller.
struct Placement {
  std::int32_t x_px = 0;
  std::int32_t y_px = 0;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  std::int32_t scale = 0;
};

/// The placement in the middle of a room: magnified by the largest whole number that fits, at most
/// `most_scale` unless that is 0, or else made smaller in proportion.
Placement place(std::int32_t picture_width_px, std::int32_t picture_height_px, std::int32_t room_width_px,
                std::int32_t room_height_px, std::int32_t most_scale);

/// The coordinate in the picture of a coordinate on the screen, rounded down, also beyond the picture.
std::int32_t to_picture(std::int32_t screen, std::int32_t first, std::int32_t screen_size,
                        std::int32_t picture_size);

/// Draws the picture with its look. The light of pixels that become one is averaged.
void draw_picture(Canvas* canvas, const Placement& placement, const Picture& picture, const Look& look);

inline constexpr std::int32_t kGlyphWidthPx = 6;    ///< with the gap to the next
inline constexpr std::int32_t kGlyphHeightPx = 10;  ///< with the gap to the next line
/// Draws lines of ASCII, `scale` pixels a dot of the font; other characters are shown as a box.
void draw_text(Canvas* canvas, std::int32_t x, std::int32_t y, std::int32_t scale, Rgb8 color,
               std::string_view text);

/// Columns and lines of a text.
struct TextSize {
  std::int32_t columns = 0;
  std::int32_t lines = 0;
};
TextSize text_size(std::string_view text);
/// Lines of at most `columns` (above 0), broken between words; a longer word is broken where it must be.
std::string folded(std::string_view text, std::size_t columns);

/// What the screens share that draw on a canvas: the picture and the text that are shown, and what the user did.
class CanvasScreen : public Screen {
 public:
  explicit CanvasScreen(const ScreenOptions& options)
      : look_(options.look),
        fixed_scale_(options.scale),
        status_lines_(options.status_lines),
        picture_{nullptr, options.width_px, options.height_px} {}
  void set_status(std::string_view text) override { status_ = text; }
  void set_overlay(std::string_view text) override { overlay_ = text; }

 protected:
  static constexpr Rgb8 kPanel{32, 34, 38};
  static constexpr Rgb8 kPanelText{206, 210, 216};
  static constexpr Rgb8 kOverlayText{255, 255, 255};

  /// Copies a picture, to be drawn again when the screen asks for it.
  void keep(const Picture& picture);
  /// The oldest event, if any.
  std::optional<Event> take_event();

  Look look_;
  std::int32_t fixed_scale_;
  std::int32_t status_lines_;
  std::string status_;
  std::string overlay_;
  Picture picture_;  ///< shown last; before, the size of those that will come
  Canvas canvas_;
  Placement placement_;
  std::deque<Event> events_;

 private:
  std::vector<std::uint8_t> rgb_;
};

}  // namespace thimble::host
