// `.ply` files: meshes and point clouds, as text and as binary of either byte order.
//
// What is read: any elements and properties of any scalar type (old names such as `uchar`, new ones such as
// `uint8`) and lists anywhere; of these are used
// - element `vertex`: x, y, z; and red, green, blue (also `diffuse_red` ..., or `r`, `g`, `b`) when all
//   three are there: integers from 0 to 255 (ushort: 0 to 65535), float and double from 0 to 1, clamped;
// - element `face`: the list `vertex_indices` or `vertex_index`, a polygon; and, where vertices have no colours, its own;
// - element `tristrips`: a list of the same name, strips separated by -1.
// All else is passed over. A file with faces or strips becomes a mesh, any other
// a point cloud that streams from the file's bytes.
//
// Header lines may end with LF, CRLF or CR; lines with an unknown first word are passed over like comments,
// because exporters have written such. Values of a text file may be laid out on lines in any way; where the first line
// of an element holds more than one of it takes, and there are lines for all that follow, each line is one, and what else stands on
// it is passed over. Text behind the last value is noted; bytes after the last binary element are ignored.
//
// Source of the format: Greg Turk, "The PLY Polygon File Format", 1994.

#include "readers/color_scale.h"
#include "readers/ply_header.h"
#include "readers/texture.h"

namespace thimble::tools {

namespace {

bool has_color(const PlyElement& element) {
  return element.has(PlyRole::kRed) && element.has(PlyRole::kGreen) && element.has(PlyRole::kBlue);
}

bool is_splat(const PlyElement& element) {
  return std::any_of(element.properties.begin(), element.properties.end(),
                     [](const PlyProperty& property) { return property.is_harmonic; });
}

// --- Body --------------------------------------------------------------------------------------------------
// `AsciiBody` and `BinaryBody` have the same members, so that one walk serves both:
//   scalar(type)        the next value; NaN where the text says so
//   skip(type, count)   passes over values
//   remaining()         bytes left
//   least_bytes(...)    the fewest bytes a record of an element can take
//   begin(element), end_record()   what comes next is an element's records; one of them ends
//   finish(notes)       says what stands behind all of them
//   fail_if(is_wrong, sentence)   throws with the place of the value read last
// and are copyable marks of their own position.

class AsciiBody {
 public:
  AsciiBody(const SharedBytes& file, const PlyHeader& header)
      : words_(file.text().substr(header.body_offset), 0, header.body_line), start_(header.body_offset) {
    for (const PlyElement& element : header.elements) {
      records_left_ += element.properties.empty() ? 0 : element.count;
    }
  }

  double scalar(const NumberType&) {
    const std::string_view word = next();
    return number_or_nan(word, words_.line());
  }
  void skip(const NumberType&, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      next();
    }
  }
  /// A digit and what separates it from the next; the last one may stand at the very end.
  static std::uint64_t least_bytes(const PlyElement& element) { return 2 * element.properties.size(); }
  static std::uint64_t least_bytes(const NumberType&) { return 2; }
  std::uint64_t remaining() const { return std::uint64_t{words_.remaining()} + 1; }
  std::size_t offset() const { return start_ + words_.offset(); }
  std::uint64_t line() const { return words_.line(); }
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    fail_at_line_if(is_wrong, words_.line(), pieces...);
  }
  /// Decides whether each of the element's records is a line.
  void begin(const PlyElement& element) {
    WordReader line = words_;
    std::string_view word = line.next();
    for (const PlyProperty& property : element.properties) {
      std::int64_t values = 1;
      if (property.is_list) {
        parse_integer(word, values);
        word = line.next_on_line();
      }
      for (; values > 0 && !word.empty(); --values) {
        word = line.next_on_line();
      }
    }
    is_by_line_ = element.count != 0 && !word.empty() && has_line_each_.value_or(true);
    if (is_by_line_ && !has_line_each_) {
      has_line_each_ = is_by_line_ = line.has_lines(records_left_ - 1);
    }
    has_more_ = has_more_ || is_by_line_;
  }
  void end_record() {
    --records_left_;
    if (is_by_line_) {
      words_.skip_line();
    }
  }
  void finish(Notes& notes) {
    note_if(has_more_, notes, "its lines hold more values than the header declares; those are not read");
    const std::string_view word = words_.next();
    note_if(!word.empty(), notes, "line ", words_.line(), ": ", quoted(word),
            " and what follows comes after the last value that the header declares and is not read");
  }

