#include "readers/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "readers/color_scale.h"
#include "readers/mesh.h"
#include "readers/text.h"

namespace thimble::tools {

namespace {

enum class PlyEncoding : std::uint8_t { kAscii, kLittleEndian, kBigEndian };
enum class Scalar : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

/// What a property is to us. The first seven are positions in an array of a vertex's values.
enum class Role : std::uint8_t { kX, kY, kZ, kRed, kGreen, kBlue, kOpacity, kIndices, kUnused };
constexpr std::size_t kVertexValues = 7;

enum class ElementKind : std::uint8_t { kVertex, kFace, kStrips, kOther };

struct Property {
  Scalar type = Scalar::kInt8;
  Scalar count_type = Scalar::kUint8;  ///< of a list
  bool is_list = false;
  Role role = Role::kUnused;
  bool is_harmonic = false;  ///< a Gaussian splat's mean colour, as the first of its spherical harmonics
};

struct Element {
  std::string name;
  ElementKind kind = ElementKind::kOther;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<Element> elements;
  std::size_t body_offset = 0;
  std::uint64_t body_line = 0;  ///< line number of the body's first byte
  bool has_picture = false;     ///< a comment names one
};

constexpr std::size_t size_bytes(Scalar type) {
  switch (type) {
    case Scalar::kInt8:
    case Scalar::kUint8:
      return 1;
    case Scalar::kInt16:
    case Scalar::kUint16:
      return 2;
    case Scalar::kInt32:
    case Scalar::kUint32:
    case Scalar::kFloat:
      return 4;
    case Scalar::kDouble:
      break;
  }
  return 8;
}

constexpr bool is_real(Scalar type) {
  return type == Scalar::kFloat || type == Scalar::kDouble;
}

bool has_role(const Element& element, Role role) {
  for (const Property& property : element.properties) {
    if (property.role == role) {
      return true;
    }
  }
  return false;
}

bool has_color(const Element& element) {
  return has_role(element, Role::kRed) && has_role(element, Role::kGreen) && has_role(element, Role::kBlue);
}

bool is_splat(const Element& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const Property& property) { return property.is_harmonic; });
}

// --- Header ------------------------------------------------------------------------------------------------

std::optional<Scalar> scalar_named(std::string_view name) {
  struct Name {
    std::string_view old_name, new_name;
    Scalar type;
  };
  static constexpr std::array<Name, 8> kNames{{{"char", "int8", Scalar::kInt8},
                                               {"uchar", "uint8", Scalar::kUint8},
                                               {"short", "int16", Scalar::kInt16},
                                               {"ushort", "uint16", Scalar::kUint16},
                                               {"int", "int32", Scalar::kInt32},
                                               {"uint", "uint32", Scalar::kUint32},
                                               {"float", "float32", Scalar::kFloat},
                                               {"double", "float64", Scalar::kDouble}}};
  for (const Name& known : kNames) {
    if (name == known.old_name || name == known.new_name) {
      return known.type;
    }
  }
  return std::nullopt;
}

Role role_of(ElementKind kind, std::string_view name, bool is_list) {
  struct Name {
    std::string_view name;
    Role role;
  };
  static constexpr std::array<Name, 16> kScalars{{{"x", Role::kX},
                                                  {"y", Role::kY},
                                                  {"z", Role::kZ},
                                                  {"red", Role::kRed},
                                                  {"green", Role::kGreen},
                                                  {"blue", Role::kBlue},
                                                  {"diffuse_red", Role::kRed},
                                                  {"diffuse_green", Role::kGreen},
                                                  {"diffuse_blue", Role::kBlue},
                                                  {"r", Role::kRed},
                                                  {"g", Role::kGreen},
                                                  {"b", Role::kBlue},
                                                  {"f_dc_0", Role::kRed},
                                                  {"f_dc_1", Role::kGreen},
                                                  {"f_dc_2", Role::kBlue},
                                                  {"opacity", Role::kOpacity}}};
  if (kind == ElementKind::kVertex && !is_list) {
    for (const Name& known : kScalars) {
      if (name == known.name) {
        return known.role;
      }
    }
  }
  const bool has_corners = kind == ElementKind::kFace || kind == ElementKind::kStrips;
  if (has_corners && is_list && (name == "vertex_indices" || name == "vertex_index")) {
    return Role::kIndices;
  }
  return Role::kUnused;
}

