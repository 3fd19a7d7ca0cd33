// libFuzzer targets: THIMBLE_FUZZED, a reader, on any bytes: refused with an InputError, or every promise of source.h
// kept. CMakeLists.txt names the readers; each is a program of its own.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <variant>

#include "readers/formats.h"

namespace thimble::tools {
namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

// Aborts when a promise of source.h is broken or anything but an InputError is thrown; returns 0.
int check_reader(FormatReader* read, std::span<const std::uint8_t> bytes) {
  Source source;
  try {
    source = read({bytes, nullptr}, {}, {});
  } catch (const InputError& error) {
    const std::string what = error.what();
    require(!what.empty() && what.back() != '.' && what.find('\n') == std::string::npos);
    return 0;
  }
  if (const auto* mesh = std::get_if<TriangleMesh>(&source)) {
    require(!mesh->positions.empty());
    require(mesh->colors.empty() || mesh->colors.size() == mesh->positions.size());
    const auto& corners = mesh->texcoord_corners;
    require(mesh->surface_of.size() == (mesh->surfaces.empty() ? 0 : mesh->triangles.size()));
    require(corners.empty() || corners.size() == mesh->triangles.size());
    require(!corners.empty() || mesh->texcoords.empty() || mesh->texcoords.size() == mesh->positions.size());
    for (const std::uint32_t surface : mesh->surface_of) {
      require(surface < mesh->surfaces.size());
    }
    for (const auto& position : mesh->positions) {
      require(std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(position[2]));
    }
    for (const auto& triangle : mesh->triangles) {
      for (const std::uint32_t corner : triangle) {
        require(corner < mesh->positions.size());
      }
    }
    return 0;
  }
  std::uint64_t count = 0;
  if (const auto* grid = std::get_if<std::unique_ptr<VoxelGrid>>(&source)) {
    const auto size = (*grid)->size();
    // A few bytes may stand for 2^27 voxels, sanitized a minute's: the first of them tell.
    struct Enough {};
    try {
      (*grid)->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, Rgb) {
        require(x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2]);
        if (++count == std::uint64_t{1} << 22) {
          throw Enough();
        }
      });
    } catch (const Enough&) {
      return 0;
    }
    require(count != 0);
    return 0;
  }
  std::get<std::unique_ptr<PointCloud>>(source)->for_each([&](const CloudPoint& point) {
    require(std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z));
    require(point.line != 0);
    ++count;
  });
  require(count != 0);
  return 0;
}

}  // namespace
}  // namespace thimble::tools

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return thimble::tools::check_reader(thimble::tools::THIMBLE_FUZZED, {data, size});
}
