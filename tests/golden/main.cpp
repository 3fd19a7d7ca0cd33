// Draws every golden frame in every variant and compares the CRC-32s with golden_table.h.
//
//   thimble_golden_tests            compare; exit status 1 when anything differs
//   thimble_golden_tests --print    write a new golden_table.h to stdout (from the first variant)
//   thimble_golden_tests --sizes    bytes of every scene in every structure, as CSV
//   thimble_golden_tests --frame NAME   that frame's pixels, as stored, to stdout: to look at a difference
//
// Only stdio is used besides the core, and one fixed arena: a board's runner differs in its printf alone.
#include <stdio.h>
#include <string.h>

#include "golden/golden_table.h"
#include "golden/scenes.h"

namespace {

using namespace thimble;
using namespace thimble::golden;

constexpr size_t kArenaBytes = size_t{256} << 10;
constexpr size_t kBandBytes = size_t{61} * 37 * 3 + 4096;

constexpr Structure kStructures[] = {Structure::kDense, Structure::kPool, Structure::kCompact};

alignas(8) uint8_t arena_bytes[kArenaBytes];
uint8_t band_bytes_given[kBandBytes];

const char* name_of(Structure structure) {
  return structure == Structure::kDense ? "dense" : structure == Structure::kPool ? "pool" : "compact";
}
const char* name_of(Width width) {
  return width == Width::kAuto ? "auto" : width == Width::k32 ? "32" : "64";
}

struct Score {
  int passed = 0;
  int failed = 0;
};

void fail(Score* score, const Frame& frame, const Variant& variant, const char* what) {
  ++score->failed;
  printf("FAILED %s (%s, width %s, bands of %d): %s\n", frame.name, name_of(variant.structure),
         name_of(variant.width), static_cast<int>(variant.band_rows), what);
}

void compare(const Frame& frame, const Variant& variant, const World& world, uint32_t wanted, Score* score) {
  uint32_t crc = 0;
  RenderCounts counts;
  const Status status =
      frame_crc32(frame, world, variant.width, variant.band_rows, Bytes(band_bytes_given), &crc, &counts);
  if (status != Status::kOk) {
    fail(score, frame, variant, status_text(status));
  } else if (crc != wanted) {
    char text[64];
    snprintf(text, sizeof text, "CRC-32 %08lx, wanted %08lx", static_cast<unsigned long>(crc),
             static_cast<unsigned long>(wanted));
    fail(score, frame, variant, text);
  } else {
    ++score->passed;
  }
}

// The 32-bit path must refuse the frames that are not marked as narrow.
void expect_refusal(const Frame& frame, const Variant& variant, const World& world, Score* score) {
  uint32_t crc = 0;
  const Status status =
      frame_crc32(frame, world, variant.width, variant.band_rows, Bytes(band_bytes_given), &crc, nullptr);
  if (status == Status::kBadArgument) {
    ++score->passed;
  } else {
    fail(score, frame, variant, "rays too long for 32 bits were not refused");
  }
}

const GoldenEntry* find(const char* name) {
  for (const GoldenEntry& entry : kGoldenTable) {
    if (strcmp(entry.name, name) == 0) {
      return &entry;
    }
  }
  return nullptr;
}

// Builds each scene once a structure, and draws all its frames.
void compare_scene(SceneId id, Structure structure, Score* score) {
  Arena arena{Bytes(arena_bytes)};
  World world;
  const Status status = build_scene(id, structure, &arena, &world);
  if (status != Status::kOk) {
    ++score->failed;
    printf("FAILED scene %s (%s): %s\n", scene_info(id).name, name_of(structure), status_text(status));
    return;
  }
  for (int f = 0; f < frame_count(); ++f) {
    const Frame& shown = frame(f);
    const GoldenEntry* entry = shown.scene == id ? find(shown.name) : nullptr;
    if (entry == nullptr) {
      continue;
    }
    for (int v = 0; v < variant_count(); ++v) {
      const Variant& way = variant(v);
      if (way.structure != structure) {
        continue;
      }
      if (applies(shown, way)) {
        compare(shown, way, world, entry->crc32, score);
      } else if (!shown.narrow && way.width == Width::k32) {
        expect_refusal(shown, way, world, score);
      }
    }
  }
}

int run_all() {
  Score score;
  const int listed = static_cast<int>(sizeof kGoldenTable / sizeof kGoldenTable[0]);
  if (listed != frame_count()) {
    ++score.failed;
    printf("FAILED: golden_table.h lists %d frames, there are %d\n", listed, frame_count());
  }
  for (int f = 0; f < frame_count(); ++f) {
    if (find(frame(f).name) == nullptr) {
      ++score.failed;
      printf("FAILED %s: not in golden_table.h\n", frame(f).name);
    }
  }
  for (int scene = 0; scene < kSceneCount; ++scene) {
    const SceneId id = static_cast<SceneId>(scene);
    compare_scene(id, Structure::kCompact, &score);
    compare_scene(id, Structure::kPool, &score);
    if (scene_info(id).has_dense) {
      compare_scene(id, Structure::kDense, &score);
    }
  }
  printf("%d passed, %d failed\n", score.passed, score.failed);
  return score.failed == 0 ? 0 : 1;
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

int main(int argc, char** argv) {
  if (argc == 1) {
    return run_all();
  }
  if (argc == 2 && strcmp(argv[1], "--print") == 0) {
    return print_table();
  }
  if (argc == 2 && strcmp(argv[1], "--sizes") == 0) {
    return print_sizes();
  }
  if (argc == 3 && strcmp(argv[1], "--frame") == 0) {
    return print_frame(argv[2]);
  }
  fprintf(stderr, "usage: thimble_golden_tests [--print | --sizes | --frame NAME]\n");
  return 2;
}
