// tinyobjloader, which Debian has compiled for the host alone.
#define TINYOBJLOADER_IMPLEMENTATION
#pragma clang diagnostic ignored "-Weverything"
#include <tiny_obj_loader.h>