 private:
  std::string_view next() {
    const std::string_view word = words_.next();
    fail_if(word.empty(), "the file ends before all that the header declares");
    return word;
  }

  WordReader words_;
  std::size_t start_;
  bool is_by_line_ = false;
  bool has_more_ = false;  ///< lines with other values
  std::uint64_t records_left_ = 0;
  std::optional<bool> has_line_each_{};  ///< of all that were left when the first line with more was met
};

class BinaryBody {
 public:
  BinaryBody(const SharedBytes& file, const PlyHeader& header)
      : bytes_(file.bytes),
        next_(header.body_offset),
        big_endian_(header.encoding == PlyEncoding::kBigEndian) {}

  double scalar(const NumberType& type) {
    skip(type, 1);
    return load_number(&bytes_[next_ - type.size_bytes], type, big_endian_);
  }
  void skip(const NumberType& type, std::uint64_t count) {
    tools::fail_if(count > remaining() / type.size_bytes, "after byte offset ", next_,
                   ": the file ends before all that the header declares");
    next_ += static_cast<std::size_t>(count) * type.size_bytes;
  }
  static std::uint64_t least_bytes(const PlyElement& element) {
    std::uint64_t sum = 0;
    for (const PlyProperty& property : element.properties) {
      sum += (property.is_list ? property.count_type : property.type).size_bytes;
    }
    return sum;
  }
  static std::uint64_t least_bytes(const NumberType& type) { return type.size_bytes; }
  std::uint64_t remaining() const { return bytes_.size() - next_; }
  std::size_t offset() const { return next_; }
  static std::uint64_t line() { return 0; }
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    tools::fail_if(is_wrong, "before byte offset ", next_, ": ", pieces...);
  }
  static void begin(const PlyElement&) {}
  static void end_record() {}
  static void finish(Notes&) {}

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t next_;
  bool big_endian_;
};

template <class Body>
void begin_element(Body& body, const PlyElement& element) {
  const std::uint64_t least = Body::least_bytes(element);
  if (least != 0 && element.count > body.remaining() / least) {
    throw InputError("the header declares ", element.count, " of element ", tools::quoted(element.name),
                     ", but the file has room for ", body.remaining() / least, " at most");
  }
  body.begin(element);
}

/// The length of a list, held against the bytes left.
template <class Body>
std::uint64_t list_length(Body& body, const PlyProperty& property) {
  const double length = body.scalar(property.count_type);
  body.fail_if(!(length >= 0) || length != std::floor(length),
               "the length of a list is not a whole number from 0 on");
  const std::uint64_t most = body.remaining() / Body::least_bytes(property.type);
  body.fail_if(length > static_cast<double>(most), "a list of ",
               static_cast<std::uint64_t>(std::min(length, 1e18)),
               " entries is longer than the rest of the file");
  return static_cast<std::uint64_t>(length);
}

template <class Body>
void skip_property(Body& body, const PlyProperty& property) {
  body.skip(property.type, property.is_list ? list_length(body, property) : 1);
}

/// Walks the records of an element, each by `read(number)`.
template <class Body, class Read>
void read_records(Body& body, const PlyElement& element, ProgressMeter& meter, const Read& read) {
  begin_element(body, element);
  // Records without properties take no bytes, whatever their count.
  const std::uint64_t count = element.properties.empty() ? 0 : element.count;
  for (std::uint64_t record = 0; record < count; ++record) {
    read(record);
    body.end_record();
    meter.at(body.offset());
  }
}

template <class Body>
void skip_element(Body& body, const PlyElement& element, ProgressMeter& meter) {
  read_records(body, element, meter, [&](std::uint64_t) {
    for (const PlyProperty& property : element.properties) {
      skip_property(body, property);
    }
  });
}

/// One vertex as it is written; a splat's colour from 0 to 1.
struct PlyVertex {
  std::array<double, kPlyVertexValues> values{};
  std::uint64_t line = 0;  ///< 0 in a binary file

