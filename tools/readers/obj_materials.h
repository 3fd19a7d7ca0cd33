/// The materials of `.obj` files: `.mtl`, of which `Kd`, `d`, `Ke` and their pictures are read. Internal to the `.obj` reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "readers/source.h"

namespace thimble::tools {

/// Which face has which material, by the names that an `.obj` uses, and what files beside it say of these.
class ObjMaterials {
 public:
  /// The rest of a line `mtllib` or `usemtl`: names may hold blanks.
  void add_library(std::string_view name);
  void use(std::string_view name);
  /// Triangles `first` to `end` - 1 have the material in use.
  void take_triangles(std::size_t first, std::size_t end);

  /// Opens the libraries beside `path` and colours the faces of `mesh`, which gets surfaces with pictures; faces that
  /// are clear are left out. Nothing where no material has a colour. Where vertices have colours, these stay unless
  /// there is a picture. Adds the notes of what is missing and what is not drawn.
  /// @throws ShortageError  no descriptors or memory left to open a library
  void color_faces(const std::string& path, TriangleMesh& mesh) const;

 private:
  struct Described;
  /// Reads the library that `line` names, or, where there is none, the several.
  void read_libraries(const std::string& path, const std::string& line, Described& described,
                      Notes& notes) const;

  std::vector<std::string> libraries_;
  std::unordered_map<std::string, std::uint32_t> numbers_{{"", 0}};  ///< of the materials used; 0 is none
  bool has_more_ = false;
  std::uint32_t in_use_ = 0;
  std::vector<std::uint32_t> of_triangle_;  ///< empty as long as no material is used
};

}  // namespace thimble::tools
