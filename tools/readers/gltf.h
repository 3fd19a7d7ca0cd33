/// @file gltf.h
/// glTF 2.0 scenes: `.gltf` (JSON) and `.glb`.
///
/// What is read: the nodes of the default scene (of a file without one, all) with their transforms and instances
/// (EXT_mesh_gpu_instancing), the triangles, strips and fans of their meshes, or where there are none the points, and
/// colours: the material's base colour (or the diffuse one of KHR_materials_pbrSpecularGlossiness), its picture (PNG
/// or JPEG) by its coordinates, transform and wrap modes, and COLOR_0, multiplied. With alphaMode MASK what is less
/// opaque than the cutoff is nothing, with BLEND what is less than a tenth; vertices' alpha decides for a whole
/// triangle. Buffers are in the file, in `data:` links or in files beside it; a link that leaves the file's folder is
/// refused. y is up.
///
/// Not read: compressed meshes (Draco, meshopt) and what a file requires and is not known here, which are refused by
/// name, while of lights, materials and pictures it is noted; skins, morphs and animations, so that things stand as they
/// are at rest; lights and cameras. A picture that is not read is noted.
///
/// JSON is parsed by nlohmann's library, which takes some hundred bytes a value: a file is refused that has
/// more than `kGltfValueLimit` of them, or nests them deeper than `kGltfDepthLimit`.
///
/// Source of the format: Khronos Group, "glTF 2.0 Specification".
#ifndef THIMBLE_TOOLS_READERS_GLTF_H
#define THIMBLE_TOOLS_READERS_GLTF_H

#include <string>

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

inline constexpr std::uint64_t kGltfValueLimit = std::uint64_t{1} << 19;
inline constexpr int kGltfDepthLimit = 64;

bool looks_like_gltf(std::span<const std::uint8_t> bytes);
/// Whether this program has the reader: the page does without (tools/web/left_out.cpp).
bool has_gltf_reader();

/// Reads all of `file` and keeps none of it. Memory: 24 bytes a vertex (27 with colour, 35 with a picture), 12 a
/// triangle (16 with a picture). A mesh may be placed many times: what all places take is limited to three times the
/// bytes read, and 64 MB; pictures have a limit of their own (texture.h).
/// @param path  of the file, to find others beside it; empty: others are refused
/// @throws InputError  broken JSON, or anything in it that is missing, of another type or out of range; a
///   node that is its own descendant; an accessor that leaves its buffer; a position that is not finite
Source read_gltf(const SharedBytes& file, const std::string& path, const Progress& progress = {});

}  // namespace thimble::tools

#endif
