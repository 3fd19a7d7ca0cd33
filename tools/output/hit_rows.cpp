#include "output/hit_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <limits>
#include <string_view>
#include <type_traits>

#include "output/units.h"

namespace thimble::tools {
namespace {

// A line is shorter: fifteen whole numbers of up to 11 characters, two of up to 24, commas.
constexpr std::size_t kMostCharacters = 256;

// NumPy's types of px, py and kHitColumns, as `put_row` puts them.
constexpr std::array<std::string_view, 17> kTypes{"<i4", "<i4", "|u1", "<i4", "<i4", "<i4",
                                                  "<f8", "|i1", "<u4", "<i4", "<i4", "<i4",
                                                  "<i4", "<i4", "<i4", "<i2", "<f8"};
constexpr std::string_view kPixelColumns = "px,py,";

// A number that a line has with all of its 17 digits.
struct AllDigits {
  double value;
};

// The squares' sum is exact: below 2^42.
double length(const Vec3i& direction) {
  std::int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += std::int64_t{direction[axis]} * direction[axis];
  }
  return std::sqrt(static_cast<double>(sum));
}

// Calls put(value, is known) column by column.
template <class Put>
void put_row(const Ray& ray, const Hit& hit, bool has_material, const Put& put) {
  const bool is_hit = hit.kind == HitKind::kHit;
  const bool is_known = is_hit && has_material;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  put(static_cast<std::uint8_t>(is_hit ? 1 : 0), true);
  for (int axis = 0; axis < 3; ++axis) {
    put(is_hit ? hit.voxel[axis] : -1, is_hit);
  }
  put(AllDigits{is_hit ? hit_t(hit) : kNever}, is_hit);
  put(static_cast<std::int8_t>(is_hit ? static_cast<int>(hit.axis) : -1), is_hit);
  put(static_cast<std::uint32_t>(hit.visits), true);
  for (int axis = 0; axis < 3; ++axis) {
    put(ray.origin[axis].raw, true);
  }
  for (int axis = 0; axis < 3; ++axis) {
    put(ray.direction[axis], true);
  }
  put(static_cast<std::int16_t>(is_known ? hit.material : -1), is_known);
  put(is_hit ? hit_t(hit) * length(ray.direction) : kNever, is_hit);
}

// The bytes of a record.
struct PutBytes {
  std::string* to;

  template <class Number>
  void operator()(Number number, bool /*is_known*/) const {
    if constexpr (std::is_same_v<Number, AllDigits>) {
      (*this)(number.value, true);
    } else if constexpr (std::is_same_v<Number, double>) {
      (*this)(std::bit_cast<std::uint64_t>(number), true);
    } else {
      append_little(to, static_cast<std::uint64_t>(number), sizeof number);
    }
  }
};

// The letters of a line, a comma behind each number.
struct PutText {
  char** at;
  char* end;

  template <class Number>
  void operator()(Number number, bool is_known) const {
    if constexpr (std::is_same_v<Number, AllDigits>) {
      *at = is_known ? std::to_chars(*at, end, number.value, std::chars_format::general, 17).ptr : *at;
    } else if constexpr (std::is_same_v<Number, double>) {
      *at = is_known ? std::to_chars(*at, end, number).ptr : *at;
    } else {
      *at = is_known ? std::to_chars(*at, end, static_cast<std::int64_t>(number)).ptr : *at;
    }
    *(*at)++ = ',';
  }
};

}  // namespace

HitRows::HitRows(const std::string& path, bool has_pixels, bool has_material)
    : is_array_(path.ends_with(".npy")), has_pixels_(has_pixels), has_material_(has_material) {}

std::string HitRows::beginning(std::uint64_t rows) const {
  const std::string columns = concat(has_pixels_ ? kPixelColumns : "", kHitColumns);
  if (!is_array_) {
    return columns + "\n";
  }
  std::string type = "[";
  std::string_view names = columns;
  for (std::size_t i = has_pixels_ ? 0 : 2; i < kTypes.size(); ++i) {
    const std::size_t end = std::min(names.find(','), names.size());
    type.append(type.size() == 1 ? "('" : ", ('").append(names.substr(0, end)).append("', '");
    type.append(kTypes[i]).append("')");
    names.remove_prefix(std::min(end + 1, names.size()));
  }
  return npy_header(type + "]", std::to_string(rows) + ",");
}

void HitRows::append(std::string* to, const Ray& ray, const Hit& hit, std::int32_t x_px,
                     std::int32_t y_px) const {
  const auto put_all = [&](const auto& put) {
    if (has_pixels_) {
      put(x_px, true);
      put(y_px, true);
    }
    put_row(ray, hit, has_material_, put);
  };
  if (is_array_) {
    put_all(PutBytes{to});
    return;
  }
  const std::size_t before = to->size();
  to->resize(before + kMostCharacters);
  char* at = to->data() + before;
  put_all(PutText{&at, at + kMostCharacters});
  at[-1] = '\n';
  to->resize(static_cast<std::size_t>(at - to->data()));
}

}  // namespace thimble::tools
