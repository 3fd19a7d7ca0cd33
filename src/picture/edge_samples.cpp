#include "thimble/picture/render.h"

namespace thimble {
namespace {

uint32_t larger_gap(uint32_t one, uint32_t other) {
  return one > other ? one : other;
}

// The largest of a channel between two pixels.
uint32_t difference(const uint8_t* one, const uint8_t* other, size_t channels) {
  uint32_t most = 0;
  for (size_t i = 0; i < channels; ++i) {
    const int32_t gap = one[i] - other[i];
    most = larger_gap(most, static_cast<uint32_t>(gap < 0 ? -gap : gap));
  }
  return most;
}

bool takes_row(ConstBytes bytes, size_t size, bool may_be_empty) {
  return bytes.size >= size || (may_be_empty && bytes.size == 0);
}

// How many of a segment's strengths are at least `least`.
int count_from(const uint8_t* strengths, int32_t count, int least) {
  int found = 0;
  for (int32_t x = 0; x < count; ++x) {
    found += strengths[x] >= least ? 1 : 0;
  }
  return found;
}

// The greatest strength that `wanted` pixels of the segment have or exceed: at least `wanted` edges have
// kEdgeStrength.
int strength_of_rank(const uint8_t* strengths, int32_t count, int wanted) {
  int low = kEdgeStrength;
  int high = 256;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    if (count_from(strengths, count, middle) >= wanted) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

// Turns the strengths of a segment into numbers of samples, in place.
void serve_segment(uint8_t* segment, int32_t count) {
  const int edges = count_from(segment, count, kEdgeStrength);
  int left = kEdgeSegmentSamples * count / kEdgeSegmentPx;
  int had = 0;   // what all edges have
  int more = 2;  // what those that are served get in all
  while (more < kMostEdgeSamples && left >= edges * (more - had)) {
    left -= edges * (more - had);
    had = more;
    more *= 2;
  }
  int served = left / (more - had);
  served = served < edges ? served : edges;
  const int least = served == 0 ? 256 : strength_of_rank(segment, count, served);
  int ties = served - count_from(segment, count, least + 1);
  for (int32_t x = 0; x < count; ++x) {
    const int strength = segment[x];
    const bool is_served = strength > least || (strength == least && ties-- > 0);
    segment[x] = static_cast<uint8_t>(strength < kEdgeStrength ? 0 : is_served ? more : had);
  }
}

}  // namespace

Status edge_strengths(ConstBytes above, ConstBytes row, ConstBytes below, int channels, int32_t width_px,
                      Bytes strengths) {
  if (channels < 1 || channels > 4) {
    return Status::kBadArgument;
  }
  if (width_px < 0 || width_px > kMaxPicturePx) {
    return Status::kOutOfRange;
  }
  const size_t pixel = static_cast<size_t>(channels);
  const size_t pixels = static_cast<size_t>(width_px);
  if (!takes_row(row, pixel * pixels, false) || !takes_row(above, pixel * pixels, true) ||
      !takes_row(below, pixel * pixels, true) || strengths.size < pixels) {
    return Status::kOutOfMemory;
  }
  uint32_t before = 0;  // against the pixel to the left
  for (size_t x = 0; x < pixels; ++x) {
    const size_t at = x * pixel;
    const uint32_t behind = x + 1 < pixels ? difference(row.data + at, row.data + at + pixel, pixel) : 0;
    uint32_t most = larger_gap(before, behind);
    if (above.size != 0) {
      most = larger_gap(most, difference(row.data + at, above.data + at, pixel));
    }
    if (below.size != 0) {
      most = larger_gap(most, difference(row.data + at, below.data + at, pixel));
    }
    strengths[x] = static_cast<uint8_t>(most);
    before = behind;
  }
  return Status::kOk;
}

Status place_edge_samples(ConstBytes strengths, int32_t width_px, Bytes samples) {
  if (width_px < 0 || width_px > kMaxPicturePx) {
    return Status::kOutOfRange;
  }
  const size_t pixels = static_cast<size_t>(width_px);
  if (strengths.size < pixels || samples.size < pixels) {
    return Status::kOutOfMemory;
  }
  for (size_t x = 0; x < pixels; ++x) {
    samples[x] = strengths[x];
  }
  for (int32_t x = 0; x < width_px; x += kEdgeSegmentPx) {
    const int32_t rest = width_px - x;
    serve_segment(samples.data + x, rest < kEdgeSegmentPx ? rest : kEdgeSegmentPx);
  }
  return Status::kOk;
}

}  // namespace thimble
