// `.pcd` point clouds (Point Cloud Library), as text, as binary and as compressed binary.
//
// What is read: headers of versions .5 to .7; of the fields x, y and z, of any type, and `rgb` or `rgba`,
// four bytes that hold a colour (as an integer, or as the float with these bytes). All other fields are
// passed over. Points whose position is not finite mark where the sensor saw nothing and are left out.
// Compressed data (LZF) is unpacked once and kept. z is up, as it is in the file.
//
// Source of the format: Point Cloud Library, "The PCD (Point Cloud Data) file format"; of LZF: Marc Lehmann,
// "LibLZF", whose stream this reads with code of its own.
#include <limits>

#include "readers/color_scale.h"

namespace thimble::tools {
namespace {

enum class PcdEncoding : std::uint8_t { kText, kBinary, kCompressed };

struct Field {
  std::string_view name;
  NumberType type;
  std::uint64_t count = 1;
};

/// x, y, z, the colour as one value, and its components as three.
constexpr std::size_t kUsed = 7;
constexpr std::size_t kColor = 3;
constexpr std::size_t kParts = 4;

struct PcdHeader {
  std::vector<Field> fields;
  std::optional<std::uint64_t> width, height, points;
  PcdEncoding encoding = PcdEncoding::kText;
  std::size_t data_offset = 0;
  std::uint64_t data_line = 0;
  bool is_turned = false;  ///< from where the sensor stood to somewhere else
};

/// Where a value of all points lies.
struct Column {
  Field field;
  std::uint64_t first = 0;   ///< byte offset, or in a text the number of values before it
  std::uint64_t stride = 0;  ///< bytes from point to point
};

class PcdHeaderParser {
 public:
  explicit PcdHeaderParser(std::string_view text) : lines_(text) {}

  PcdHeader parse() {
    std::string_view line;
    for (;;) {
      tools::fail_if(!lines_.next(line), "the header has no line 'DATA'");
      const std::string_view word = take_word(line);
      if (word == "DATA") {
        encoding(take_word(line));
        break;
      }
      statement(word, line);
    }
    tools::fail_if(header_.fields.empty(), "the header has no line 'FIELDS'");
    header_.data_offset = lines_.offset();
    header_.data_line = lines_.line_number() + 1;
    return std::move(header_);
  }

 private:
  void statement(std::string_view word, std::string_view line) {
    if (word == "FIELDS" || word == "COLUMNS") {
      for (std::string_view name = take_word(line); !name.empty(); name = take_word(line)) {
        Field field;
        field.name = name;
        header_.fields.push_back(field);
      }
    } else if (word == "SIZE") {
      each_field(line, [&](Field& field, std::string_view value) {
        field.type.size_bytes = number(value, 8);
        fail_if(!std::has_single_bit(field.type.size_bytes), "the size ", quoted(value),
                " is not 1, 2, 4 or 8");
      });
    } else if (word == "TYPE") {
      each_field(line, [&](Field& field, std::string_view value) {
        fail_if(value != "F" && value != "U" && value != "I", "the type ", quoted(value),
                " is not F, U or I");
        field.type.kind = static_cast<char>(value.front() - 'A' + 'a');
      });
    } else if (word == "COUNT") {
      constexpr std::uint64_t kMostValues = 65536;
      each_field(line,
                 [&](Field& field, std::string_view value) { field.count = number(value, kMostValues); });
    } else if (word == "WIDTH") {
      header_.width = number(take_word(line), UINT32_MAX);
    } else if (word == "HEIGHT") {
      header_.height = number(take_word(line), UINT32_MAX);
    } else if (word == "POINTS") {
      header_.points = number(take_word(line), INT64_MAX);
    } else if (word == "VIEWPOINT") {
      for (const double still : {0, 0, 0, 1, 0, 0, 0}) {
        double value = still;
        parse_number(take_word(line), value);
        header_.is_turned = header_.is_turned || value != still;
      }
    } else {
      fail_if(!word.empty() && word.front() != '#' && word != "VERSION", quoted(word),
              " begins no line of a header");
    }
  }

  template <class Set>
  void each_field(std::string_view line, const Set& set) {
    for (Field& field : header_.fields) {
      set(field, take_word(line));
    }
  }

  void encoding(std::string_view word) {
    if (word == "binary") {
      header_.encoding = PcdEncoding::kBinary;
    } else if (word == "binary_compressed") {
      header_.encoding = PcdEncoding::kCompressed;
    } else {
      fail_if(word != "ascii", "the data ", quoted(word), " is not ascii, binary or binary_compressed");
    }
  }

  std::uint64_t number(std::string_view word, std::uint64_t most) const {
    std::int64_t value = 0;
    fail_if(!parse_integer(word, value) || value < 0 || static_cast<std::uint64_t>(value) > most,
            quoted(word), " is no whole number from 0 to ", most);
    return static_cast<std::uint64_t>(value);
  }
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    fail_at_line_if(is_wrong, lines_.line_number(), pieces...);
  }