  std::array<double, 3> position() const { return {values[0], values[1], values[2]}; }
  bool is_finite() const {
    return std::isfinite(values[0]) && std::isfinite(values[1]) && std::isfinite(values[2]);
  }
  /// A splat that covers less than a tenth of what is behind it; opacities are written as logits.
  bool is_clear() const {
    return 1 / (1 + std::exp(-values[static_cast<std::size_t>(PlyRole::kOpacity)])) < 0.1;
  }
};

/// What the three components of an element's colours are parts of.
class ColorParts {
 public:
  ColorParts(const PlyElement& element, const ReadOptions& options)
      : stated_(options.full_color), floats_(options) {
    for (const PlyProperty& property : element.properties) {
      if (property.role >= PlyRole::kRed && property.role <= PlyRole::kBlue) {
        types_[static_cast<std::size_t>(property.role) - 3] = property.type;
      }
    }
  }
  void see(const PlyVertex& vertex) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (types_[i].kind == 'f') {
        floats_.see(vertex.values[3 + i]);
      }
    }
  }
  void add_note(Notes& notes) const { floats_.add_note(notes); }
  /// Floats are of 0 to 1, or of 0 to 255 where any that was seen is above 1.
  Rgb color(const PlyVertex& vertex) const {
    std::array<std::uint8_t, 3> bytes{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double full = stated_ != 0 || types_[i].kind == 'f' ? floats_.full()
                          : types_[i] == NumberType{'u', 2}     ? 65535
                                                                : 255;
      bytes[i] = unit_to_byte(vertex.values[3 + i] / full);
    }
    return {bytes[0], bytes[1], bytes[2]};
  }

 private:
  std::array<NumberType, 3> types_{};
  std::uint16_t stated_;
  ColorScale floats_;
};

/// Reads all vertices; `visit(vertex)`.
template <class Body, class VisitVertex>
void read_vertices(Body& body, const PlyElement& element, ProgressMeter& meter, const VisitVertex& visit) {
  // A splat's colour is half and this part of the first of its harmonics, 1 / (2 sqrt(pi)).
  constexpr double kHarmonic = 0.28209479177387814;
  PlyVertex vertex;
  read_records(body, element, meter, [&](std::uint64_t) {
    for (const PlyProperty& property : element.properties) {
      if (property.role > PlyRole::kV) {
        skip_property(body, property);
        continue;
      }
      const double value = body.scalar(property.type);
      vertex.values[static_cast<std::size_t>(property.role)] =
          property.is_harmonic ? std::fmin(1, std::fmax(0, 0.5 + kHarmonic * value)) : value;
    }
    vertex.line = body.line();
    visit(vertex);
  });
}

/// A place on a picture, v downwards; in a file v runs up.
std::array<float, 2> texcoord_of(double u, double v) {
  return {static_cast<float>(u), static_cast<float>(1 - v)};
}

/// Reads one index; `lowest` is -1 where that has a meaning.
template <class Body>
std::int64_t read_index(Body& body, const NumberType& type, std::int64_t lowest, std::uint64_t vertex_count,
                        const PlyElement& element, std::uint64_t record) {
  const double value = body.scalar(type);
  body.fail_if(!(value >= static_cast<double>(lowest) && value < static_cast<double>(vertex_count)) ||
                   value != std::floor(value),
               element.name, " ", record, " has an index that is not one of the ", vertex_count, " vertices");
  return static_cast<std::int64_t>(value);
}

/// A face as it is written.
struct PlyFace {
  std::vector<std::uint32_t> corners;
  std::vector<std::array<float, 2>> texcoords;
  std::uint32_t surface = 1;  ///< of the mesh: the number of its picture and 1
  PlyVertex color;            ///< of which only that is set
};

