// What the page does without: Debian has compiled the decoders of Draco and WebP for the host alone.
#include <webp/decode.h>

#include "readers/gltf_file.h"

namespace thimble::tools {

void unpack_draco(GltfFile& /*file*/, const nlohmann::json& /*primitive*/,
                  const nlohmann::json& /*extension*/, const std::string& place) {
  throw InputError(place +
                   ": it is compressed by Draco, which this page does not read; the thimble command does");
}

}  // namespace thimble::tools

extern "C" {

// No bytes are WebP, so none is decoded.
int WebPGetInfo(const std::uint8_t* /*bytes*/, std::size_t /*size*/, int* /*width*/, int* /*height*/) {
  return 0;
}
std::uint8_t* WebPDecodeRGBA(const std::uint8_t* /*bytes*/, std::size_t /*size*/, int* /*width*/,
                             int* /*height*/) {
  return nullptr;
}
void WebPFree(void* /*pixels*/) {}
}