  LineReader lines_;
  PcdHeader header_;
};

/// Unpacks LZF. A byte below 32 stands before that many literal bytes and one more; any other before a copy
/// of what came already: three bits of length (7: a byte more follows), thirteen of distance.
std::string unpack_lzf(std::span<const std::uint8_t> packed, std::size_t size) {
  // A copy of three bytes makes at most 264.
  fail_if(size / 88 > packed.size(), "the compressed data announces ", size, " bytes, which ", packed.size(),
          " packed ones cannot hold");
  ByteReader reader(packed, "the compressed data");
  std::string out;
  out.reserve(size);
  while (reader.remaining() > 0) {
    const std::size_t control = reader.u8();
    if (control < 32) {
      out.append(reader.text(control + 1));
    } else {
      const std::size_t length = 2 + ((control >> 5) == 7 ? 7 + std::size_t{reader.u8()} : control >> 5);
      const std::size_t distance = ((control & 31) << 8 | reader.u8()) + 1;
      reader.fail_if(distance > out.size(), "a copy at byte ", reader.offset(),
                     " of it reaches before the beginning");
      for (std::size_t i = 0; i < length; ++i) {
        out.push_back(out[out.size() - distance]);
      }
    }
    reader.fail_if(out.size() > size, "it holds more than the ", size, " bytes announced");
  }
  reader.fail_if(out.size() != size, "it holds ", out.size(), " bytes, not the ", size, " announced");
  return out;
}

Rgb color_of(std::uint32_t bits) {
  return {static_cast<std::uint8_t>(bits >> 16), static_cast<std::uint8_t>(bits >> 8),
          static_cast<std::uint8_t>(bits)};
}

class PcdCloud final : public PointCloud {
 public:
  PcdCloud(const SharedBytes& file, const ReadOptions& options, const Progress& progress)
      : file_(file), scale_(options) {
    const PcdHeader header = PcdHeaderParser(file.text()).parse();
    is_text_ = header.encoding == PcdEncoding::kText;
    data_offset_ = header.data_offset;
    data_line_ = header.data_line;
    fail_if(!header.points && !header.width, "the header has no line 'POINTS' or 'WIDTH'");
    count_ = header.points.value_or(header.width.value_or(0) * header.height.value_or(1));
    find_columns(header);
    if (header.encoding == PcdEncoding::kCompressed) {
      ByteReader data(file.bytes.subspan(data_offset_), "the compressed data", data_offset_);
      const std::uint32_t packed_bytes = data.u32();
      const std::uint32_t size_bytes = data.u32();
      fail_if(count_ != size_bytes / record_ || size_bytes % record_ != 0, "the header counts ", count_,
              " points of ", record_, " bytes, but the compressed data announces ", size_bytes, " bytes");
      file_ = SharedBytes::own(unpack_lzf(data.take(packed_bytes), size_bytes));
      data_offset_ = 0;
    }
    const std::uint64_t room = (file_.bytes.size() - data_offset_ + (is_text_ ? 1 : 0)) / record_;
    fail_if(count_ > room, "the header counts ", count_, " points, but the file has room for ", room,
            " at most");
    ProgressMeter meter(progress, file.bytes.size());
    std::uint64_t finite = 0;
    walk(
        [&](const CloudPoint&, const Components& components) {
          ++finite;
          for (const double component : components) {
            scale_.see(component);
          }
        },
        meter);
    fail_if(finite == 0, count_ == 0 ? "the header counts no points" : "no point of the file is finite");
    fail_if(has_parts_ && !scale_.is_valid(), "the fields r, g and b hold values that are no colors");
    note_left_out(notes, count_ - finite);
    note_if(header.is_turned, notes,
            "its points are drawn as the sensor saw them, without the header's VIEWPOINT");
    scale_.add_note(notes);
  }

  void for_each(const Visit& visit) const override {
    ProgressMeter meter;
    walk(
        [&](CloudPoint& point, const Components& components) {
          if (has_parts_) {
            point.color = scale_.color(components[0], components[1], components[2]);
          }
          visit(point);
        },
        meter);
  }
  bool has_color() const override { return has_color_ || has_parts_; }
  const char* counts_in() const override { return is_text_ ? "line" : "point"; }

 private:
  using Components = std::array<double, 3>;

  void find_columns(const PcdHeader& header) {
    static constexpr std::array<std::string_view, kUsed> kNames{"x", "y", "z", "rgb", "r", "g", "b"};
    std::array<bool, kUsed> found{};
    std::uint64_t bytes = 0;
    std::uint64_t values = 0;
    for (const Field& field : header.fields) {
      for (std::size_t i = 0; i < kUsed; ++i) {
        const bool is_name = equals_ignoring_case(field.name, kNames[i]) ||
                             (i == kColor && equals_ignoring_case(field.name, "rgba"));
        const bool is_color = i != kColor || field.type.size_bytes == 4;
        if (is_name && is_color && !found[i] && field.count > 0) {
          found[i] = true;
          columns_[i].field = field;
          columns_[i].first = is_text_ ? values : bytes;
        }
      }
      fail_if(field.type.kind == 'f' && field.type.size_bytes < 4, "the field ", quoted(field.name),
              " is of floats of ", field.type.size_bytes, " bytes, which there are not");
      bytes += field.type.size_bytes * field.count;
      values += field.count;
    }
    for (std::size_t i = 0; i < kColor; ++i) {
      fail_if(!found[i], "no field of the header is named ", kNames[i]);
    }
    has_color_ = found[kColor];
    has_parts_ = !has_color_ && found[kParts] && found[kParts + 1] && found[kParts + 2];
    record_ = is_text_ ? 2 * values : bytes;
    for (Column& column : columns_) {
      // Compressed data holds all values of one field, then all of the next.
      const bool is_apart = header.encoding == PcdEncoding::kCompressed;
      column.stride = is_apart ? column.field.type.size_bytes * column.field.count : bytes;
      column.first *= is_apart ? count_ : 1;
    }
  }

