/// The header of a `.ply` file: which elements it holds, and what their properties are to us. Internal to its reader.
#pragma once

#include "readers/formats.h"

namespace thimble::tools {

enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

/// What a property is to us. The first nine are positions in an array of a vertex's values.
enum class PlyRole : std::uint8_t {
  kX,
  kY,
  kZ,
  kRed,
  kGreen,
  kBlue,
  kOpacity,
  kU,
  kV,
  kIndices,
  kTexcoords,  ///< u and v of each corner of a face
  kPicture,    ///< the number of a face's picture
  kUnused
};
constexpr std::size_t kPlyVertexValues = 9;

/// As many as a file's lines may name.
constexpr std::size_t kMostPlyPictures = 256;

enum class PlyElementKind : std::uint8_t { kVertex, kFace, kStrips, kOther };

struct PlyProperty {
  NumberType type;
  NumberType count_type;  ///< of a list
  bool is_list = false;
  PlyRole role = PlyRole::kUnused;
  bool is_harmonic = false;  ///< a Gaussian splat's mean colour, as the first of its spherical harmonics
};

struct PlyElement {
  std::string name;
  PlyElementKind kind = PlyElementKind::kOther;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has(PlyRole role) const {
    return std::any_of(properties.begin(), properties.end(),
                       [role](const PlyProperty& property) { return property.role == role; });
  }
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::size_t body_offset = 0;
  std::uint64_t body_line = 0;        ///< line number of the body's first byte
  std::vector<std::string> pictures;  ///< that comments name, in their order
};

/// The header at the front of a whole file.
class PlyHeaderParser {
 public:
  explicit PlyHeaderParser(std::string_view text) : text_(text), lines_(text) {}

  /// @throws InputError  it is broken
  PlyHeader parse() {
    tools::fail_if(!looks_like_ply(text_), "the first line is not 'ply'");
    std::string_view line;
    lines_.next(line);
    for (;;) {
      tools::fail_if(!lines_.next(line), "the header has no line 'end_header'");
      const std::string_view word = take_word(line);
      if (word == "end_header") {
        break;
      }
      if (word == "format") {
        format(line);
      } else if (word == "element") {
        element(line);
      } else if (word == "property") {
        property(line);
      } else if (word == "comment") {
        if (take_word(line) == "TextureFile" && header_.pictures.size() < kMostPlyPictures) {
          header_.pictures.emplace_back(trimmed(line));
        }
      }
    }
    tools::fail_if(!has_format_, "the header has no line 'format'");
    header_.body_offset = lines_.offset();
    header_.body_line = lines_.line_number() + 1;
    // A binary body may begin with a byte that looks like the second half of a CRLF; only a header written
    // with CRLF throughout has one that belongs to the header.
    const bool first_line_has_cr_alone = text_.substr(3, 1) == "\r" && text_.substr(4, 1) != "\n";
    if (first_line_has_cr_alone && text_.substr(header_.body_offset - 2, 2) == "\r\n") {
      --header_.body_offset;
    }
    return std::move(header_);
  }

 private:
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    fail_at_line_if(is_wrong, lines_.line_number(), pieces...);
  }

