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
#include "thimble/tree/brick_map.h"

namespace {

using namespace thimble;
using namespace thimble::golden;

constexpr size_t kArenaBytes = size_t{256} << 10;
constexpr size_t kBandBytes = size_t{61} * 37 * 3 + 4096;

constexpr Structure kStructures[] = {Structure::kDense, Structure::kPool, Structure::kCompact};

alignas(8) uint8_t arena_bytes[kArenaBytes];
size_t arena_size = kArenaBytes;
uint8_t band_bytes_given[kBandBytes];
// The map of any golden scene that may have one: they are of level 6 at most.
constexpr int kMostMapLevel = 6;
alignas(8) uint8_t map_bytes[most_brick_map_bytes(kMostMapLevel)];

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
            strcmp(detail, other.detail != nullptr ? other.detail : "") == 0) {
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

// Draws each frame by its scene's brick map, where the world is small enough for one.
bool maps_agree() {
  int drawn = 0;
  int wrong = 0;
  for (int f = 0; f < frame_count(); ++f) {
    const Frame& shown = frame(f);
    if (scene_info(shown.scene).level > kMostMapLevel) {
      continue;
    }
    Arena arena{Bytes(arena_bytes)};
    World world;
    BrickMap map;
    Camera camera;
    Shading shading;
    Band band;
    band.pixels = {band_bytes_given, band_bytes(shown.format, shown.width_px, shown.height_px)};
    band.format = shown.format;
    band.rows = shown.height_px;
    Status status = build_scene(shown.scene, Structure::kCompact, &arena, &world);
    if (status == Status::kOk) {
      status = BrickMap::make(world.compact, Bytes(map_bytes), &map);
    }
    if (status == Status::kOk) {
      status = set_up(shown, &camera, &shading);
    }
    if (status == Status::kOk) {
      status = render_band(world.compact, map, camera, shading, band);
    }
    const uint32_t crc = crc32(band.pixels);
    ++drawn;
    if (status != Status::kOk || crc != kGoldenTable[f].crc32) {
      printf("FAILED golden: %s by its map: %s, 0x%08lX in place of 0x%08lX\n", shown.name,
             status_text(status), static_cast<unsigned long>(crc),
             static_cast<unsigned long>(kGoldenTable[f].crc32));
      ++wrong;
    }
  }
  printf("golden: %d frames by maps, %d wrong\n", drawn, wrong);
  return drawn != 0 && wrong == 0;
}

int run_all() {
  // Each of them says what is wrong.
  const bool sound = lists_agree() && names_differ(portable::kCoreGroups) &&
                     names_differ(portable::kGoldenGroups) && names_differ(portable::kLitGroups) &&
                     names_differ(portable::kPanelGroups) && names_differ(portable::kWorldGroups) &&
                     names_differ(portable::kBrickGroups) && names_differ(portable::kMapLightGroups) &&
                     maps_agree();
  const int core = apps::selftest();
  const int frames = apps::golden();
  const int formats = apps::formats();
  const int lit = apps::lit();
  const int worlds = apps::worlds();
  const int bricks = apps::bricks();
  const int map_light = apps::map_light();
  const bool passed =
      core == 0 && frames == 0 && formats == 0 && lit == 0 && worlds == 0 && bricks == 0 && map_light == 0;
  return sound && passed ? 0 : 1;
}

bool print_crcs(const char* all, const char* common, Span<const portable::Group* const> groups) {
  portable::Runner* runner = portable::Runner::make(Bytes(arena_bytes));
  for (const portable::Group* group : groups) {
    for (int i = 0; i < group->count; ++i) {
      if (runner->run(group->at(i)) != nullptr) {
        fprintf(stderr, "%s: %s: failed, so there is no right CRC\n", group->name, group->at(i).name);
        return false;
      }
    }
  }
  printf("inline constexpr uint32_t %s = 0x%08lX;\n", all, static_cast<unsigned long>(runner->crc32()));
  if (common != nullptr) {
    printf("inline constexpr uint32_t %s = 0x%08lX;\n", common,
           static_cast<unsigned long>(runner->common_crc32()));
  } else if (runner->crc32() != runner->common_crc32()) {
    fprintf(stderr, "a case needs more than kCommonArenaBytes\n");
    return false;
  }
  return true;
}

int print_crc() {
  printf("/// @file result_crc.h\n");
  printf(
      "/// What the portable cases compute, as CRC-32s (runner.h). Written by `thimble_golden_tests "
      "--crc`.\n");
  printf("#ifndef THIMBLE_TESTS_PORTABLE_RESULT_CRC_H\n#define THIMBLE_TESTS_PORTABLE_RESULT_CRC_H\n\n");
  printf("#include <stdint.h>\n\nnamespace thimble::portable {\n\n");
  printf("/// Of the core's own cases, all of which every board runs.\n");
  if (!print_crcs("kCoreCrc32", nullptr, portable::kCoreGroups)) {
    return 1;
  }
  printf(
      "/// Of what lies in flash: baked scenes and golden frames, all of them and those that every board "
      "runs.\n");
  if (!print_crcs("kGoldenCrc32", "kCommonGoldenCrc32", portable::kGoldenGroups)) {
    return 1;
  }
  printf("/// Of the formats of panels, in an image that has them all.\n");
  if (!print_crcs("kPanelCrc32", nullptr, portable::kPanelGroups)) {
    return 1;
  }
  printf("/// Of lit pictures, all of which every board draws.\n");
  if (!print_crcs("kLitCrc32", nullptr, portable::kLitGroups)) {
    return 1;
  }
  printf("/// Of worlds of other shapes and of the plane, all of which every board runs.\n");
  if (!print_crcs("kWorldCrc32", nullptr, portable::kWorldGroups)) {
    return 1;
  }
  printf("/// Of frames by bricks, all of them and those that every board draws.\n");
  if (!print_crcs("kBrickCrc32", "kCommonBrickCrc32", portable::kBrickGroups)) {
    return 1;
  }
  printf("/// Of lit frames by bricks.\n");
  if (!print_crcs("kMapLightCrc32", nullptr, portable::kMapLightGroups)) {
    return 1;
  }
  printf("\n}  // namespace thimble::portable\n\n#endif\n");
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
  printf("/// @file golden_table.h\n");
  printf("/// CRC-32 of every golden frame (scenes.h). Written by `thimble_golden_tests --print`.\n");
  printf("#ifndef THIMBLE_TESTS_GOLDEN_GOLDEN_TABLE_H\n#define THIMBLE_TESTS_GOLDEN_GOLDEN_TABLE_H\n\n");
  printf("#include <stdint.h>\n\nnamespace thimble::golden {\n\n");
  printf("struct GoldenEntry {\n  const char* name;\n  uint32_t crc32;\n};\n\n");
  printf("inline constexpr GoldenEntry kGoldenTable[] = {\n");
  for (int f = 0; f < frame_count(); ++f) {
    uint32_t crc = 0;
    if (!first_variant(frame(f), &crc)) {
      return 1;
    }
    printf("    {\"%s\", 0x%08lX},\n", frame(f).name, static_cast<unsigned long>(crc));
  }
  printf("};\n\n}  // namespace thimble::golden\n\n#endif\n");
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
