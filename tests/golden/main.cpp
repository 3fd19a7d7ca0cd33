// The cases that run everywhere (tests/portable), the golden frames among them, by the application that runs
// them on a board (tests/boards/apps/cases.cpp), over a port that is a block of bytes and standard output.
//
//   thimble_golden_tests                 run all; exit status 1 when anything differs
//   thimble_golden_tests --arena BYTES   the same with that much memory, as a small board has
//   thimble_golden_tests --print    write a new golden/golden_table.h to stdout (from the first variant)
//   thimble_golden_tests --trees    write a new portable/golden_trees.bin to stdout
//   thimble_golden_tests --crc      write a new portable/result_crc.h to stdout
//   thimble_golden_tests --sizes    bytes of every scene in every structure, as CSV
//   thimble_golden_tests --frame NAME   that frame's pixels, as stored, to stdout: to look at a difference
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "apps/apps.h"
#include "golden/golden_table.h"
#include "golden/scenes.h"
#include "port.h"
#include "portable/golden_trees.h"
#include "portable/runner.h"

namespace {

using namespace thimble;
using namespace thimble::golden;

constexpr size_t kArenaBytes = size_t{256} << 10;
constexpr size_t kBandBytes = size_t{61} * 37 * 3 + 4096;

constexpr Structure kStructures[] = {Structure::kDense, Structure::kPool, Structure::kCompact};

alignas(8) uint8_t arena_bytes[kArenaBytes];
size_t arena_size = kArenaBytes;
uint8_t band_bytes_given[kBandBytes];

const char* name_of(Structure structure) {
  return structure == Structure::kDense ? "dense" : structure == Structure::kPool ? "pool" : "compact";
}
// Names tell cases apart, so no two are equal.
bool names_differ(Span<const portable::Group* const> groups) {
  bool differ = true;
  for (const portable::Group* group : groups) {
    for (int i = 0; i < group->count; ++i) {
      const portable::Case one = group->at(i);
      for (int k = 0; k < i; ++k) {
        const portable::Case other = group->at(k);
        const char* detail = one.detail != nullptr ? one.detail : "";
        if (strcmp(one.name, other.name) == 0 &&
            strcmp(detail, other.detail != nullptr ? other.detail : "") == 0 &&
            (one.times == 1 || one.index == other.index)) {
          printf("FAILED %s: two cases are named %s (%s)\n", group->name, one.name, detail);
          differ = false;
        }
      }
    }
  }
  return differ;
}

bool lists_agree() {
  const int counted = portable::count_golden_frame_cases();
  const int frames = static_cast<int>(sizeof kGoldenTable / sizeof kGoldenTable[0]);
  if (counted != portable::kGoldenFrameCases || frames != frame_count()) {
    printf("FAILED golden: %d frames in golden_table.h, %d in scenes.cpp; %d cases in groups.h, counted %d\n",
           frames, frame_count(), portable::kGoldenFrameCases, counted);
    return false;
  }
  bool agree = true;
  for (int f = 0; f < frames; ++f) {
    if (strcmp(kGoldenTable[f].name, frame(f).name) != 0) {
      printf("FAILED golden: line %d of golden_table.h is %s, not %s\n", f, kGoldenTable[f].name,
             frame(f).name);
      agree = false;
    }
  }
  return agree;
}

// The groups of each application, and what result_crc.h says of them: `common` where not every board runs all.
struct Groups {
  Span<const portable::Group* const> groups;
  int (*run)();
  const char* what;
  const char* all;
  const char* common;
};
constexpr Groups kGroups[] = {
    {portable::kCoreGroups, apps::selftest, "the core's own cases, all of which every board runs",
     "kCoreCrc32", nullptr},
    {portable::kGoldenGroups, apps::golden,
     "what lies in flash: baked scenes and golden frames, all of them and those that every board runs",
     "kGoldenCrc32", "kCommonGoldenCrc32"},
    {portable::kPanelGroups, apps::formats, "the formats of panels, in an image that has them all",
     "kPanelCrc32", nullptr},
    {portable::kLitGroups, apps::lit, "lit pictures, all of which every board draws", "kLitCrc32", nullptr},
    {portable::kWorldGroups, apps::worlds,
     "worlds of other shapes and of the plane, all of which every board runs", "kWorldCrc32", nullptr},
    {portable::kBrickGroups, apps::bricks, "frames by bricks, all of them and those that every board draws",
     "kBrickCrc32", "kCommonBrickCrc32"},
    {portable::kMapLightGroups, apps::map_light, "lit frames by bricks", "kMapLightCrc32", nullptr},
};

int run_all() {
  // Each of them says what is wrong.
  bool passed = lists_agree();
  for (const Groups& one : kGroups) {
    passed = names_differ(one.groups) && passed;
    passed = one.run() == 0 && passed;
  }
  return passed ? 0 : 1;
}

bool print_crcs(const Groups& of) {
  portable::Runner* runner = portable::Runner::make(Bytes(arena_bytes));
  for (const portable::Group* group : of.groups) {
    for (int i = 0; i < group->count; ++i) {
      if (runner->run(group->at(i)) != nullptr) {
        fprintf(stderr, "%s: %s: failed, so there is no right CRC\n", group->name, group->at(i).name);
        return false;
      }
    }
  }
  printf("/// Of %s.\n", of.what);
  printf("inline constexpr uint32_t %s = 0x%08lX;\n", of.all, static_cast<unsigned long>(runner->crc32()));
  if (of.common != nullptr) {
    printf("inline constexpr uint32_t %s = 0x%08lX;\n", of.common,
           static_cast<unsigned long>(runner->common_crc32()));
  } else if (runner->crc32() != runner->common_crc32()) {
    fprintf(stderr, "a case needs more than kCommonArenaBytes\n");
    return false;
  }
  return true;
}

int print_crc() {
  printf(
      "/// What the portable cases compute, as CRC-32s (runner.h). Written by `thimble_golden_tests "
      "--crc`.\n");
  printf("#pragma once\n\n#include <stdint.h>\n\nnamespace thimble::portable {\n\n");
  for (const Groups& one : kGroups) {
    if (!print_crcs(one)) {
      return 1;
    }
  }
  printf("\n}  // namespace thimble::portable\n");
  return 0;
}

int print_trees() {
  for (int scene = 0; scene < kSceneCount; ++scene) {
    Arena arena{Bytes(arena_bytes)};
    World world;
    const Status status = build_scene(static_cast<SceneId>(scene), Structure::kCompact, &arena, &world);
    if (status != Status::kOk) {
      fprintf(stderr, "%s: %s\n", scene_info(static_cast<SceneId>(scene)).name, status_text(status));
      return 1;
    }
    const uint8_t padding[3] = {};
    const size_t size = world.compact.size_bytes();
    if (fwrite(world.compact.bytes(), 1, size, stdout) != size ||
        fwrite(padding, 1, -size % 4, stdout) != -size % 4) {
      return 1;
    }
  }
  return 0;
}

bool first_variant(const Frame& shown, uint32_t* crc) {
  Arena arena{Bytes(arena_bytes)};
  World world;
  Status status = build_scene(shown.scene, variant(0).structure, &arena, &world);
  if (status == Status::kOk) {
    status = frame_crc32(shown, world, variant(0).width, variant(0).band_rows, Bytes(band_bytes_given), crc,
                         nullptr);
  }
  if (status != Status::kOk) {
    fprintf(stderr, "%s: %s\n", shown.name, status_text(status));
  }
  return status == Status::kOk;
}

int print_table() {
  printf("/// CRC-32 of every golden frame (scenes.h). Written by `thimble_golden_tests --print`.\n");
  printf("#pragma once\n\n#include <stdint.h>\n\nnamespace thimble::golden {\n\n");
  printf("struct GoldenEntry {\n  const char* name;\n  uint32_t crc32;\n};\n\n");
  printf("inline constexpr GoldenEntry kGoldenTable[] = {\n");
  for (int f = 0; f < frame_count(); ++f) {
    uint32_t crc = 0;
    if (!first_variant(frame(f), &crc)) {
      return 1;
    }
    printf("    {\"%s\", 0x%08lX},\n", frame(f).name, static_cast<unsigned long>(crc));
  }
  printf("};\n\n}  // namespace thimble::golden\n");
  return 0;
}

int print_sizes() {
  printf("scene,structure,arena_bytes,pool_nodes,pool_nodes_high_water,voxels,solid_added\n");
  for (int scene = 0; scene < kSceneCount; ++scene) {
    const SceneId id = static_cast<SceneId>(scene);
    for (const Structure structure : kStructures) {
      if (structure == Structure::kDense && !scene_info(id).has_dense) {
        continue;
      }
      Arena arena{Bytes(arena_bytes)};
      World world;
      const Status status = build_scene(id, structure, &arena, &world);
      if (status != Status::kOk) {
        fprintf(stderr, "%s: %s\n", scene_info(id).name, status_text(status));
        return 1;
      }
      const bool dense = structure == Structure::kDense;
      printf("%s,%s,%lu,%lu,%lu,%lu,%lu\n", scene_info(id).name, name_of(structure),
             static_cast<unsigned long>(arena.high_water_bytes()),
             static_cast<unsigned long>(dense ? 0 : world.pool.nodes_used()),
             static_cast<unsigned long>(dense ? 0 : world.pool.nodes_high_water()),
             static_cast<unsigned long>(dense ? world.grid.voxel_count() : world.pool.voxels()),
             static_cast<unsigned long>(dense ? 0 : world.pool.solid_added()));
    }
  }
  return 0;
}

int print_frame(const char* name) {
  for (int f = 0; f < frame_count(); ++f) {
    const Frame& shown = frame(f);
    uint32_t crc = 0;
    if (strcmp(shown.name, name) == 0 && first_variant(shown, &crc)) {
      fwrite(band_bytes_given, 1, band_bytes(shown.format, shown.width_px, shown.height_px), stdout);
      return 0;
    }
  }
  fprintf(stderr, "no frame named %s\n", name);
  return 1;
}

}  // namespace