ElementKind kind_named(std::string_view name) {
  if (name == "vertex") {
    return ElementKind::kVertex;
  }
  if (name == "face") {
    return ElementKind::kFace;
  }
  return name == "tristrips" ? ElementKind::kStrips : ElementKind::kOther;
}

class PlyHeaderParser {
 public:
  explicit PlyHeaderParser(std::string_view text) : text_(text), lines_(text) {}

  PlyHeader parse() {
    if (!looks_like_ply({reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size()})) {
      throw InputError("the first line is not 'ply'");
    }
    std::string_view line;
    lines_.next(line);
    for (;;) {
      if (!lines_.next(line)) {
        throw InputError("the header has no line 'end_header'");
      }
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
        header_.has_picture = header_.has_picture || take_word(line) == "TextureFile";
      }
    }
    if (!has_format_) {
      throw InputError("the header has no line 'format'");
    }
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
  [[noreturn]] void fail(const std::string& sentence) const { fail_at_line(lines_.line_number(), sentence); }

  void format(std::string_view line) {
    const std::string_view word = take_word(line);
    if (word == "ascii") {
      header_.encoding = PlyEncoding::kAscii;
    } else if (word == "binary_little_endian") {
      header_.encoding = PlyEncoding::kLittleEndian;
    } else if (word == "binary_big_endian") {
      header_.encoding = PlyEncoding::kBigEndian;
    } else {
      fail("the format " + quoted(word) + " is not ascii, binary_little_endian or binary_big_endian");
    }
    has_format_ = true;
  }

  void element(std::string_view line) {
    const std::string_view name = take_word(line);
    const std::string_view count = take_word(line);
    std::int64_t value = 0;
    if (name.empty() || !parse_integer(count, value) || value < 0) {
      fail("element " + quoted(name) + " has the count " + quoted(count) +
           ", which is no number of elements");
    }
    Element added;
    added.name = name;
    added.kind = kind_named(name);
    added.count = static_cast<std::uint64_t>(value);
    if (added.kind != ElementKind::kOther) {
      for (const Element& other : header_.elements) {
        if (other.kind == added.kind) {
          fail("element " + quoted(name) + " is declared twice");
        }
      }
    }
    header_.elements.push_back(std::move(added));
  }

  void property(std::string_view line) {
    if (header_.elements.empty()) {
      fail("a property comes before the first element");
    }
    Element& element = header_.elements.back();
    Property added;
    std::string_view word = take_word(line);
    if (word == "list") {
      added.is_list = true;
      added.count_type = type(take_word(line));
      if (is_real(added.count_type)) {
        fail("the length of a list cannot be of type float or double");
      }
      word = take_word(line);
    }
    added.type = type(word);
    const std::string_view name = take_word(line);
    if (name.empty()) {
      fail("a property has no name");
    }
    added.role = role_of(element.kind, name, added.is_list);
    added.is_harmonic = name.starts_with("f_dc_");
    if (added.role != Role::kUnused && has_role(element, added.role)) {
      if (added.role <= Role::kZ || added.role == Role::kIndices) {
        fail("property " + quoted(name) + " is declared twice");
      }
      added.is_harmonic = false;
      added.role = Role::kUnused;  // A second set of colours; the first one counts.
    }
    element.properties.push_back(added);
  }

  Scalar type(std::string_view name) const {
    const std::optional<Scalar> found = scalar_named(name);
    if (!found) {
      fail("the type " + quoted(name) + " is unknown");
    }
    return *found;
  }

  std::string_view text_;
  LineReader lines_;
  PlyHeader header_;
  bool has_format_ = false;
};

// --- Body --------------------------------------------------------------------------------------------------
// `AsciiBody` and `BinaryBody` have the same members, so that one walk serves both:
//   scalar(type)        the next value; NaN where the text says so
//   skip(type, count)   passes over values
//   remaining()         bytes left
//   least_bytes(...)    the fewest bytes a record of an element can take
//   fail(sentence)      throws with the place of the value read last
// and are copyable marks of their own position.

