// NumPy arrays: `.npy`, and of an `.npz` the member with the most numbers among those of two dimensions and
// more.
//
// What an array is, its shape says:
// - N x 3 to N x 9 numbers: points, unless `ArrayAs::kHeights`. Of 6, 7 or 9 columns the last three, of 8 the fourth
//   to sixth are a colour where all of them are from 0 to 1 or whole numbers up to 255. Points that are not finite
//   are left out.
// - H x W numbers: heights, the first row the farthest (height_grid.cpp).
// - X x Y x Z: voxels, solid where a number is not 0 (a float: 0.5 or more).
// - X x Y x Z x 3 bytes: colours, black is empty; x 4: empty where the fourth is 0.
// Numbers are booleans, integers or floats of 2, 4 or 8 bytes, of either byte order, in C or Fortran order. In
// arrays of voxels z is up.
//
// Source of the format: NumPy, "NEP 1 - A Simple File Format for NumPy Arrays".
#include "readers/color_scale.h"

namespace thimble::tools {
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";
constexpr std::string_view kZipMagic("PK\x03\x04", 4);
// NumPy's own limit is 64.
constexpr std::size_t kMostDimensions = 64;

/// What a header says.
struct NpyHeader {
  NumberType type{'u', 1};
  bool is_big_endian = false;
  bool is_fortran = false;
  std::vector<std::uint64_t> shape;
  std::size_t data_offset = 0;
};

std::uint64_t numbers_of(const NpyHeader& header) {
  std::uint64_t count = 1;
  for (const std::uint64_t side : header.shape) {
    if (side != 0 && count > UINT64_MAX / 16 / side) {
      return UINT64_MAX / 16;
    }
    count *= side;
  }
  return count;
}

/// What stands behind a key in the header's dictionary, up to the next key.
std::string_view value_of(std::string_view dictionary, std::string_view key) {
  const std::size_t at = dictionary.find("'" + std::string(key) + "'");
  const std::size_t colon = dictionary.find(':', at);
  fail_if(colon == std::string_view::npos, "the header has no ", quoted(key));
  std::string_view value = dictionary.substr(colon + 1);
  value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
  return value;
}

void read_type(std::string_view value, NpyHeader& header) {
  const std::string_view text = value.size() > 1 && (value[0] == '\'' || value[0] == '"')
                                    ? value.substr(1, value.find(value[0], 1) - 1)
                                    : std::string_view();
  static constexpr std::array<std::string_view, 13> kTypes{"b1", "u1", "u2", "u4", "u8", "i1", "i2",
                                                           "i4", "i8", "f2", "f4", "f8", "?"};
  const bool has_order = !text.empty() && std::string_view("<>|=").find(text[0]) != std::string_view::npos;
  const std::string_view type = text.substr(has_order ? 1 : 0);
  fail_if(std::find(kTypes.begin(), kTypes.end(), type) == kTypes.end(), "the type of the array's numbers, ",
          !text.empty()            ? quoted(text)
          : value.starts_with('[') ? "records"
                                   : quoted(value.substr(0, value.find(','))),
          ", is none of booleans, integers, and floats of 2, 4 or 8 bytes");
  header.type.kind = type[0] == '?' ? 'b' : type[0];
  header.type.size_bytes = type.size() < 2 ? 1 : static_cast<std::size_t>(type[1] - '0');
  header.is_big_endian = has_order && text[0] == '>';
}

void read_shape(std::string_view value, NpyHeader& header) {
  const std::size_t end = value.find(')');
  fail_if(value.empty() || value[0] != '(' || end == std::string_view::npos,
          "the array's shape is no list in parentheses");
  value = value.substr(1, end - 1);
  while (value.find_first_not_of(" ,") != std::string_view::npos) {
    value.remove_prefix(value.find_first_not_of(" ,"));
    const std::size_t length = std::min(value.find_first_of(" ,"), value.size());
    std::int64_t side = 0;
    fail_if(!parse_integer(value.substr(0, length), side) || side < 0, "the array's shape holds ",
            quoted(value.substr(0, length)), ", which is no length");
    fail_if(header.shape.size() == kMostDimensions, "the array has more than ", kMostDimensions,
            " dimensions");
    header.shape.push_back(static_cast<std::uint64_t>(side));
    value.remove_prefix(length);
  }
}

NpyHeader read_npy_header(std::span<const std::uint8_t> bytes) {
  fail_if(!SharedBytes{bytes, nullptr}.text().starts_with(kNpyMagic),
          "is no NumPy array: it does not begin with \"\\x93NUMPY\"");
  ByteReader reader(bytes, "the header");
  reader.skip(kNpyMagic.size());
  const unsigned version = reader.u8();
  reader.skip(1);
  fail_if(version < 1 || version > 3, "version ", version,
          " at byte offset 6 is not supported, only 1 to 3 are");
  const std::string_view dictionary = reader.text(version == 1 ? reader.u16() : reader.u32());
  NpyHeader header;
  read_type(value_of(dictionary, "descr"), header);
  header.is_fortran = value_of(dictionary, "fortran_order").starts_with("True");
  read_shape(value_of(dictionary, "shape"), header);
  header.data_offset = static_cast<std::size_t>(reader.offset());
  return header;
}

/// An array's numbers.
struct Array {
  NpyHeader header;
  SharedBytes bytes;
  std::vector<std::uint64_t> strides;  ///< in numbers

