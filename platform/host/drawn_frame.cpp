#include "host/drawn_frame.h"

#include <algorithm>
#include <cstring>

namespace thimble::host {
namespace {

// The bytes that a value consists of. Equal ones are the same value; where padding alone differs, a frame is
// drawn once more.
template <class Value>
const std::uint8_t* bytes_of(const Value& value) {
  return reinterpret_cast<const std::uint8_t*>(&value);
}

bool lies_in(const void* data, std::size_t size, ConstBytes bytes) {
  const auto begin = reinterpret_cast<std::uintptr_t>(data);
  const auto front = reinterpret_cast<std::uintptr_t>(bytes.data);
  return begin >= front && size <= bytes.size && begin - front <= bytes.size - size;
}

}  // namespace

bool DrawnFrame::begins_with(const CompactTree& tree, const Camera& camera, const Shading& shading,
                             const Band& band, std::uintptr_t stack) {
  may_draw_ = painter_ != nullptr && lies_in(tree.bytes(), tree.size_bytes(), flash_) &&
              lies_in(shading.palette.data, shading.palette.size * sizeof(Rgb8), flash_);
  if (!may_draw_ || (next_row_ >= 0 && band.first_row >= next_row_ && band.format == format_ &&
                     tree.bytes() == tree_.bytes() &&
                     std::equal(camera_bytes_.begin(), camera_bytes_.end(), bytes_of(camera)) &&
                     std::equal(shading_bytes_.begin(), shading_bytes_.end(), bytes_of(shading)))) {
    return false;
  }
  tree_ = tree;
  camera_ = camera;
  shading_ = shading;
  format_ = band.format;
  std::copy_n(bytes_of(camera), sizeof(Camera), camera_bytes_.begin());
  std::copy_n(bytes_of(shading), sizeof(Shading), shading_bytes_.begin());
  next_row_ = 0;
  is_left_ = stack < deepest_;
  deepest_ = std::min(deepest_, stack);
  return true;
}

void DrawnFrame::draw() {
  pixels_.assign(band_bytes(format_, camera_.width_px(), camera_.height_px()), 0);
  is_drawn_ = painter_->draw(tree_, camera_, shading_, format_, {pixels_.data(), pixels_.size()});
}

// Whether its rows are in the picture and have room: if not, it is for the core to say so.
bool DrawnFrame::holds(const Band& band) const {
  if (has_pages(band.format) && (band.first_row % 8 != 0 ||
                                 (band.rows % 8 != 0 && band.first_row + band.rows != camera_.height_px()))) {
    return false;
  }
  const std::size_t row = row_bytes(format_, camera_.width_px());
  const std::size_t stride = band.stride_bytes == 0 ? row : band.stride_bytes;
  return band.first_row >= 0 && band.rows > 0 && band.rows <= camera_.height_px() - band.first_row &&
         stride >= row && row <= band.pixels.size &&
         row_place(format_, whole_rows(format_, band.rows)) - 1 <= (band.pixels.size - row) / stride;
}

bool DrawnFrame::hand_out(const Band& band) {
  left_rows_ = 0;
  if (!may_draw_ || !is_drawn_ || !holds(band)) {
    return false;
  }
  next_row_ = band.first_row + band.rows;
  if (is_left_) {
    left_row_ = band.first_row;
    left_rows_ = band.rows;
    return false;
  }
  const std::size_t row = row_bytes(format_, camera_.width_px());
  const std::size_t stride = band.stride_bytes == 0 ? row : band.stride_bytes;
  const std::uint8_t* from = pixels_.data() + row_place(format_, band.first_row) * row;
  const std::size_t places = row_place(format_, whole_rows(format_, band.rows));
  for (std::size_t i = 0; i < places; ++i, from += row) {
    // By a function that the simulation has bound: see bind_functions.
    std::memmove(band.pixels.data + i * stride, from, row);
  }
  return true;
}

bool DrawnFrame::contradicts(const Band& band) {
  const std::int32_t rows = left_rows_;
  left_rows_ = 0;
  if (rows == 0 || band.first_row != left_row_ || band.rows != rows || band.format != format_ ||
      !holds(band)) {
    return false;
  }
  const std::size_t row = row_bytes(format_, camera_.width_px());
  const std::uint8_t* from = pixels_.data() + row_place(format_, band.first_row) * row;
  const std::size_t bytes = row_place(format_, whole_rows(format_, rows)) * row;
  return !std::equal(band.pixels.begin(), band.pixels.begin() + bytes, from);
}

}  // namespace thimble::host