class AsciiBody {
 public:
  AsciiBody(const SharedBytes& file, const PlyHeader& header)
      : words_(file.text().substr(header.body_offset), 0, header.body_line), start_(header.body_offset) {}

  double scalar(Scalar) {
    const std::string_view word = next();
    double value = 0;
    switch (parse_number(word, value)) {
      case NumberKind::kFinite:
        return value;
      case NumberKind::kNotFinite:
        return std::numeric_limits<double>::quiet_NaN();
      case NumberKind::kGarbage:
        break;
    }
    fail(quoted(word) + " is not a number");
  }
  void skip(Scalar, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      next();
    }
  }
  /// A digit and what separates it from the next; the last one may stand at the very end.
  static std::uint64_t least_bytes(const Element& element) { return 2 * element.properties.size(); }
  static std::uint64_t least_bytes(Scalar) { return 2; }
  std::uint64_t remaining() const { return std::uint64_t{words_.remaining()} + 1; }
  std::size_t offset() const { return start_ + words_.offset(); }
  std::uint64_t line() const { return words_.line(); }
  [[noreturn]] void fail(const std::string& sentence) const { fail_at_line(words_.line(), sentence); }
  static bool skip_fixed(const Element&) { return false; }
  void finish() {
    const std::string_view word = words_.next();
    if (!word.empty()) {
      fail(quoted(word) + " comes after the last value that the header declares");
    }
  }

 private:
  std::string_view next() {
    const std::string_view word = words_.next();
    if (word.empty()) {
      fail("the file ends before all that the header declares");
    }
    return word;
  }

  WordReader words_;
  std::size_t start_;
};

class BinaryBody {
 public:
  BinaryBody(const SharedBytes& file, const PlyHeader& header)
      : bytes_(file.bytes),
        next_(header.body_offset),
        big_endian_(header.encoding == PlyEncoding::kBigEndian) {}

  double scalar(Scalar type) {
    const std::uint64_t bits = take(size_bytes(type));
    switch (type) {
      case Scalar::kInt8:
        return static_cast<std::int8_t>(bits);
      case Scalar::kUint8:
        return static_cast<std::uint8_t>(bits);
      case Scalar::kInt16:
        return static_cast<std::int16_t>(bits);
      case Scalar::kUint16:
        return static_cast<std::uint16_t>(bits);
      case Scalar::kInt32:
        return static_cast<std::int32_t>(bits);
      case Scalar::kUint32:
        return static_cast<std::uint32_t>(bits);
      case Scalar::kFloat:
        return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
      case Scalar::kDouble:
        break;
    }
    return std::bit_cast<double>(bits);
  }
  void skip(Scalar type, std::uint64_t count) {
    if (count > remaining() / size_bytes(type)) {
      fail_early();
    }
    next_ += static_cast<std::size_t>(count) * size_bytes(type);
  }
  static std::uint64_t least_bytes(const Element& element) {
    std::uint64_t sum = 0;
    for (const Property& property : element.properties) {
      sum += size_bytes(property.is_list ? property.count_type : property.type);
    }
    return sum;
  }
  static std::uint64_t least_bytes(Scalar type) { return size_bytes(type); }
  std::uint64_t remaining() const { return bytes_.size() - next_; }
  std::size_t offset() const { return next_; }
  static std::uint64_t line() { return 0; }
  [[noreturn]] void fail(const std::string& sentence) const {
    throw InputError("before byte offset " + std::to_string(next_) + ": " + sentence);
  }
  /// Passes over an element without lists at once; its count has been held against the bytes left.
  bool skip_fixed(const Element& element) {
    for (const Property& property : element.properties) {
      if (property.is_list) {
        return false;
      }
    }
    next_ += static_cast<std::size_t>(element.count * least_bytes(element));
    return true;
  }
  static void finish() {}