  void format(std::string_view line) {
    const std::string_view word = take_word(line);
    if (word == "ascii") {
      header_.encoding = PlyEncoding::kAscii;
    } else if (word == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else {
      fail_if(word != "binary_big_endian", "the format ", quoted(word),
              " is not ascii, binary_little_endian or binary_big_endian");
      header_.encoding = PlyEncoding::kBigEndian;
    }
    has_format_ = true;
  }

  void element(std::string_view line) {
    const std::string_view name = take_word(line);
    const std::string_view count = take_word(line);
    std::int64_t value = 0;
    fail_if(name.empty() || !parse_integer(count, value) || value < 0, "element ", quoted(name),
            " has the count ", quoted(count), ", which is no number of elements");
    PlyElement added;
    added.name = name;
    added.kind = kind_named(name);
    added.count = static_cast<std::uint64_t>(value);
    if (added.kind != PlyElementKind::kOther) {
      for (const PlyElement& other : header_.elements) {
        fail_if(other.kind == added.kind, "element ", quoted(name), " is declared twice");
      }
    }
    header_.elements.push_back(std::move(added));
  }

  void property(std::string_view line) {
    fail_if(header_.elements.empty(), "a property comes before the first element");
    PlyElement& element = header_.elements.back();
    PlyProperty added;
    std::string_view word = take_word(line);
    if (word == "list") {
      added.is_list = true;
      added.count_type = type(take_word(line));
      fail_if(added.count_type.kind == 'f', "the length of a list cannot be of type float or double");
      word = take_word(line);
    }
    added.type = type(word);
    const std::string_view name = take_word(line);
    fail_if(name.empty(), "a property has no name");
    added.role = role_of(element.kind, name, added.is_list);
    added.is_harmonic = is_splat(name);
    if (added.role != PlyRole::kUnused && element.has(added.role)) {
      fail_if(added.role <= PlyRole::kZ || added.role == PlyRole::kIndices, "property ", quoted(name),
              " is declared twice");
      added.is_harmonic = false;
      added.role = PlyRole::kUnused;  // A second set of colours; the first one counts.
    }
    element.properties.push_back(added);
  }

  NumberType type(std::string_view name) const {
    const std::optional<NumberType> found = type_named(name);
    fail_if(!found, "the type ", quoted(name), " is unknown");
    return *found;
  }

  static std::optional<NumberType> type_named(std::string_view name) {
    struct Name {
      std::string_view old_name, new_name;
      NumberType type;
    };
    static constexpr std::array<Name, 8> kNames{{{"char", "int8", {'i', 1}},
                                                 {"uchar", "uint8", {'u', 1}},
                                                 {"short", "int16", {'i', 2}},
                                                 {"ushort", "uint16", {'u', 2}},
                                                 {"int", "int32", {'i', 4}},
                                                 {"uint", "uint32", {'u', 4}},
                                                 {"float", "float32", {'f', 4}},
                                                 {"double", "float64", {'f', 8}}}};
    for (const Name& known : kNames) {
      if (name == known.old_name || name == known.new_name) {
        return known.type;
      }
    }
    return std::nullopt;
  }

  static bool is_splat(std::string_view name) { return name.starts_with("f_dc_"); }

  static PlyRole role_of(PlyElementKind kind, std::string_view name, bool is_list) {
    // In the order of `PlyRole`.
    static constexpr std::array<std::string_view, kPlyVertexValues> kScalars{"x",
                                                                             "y",
                                                                             "z",
                                                                             "red diffuse_red r f_dc_0",
                                                                             "green diffuse_green g f_dc_1",
                                                                             "blue diffuse_blue b f_dc_2",
                                                                             "opacity",
                                                                             "u s texture_u texcoord_u",
                                                                             "v t texture_v texcoord_v"};
    for (std::size_t i = 0; !is_list && i < kScalars.size(); ++i) {
      const auto role = static_cast<PlyRole>(i);
      const bool is_color = role >= PlyRole::kRed && role <= PlyRole::kBlue;
      const bool is_of_it =
          kind == PlyElementKind::kVertex || (is_color && kind == PlyElementKind::kFace && !is_splat(name));
      std::string_view names = kScalars[i];
      for (std::string_view known = take_word(names); is_of_it && !known.empty(); known = take_word(names)) {
        if (equals_ignoring_case(name, known)) {
          return role;
        }
      }
    }
    const bool has_corners = kind == PlyElementKind::kFace || kind == PlyElementKind::kStrips;
    if (has_corners && is_list && (name == "vertex_indices" || name == "vertex_index")) {
      return PlyRole::kIndices;
    }
    if (kind == PlyElementKind::kFace && is_list && name == "texcoord") {
      return PlyRole::kTexcoords;
    }
    if (kind == PlyElementKind::kFace && !is_list && (name == "texnumber" || name == "texture")) {
      return PlyRole::kPicture;
    }
    return PlyRole::kUnused;
  }

  static PlyElementKind kind_named(std::string_view name) {
    if (name == "vertex") {
      return PlyElementKind::kVertex;
    }
    if (name == "face") {
      return PlyElementKind::kFace;
    }
    return name == "tristrips" ? PlyElementKind::kStrips : PlyElementKind::kOther;
  }

  std::string_view text_;
  LineReader lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

}  // namespace thimble::tools
