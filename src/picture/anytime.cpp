// Progressive sampling on nested grids. What is usual there (sample, fill the block, halve it) makes errors
// larger at times: a block takes the colour of a detail that is smaller than it. So a sample colours only
// towards samples like it, and not at all where samples have not been like their neighbours.
#include "thimble/picture/anytime.h"

#include "../base/wide_arithmetic.h"
#include "../trace/path_cache.h"
#include "band.h"

namespace thimble {
namespace {

// One round over the picture.
struct Pass {
  uint8_t step;        // pixels at multiples of it
  bool diagonal;       // only those at odd ones on both axes
  bool where_differs;  // only those whose neighbours in that distance differ
};
constexpr Pass kPasses[] = {
    {16, true, false}, {16, false, false}, {8, true, false},  {8, false, false}, {4, true, false},
    {4, false, false}, {2, true, true},    {2, false, true},  {1, false, true},  {2, true, false},
    {2, false, false}, {1, false, true},   {1, false, false},
};
constexpr uint8_t kPassCount = sizeof kPasses / sizeof kPasses[0];

// Blocks that are tested against the box of what is solid. Their bits are whole bytes.
constexpr int32_t kTilePx = 8;

// Differences of a channel up to which two samples are alike when it comes to colouring, and above which two
// differ when it comes to the order.
constexpr int32_t kAlike = 16;
constexpr int32_t kDiffers = 12;

// Scores count neighbours that are like a sample less those that are not. Colouring begins when a few more
// are; the limit lets a picture change its character.
constexpr int32_t kScoreEnough = 3;
constexpr int32_t kScoreLimit = 64;

int32_t limited(int32_t score) {
  return score > kScoreLimit ? kScoreLimit : score < -kScoreLimit ? -kScoreLimit : score;
}

bool is_near(int32_t a, int32_t b, int32_t tolerance) {
  const int32_t difference = a < b ? b - a : a - b;
  return difference <= tolerance;
}
bool is_near(Rgb8 a, Rgb8 b, int32_t tolerance) {
  return is_near(a.r, b.r, tolerance) && is_near(a.g, b.g, tolerance) && is_near(a.b, b.b, tolerance);
}

// A panel's pixel stored on its own, in the column of a row that has the same place in its bytes and in the dither,
// and looked at again.
[[gnu::noinline]] Rgb8 shown_by_panel(Rgb8 color, int32_t x, int32_t y, PixelFormat format) {
  uint8_t row[16] = {};
  store_panel_pixel(row, x & 7, y, format, color);
  return load_pixel(row, x & 7, y, format);
}

// What a display shows of a colour, in 8 bits a channel: grey formats as a grey.
Rgb8 shown(Rgb8 color, int32_t x, int32_t y, PixelFormat format) {
  if (is_panel(format)) {
    return shown_by_panel(color, x, y, format);
  }
  const uint8_t gray = gray_of(color);
  switch (format) {
    case PixelFormat::kMono1: {
      const uint8_t lit = dithered(gray, x, y) ? 255 : 0;
      return {lit, lit, lit};
    }
    case PixelFormat::kGray4: {
      const uint8_t level = static_cast<uint8_t>((((gray + 8U) * 241U) >> 12) * 17U);
      return {level, level, level};
    }
    case PixelFormat::kGray8:
      return {gray, gray, gray};
    case PixelFormat::kRgb565:
      return {static_cast<uint8_t>((color.r & 0xF8) | color.r >> 5),
              static_cast<uint8_t>((color.g & 0xFC) | color.g >> 6),
              static_cast<uint8_t>((color.b & 0xF8) | color.b >> 5)};
    default:
      return color;
  }
}

// store_pixel over a pixel that holds something.
void replace_pixel(uint8_t* row, int32_t x, int32_t y, PixelFormat format, Rgb8 color) {
  const size_t column = static_cast<size_t>(x);
  if (format == PixelFormat::kMono1) {
    row[column >> 3] = static_cast<uint8_t>(row[column >> 3] & ~(0x80U >> (column & 7U)));
  } else if (format == PixelFormat::kGray4) {
    row[column >> 1] = static_cast<uint8_t>(row[column >> 1] & ((column & 1U) != 0 ? 0xF0U : 0x0FU));
  } else if (is_panel(format)) {
    clear_panel_pixel(row, x, y, format);
  }
  store_pixel(row, x, y, format, color);
}

bool is_paper(PixelFormat format) {
  return is_format<PixelFormat::kPaper3>(format) || is_format<PixelFormat::kPaper7>(format);
}

// The greys that were seen, as the least and the greatest.
struct GrayRange {
  int low = 255;
  int high = 0;
  bool differ = false;  // colours that a paper dithers
  Rgb8 first{};