// The port: no display, no clock, no buttons.
namespace thimble::port {

const Facts& facts() {
  static const Facts host = {"the host", kArenaBytes, 0, 0, {128, 64, PixelFormat::kGray4, false}};
  return host;
}
Bytes arena() {
  return {arena_bytes, arena_size};
}
void write(ConstBytes bytes) {
  fwrite(bytes.data, 1, bytes.size, stdout);
}

}  // namespace thimble::port

int main(int argc, char** argv) {
  if (argc == 1) {
    return run_all();
  }
  if (argc == 3 && strcmp(argv[1], "--arena") == 0) {
    const unsigned long bytes = strtoul(argv[2], nullptr, 10);
    arena_size = bytes < kArenaBytes ? bytes : kArenaBytes;
    return run_all();
  }
  if (argc == 2 && strcmp(argv[1], "--print") == 0) {
    return print_table();
  }
  if (argc == 2 && strcmp(argv[1], "--trees") == 0) {
    return print_trees();
  }
  if (argc == 2 && strcmp(argv[1], "--crc") == 0) {
    return print_crc();
  }
  if (argc == 2 && strcmp(argv[1], "--sizes") == 0) {
    return print_sizes();
  }
  if (argc == 3 && strcmp(argv[1], "--frame") == 0) {
    return print_frame(argv[2]);
  }
  fprintf(
      stderr,
      "usage: thimble_golden_tests [--arena BYTES | --print | --trees | --crc | --sizes | --frame NAME]\n");
  return 2;
}