 private:
  [[noreturn]] void fail_early() const {
    throw InputError("after byte offset " + std::to_string(next_) +
                     ": the file ends before all that the header declares");
  }
  std::uint64_t take(std::size_t count) {
    if (count > remaining()) {
      fail_early();
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t shift = 8 * (big_endian_ ? count - 1 - i : i);
      bits |= std::uint64_t{bytes_[next_ + i]} << shift;
    }
    next_ += count;
    return bits;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t next_;
  bool big_endian_;
};

template <class Body>
void check_count(const Body& body, const Element& element) {
  const std::uint64_t least = Body::least_bytes(element);
  if (least != 0 && element.count > body.remaining() / least) {
    throw InputError("the header declares " + std::to_string(element.count) + " of element " +
                     quoted(element.name) + ", but the file has room for " +
                     std::to_string(body.remaining() / least) + " at most");
  }
}

/// The length of a list, held against the bytes left.
template <class Body>
std::uint64_t list_length(Body& body, const Property& property) {
  const double length = body.scalar(property.count_type);
  if (!(length >= 0) || length != std::floor(length)) {
    body.fail("the length of a list is not a whole number from 0 on");
  }
  const std::uint64_t most = body.remaining() / Body::least_bytes(property.type);
  if (length > static_cast<double>(most)) {
    body.fail("a list of " + std::to_string(static_cast<std::uint64_t>(std::min(length, 1e18))) +
              " entries is longer than the rest of the file");
  }
  return static_cast<std::uint64_t>(length);
}

template <class Body>
void skip_property(Body& body, const Property& property) {
  body.skip(property.type, property.is_list ? list_length(body, property) : 1);
}

template <class Body>
void skip_element(Body& body, const Element& element, ProgressMeter& meter) {
  check_count(body, element);
  // Records without properties take no bytes, whatever their count.
  if (element.properties.empty() || body.skip_fixed(element)) {
    return;
  }
  for (std::uint64_t record = 0; record < element.count; ++record) {
    for (const Property& property : element.properties) {
      skip_property(body, property);
    }
    meter.at(body.offset());
  }
}

/// One vertex as it is written; a splat's colour from 0 to 1.
struct PlyVertex {
  std::array<double, kVertexValues> values{};
  std::uint64_t line = 0;  ///< 0 in a binary file

  std::array<double, 3> position() const { return {values[0], values[1], values[2]}; }
  bool is_finite() const {
    return std::isfinite(values[0]) && std::isfinite(values[1]) && std::isfinite(values[2]);
  }
  /// A splat that covers less than a tenth of what is behind it; opacities are written as logits.
  bool is_clear() const {
    return 1 / (1 + std::exp(-values[static_cast<std::size_t>(Role::kOpacity)])) < 0.1;
  }
};

/// What the three components of an element's colours are parts of.
class ColorParts {
 public:
  explicit ColorParts(const Element& element) {
    for (const Property& property : element.properties) {
      if (property.role >= Role::kRed && property.role <= Role::kBlue) {
        types_[static_cast<std::size_t>(property.role) - 3] = property.type;
      }
    }
  }
  void see(const PlyVertex& vertex) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (is_real(types_[i])) {
        floats_.see(vertex.values[3 + i]);
      }
    }
  }
  /// Floats are of 0 to 1, or of 0 to 255 where any that was seen is above 1.
  Rgb color(const PlyVertex& vertex) const {
    std::array<std::uint8_t, 3> bytes{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double full =
          is_real(types_[i]) ? floats_.full() : (types_[i] == Scalar::kUint16 ? 65535.0 : 255.0);
      bytes[i] = unit_to_byte(vertex.values[3 + i] / full);
    }
    return {bytes[0], bytes[1], bytes[2]};
  }

 private:
  std::array<Scalar, 3> types_{};
  ColorScale floats_;
};

/// Reads all vertices; `visit(vertex)`.
template <class Body, class VisitVertex>
void read_vertices(Body& body, const Element& element, ProgressMeter& meter, const VisitVertex& visit) {
  // A splat's colour is half and this part of the first of its harmonics, 1 / (2 sqrt(pi)).
  constexpr double kHarmonic = 0.28209479177387814;
  check_count(body, element);
  PlyVertex vertex;
  for (std::uint64_t record = 0; record < element.count; ++record) {
    for (const Property& property : element.properties) {
      if (property.role > Role::kOpacity) {
        skip_property(body, property);
        continue;
      }
      const double value = body.scalar(property.type);
      vertex.values[static_cast<std::size_t>(property.role)] =
          property.is_harmonic ? std::fmin(1, std::fmax(0, 0.5 + kHarmonic * value)) : value;
    }
    vertex.line = body.line();
    visit(vertex);
    meter.at(body.offset());
  }
}