  template <class Take>
  void walk(const Take& take, ProgressMeter& meter) const {
    if (is_text_) {
      walk_lines(take, meter);
      return;
    }
    for (std::uint64_t i = 0; i < count_; ++i) {
      meter.at(data_offset_ + i * record_);
      const auto color = [&] {
        return color_of(static_cast<std::uint32_t>(load_bits(place(columns_[kColor], i), 4, false)));
      };
      give(
          i + 1, [&](std::size_t column) { return value(columns_[column], i); }, color, take);
    }
  }

  /// Gives `take` a point, unless it is not finite.
  template <class Value, class Color, class Take>
  void give(std::uint64_t line, const Value& value, const Color& color, const Take& take) const {
    CloudPoint point{value(0), value(1), value(2), {}, line};
    if (has_color_) {
      point.color = color();
    }
    Components components{};
    for (std::size_t part = 0; has_parts_ && part < 3; ++part) {
      components[part] = value(kParts + part);
    }
    if (point.is_finite()) {
      take(point, components);
    }
  }

  template <class Take>
  void walk_lines(const Take& take, ProgressMeter& meter) const {
    LineReader lines(file_.text().substr(data_offset_));
    std::string_view line;
    std::uint64_t last = 0;
    for (const Column& column : columns_) {
      last = std::max(last, column.first);
    }
    for (std::uint64_t done = 0; done < count_;) {
      fail_if(!lines.next(line), "the header counts ", count_, " points, but the file holds ", done);
      meter.at(data_offset_ + lines.offset());
      std::array<std::string_view, kUsed> words;
      std::uint64_t at = 0;
      for (std::string_view word = take_word(line); at <= last && !word.empty();
           word = take_word(line), ++at) {
        for (std::size_t i = 0; i < kUsed; ++i) {
          words[i] = columns_[i].first == at ? word : words[i];
        }
      }
      if (at == 0) {
        continue;
      }
      ++done;
      const std::uint64_t line_number = data_line_ + lines.line_number() - 1;
      fail_at_line_if(at <= last, line_number, at, " values, but the fields of the header take more");
      give(
          line_number, [&](std::size_t column) { return number_or_nan(words[column], line_number); },
          [&] { return written_color(words[kColor], line_number); }, take);
    }
  }

  Rgb written_color(std::string_view word, std::uint64_t line) const {
    const double value = number_or_nan(word, line);
    if (columns_[kColor].field.type.kind == 'f') {
      // Too large to be a float: its bytes stand for no colour either.
      return std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max())
                 ? color_of(std::bit_cast<std::uint32_t>(static_cast<float>(value)))
                 : Rgb{};
    }
    if (!(value >= INT32_MIN && value <= UINT32_MAX)) {
      fail_at_line(line, "the color ", quoted(word), " does not fit 32 bits");
    }
    return color_of(static_cast<std::uint32_t>(static_cast<std::int64_t>(value)));
  }

  const std::uint8_t* place(const Column& column, std::uint64_t i) const {
    return file_.bytes.data() + data_offset_ + column.first + i * column.stride;
  }
  double value(const Column& column, std::uint64_t i) const {
    return load_number(place(column, i), column.field.type, false);
  }

  SharedBytes file_;  ///< or what it unpacks to
  std::size_t data_offset_ = 0;
  std::uint64_t data_line_ = 0;
  std::uint64_t count_ = 0;
  std::uint64_t record_ = 0;  ///< fewest bytes of a point
  std::array<Column, kUsed> columns_;
  bool is_text_ = true;
  bool has_color_ = false;
  bool has_parts_ = false;  ///< the colour is in three fields
  ColorScale scale_;        ///< of these
};

}  // namespace

/// True when the first word that is no comment is one that a header begins with, or the first comment says
/// it.
bool looks_like_pcd(std::string_view text) {
  if (text.starts_with("# .PCD")) {
    return true;
  }
  const std::string_view word = WordReader(text, '#').next();
  return word == "VERSION" || word == "FIELDS" || word == "COLUMNS";
}

/// Checks the whole file once; the result keeps `file`, or what it unpacks to, and streams from it.
/// @throws InputError  a broken header, a field's type or size that there is not, a count that the bytes
///   cannot hold, a line with too few values, damaged LZF, no finite point
Source read_pcd(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  return std::make_unique<PcdCloud>(file, options, progress);
}

}  // namespace thimble::tools
