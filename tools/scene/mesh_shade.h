/// Voxels of meshes with colours or pictures.
///
/// A voxel has the colour of its triangle next to the voxel's middle: the face's, or that of the corners mixed there, times
/// that of the picture, averaged as light over as much of it as a voxel covers. Where that is clear, the triangle gives no voxel; nor does its edge where the middle is
/// beyond it and the picture, which continues there on a neighbour, is clear. A voxel that gives off a tenth of a screen's
/// white, and more than it has of a colour, is of that light alone.
#pragma once

#include <cstdint>
#include <functional>

#include "readers/source.h"
#include "scene/voxelise.h"

namespace thimble::tools {

/// `voxelise` of a mesh that `is_shaded`; the material of a voxel is what `material_of` says of its colour and, where it
/// glows, its power (ColorHistogram), once or more often a voxel. Memory: 12 bytes a vertex, 19 more with a colour, and 24 a triangle that may
/// be clear; cell by cell 88 a triangle more, and the lists.
/// @throws InputError  no triangles, or so many clear ones over each other that it does not end
void voxelise_shaded(const TriangleMesh& mesh, int level, bool z_up,
                     const std::function<std::uint8_t(Rgb, std::uint32_t power_q8)>& material_of,
                     const BlockSink& sink, const Progress& progress);

/// For PaletteMap: the colours of its voxels in a world of 2^level, for which it is voxelised. Empty when it has none.
ColorHistogram mesh_colors(const TriangleMesh& mesh, int level, bool z_up);

}  // namespace thimble::tools
