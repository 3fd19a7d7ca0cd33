// The reader that the page does without: glTF needs a JSON parser and two decoders of pictures. The table of
// readers (readers/read_any.cpp) knows it still, so that the sentence names the format.
#include "readers/gltf.h"
#include "readers/read_any.h"

namespace thimble::tools {

bool looks_like_gltf(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && bytes[0] == 'g' && bytes[1] == 'l' && bytes[2] == 'T' && bytes[3] == 'F';
}
bool has_gltf_reader() {
  return false;
}
Source read_gltf(const SharedBytes& /*file*/, const std::string& /*path*/, const Progress& /*progress*/) {
  throw InputError("is a glTF scene, which takes the thimble command; this page reads " + reader_endings());
}

}  // namespace thimble::tools