/// Reads a face.
template <class Body>
void read_face(Body& body, const PlyElement& element, std::uint64_t record, std::uint64_t vertex_count,
               bool has_pictures, PlyFace& face) {
  face.corners.clear();
  face.texcoords.clear();
  for (const PlyProperty& property : element.properties) {
    if (property.role == PlyRole::kIndices) {
      const std::uint64_t length = list_length(body, property);
      for (std::uint64_t i = 0; i < length; ++i) {
        face.corners.push_back(
            static_cast<std::uint32_t>(read_index(body, property.type, 0, vertex_count, element, record)));
      }
    } else if (property.role == PlyRole::kTexcoords && has_pictures) {
      const std::uint64_t length = list_length(body, property);
      for (std::uint64_t i = 0; i + 1 < length; i += 2) {
        const double u = body.scalar(property.type);
        face.texcoords.push_back(texcoord_of(u, body.scalar(property.type)));
      }
      body.skip(property.type, length % 2);
    } else if (property.role <= PlyRole::kBlue) {
      face.color.values[static_cast<std::size_t>(property.role)] = body.scalar(property.type);
    } else if (property.role == PlyRole::kPicture && has_pictures) {
      const double number = body.scalar(property.type);
      face.surface = number >= 0 && number < kMostPlyPictures ? static_cast<std::uint32_t>(number) + 1 : 0;
    } else {
      skip_property(body, property);
    }
  }
}

template <class Body>
void read_strips(Body& body, const PlyElement& element, std::uint64_t vertex_count, TriangleMesh& mesh,
                 ProgressMeter& meter) {
  read_records(body, element, meter, [&](std::uint64_t record) {
    for (const PlyProperty& property : element.properties) {
      if (property.role != PlyRole::kIndices) {
        skip_property(body, property);
        continue;
      }
      const std::uint64_t length = list_length(body, property);
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
  });
}

/// @param pictures  that the file names
/// @param parts     of the faces' colours; null where those are not drawn
template <class Body>
void read_faces(Body& body, const PlyElement& element, std::uint64_t vertex_count, std::size_t pictures,
                const ColorParts* parts, TriangleMesh& mesh, Polygons& polygons, ProgressMeter& meter) {
  begin_element(body, element);
  // Most files hold triangles only; the check above makes this at most a few times the file's size.
  mesh.triangles.reserve(mesh.triangles.size() + static_cast<std::size_t>(element.count));
  PlyFace face;
  read_records(body, element, meter, [&](std::uint64_t record) {
    read_face(body, element, record, vertex_count, pictures != 0, face);
    const bool has_place = !face.texcoords.empty() && face.texcoords.size() == face.corners.size() &&
                           mesh.texcoords.size() + face.corners.size() < kNoTexcoord;
    const auto first = static_cast<std::uint32_t>(mesh.texcoords.size());
    polygons.begin();
    for (std::uint32_t i = 0; i < face.corners.size(); ++i) {
      polygons.add(face.corners[i], has_place ? first + i : kNoTexcoord);
    }
    if (has_place) {
      mesh.texcoords.insert(mesh.texcoords.end(), face.texcoords.begin(), face.texcoords.end());
    }
    if (pictures > 1) {
      mesh.surface_of.resize(mesh.triangles.size(), face.surface <= pictures ? face.surface : 0);
    }
    if (parts != nullptr) {
      mesh.face_colors.resize(mesh.triangles.size(), parts->color(face.color));
    }
  });
}

bool holds_polygons(const PlyElement& element) {
  return element.count != 0 && element.has(PlyRole::kIndices);
}

bool has_face_texcoords(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& element) { return element.has(PlyRole::kTexcoords); });
}

/// Gives the mesh the pictures that its file names.
void add_pictures(const std::string& path, const PlyHeader& header, TriangleMesh& mesh) {
  if (header.pictures.empty()) {
    return;
  }
  Textures textures(path);
  mesh.surfaces.resize(header.pictures.size() + 1);
  for (std::size_t i = 0; i < header.pictures.size(); ++i) {
    if (mesh.texcoords.empty()) {
      textures.miss(header.pictures[i], "has no place, for there are no texture coordinates");
    } else {
      mesh.surfaces[i + 1].color = textures.beside(header.pictures[i]);
    }
  }
  mesh.surface_of.resize(mesh.triangles.size(), 1);
  textures.add_notes(mesh.notes);
  check_texcoords(mesh);
  if (!mesh.surfaces.empty()) {
    mesh.colors = {};  // which are the picture's once more, or nothing
  }
}