  Array(NpyHeader read, SharedBytes file) : header(std::move(read)), bytes(std::move(file)) {
    const std::uint64_t room = (bytes.bytes.size() - header.data_offset) / header.type.size_bytes;
    fail_if(numbers_of(header) > room, "the array's shape takes ", numbers_of(header), " numbers of ",
            header.type.size_bytes, " bytes, but the file has room for ", room);
    strides.resize(header.shape.size());
    std::uint64_t stride = 1;
    for (std::size_t i = 0; i < strides.size(); ++i) {
      const std::size_t axis = header.is_fortran ? i : strides.size() - 1 - i;
      strides[axis] = stride;
      stride *= header.shape[axis];
    }
  }

  double at(std::uint64_t index) const {
    const std::uint8_t* first = bytes.bytes.data() + header.data_offset + index * header.type.size_bytes;
    return load_number(first, header.type, header.is_big_endian);
  }
};

class ArrayPoints final : public PointCloud {
 public:
  ArrayPoints(Array array, const ReadOptions& options) : array_(std::move(array)), scale_(options) {
    const std::uint64_t columns = array_.header.shape[1];
    first_color_ = columns < 6 ? 0 : (columns == 8 ? 3 : columns - 3);
    std::uint64_t finite = 0;
    walk([&](const CloudPoint& point) {
      ++finite;
      for (std::uint64_t channel = 0; first_color_ != 0 && channel < 3; ++channel) {
        scale_.see(number(point.line - 1, first_color_ + channel));
      }
    });
    fail_if(finite == 0,
            array_.header.shape[0] == 0 ? "the array holds no points" : "no point of the array is finite");
    note_left_out(notes, array_.header.shape[0] - finite);
    has_color_ = first_color_ != 0 && scale_.looks_like_colors();
    if (has_color_) {
      scale_.add_note(notes);
    }
    const std::uint64_t used = has_color_ ? 6 : 3;
    note_if(columns > used, notes, "of the array's ", columns, " columns, ",
            has_color_ ? concat("1 to 3 are taken for places and ", first_color_ + 1, " to ",
                                first_color_ + 3, " for colors")
                       : "the first three are taken for places, none for colors");
    note_if(columns <= used && array_.header.type.kind != 'f' && options.as == ArrayAs::kByShape, notes,
            "its rows of whole numbers are places: voxels by --as-voxels, heights by --as-heights");
  }
  void for_each(const Visit& visit) const override {
    walk([&](CloudPoint& point) {
      if (has_color_) {
        const auto part = [&](std::uint64_t channel) {
          return number(point.line - 1, first_color_ + channel);
        };
        point.color = scale_.color(part(0), part(1), part(2));
      }
      visit(point);
    });
  }
  bool has_color() const override { return has_color_; }

 private:
  double number(std::uint64_t i, std::uint64_t column) const {
    return array_.at(i * array_.strides[0] + column * array_.strides[1]);
  }
  /// Calls take(point) for each point that is finite, without its colour.
  template <class Take>
  void walk(const Take& take) const {
    for (std::uint64_t i = 0; i < array_.header.shape[0]; ++i) {
      CloudPoint point{number(i, 0), number(i, 1), number(i, 2), {}, i + 1};
      if (point.is_finite()) {
        take(point);
      }
    }
  }
  Array array_;
  ColorScale scale_;
  std::uint64_t first_color_ = 0;  ///< column; 0 where there is none
  bool has_color_ = false;
};

class ArrayGrid final : public VoxelGrid {
 public:
  explicit ArrayGrid(Array array)
      : array_(std::move(array)), channels_(array_.header.shape.size() == 4 ? array_.header.shape[3] : 0) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint64_t side = array_.header.shape[axis];
      fail_if(side < 1 || side > kGridSideLimit, "the array has a side of ", side, " voxels; there are 1 to ",
              kGridSideLimit);
      size_[axis] = static_cast<std::int32_t>(side);
    }
    has_color_ = channels_ != 0;
    const std::uint64_t numbers = array_.header.type.kind == 'f' ? numbers_of(array_.header) : 0;
    for (std::uint64_t i = 0; i < numbers; ++i) {
      if (array_.at(i) < 0) {
        notes.emplace_back(
            "it holds numbers below 0, as distances to a surface are; solid is what is 0.5 or more");
        break;
      }
    }
    check_solid("the array holds nothing solid");
  }
  void for_each(const Visit& visit) const override {
    for (std::int32_t x = 0; x < size_[0]; ++x) {
      for (std::int32_t y = 0; y < size_[1]; ++y) {
        for (std::int32_t z = 0; z < size_[2]; ++z) {
          if (const auto color = color_at(x, y, z)) {
            visit(x, y, z, *color);
          }
        }
      }
    }
  }

 private:
  std::optional<Rgb> color_at(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::uint64_t first = static_cast<std::uint64_t>(x) * array_.strides[0] +
                                static_cast<std::uint64_t>(y) * array_.strides[1] +
                                static_cast<std::uint64_t>(z) * array_.strides[2];
    if (channels_ == 0) {
      const double value = array_.at(first);
      return value != 0 && (array_.header.type.kind != 'f' || value >= 0.5) ? std::optional<Rgb>(Rgb{})
                                                                            : std::nullopt;
    }
    const auto channel = [&](std::uint64_t i) {
      return static_cast<std::uint8_t>(array_.at(first + i * array_.strides[3]));
    };
    const Rgb color{channel(0), channel(1), channel(2)};
    const bool is_solid = channels_ == 4 ? channel(3) != 0 : color != Rgb{0, 0, 0};
    return is_solid ? std::optional<Rgb>(color) : std::nullopt;
  }

  Array array_;
  std::uint64_t channels_;  ///< 0 without colours
};

