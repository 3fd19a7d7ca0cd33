#include "scene/built_scene.h"

#include <algorithm>
#include <chrono>
#include <new>

#include "output/units.h"
#include "scene/scene_source.h"
#include "scene/structure_builder.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {
namespace {

// Bytes of an arena that a renderer with such a band takes first.
std::uint64_t used_before_structure(std::uint64_t state_bytes, std::uint64_t band_bytes) {
  constexpr std::uint64_t kAlign = alignof(std::uint64_t);
  const auto up = [](std::uint64_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; };
  return band_bytes == 0 ? 0 : up(up(state_bytes) + band_bytes);
}

// What building writes in any case, if that is known before: a key of each point. Few points are left out, whose
// places may be fewer than points.
std::size_t bytes_to_be_written(const SceneSource& source, std::size_t most) {
  const bool has_keys = source.is_point_set() && source.baked() == nullptr;
  const std::uint64_t bytes = has_keys ? source.points() * sizeof(std::uint32_t) : 0;
  return static_cast<std::size_t>(std::min<std::uint64_t>(bytes, most));
}

// How many different voxels `source` streams. For reporting only, in memory beside the arena: the voxels are
// counted in as many turns as keep a list of them below 256 MiB, each turn a part of the world.
std::uint64_t count_distinct(const SceneSource& source, const Progress& progress) {
  constexpr std::uint64_t kMostKeys = std::uint64_t{1} << 25;
  std::uint64_t streamed = 0;
  source.stream([&](auto, auto, auto, auto) { ++streamed; }, progress);
  const std::uint64_t turns = streamed / kMostKeys + 1;
  std::uint64_t distinct = 0;
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    std::vector<std::uint64_t> codes;
    source.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t) {
          const std::uint64_t code = morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                                 static_cast<std::uint32_t>(z));
          if (code % turns == turn) {
            codes.push_back(code);
          }
        },
        progress);
    std::sort(codes.begin(), codes.end());
    distinct += static_cast<std::uint64_t>(std::unique(codes.begin(), codes.end()) - codes.begin());
  }
  return distinct;
}

// What the scene would need, where it does not fit the budget.
std::string shortage_text(const SceneSource& source, const BuildOptions& options, const Progress& progress) {
  const bool dense = options.structure == StructureKind::kDense;
  std::uint64_t needed = 0;
  std::string part;
  if (dense) {
    // Known without building it.
    const Vec3i size = dense_size(source);
    needed =
        used_before_structure(options.render_state_bytes, options.least_band_bytes) + dense_grid_bytes(size);
    part = " (" + grouped(dense_grid_bytes(size)) + " of them the grid of " + std::to_string(size.x) + " x " +
           std::to_string(size.y) + " x " + std::to_string(size.z) + " voxels)";
  } else {
    BuildOptions unlimited = options;
    unlimited.memory_bytes.reset();
    unlimited.coarsen = false;
    unlimited.band_bytes = options.least_band_bytes;
    needed = BuiltScene(source, unlimited, progress).least_budget_bytes();
  }
  return (options.coarsen && !dense ? "too little even for a coarse tree: in full it needs " : "needs ") +
         grouped(needed) + " bytes" + part + ", the budget is " + grouped(*options.memory_bytes) + " (" +
         options.budget_name + "); give it more" +
         (dense             ? " or another --structure"
          : options.coarsen ? ""
                            : ", a smaller --depth or --coarsen");
}

}  // namespace

BuiltScene::BuiltScene(const SceneSource& source, const BuildOptions& options, const Progress& progress)
    : options_(options) {
  for (const Material& material : source.palette()) {
    palette_.push_back({material.color.r, material.color.g, material.color.b});
  }
  const auto start = std::chrono::steady_clock::now();
  try {
    memory_ = options.memory_bytes ? HostMemory(static_cast<std::size_t>(*options.memory_bytes))
                                   : HostMemory::largest();
  } catch (const std::bad_alloc&) {
    throw InputError(options.memory_bytes ? "this machine does not give " + grouped(*options.memory_bytes) +
                                                " bytes (" + options.budget_name + ")"
                                          : "this machine has no memory left for the scene");
  }
  use_large_pages(memory_.bytes().subspan(0, bytes_to_be_written(source, memory_.bytes().size)));
  if (!try_to_build(source, progress)) {
    throw InputError(options.memory_bytes ? shortage_text(source, options, progress)
                                          : "the scene does not fit into this machine's memory");
  }
  least_budget_bytes_ = least_budget_bytes_ == 0 ? high_water_bytes() : least_budget_bytes_;
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // The tree knows what each merge added when it was made; voxels that came later and were already covered
  // are taken off by counting what the source really has.
  const bool coarsened =
      structure() == StructureKind::kPool ? traced_.pool.solid_added() != 0 : compact().merged();
  const BakedScene* baked = source.baked();
  if (coarsened) {
    solid_added_ =
        voxels() - (baked != nullptr ? baked->tree().voxel_count() : count_distinct(source, progress));
  }
  solid_added_ += baked != nullptr ? baked->tree().solid_added() : 0;
}

// A band of the least size leaves more room for the scene; merging blocks is the last resort.
bool BuiltScene::try_to_build(const SceneSource& source, const Progress& progress) {
  const bool may_coarsen = options_.coarsen && options_.structure != StructureKind::kDense;
  for (int attempt = 0; attempt < (may_coarsen ? 4 : 2); ++attempt) {
    const bool least = attempt % 2 == 1;
    if (least && options_.least_band_bytes == options_.band_bytes) {
      continue;
    }
    try {
      build(source, least ? options_.least_band_bytes : options_.band_bytes, attempt >= 2, progress);
      return true;
    } catch (const StructureBuilder::Shortage&) {
      // The next attempt makes do with less.
    }
  }
  return false;
}

void BuiltScene::build(const SceneSource& source, std::uint64_t band_bytes, bool coarsen,
                       const Progress& progress) {
  arena_ = Arena(memory_.bytes());
  band_ = {};
  if (band_bytes != 0) {
    if (arena_.take(static_cast<std::size_t>(options_.render_state_bytes)).empty()) {
      throw StructureBuilder::Shortage{};
    }
    band_ = arena_.take(static_cast<std::size_t>(band_bytes));
    if (band_.empty()) {
      throw StructureBuilder::Shortage{};
    }
  }
  StructureBuilder builder(source, &arena_, options_.baked_in_flash, options_.threads, progress);
  traced_ = builder.build(options_.structure, coarsen);
  least_budget_bytes_ = builder.least_bytes();
}

}  // namespace thimble::tools
