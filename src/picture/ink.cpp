#include "thimble/picture/ink.h"

#include "../base/wide_arithmetic.h"
#include "band.h"

namespace thimble {
namespace {

// Patterns, in the picture of tones once `finish` is done with it.
constexpr uint8_t kBlack = 0;
constexpr uint8_t kChecker = 1;
constexpr uint8_t kWhite = 2;

// Tones are told apart in steps of 8.
constexpr int kTones = 32;
constexpr int kToneShift = 3;

// From which tones on a pixel is a checker, and white.
struct Levels {
  int checker = 0;
  int white = 0;
};

// The two levels between which the squares of tones' differences from the mean of their pattern add up to least
// (N. Otsu, "A threshold selection method from gray-level histograms", IEEE Trans. SMC 9, 1979). Where one or two
// tones are all that there is, these are told apart, the brightest white.
Levels levels_of(const uint32_t (&pixels)[kTones]) {
  // Of the tones of a pattern: pixels, and the sum of their tones. At most 2^28 pixels, so sums are below 2^33.
  struct Pattern {
    uint32_t count = 0;
    uint64_t sum = 0;
  };
  const auto add = [&pixels](Pattern& pattern, int tone) {
    pattern.count += pixels[tone];
    pattern.sum += wide_product_u(pixels[tone], static_cast<uint32_t>(tone));
  };
  // A pattern's sum, squared and divided by its pixels: the sum times the mean, which has 8 bits behind the point.
  const auto weight = [](const Pattern& pattern) {
    return pattern.count == 0
               ? uint64_t{0}
               : (pattern.sum * divide(pattern.sum << 8, pattern.count)) >> 8;  // below 2^33 * 2^13
  };
  uint64_t bright[kTones];
  Pattern white_ones;
  for (int white = kTones - 1; white >= 0; --white) {
    add(white_ones, white);
    bright[white] = weight(white_ones);
  }
  Levels best;
  uint64_t most = 0;
  Pattern black_ones;
  for (int checker = 0; checker < kTones; ++checker) {
    const uint64_t dark = weight(black_ones);
    Pattern between;
    for (int white = checker; white < kTones; ++white) {
      const uint64_t all = dark + weight(between) + bright[white];
      if (all > most) {
        most = all;
        best = {checker, white};
      }
      add(between, white);
    }
    add(black_ones, checker);
  }
  return best;
}

// Pixels of one surface about one of it, and itself.
struct Near {
  uint8_t tones[9];
  int count = 0;
  uint8_t middle = 0;
};

uint8_t median(Near near) {
  for (int i = 1; i < near.count; ++i) {
    const uint8_t tone = near.tones[i];
    int place = i;
    for (; place > 0 && near.tones[place - 1] > tone; --place) {
      near.tones[place] = near.tones[place - 1];
    }
    near.tones[place] = tone;
  }
  return near.tones[near.count / 2];
}

// What most of them have; the middle one counts twice, and of as many the darkest is taken.
uint8_t commonest(const Near& near) {
  uint8_t counts[3] = {};
  ++counts[near.middle];
  for (int i = 0; i < near.count; ++i) {
    ++counts[near.tones[i]];
  }
  uint8_t best = kBlack;
  best = counts[kChecker] > counts[best] ? kChecker : best;
  return counts[kWhite] > counts[best] ? kWhite : best;
}

// Whether a tone, and those on both sides of it, are `tone`.
bool are_all(uint8_t tone, const uint8_t* middle) {
  return middle[0] == tone && middle[-1] == tone && middle[1] == tone;
}

int distance(int one, int other) {
  return one < other ? other - one : one - other;
}

}  // namespace

Status InkPicture::make(int32_t width_px, int32_t height_px, Bytes memory, InkPicture* ink) {
  if (width_px < 1 || height_px < 1 || width_px > kMaxPicturePx || height_px > kMaxPicturePx) {
    return Status::kBadArgument;
  }
  if (memory.size < ink_bytes(width_px, height_px)) {
    return Status::kOutOfMemory;
  }
  const size_t pixels = band_bytes(PixelFormat::kGray8, width_px, height_px);
  ink->tones_ = memory.subspan(0, pixels);
  ink->depths_ = memory.subspan(pixels, pixels);
  ink->rows_ = memory.subspan(2 * pixels, 2 * static_cast<size_t>(width_px));
  ink->width_px_ = width_px;
  ink->height_px_ = height_px;
  return Status::kOk;
}

// Replaces each tone by what `filter` makes of those about it on the same surface. Two rows are kept as they were.
template <class Filter>
void InkPicture::pass(Filter filter) {
  const size_t width = static_cast<size_t>(width_px_);
  uint8_t* above = rows_.data;
  uint8_t* here = rows_.data + width;
  for (int32_t y = 0; y < height_px_; ++y) {
    uint8_t* const row = tones_.data + static_cast<size_t>(y) * width;
    const uint8_t* const depth = depths_.data + static_cast<size_t>(y) * width;
    __builtin_memcpy(here, row, width);
    for (int32_t x = 0; x < width_px_; ++x) {
      if (depth[x] == 0) {
        continue;
      }
      // Either filter leaves a tone among its like: most of a face.
      const bool inside = x > 0 && x + 1 < width_px_ && y > 0 && y + 1 < height_px_;
      if (inside && are_all(here[x], here + x) && are_all(here[x], above + x) &&
          are_all(here[x], row + width + x)) {
        continue;
      }
      Near near;
      near.middle = here[x];
      for (int down = y == 0 ? 0 : -1; down <= (y + 1 == height_px_ ? 0 : 1); ++down) {
        const uint8_t* const tones = down < 0 ? above : down == 0 ? here : row + width;
        const uint8_t* const depths = depth + static_cast<ptrdiff_t>(width) * down;
        for (int32_t across = x == 0 ? 0 : x - 1; across <= x + 1 && across < width_px_; ++across) {
          if (depths[across] != 0 && distance(depths[across], depth[x]) <= least_jump_) {
            near.tones[near.count++] = tones[across];
          }
        }
      }
      row[x] = filter(near);
    }
    uint8_t* const before = above;
    above = here;
    here = before;
  }
}

void InkPicture::finish() {
  int nearest = 0;
  int farthest = 255;
  for (size_t i = 0; i < depths_.size; ++i) {
    const int depth = depths_[i];
    if (depth != 0) {
      nearest = depth > nearest ? depth : nearest;
      farthest = depth < farthest ? depth : farthest;
    }
  }
  // A sixteenth of the depth that is seen: with less, steps of a slope are lines.
  least_jump_ = (nearest - farthest) / 16;
  least_jump_ = least_jump_ < 2 ? 2 : least_jump_;
  pass(median);
  pass(median);
  uint32_t pixels[kTones] = {};
  for (size_t i = 0; i < tones_.size; ++i) {
    pixels[tones_[i] >> kToneShift] += depths_[i] != 0 ? 1U : 0U;
  }
  const Levels levels = levels_of(pixels);
  for (size_t i = 0; i < tones_.size; ++i) {
    const int tone = tones_[i] >> kToneShift;
    tones_[i] = tone >= levels.white ? kWhite : tone >= levels.checker ? kChecker : kBlack;
  }
  pass(commonest);
  pass(commonest);
}

// How much nearer the pixel is than its neighbour `towards` it, in greys of depth, where that is a jump and no slope that
// comes from the pixel before or leads to the one beyond; 0 where it is none, and 256 where nothing is there. Of the line
// that they are on, `after` pixels are left that way and `before` are behind.
int InkPicture::jump(const uint8_t* depth, ptrdiff_t towards, int32_t before, int32_t after) const {
  if (after == 0) {
    return 0;
  }
  const int next = depth[towards];
  if (next == 0) {
    return 256;
  }
  const int step = *depth - next;
  const int behind = before > 0 ? depth[-towards] : 0;
  const int beyond = after > 1 ? depth[2 * towards] : 0;
  const bool slopes = (behind != 0 && distance(behind - *depth, step) <= least_jump_) ||
                      (beyond != 0 && distance(next - beyond, step) <= least_jump_);
  return distance(step, 0) <= least_jump_ || slopes ? 0 : step;
}

bool InkPicture::is_white(int32_t x, int32_t y) const {
  const size_t place = static_cast<size_t>(y) * static_cast<size_t>(width_px_) + static_cast<size_t>(x);
  const uint8_t* const depth = depths_.data + place;
  if (*depth == 0) {
    return false;
  }
  const int32_t left[4] = {x, width_px_ - 1 - x, y, height_px_ - 1 - y};
  const ptrdiff_t towards[4] = {-1, 1, -ptrdiff_t{width_px_}, ptrdiff_t{width_px_}};
  int nearer = 0;
  int farther = 0;
  for (int i = 0; i < 4; ++i) {
    const int step = jump(depth, towards[i], left[i ^ 1], left[i]);
    nearer = step > nearer ? step : nearer;
    farther = step < farther ? step : farther;
  }
  const uint8_t pattern = tones_[place];
  if (nearer == 256 || farther < 0) {
    return nearer == 256;
  }
  return nearer > 0 || pattern == kWhite || (pattern == kChecker && ((x + y) & 1) == 0);
}

Status InkPicture::store(const Band& band) const {
  size_t stride = 0;
  const Status status = check_rows(width_px_, height_px_, band, &stride);
  if (status != Status::kOk) {
    return status;
  }
  const size_t line_bytes = row_bytes(band.format, width_px_);
  for (int32_t row = 0; row < band.rows; ++row) {
    uint8_t* const line = band.pixels.data + stride * row_place(band.format, row);
    for (size_t i = 0; i < line_bytes && begins_bytes(band.format, row); ++i) {
      line[i] = 0;
    }
    const int32_t y = band.first_row + row;
    for (int32_t x = 0; x < width_px_; ++x) {
      const uint8_t shown = is_white(x, y) ? 255 : 0;
      store_pixel(line, x, y, band.format, {shown, shown, shown});
    }
  }
  return Status::kOk;
}

}  // namespace thimble