/// Reads one index; `lowest` is -1 where that has a meaning.
template <class Body>
std::int64_t read_index(Body& body, Scalar type, std::int64_t lowest, std::uint64_t vertex_count,
                        const Element& element, std::uint64_t record) {
  const double value = body.scalar(type);
  if (!(value >= static_cast<double>(lowest) && value < static_cast<double>(vertex_count)) ||
      value != std::floor(value)) {
    body.fail(element.name + " " + std::to_string(record) + " has an index that is not one of the " +
              std::to_string(vertex_count) + " vertices");
  }
  return static_cast<std::int64_t>(value);
}

template <class Body>
void read_polygons(Body& body, const Element& element, std::uint64_t vertex_count, TriangleMesh& mesh,
                   Polygons& polygons, ProgressMeter& meter) {
  check_count(body, element);
  if (element.kind == ElementKind::kFace) {
    // Most files hold triangles only; the check above makes this at most a few times the file's size.
    mesh.triangles.reserve(mesh.triangles.size() + static_cast<std::size_t>(element.count));
  }
  for (std::uint64_t record = 0; record < element.count; ++record) {
    for (const Property& property : element.properties) {
      if (property.role != Role::kIndices) {
        skip_property(body, property);
        continue;
      }
      const std::uint64_t length = list_length(body, property);
      if (element.kind == ElementKind::kFace) {
        polygons.begin();
        for (std::uint64_t i = 0; i < length; ++i) {
          polygons.add(
              static_cast<std::uint32_t>(read_index(body, property.type, 0, vertex_count, element, record)));
        }
      } else {
        TriangleStrip strip(mesh);
        for (std::uint64_t i = 0; i < length; ++i) {
          const std::int64_t index = read_index(body, property.type, -1, vertex_count, element, record);
          if (index < 0) {
            strip.restart();
          } else {
            strip.add(static_cast<std::uint32_t>(index));
          }
        }
      }
    }
    meter.at(body.offset());
  }
}

bool holds_polygons(const Element& element) {
  return element.count != 0 && has_role(element, Role::kIndices);
}

/// Walks a whole body and gathers its mesh.
template <class Body>
TriangleMesh read_mesh(Body body, const PlyHeader& header, const Element& vertices, ProgressMeter& meter) {
  if (vertices.count > kMeshVertexLimit) {
    throw InputError("the mesh has " + std::to_string(vertices.count) + " vertices, the limit is " +
                     std::to_string(kMeshVertexLimit));
  }
  TriangleMesh mesh;
  Polygons polygons(mesh);
  for (const Element& element : header.elements) {
    if (element.kind == ElementKind::kVertex) {
      check_count(body, element);
      mesh.positions.reserve(static_cast<std::size_t>(element.count));
      const bool colored = has_color(element);
      Body first = body;
      ColorParts parts(element);
      read_vertices(body, element, meter, [&](const PlyVertex& vertex) {
        if (!vertex.is_finite()) {
          body.fail("a coordinate of vertex " + std::to_string(mesh.positions.size()) + " is not finite");
        }
        parts.see(vertex);
        mesh.positions.push_back(vertex.position());
      });
      if (colored) {
        mesh.colors.reserve(static_cast<std::size_t>(element.count));
        const Progress no_progress;
        ProgressMeter again(no_progress, 0);
        read_vertices(first, element, again,
                      [&](const PlyVertex& vertex) { mesh.colors.push_back(parts.color(vertex)); });
      }
    } else if (holds_polygons(element)) {
      read_polygons(body, element, vertices.count, mesh, polygons, meter);
    } else {
      skip_element(body, element, meter);
    }
  }
  body.finish();
  polygons.cut_ears();
  return mesh;
}

