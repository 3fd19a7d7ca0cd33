#include "support/reader_inputs.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <variant>

namespace thimble::tools::test {

namespace {

bool is_sentence(const std::string& what) {
  return what.size() > 8 && what.size() < 400 && what.back() != '.' && what.find('\n') == std::string::npos;
}

}  // namespace

std::filesystem::path data_folder() {
  const char* folder = std::getenv("THIMBLE_DATA");
  if (folder == nullptr) {
    std::fprintf(stderr, "skipped: THIMBLE_DATA is not set\n");
    return {};
  }
  return folder;
}

std::string contents_of(const std::filesystem::path& path) {
  if (path.extension() != ".gz") {
    std::ifstream file(path, std::ios::binary);
    REQUIRE(file.good());
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  REQUIRE(file != nullptr);
  std::string out;
  std::array<char, 65536> block{};
  int count = 0;
  while ((count = gzread(file.get(), block.data(), static_cast<unsigned>(block.size()))) > 0) {
    out.append(block.data(), static_cast<std::size_t>(count));
  }
  REQUIRE(count == 0);
  return out;
}

std::vector<CloudPoint> points_of(const PointCloud& cloud) {
  std::vector<CloudPoint> points;
  cloud.for_each([&](const CloudPoint& point) { points.push_back(point); });
  std::size_t next = 0;
  bool same = true;
  cloud.for_each([&](const CloudPoint& point) {
    same = same && next < points.size() && point.x == points[next].x && point.y == points[next].y &&
           point.z == points[next].z && point.color == points[next].color && point.line == points[next].line;
    ++next;
  });
  CHECK(same);
  CHECK(next == points.size());
  return points;
}

Source source_of(Reader reader, std::string text) {
  return reader(SharedBytes::own(std::move(text)), {}, {});
}

std::vector<CloudPoint> read_points(Reader reader, std::string text) {
  const Source source = source_of(reader, std::move(text));
  REQUIRE(std::holds_alternative<std::unique_ptr<PointCloud>>(source));
  return points_of(*std::get<std::unique_ptr<PointCloud>>(source));
}

bool cloud_has_color(Reader reader, std::string text) {
  const Source source = source_of(reader, std::move(text));
  REQUIRE(std::holds_alternative<std::unique_ptr<PointCloud>>(source));
  return std::get<std::unique_ptr<PointCloud>>(source)->has_color();
}

TriangleMesh read_mesh(Reader reader, std::string text) {
  Source source = source_of(reader, std::move(text));
  REQUIRE(std::holds_alternative<TriangleMesh>(source));
  return std::get<TriangleMesh>(std::move(source));
}

std::vector<GridVoxel> read_voxels(Reader reader, std::string text) {
  const Source source = source_of(reader, std::move(text));
  REQUIRE(std::holds_alternative<std::unique_ptr<VoxelGrid>>(source));
  std::vector<GridVoxel> voxels;
  std::get<std::unique_ptr<VoxelGrid>>(source)->for_each(
      [&](std::int32_t x, std::int32_t y, std::int32_t z, Rgb color) {
        voxels.push_back({x, y, z, color});
      });
  return voxels;
}

std::string error_of(Reader reader, std::string text) {
  try {
    source_of(reader, std::move(text));
  } catch (const InputError& error) {
    INFO(error.what());
    CHECK(is_sentence(error.what()));
    return error.what();
  }
  return "";
}

long long outcome_of(Reader reader, std::string bytes) {
  try {
    const Source source = source_of(reader, std::move(bytes));
    bool kept = true;
    long long count = 0;
    if (const TriangleMesh* mesh = std::get_if<TriangleMesh>(&source)) {
      kept = mesh->colors.empty() || mesh->colors.size() == mesh->positions.size();
      for (const auto& position : mesh->positions) {
        kept = kept && std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(position[2]);
      }
      for (const auto& triangle : mesh->triangles) {
        for (const std::uint32_t corner : triangle) {
          kept = kept && corner < mesh->positions.size();
        }
      }
      count = static_cast<long long>(mesh->positions.size());
    } else if (const auto* grid = std::get_if<std::unique_ptr<VoxelGrid>>(&source)) {
      const auto size = (*grid)->size();
      (*grid)->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, Rgb) {
        kept = kept && x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2];
        ++count;
      });
    } else if (const auto* model = std::get_if<std::unique_ptr<VoxelModel>>(&source)) {
      const auto size = (*model)->size();
      (*model)->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
        kept =
            kept && x >= 0 && y >= 0 && z >= 0 && x < size[0] && y < size[1] && z < size[2] && material > 0;
        ++count;
      });
      count += 1;  // a model may be empty
    } else if (const auto* cloud = std::get_if<std::unique_ptr<PointCloud>>(&source); cloud == nullptr) {
      return 1;
    } else {
      std::get<std::unique_ptr<PointCloud>>(source)->for_each([&](const CloudPoint& point) {
        kept = kept && std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
        ++count;
      });
    }
    CHECK(kept);
    CHECK(count > 0);
    return count;
  } catch (const InputError& error) {
    INFO(error.what());
    CHECK(is_sentence(error.what()));
    return -1;
  }
}

std::vector<std::size_t> accepted_lengths(Reader reader, const std::string& whole) {
  std::vector<std::size_t> accepted;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    if (outcome_of(reader, whole.substr(0, length)) >= 0) {
      accepted.push_back(length);
    }
  }
  return accepted;
}

bool notes_hold(const Source& source, std::string_view part) {
  const Notes notes = notes_of(source);
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return contains(note, part); });
}

}  // namespace thimble::tools::test
