/// @file thimble.h
/// What a first program needs: voxels put into a tree, or a scene baked beforehand, and pictures of it.
///
/// To draw a picture, read four headers
///
///   tree/octree.h         a world that is built voxel by voxel, in bytes that you give it
///   tree/compact_tree.h   the same world, small and read-only: what is traced
///   picture/camera.h      where the picture is taken from
///   picture/render.h      rows of pixels into your bytes
///
/// and one for what you want besides: base/memory.h (how memory is handed over, and what `open`, `make` and
/// `set` mean everywhere), picture/shading.h (colours), bake/baked_scene.h (a scene from a file or flash),
/// trace/ray.h (a single ray). Not included here, since programs that draw no more than that need none of
/// it: light/ (lights, shadows, glass, water), plane/ (the bit field and the balls), and the tree's other
/// forms.
#ifndef THIMBLE_THIMBLE_H
#define THIMBLE_THIMBLE_H

#include "bake/baked_scene.h"
#include "base/memory.h"
#include "base/status.h"
#include "picture/camera.h"
#include "picture/render.h"
#include "picture/shading.h"
#include "trace/ray.h"
#include "tree/compact_tree.h"
#include "tree/octree.h"

#endif