/// The faces, in their own colours where vertices have none and no picture is named.
template <class Body>
void add_faces(Body& body, const PlyElement& element, const PlyHeader& header, const PlyElement& vertices,
               const ReadOptions& options, TriangleMesh& mesh, Polygons& polygons, ProgressMeter& meter) {
  const bool is_colored = has_color(element) && !has_color(vertices) && header.pictures.empty();
  ColorParts parts(element, options);
  if (is_colored) {
    Body ahead = body;  // what full is shows at their end
    PlyFace face;
    ProgressMeter unseen;
    read_records(ahead, element, unseen, [&](std::uint64_t record) {
      read_face(ahead, element, record, vertices.count, false, face);
      parts.see(face.color);
    });
    parts.add_note(mesh.notes);
  } else if (has_color(element)) {
    mesh.notes.push_back(std::string("the colors of its faces are not drawn, but those of its ") +
                         (header.pictures.empty() ? "vertices" : "pictures"));
  }
  read_faces(body, element, vertices.count, header.pictures.size(), is_colored ? &parts : nullptr, mesh,
             polygons, meter);
}

/// Walks a whole body and gathers its mesh.
template <class Body>
TriangleMesh read_mesh(Body body, const PlyHeader& header, const PlyElement& vertices,
                       const ReadOptions& options, ProgressMeter& meter) {
  fail_if(vertices.count > kMeshVertexLimit, "the mesh has ", vertices.count, " vertices, the limit is ",
          kMeshVertexLimit);
  TriangleMesh mesh;
  Polygons polygons(mesh);
  for (const PlyElement& element : header.elements) {
    if (element.kind == PlyElementKind::kVertex) {
      begin_element(body, element);
      mesh.positions.reserve(static_cast<std::size_t>(element.count));
      const bool colored = has_color(element);
      // Those of corners count before those of vertices.
      const bool has_places = !header.pictures.empty() && element.has(PlyRole::kU) &&
                              element.has(PlyRole::kV) && !has_face_texcoords(header);
      Body first = body;
      ColorParts parts(element, options);
      read_vertices(body, element, meter, [&](const PlyVertex& vertex) {
        body.fail_if(!vertex.is_finite(), "a coordinate of vertex ", mesh.positions.size(), " is not finite");
        parts.see(vertex);
        mesh.positions.push_back(vertex.position());
        if (has_places) {
          mesh.texcoords.push_back(texcoord_of(vertex.values[static_cast<std::size_t>(PlyRole::kU)],
                                               vertex.values[static_cast<std::size_t>(PlyRole::kV)]));
        }
      });
      parts.add_note(mesh.notes);
      if (colored) {
        mesh.colors.reserve(static_cast<std::size_t>(element.count));
        ProgressMeter again;
        read_vertices(first, element, again,
                      [&](const PlyVertex& vertex) { mesh.colors.push_back(parts.color(vertex)); });
      }
    } else if (holds_polygons(element)) {
      if (element.kind == PlyElementKind::kFace) {
        add_faces(body, element, header, vertices, options, mesh, polygons, meter);
      } else {
        read_strips(body, element, vertices.count, mesh, meter);
      }
    } else {
      skip_element(body, element, meter);
    }
  }
  body.finish(mesh.notes);
  if (!mesh.face_colors.empty()) {
    mesh.face_colors.resize(mesh.triangles.size());  // strips have none
  }
  polygons.cut_ears();
  return mesh;
}

/// The vertices of a file without faces. `body` stands at the first of them.
template <class Body>
class PlyCloud final : public PointCloud {
 public:
  /// Reads them once, and leaves `body` behind them.
  PlyCloud(SharedBytes file, const PlyElement& vertices, Body& body, const ReadOptions& options,
           ProgressMeter& meter)
      : file_(std::move(file)), vertices_(vertices), body_(body), parts_(vertices, options) {
    std::uint64_t finite = 0;
    std::uint64_t drawn = 0;
    read_vertices(body, vertices_, meter, [&](const PlyVertex& vertex) {
      finite += vertex.is_finite() ? 1U : 0U;
      if (is_drawn(vertex)) {
        ++drawn;
        parts_.see(vertex);
      }
    });
    fail_if(drawn == 0,
            finite == 0 ? "no vertex of the file is finite" : "all splats of the file are nearly clear");
    note_left_out(notes, vertices_.count - finite);
    parts_.add_note(notes);
    const std::string clear = concat("; ", finite - drawn, " of ", finite, " are nearly clear and left out");
    note_if(is_splat(vertices_), notes, "Gaussian splats are drawn as points", finite == drawn ? "" : clear);
  }

