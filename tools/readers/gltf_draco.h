/// Meshes of a glTF file that Draco compressed (KHR_draco_mesh_compression). Internal to the glTF reader.
#pragma once

#include <string>

#include "readers/gltf_file.h"

namespace thimble::tools {

/// Fills the accessors of `primitive` with what its `extension` holds; then it is one of triangles.
/// @throws InputError  damaged data, more triangles than its bytes are believed to hold, an accessor of another length
void unpack_draco(GltfFile& file, const nlohmann::json& primitive, const nlohmann::json& extension,
                  const std::string& place);

}  // namespace thimble::tools
