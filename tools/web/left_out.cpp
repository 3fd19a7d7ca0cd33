// Readers that the page does without: they need zlib, a JSON parser or pictures, half a megabyte for files
// that few drop. The table of readers (readers/read_any.cpp) knows them still, so that the sentence names the
// format.
#include "readers/gltf.h"
#include "readers/mts.h"
#include "readers/npy.h"
#include "readers/schematic.h"

namespace thimble::tools {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw InputError(std::string("is a ") + what + ", which this page does not read; the thimble command does");
}

}  // namespace

bool looks_like_gltf(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && bytes[0] == 'g' && bytes[1] == 'l' && bytes[2] == 'T' && bytes[3] == 'F';
}
Source read_gltf(const SharedBytes& /*file*/, const std::string& /*path*/, const Progress& /*progress*/) {
  refuse("glTF scene");
}
bool looks_like_mts(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && bytes[0] == 'M' && bytes[1] == 'T' && bytes[2] == 'S' && bytes[3] == 'M';
}
Source read_mts(const SharedBytes& /*file*/, const Progress& /*progress*/) {
  refuse("Minetest schematic");
}
bool looks_like_npy(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 6 && bytes[0] == 0x93 && bytes[1] == 'N' && bytes[2] == 'U' && bytes[3] == 'M';
}
Source read_npy(const SharedBytes& /*file*/, const Progress& /*progress*/) {
  refuse("NumPy array");
}
bool looks_like_schematic(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 3 && bytes[0] == 10 && bytes[1] == 0;
}
Source read_schematic(const SharedBytes& /*file*/, const Progress& /*progress*/) {
  refuse("Minecraft schematic");
}

}  // namespace thimble::tools