  void add(Rgb8 color, PixelFormat format) {
    if (is_paper(format)) {
      differ = differ || (high != 0 && !(color == first));
      first = color;
      high = 1;
      return;
    }
    // The dither is looked at when the range is known.
    const bool dithers =
        format == PixelFormat::kMono1 || has_pages(format) || is_format<PixelFormat::kGray2>(format);
    const int gray = gray_of(dithers ? color : shown(color, 0, 0, format));
    low = gray < low ? gray : low;
    high = gray > high ? gray : high;
  }
  int range(PixelFormat format) const {
    if (is_paper(format)) {
      return differ ? 255 : 0;
    }
    if (is_format<PixelFormat::kGray2>(format) && low < high) {
      const int levels = (high * 3 + 254) / 255 - low * 3 / 255;  // 1 .. 3
      return levels * 85;
    }
    if (format != PixelFormat::kMono1 && !has_pages(format)) {
      return high - low;
    }
    // A pixel can be lit by one and not by the other when the threshold of some place, 2 modulo 4, lies
    // between them.
    const int threshold = low + ((2 - low) & 3);
    return threshold < high ? 255 : 0;
  }
};

// The most nodes that a ray visits: it passes 3 * 2^k - 2 cells of a grid of 2^k, since it crosses each of
// its 3 * (2^k - 1) planes once.
constexpr uint32_t most_nodes(int level) {
  return 3 * ((uint32_t{1} << level) - 1) - 2 * static_cast<uint32_t>(level);
}
constexpr uint32_t least(uint32_t a, uint32_t b) {
  return a < b ? a : b;
}
// At least 1, which is what a ray that reads nothing is charged.
constexpr uint32_t at_least_one(uint32_t count) {
  return count == 0 ? 1 : count;
}

uint32_t reserve_of(const CompactTree& tree) {
  return at_least_one(least(most_nodes(tree.level()), tree.node_count()));
}
uint32_t reserve_of(const Octree& tree) {
  return at_least_one(least(most_nodes(tree.level()), tree.nodes_used()));
}
uint32_t reserve_of(const DenseGrid& grid) {
  return 3 * (uint32_t{1} << grid.level()) - 2;
}

// Materials that a hit can have.
struct Materials {
  uint32_t low;
  uint32_t high;
};
Materials materials_of(const CompactTree& tree) {
  const uint32_t only = tree.uniform_material();
  return tree.many_materials() ? Materials{0, 255} : Materials{only, only};
}
Materials materials_of(const Octree&) {
  return {0, 255};
}
Materials materials_of(const DenseGrid&) {
  return {0, 0};
}

}  // namespace

template <class Structure>
Status AnytimeFrame::make_any(const Structure& structure, uint32_t reserve, const Camera& camera,
                              const Shading& shading, PixelFormat format, Bytes memory) {
  const int32_t width = camera.width_px();
  const int32_t height = camera.height_px();
  if (width == 0 || camera.level() != structure.level()) {
    return Status::kBadArgument;
  }
  if (memory.size < anytime_bytes(width, height, format)) {
    return Status::kOutOfMemory;
  }
  camera_ = camera;
  shading_ = shading;
  format_ = format;
  row_bytes_ = row_bytes(format, width);
  bit_row_bytes_ = row_bytes(PixelFormat::kMono1, width);
  picture_ = memory.data;
  exact_ = memory.data + band_bytes(format, width, height);
  counts_ = {};
  spent_ = 0;
  left_ = 0;
  reserve_ = reserve;
  inexact_ = pixels();
  solid_score_ = 0;
  background_score_ = 0;
  background_ = shade(Hit{}, Ray{}, camera_, shading_);
  pass_ = 0;
  x_ = kPasses[0].step;
  y_ = kPasses[0].step;
  clear();
  const Materials materials = materials_of(structure);
  find_range(materials.low, materials.high);
  mark_misses(structure.bounds());
  return Status::kOk;
}

// Background everywhere, no pixel exact. The dither repeats itself every eight rows.
void AnytimeFrame::clear() {
  constexpr int32_t kPeriod = 8;
  const int32_t height = camera_.height_px();
  // The last page may be cut off, so pages are drawn to the end.
  const int32_t drawn = height < kPeriod || has_pages(format_) ? height : kPeriod;
  const size_t all = has_pages(format_) ? 0 : row_bytes_ * static_cast<size_t>(height);
  const size_t period = row_bytes_ * kPeriod;
  for (size_t i = 0; i < row_bytes_ * row_place(format_, whole_rows(format_, drawn)); ++i) {
    picture_[i] = 0;
  }
  for (int32_t y = 0; y < drawn; ++y) {
    for (int32_t x = 0; x < camera_.width_px(); ++x) {
      store_pixel(picture_ + row_bytes_ * row_place(format_, y), x, y, format_, background_);
    }
  }
  for (size_t i = period; i < all; ++i) {
    picture_[i] = picture_[i - period];
  }
  for (size_t i = 0; i < bit_row_bytes_ * static_cast<size_t>(height); ++i) {
    exact_[i] = 0;
  }
}

// Every colour that a pixel may get: the background, and what is hit by the faces that some ray can enter by.
void AnytimeFrame::find_range(uint32_t materials_low, uint32_t materials_high) {
  GrayRange range;
  range.add(background_, format_);
  if (shading_.mode == ShadeMode::kDepth) {
    const uint8_t far_gray = kFarBrightness;
    range.add({far_gray, far_gray, far_gray}, format_);
    range.add({255, 255, 255}, format_);
    gray_range_ = static_cast<uint8_t>(range.range(format_));
    return;
  }
  RayRange rays(corner_ray(camera_, 0), corner_ray(camera_, 1));
  rays.add(corner_ray(camera_, 2));
  rays.add(corner_ray(camera_, 3));
  // One material beyond the palette stands for all of them.
  const uint32_t beyond = static_cast<uint32_t>(least(256, static_cast<uint32_t>(shading_.palette.size)));
  const uint32_t last = shading_.mode == ShadeMode::kColor ? least(materials_high, beyond) : materials_low;
  for (uint32_t material = materials_low; material <= last || material == materials_low; ++material) {
    for (int face = 0; face < 6; ++face) {
      const int axis = face >> 1;
      const bool goes_up = (face & 1) == 0;  // a ray that does enters by the face that looks down
      if (goes_up ? rays.direction_high[axis] <= 0 : rays.direction_low[axis] >= 0) {
        continue;
      }
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = static_cast<int8_t>(axis);
      hit.material = static_cast<uint8_t>(material);
      Ray ray{};
      ray.direction[axis] = goes_up ? 1 : -1;
      range.add(shade(hit, ray, camera_, shading_), format_);
    }
  }
  gray_range_ = static_cast<uint8_t>(range.range(format_));
}

void AnytimeFrame::mark_misses(const VoxelBox& bounds) {
  const int32_t width = camera_.width_px();
  const int32_t height = camera_.height_px();
  for (int32_t y = 0; y < height; y += kTilePx) {
    const int32_t last_y = (y + kTilePx < height ? y + kTilePx : height) - 1;
    for (int32_t x = 0; x < width; x += kTilePx) {
      const int32_t last_x = (x + kTilePx < width ? x + kTilePx : width) - 1;
      RayRange rays(camera_.ray(x, y), camera_.ray(last_x, last_y));
      rays.add(camera_.ray(last_x, y));
      rays.add(camera_.ray(x, last_y));
      if (!all_miss(rays, bounds)) {
        continue;
      }
      for (int32_t row = y; row <= last_y; ++row) {
        exact_[static_cast<size_t>(row) * bit_row_bytes_ + static_cast<size_t>(x / kTilePx)] = 0xFF;
      }
      inexact_ -= static_cast<uint32_t>((last_x - x + 1) * (last_y - y + 1));
    }
  }
}

// Moves x_, y_ to the next pixel of this pass, or a later one, that is to be traced. False when there is
// none.
bool AnytimeFrame::next_sample() {
  for (; pass_ < kPassCount; ++pass_) {
    const Pass& pass = kPasses[pass_];
    const int32_t first = pass.diagonal ? pass.step : 0;
    const int32_t stride = pass.diagonal ? 2 * pass.step : pass.step;
    for (; y_ < camera_.height_px(); y_ += stride, x_ = first) {
      for (; x_ < camera_.width_px(); x_ += stride) {
        if (!exact(x_, y_) && (!pass.where_differs || neighbours_differ())) {
          return true;
        }
      }
    }
    if (pass_ + 1 < kPassCount) {
      x_ = kPasses[pass_ + 1].diagonal ? kPasses[pass_ + 1].step : 0;
      y_ = x_;
    }
  }
  return false;
}

// Whether two of the exact pixels around x_, y_, in the distance of the pass, differ.
bool AnytimeFrame::neighbours_differ() const {
  const int32_t step = kPasses[pass_].step;
  bool found = false;
  Rgb8 first;
  for (int32_t y = y_ - step; y <= y_ + step; y += step) {
    if (y < 0 || y >= camera_.height_px()) {
      continue;
    }
    const uint8_t* row = picture_ + row_bytes_ * row_place(format_, y);
    for (int32_t x = x_ - step; x <= x_ + step; x += step) {
      if (x < 0 || x >= camera_.width_px() || !exact(x, y)) {
        continue;  // x_, y_ itself is not exact
      }
      const Rgb8 here = load_pixel(row, x, y, format_);
      if (!found) {
        first = here;
        found = true;
      } else if (!is_near(first, here, kDiffers)) {
        return true;
      }
    }
  }
  return false;
}

// Makes the pixel x_, y_ exact, and colours towards those neighbours that are like it.
void AnytimeFrame::take_sample(Rgb8 color) {
  const int32_t width = camera_.width_px();
  const int32_t height = camera_.height_px();
  const int32_t step = kPasses[pass_].step;
  const size_t row = static_cast<size_t>(y_);
  replace_pixel(picture_ + row_bytes_ * row_place(format_, y_), x_, y_, format_, color);
  uint8_t& bits = exact_[row * bit_row_bytes_ + (static_cast<size_t>(x_) >> 3)];
  bits = static_cast<uint8_t>(bits | 0x80 >> (x_ & 7));
  --inexact_;
  if (step == 1) {
    return;
  }

  const Rgb8 mine = shown(color, x_, y_, format_);
  const bool is_background = mine == shown(background_, x_, y_, format_);
  // A bit a neighbour, in three rows of three.
  uint32_t there = 0;
  uint32_t alike = 0;
  int32_t solid_score = solid_score_;
  int32_t background_score = background_score_;
  for (int32_t place = 0; place < 9; ++place) {
    const int32_t x = x_ + (place % 3 - 1) * step;
    const int32_t y = y_ + (place / 3 - 1) * step;
    if (place == 4 || x < 0 || y < 0 || x >= width || y >= height || !exact(x, y)) {
      continue;
    }
    const Rgb8 other = load_pixel(picture_ + row_bytes_ * row_place(format_, y), x, y, format_);
    const bool is_like = is_near(mine, other, kAlike);
    there |= uint32_t{1} << place;
    alike |= is_like ? uint32_t{1} << place : 0;
    // Two different things beside each other say nothing about sizes.
    if (other == shown(background_, x, y, format_)) {
      background_score += is_background ? 1 : -1;
    } else if (is_like || is_background) {
      solid_score += is_like ? 1 : -1;
    }
  }
  solid_score_ = limited(solid_score);
  background_score_ = limited(background_score);
  if (is_background ? background_score_ <= 0 : solid_score_ <= kScoreEnough) {
    return;
  }

  // Towards each corner: the neighbour there and the two beside it.
  constexpr uint32_t kCorners[4] = {0b000'001'011, 0b000'100'110, 0b011'001'000, 0b110'100'000};
  const int32_t reach = (step + 1) / 2;
  for (uint32_t corner = 0; corner < 4; ++corner) {
    uint32_t samples = 0;
    uint32_t agreeing = 0;
    for (uint32_t place = 0; place < 9; ++place) {
      const uint32_t bit = kCorners[corner] & uint32_t{1} << place;
      samples += (there & bit) != 0 ? 1U : 0U;
      agreeing += (alike & bit) != 0 ? 1U : 0U;
    }
    if (agreeing == 0 || 2 * agreeing < samples) {
      continue;
    }
    const int32_t left = (corner & 1U) != 0 ? x_ : x_ - reach;
    const int32_t top = (corner & 2U) != 0 ? y_ : y_ - reach;
    for (int32_t y = top < 0 ? 0 : top; y <= top + reach && y < height; ++y) {
      uint8_t* line = picture_ + row_bytes_ * row_place(format_, y);
      for (int32_t x = left < 0 ? 0 : left; x <= left + reach && x < width; ++x) {
        if (!exact(x, y)) {
          replace_pixel(line, x, y, format_, color);
        }
      }
    }
  }
}

template <class Structure>
Status AnytimeFrame::refine_any(const Structure& structure, uint32_t max_visits, Width width) {
  if (picture_ == nullptr || camera_.level() != structure.level()) {
    return Status::kBadArgument;
  }
  const Status status = check_width(camera_, structure.level(), width);
  if (status != Status::kOk) {
    return status;
  }
  left_ += max_visits;
  PathCache cache;
  TraceOptions options;
  options.max_visits = reserve_;
  options.width = width;
  // The last pixel is found by its count: no look at the rest of the picture.
  while (inexact_ != 0 && left_ >= reserve_ && next_sample()) {
    const Ray ray = camera_.ray(x_, y_);
    Hit hit;
    if (closest_hit(structure, ray, &hit, options, &cache) != Status::kOk) {
      return Status::kBadArgument;  // no ray of a camera is refused
    }
    take_sample(shade(hit, ray, camera_, shading_));
    const uint32_t cost = at_least_one(hit.visits);
    left_ -= cost;
    spent_ += cost;
    ++counts_.rays;
    counts_.node_visits += hit.visits;
    counts_.hits += hit.kind == HitKind::kHit ? 1U : 0U;
    counts_.step_limited += hit.kind == HitKind::kStepLimit ? 1U : 0U;
  }
  return Status::kOk;
}

uint32_t AnytimeFrame::mean_error_bound_q8() const {
  if (inexact_ == 0) {
    return 0;
  }
  const uint64_t greys_q8 = wide_product_u(inexact_, gray_range_) << 8;  // below 2^44
  return static_cast<uint32_t>(divide(greys_q8 + pixels() - 1, pixels()));
}

Band AnytimeFrame::band(int32_t first_row, int32_t rows) const {
  const int32_t height = picture_ == nullptr ? 0 : camera_.height_px();
  Band band;
  band.format = format_;
  band.first_row = first_row < 0 ? 0 : first_row < height ? first_row : height;
  const int32_t left = height - band.first_row;
  band.rows = rows < 0 ? 0 : rows < left ? rows : left;
  if (band.rows != 0) {
    band.pixels = {picture_ + row_bytes_ * row_place(format_, band.first_row),
                   row_bytes_ * row_place(format_, whole_rows(format_, band.rows))};
  }
  return band;
}

Status AnytimeFrame::make(const CompactTree& tree, const Camera& camera, const Shading& shading,
                          PixelFormat format, Bytes memory, AnytimeFrame* frame) {
  return frame->make_any(tree, reserve_of(tree), camera, shading, format, memory);
}
Status AnytimeFrame::make(const Octree& tree, const Camera& camera, const Shading& shading,
                          PixelFormat format, Bytes memory, AnytimeFrame* frame) {
  return frame->make_any(tree, reserve_of(tree), camera, shading, format, memory);
}
Status AnytimeFrame::make(const DenseGrid& grid, const Camera& camera, const Shading& shading,
                          PixelFormat format, Bytes memory, AnytimeFrame* frame) {
  return frame->make_any(grid, reserve_of(grid), camera, shading, format, memory);
}
Status AnytimeFrame::refine(const CompactTree& tree, uint32_t max_visits, Width width) {
  return refine_any(tree, max_visits, width);
}
Status AnytimeFrame::refine(const Octree& tree, uint32_t max_visits, Width width) {
  return refine_any(tree, max_visits, width);
}
Status AnytimeFrame::refine(const DenseGrid& grid, uint32_t max_visits, Width width) {
  return refine_any(grid, max_visits, width);
}

}  // namespace thimble