  void for_each(const Visit& visit) const override {
    Body body = body_;
    ProgressMeter meter;
    std::uint64_t number = 0;
    read_vertices(body, vertices_, meter, [&](const PlyVertex& vertex) {
      ++number;
      if (is_drawn(vertex)) {
        const auto [x, y, z] = vertex.position();
        visit({x, y, z, has_color() ? parts_.color(vertex) : Rgb{}, vertex.line != 0 ? vertex.line : number});
      }
    });
  }
  bool has_color() const override { return tools::has_color(vertices_); }
  const char* counts_in() const override { return body_.line() != 0 ? "line" : "point"; }

 private:
  bool is_drawn(const PlyVertex& vertex) const {
    const bool may_be_clear = is_splat(vertices_) && vertices_.has(PlyRole::kOpacity);
    return vertex.is_finite() && !(may_be_clear && vertex.is_clear());
  }

  SharedBytes file_;
  PlyElement vertices_;
  Body body_;
  ColorParts parts_;
};

template <class Body>
Source read_body(const SharedBytes& file, const ReadOptions& options, const PlyHeader& header,
                 const Progress& progress) {
  const PlyElement* vertices = nullptr;
  bool has_polygons = false;
  for (const PlyElement& element : header.elements) {
    if (element.kind == PlyElementKind::kVertex) {
      vertices = &element;
    }
    has_polygons = has_polygons || holds_polygons(element);
  }
  fail_if(vertices == nullptr || vertices->count == 0, "the file holds no vertices");
  for (const PlyRole role : {PlyRole::kX, PlyRole::kY, PlyRole::kZ}) {
    fail_if(!vertices->has(role), "element 'vertex' has no property x, y or z that is a number");
  }
  ProgressMeter meter(progress, file.bytes.size());
  Body body(file, header);
  if (has_polygons) {
    TriangleMesh mesh = read_mesh(body, header, *vertices, options, meter);
    add_pictures(options.path, header, mesh);
    return mesh;
  }
  std::unique_ptr<PointCloud> cloud;
  for (const PlyElement& element : header.elements) {
    if (&element == vertices) {
      cloud = std::make_unique<PlyCloud<Body>>(file, element, body, options, meter);
    } else {
      skip_element(body, element, meter);
    }
  }
  body.finish(cloud->notes);
  return cloud;
}

}  // namespace

/// True when the bytes begin with the line "ply".
bool looks_like_ply(std::string_view text) {
  return text.starts_with("ply\n") || text.starts_with("ply\r") || text.starts_with("ply ");
}

/// Checks the whole file; a mesh is returned as read, a point cloud keeps `file` and reads it again each
/// time.
///
/// Pictures of a mesh (`comment TextureFile`) lie beside the file; coordinates on them are those of corners (`texcoord`
/// of faces, with `texnumber` where there are several), or else those of vertices (`u v`, `s t`, `texture_u texture_v`).
/// A mesh whose picture is there has its colours alone.
///
/// Memory beyond the file: a mesh holds 24 bytes a vertex (27 with colour) and 12 a triangle, with pictures 8 more a
/// place on them and 16 a triangle; a point cloud some bytes a header line. A count of the header is held against the bytes that follow before anything is
/// allocated for it.
/// @throws InputError  a broken header; a count that the bytes cannot hold; a file that ends early; text that
///   is no number; a coordinate that is not finite; an index out of range; no vertex
Source read_ply(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  const PlyHeader header = PlyHeaderParser(file.text()).parse();
  if (header.encoding == PlyEncoding::kAscii) {
    return read_body<AsciiBody>(file, options, header, progress);
  }
  return read_body<BinaryBody>(file, options, header, progress);
}

}  // namespace thimble::tools
