// What the page does without: glTF needs a JSON parser, and pictures need two decoders. The table of readers
// (readers/read_any.cpp) knows the format still, so that the sentence names it, and meshes note their pictures.
#include "readers/read_any.h"
#include "readers/texture.h"
#include "scene/mesh_shade.h"

namespace thimble::tools {

bool looks_like_gltf(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && bytes[0] == 'g' && bytes[1] == 'l' && bytes[2] == 'T' && bytes[3] == 'F';
}
bool has_gltf_reader() {
  return false;
}
Source read_gltf(const SharedBytes& /*file*/, const ReadOptions& /*options*/, const Progress& /*progress*/) {
  throw InputError("is a glTF scene, which takes the thimble command; this page reads " + reader_endings());
}

std::shared_ptr<const Texture> Textures::beside(const std::string& /*name*/, bool /*is_opacity*/) {
  faults_.resize(1);
  return nullptr;
}
void Textures::miss(const std::string& /*name*/, const std::string& /*reason*/) {
  faults_.resize(1);
}
void Textures::add_notes(Notes& notes) const {
  if (!faults_.empty()) {
    notes.emplace_back("its pictures are not drawn, which takes the thimble command");
  }
}
void voxelise_shaded(const TriangleMesh& /*mesh*/, int /*level*/, bool /*z_up*/,
                     const std::function<std::uint8_t(Rgb, bool)>& /*material_of*/, const BlockSink& /*sink*/,
                     const Progress& /*progress*/) {}
double glow_power(const TriangleMesh& /*mesh*/) {
  return 1;
}
ColorHistogram mesh_colors(const TriangleMesh& mesh, int /*level*/, bool /*z_up*/) {
  return triangle_colors(mesh);
}

}  // namespace thimble::tools