std::string shape_of(const NpyHeader& header) {
  std::string text;
  for (const std::uint64_t side : header.shape) {
    text += (text.empty() ? "" : " x ") + std::to_string(side);
  }
  return text.empty() ? "one number" : text;
}

Source source_of(Array array, const ReadOptions& options) {
  const NpyHeader& header = array.header;
  const std::size_t dimensions = header.shape.size();
  const bool has_rows_of_points = dimensions == 2 && header.shape[1] >= 3 && header.shape[1] <= 9;
  if (has_rows_of_points && options.as != ArrayAs::kHeights) {
    return std::make_unique<ArrayPoints>(std::move(array), options);
  }
  fail_if(options.as == ArrayAs::kPoints, "--as-points: points are N x 3 to N x 9 numbers, and this is ",
          shape_of(header));
  if (dimensions == 2) {
    return height_landscape(header.shape[1], header.shape[0], [&](std::uint64_t column, std::uint64_t row) {
      return array.at(row * array.strides[0] + column * array.strides[1]);
    });
  }
  const bool is_color =
      dimensions == 4 && header.type == NumberType{'u', 1} && (header.shape[3] == 3 || header.shape[3] == 4);
  if (dimensions == 3 || is_color) {
    return std::make_unique<ArrayGrid>(std::move(array));
  }
  throw InputError("an array of ", shape_of(header), header.shape.empty() ? "" : " numbers",
                   " is read as nothing; points are N x 3 to N x 9, heights H x W, voxels X x Y x Z, colours "
                   "X x Y x Z x 3 or 4 bytes");
}

/// The member of an archive that has the most to show, unpacked.
SharedBytes largest_member(const SharedBytes& file) {
  constexpr std::uint64_t kEnoughForHeader = 4096;
  std::optional<ZipMember> best;
  std::uint64_t most = 0;
  for (const ZipMember& member : zip_members(file)) {
    const SharedBytes beginning = zip_beginning(member, kEnoughForHeader);
    if (!beginning.text().starts_with(kNpyMagic)) {
      continue;
    }
    const NpyHeader header = read_npy_header(beginning.bytes);
    if (header.shape.size() >= 2 && numbers_of(header) > most) {
      most = numbers_of(header);
      best = member;
    }
  }
  fail_if(!best, "the archive holds no NumPy array of two dimensions or more");
  return zip_unpack(*best);
}

Array array_of(const SharedBytes& file) {
  const SharedBytes bytes = file.text().starts_with(kZipMagic) ? largest_member(file) : file;
  return {read_npy_header(bytes.bytes), bytes};
}

}  // namespace

/// True for a `.npy` and for a `.zip` whose first member's name ends so.
bool looks_like_npy(std::string_view text) {
  constexpr std::size_t kNameLength = 26;
  constexpr std::size_t kName = 30;
  if (text.starts_with(kZipMagic) && text.size() > kName) {
    const auto byte = [&](std::size_t i) { return std::size_t{static_cast<std::uint8_t>(text[i])}; };
    return text.substr(kName, byte(kNameLength) | byte(kNameLength + 1) << 8).ends_with(".npy");
  }
  return text.starts_with(kNpyMagic);
}

/// Of an archive the result keeps the member unpacked.
/// @throws InputError  a broken header, a type or a shape that is none of these, fewer bytes than the shape
///   takes, a side of voxels over `kGridSideLimit`, no point that is finite, nothing solid;
///   an array that is not what the options say
Source read_npy(const SharedBytes& file, const ReadOptions& options, const Progress&) {
  return source_of(array_of(file), options);
}

NumberTable read_npy_table(const SharedBytes& file) {
  const auto array = std::make_shared<const Array>(array_of(file));
  const NpyHeader& header = array->header;
  fail_if(header.shape.size() != 2, "the array is ", shape_of(header), ", no table of rows and columns");
  return {header.shape[0], header.shape[1], [array](std::uint64_t row, std::uint64_t column) {
            return array->at(row * array->strides[0] + column * array->strides[1]);
          }};
}

}  // namespace thimble::tools
