/// @file thimble.h
/// What a program needs to build a voxel world, make it compact and draw it.
#ifndef THIMBLE_THIMBLE_H
#define THIMBLE_THIMBLE_H

#include "base/memory.h"
#include "base/status.h"
#include "picture/camera.h"
#include "picture/render.h"
#include "picture/shading.h"
#include "tree/compact_tree.h"
#include "tree/octree.h"

#endif
