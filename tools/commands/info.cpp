// thimble info: what a scene is, and what it takes.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <set>

#include "commands/commands.h"
#include "commands/options.h"
#include "output/stats.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

const char* name_of(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kDiffuse:
      return "diffuse";
    case SurfaceKind::kMetal:
      return "metal";
    case SurfaceKind::kGlass:
      return "glass";
    case SurfaceKind::kEmit:
      return "emit";
    case SurfaceKind::kMedia:
      return "media";
  }
  return "unknown";
}

void row(const char* label, const std::string& value) {
  std::printf("%-20s %s\n", label, value.c_str());
}

void run(const SceneOptions& options) {
  const auto source = options.open();
  const BuiltScene built = options.build(*source, 0);
  const VoxelBox box = built.bounds();
  const double bytes_per_voxel =
      built.voxels() == 0 ? 0 : static_cast<double>(built.tree_bytes()) / static_cast<double>(built.voxels());

  row("scene", options.arguments.scene);
  row("kind", source->kind());
  row("depth", std::to_string(built.level()) + " (a world of " + std::to_string(1 << built.level()) +
                   " voxels a side)");
  if (source->points() != 0) {
    row("points", grouped(source->points()));
  }
  row("solid voxels", grouped(built.voxels()));
  row("occupied box", std::to_string(box.min.x) + "," + std::to_string(box.min.y) + "," +
                          std::to_string(box.min.z) + " to " + std::to_string(box.max.x) + "," +
                          std::to_string(box.max.y) + "," + std::to_string(box.max.z) + " (exclusive)");

  // Which palette entries the voxels use, counted over the stream.
  std::set<int> used;
  source->stream([&](auto, auto, auto, std::uint8_t material) { used.insert(material); }, {});
  std::array<int, 5> kinds{};
  for (const int index : used) {
    ++kinds[static_cast<std::size_t>(source->palette()[static_cast<std::size_t>(index)].kind)];
  }
  std::string materials = std::to_string(used.size());
  const char* separator = ": ";
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    if (kinds[kind] != 0) {
      materials += separator + std::to_string(kinds[kind]) + " " + name_of(static_cast<SurfaceKind>(kind));
      separator = ", ";
    }
  }
  row("materials", materials);

  if (built.nodes() != 0) {
    row("nodes", grouped(built.nodes()));
  }
  std::array<char, 64> ratio{};
  std::snprintf(ratio.data(), ratio.size(), " (%.2f a voxel)", bytes_per_voxel);
  row("structure bytes", grouped(built.tree_bytes()) + ratio.data());
  row("most bytes in use", grouped(built.high_water_bytes()));
  if (built.solid_added() != 0) {
    row("solid added", grouped(built.solid_added()) + " voxels, by coarsening");
  }
  if (built.structure() == StructureKind::kCompact) {
    uint32_t place = 0;
    const char* fault =
        CompactTree::validate({built.compact().bytes(), built.compact().size_bytes()}, &place);
    if (fault != nullptr) {
      throw InputError("the compact tree is not sound at " + std::to_string(place) + ": " + fault);
    }
    row("compact tree", "sound");
  }
  if (!options.stats_path.empty()) {
    write_stats(options.stats_path, Stats(options.arguments.scene, *source, built));
  }
}

}  // namespace

void add_info(CLI::App& app) {
  auto options = std::make_shared<SceneOptions>();
  CLI::App* sub = app.add_subcommand("info", "validate and describe a scene");
  options->add_to(*sub);
  sub->callback([options] { run(*options); });
}

}  // namespace thimble::tools
