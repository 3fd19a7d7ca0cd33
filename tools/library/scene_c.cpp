// The face for C of a scene from a file.
#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "readers/oct.h"
#include "readers/source.h"
#include "thimble/files.h"
#include "thimble/files_c.h"

struct ThimbleFile : thimble::files::Scene {
  using Scene::Scene;
};

extern "C" {

THIMBLE_FILES_API ThimbleFile* thimble_file_open(const char* path, int depth, char* error,
                                                 size_t error_bytes) {
  try {
    if (path == nullptr) {
      throw std::invalid_argument("no path was given");
    }
    return new ThimbleFile(path, depth == 0 ? thimble::files::Options{}
                                            : thimble::files::Options{"--depth", std::to_string(depth)});
  } catch (const std::exception& caught) {
    if (error != nullptr && error_bytes != 0) {
      const std::size_t length = std::min(std::strlen(caught.what()), error_bytes - 1);
      std::memcpy(error, caught.what(), length);
      error[length] = 0;
    }
    return nullptr;
  }
}

THIMBLE_FILES_API uint64_t thimble_file_size(const ThimbleFile* file, uint32_t* side) {
  if (side != nullptr) {
    *side = uint32_t{1} << file->tree().level();
  }
  return file->tree().voxel_count();
}

THIMBLE_FILES_API uint64_t thimble_file_voxels(const ThimbleFile* file, ThimbleFileVoxel* voxels,
                                               uint64_t count) {
  uint64_t copied = 0;
  thimble::tools::walk_blocks(file->tree(), [&](const thimble::Vec3i& corner, int level, uint8_t material) {
    if (copied == count) {
      return;
    }
    thimble::tools::for_voxels(corner, level, [&](int32_t x, int32_t y, int32_t z) {
      if (copied != count) {
        voxels[copied++] = {static_cast<uint16_t>(x), static_cast<uint16_t>(y), static_cast<uint16_t>(z),
                            material, 0};
      }
    });
  });
  return copied;
}

THIMBLE_FILES_API void thimble_file_palette(const ThimbleFile* file, uint8_t rgb[768]) {
  const thimble::Span<const thimble::Rgb8> palette = file->palette();
  for (std::size_t i = 0; i < palette.size; ++i) {
    const uint8_t color[3] = {palette[i].r, palette[i].g, palette[i].b};
    std::memcpy(rgb + 3 * i, color, 3);
  }
}

THIMBLE_FILES_API void thimble_file_close(ThimbleFile* file) {
  delete file;
}

}  // extern "C"