/// The vertices of a file without faces. `body` stands at the first of them.
template <class Body>
class PlyCloud final : public PointCloud {
 public:
  /// Reads them once, and leaves `body` behind them.
  PlyCloud(SharedBytes file, const Element& vertices, Body& body, ProgressMeter& meter)
      : file_(std::move(file)), vertices_(vertices), body_(body), parts_(vertices) {
    std::uint64_t finite = 0;
    std::uint64_t drawn = 0;
    read_vertices(body, vertices_, meter, [&](const PlyVertex& vertex) {
      finite += vertex.is_finite() ? 1U : 0U;
      if (is_drawn(vertex)) {
        ++drawn;
        parts_.see(vertex);
      }
    });
    if (drawn == 0) {
      throw InputError(finite == 0 ? "no vertex of the file is finite"
                                   : "all splats of the file are nearly clear");
    }
    note_left_out(notes, vertices_.count - finite);
    if (is_splat(vertices_)) {
      notes.push_back("Gaussian splats are drawn as points; " + std::to_string(finite - drawn) + " of " +
                      std::to_string(finite) + " are nearly clear and left out");
    }
  }

  void for_each(const Visit& visit) const override {
    Body body = body_;
    const Progress no_progress;
    ProgressMeter meter(no_progress, 0);
    CloudPoint point;
    std::uint64_t number = 0;
    read_vertices(body, vertices_, meter, [&](const PlyVertex& vertex) {
      ++number;
      if (!is_drawn(vertex)) {
        return;
      }
      point.x = vertex.values[0];
      point.y = vertex.values[1];
      point.z = vertex.values[2];
      point.color = has_color() ? parts_.color(vertex) : Rgb{};
      point.line = vertex.line != 0 ? vertex.line : number;
      visit(point);
    });
  }
  bool has_color() const override { return tools::has_color(vertices_); }
  const char* counts_in() const override { return body_.line() != 0 ? "line" : "point"; }

 private:
  bool is_drawn(const PlyVertex& vertex) const {
    const bool may_be_clear = is_splat(vertices_) && has_role(vertices_, Role::kOpacity);
    return vertex.is_finite() && !(may_be_clear && vertex.is_clear());
  }

  SharedBytes file_;
  Element vertices_;
  Body body_;
  ColorParts parts_;
};

template <class Body>
Source read_body(const SharedBytes& file, const PlyHeader& header, const Progress& progress) {
  const Element* vertices = nullptr;
  bool has_polygons = false;
  for (const Element& element : header.elements) {
    if (element.kind == ElementKind::kVertex) {
      vertices = &element;
    }
    has_polygons = has_polygons || holds_polygons(element);
  }
  if (vertices == nullptr || vertices->count == 0) {
    throw InputError("the file holds no vertices");
  }
  for (const Role role : {Role::kX, Role::kY, Role::kZ}) {
    if (!has_role(*vertices, role)) {
      throw InputError("element 'vertex' has no property x, y or z that is a number");
    }
  }
  ProgressMeter meter(progress, file.bytes.size());
  Body body(file, header);
  if (has_polygons) {
    TriangleMesh mesh = read_mesh(body, header, *vertices, meter);
    if (header.has_picture) {
      mesh.notes.push_back("its picture (TextureFile) is not drawn");
    }
    meter.done();
    return mesh;
  }
  std::unique_ptr<PointCloud> cloud;
  for (const Element& element : header.elements) {
    if (&element == vertices) {
      cloud = std::make_unique<PlyCloud<Body>>(file, element, body, meter);
    } else {
      skip_element(body, element, meter);
    }
  }
  body.finish();
  meter.done();
  return cloud;
}

}  // namespace

bool looks_like_ply(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && bytes[0] == 'p' && bytes[1] == 'l' && bytes[2] == 'y' &&
         (bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ');
}

Source read_ply(const SharedBytes& file, const Progress& progress) {
  const PlyHeader header = PlyHeaderParser(file.text()).parse();
  if (header.encoding == PlyEncoding::kAscii) {
    return read_body<AsciiBody>(file, header, progress);
  }
  return read_body<BinaryBody>(file, header, progress);
}

}  // namespace thimble::tools
