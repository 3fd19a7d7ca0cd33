// What a frame and a ray cost on this board, in instructions, as lines `name,value`: for people to read and
// for tests to hold against limits. The frames are the golden ones of the demonstration's round
// (demo_view.h); camera, drawing and flush are counted, the CRC-32 is not.
//
//   ENGINE.instructions_median, _min, _max    a frame
//   ENGINE.instructions_a_ray                 the median over the pixels
//   ENGINE.frames_a_second_estimate           the core's clock by the median: one instruction a cycle
//   ENGINE.node_visits                        tree nodes a frame, on average
//   ENGINE.crc.N                              of frame N: equal for all engines that are exact
//   lit.instructions_median, ...              with the effects that the scene was baked for, if any
//   lit.lit_crc.N                             of frame N with them
//   brick_map.times_faster_than_dda           beside the textbook's tracer (dda_baseline.h), where the RAM
//                                             holds its grid of bits; its pictures are nearly right
//   ray32., ray64.                            closest_hit on a fixed set of rays, by arithmetic width
//
// Where the port does not count instructions, microseconds stand in their place (`unit`).
#include "apps/apps.h"
#include "apps/band_turns.h"
#include "apps/dda_baseline.h"
#include "apps/demo_view.h"
#include "apps/ink_frame.h"
#include "apps/place.h"
#include "apps/scene_light.h"
#include "apps/shown_scene.h"
#include "apps/text.h"
#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"

namespace thimble::apps {
namespace {

// The larger functions are not inlined: what one keeps on the stack is gone when the next one draws.

/// Whether the brick map's frames alone are measured (bench_frames.sh, which has their CRCs from the host).
#ifdef THIMBLE_MEASURED
constexpr bool kFastestOnly = true;
#else
constexpr bool kFastestOnly = false;
#endif
/// Rays of a frame that are traced one by one: every eighth pixel of every eighth row.
constexpr int32_t kRayStep = 8;

struct Bench : Placed {
  Arena arena;
  ShownScene shown;
  SceneLight light;
  Orbit orbit;
  Shading shading;
  Camera camera;
  Bands bands;
  [[no_unique_address]] InkFrame ink;
  BitWorld grid;  ///< of the baseline; without bits where there is no room
  uint8_t face_grays[6] = {};
  bool counts_instructions = false;
  uint32_t costs[kGoldenFrames] = {};
  uint32_t crcs[kGoldenFrames] = {};  ///< of the first engine
  RenderCounts counts;
};

enum class Engine : uint8_t { kTree, kBrickMap, kDda, kLit };

const char* name_of(Engine engine) {
  constexpr const char* kNames[] = {"tree", "brick_map", "dda", "lit"};
  return kNames[static_cast<int>(engine)];
}

uint32_t now(const Bench& bench) {
  return bench.counts_instructions ? port::instructions() : port::microseconds();
}

void tell(const char* group, const char* name, uint64_t value) {
  put(group, ".", name, ",", value, "\n");
}
void tell(const char* name, uint64_t value) {
  put(name, ",", value, "\n");
}

Status draw(const Bench& bench, Engine engine, const Shading& shading, const Band& band,
            RenderCounts* counts) {
  if (engine == Engine::kTree) {
    return render_band(bench.shown.scene.tree(), bench.camera, shading, band, counts);
  }
  if constexpr (kCanLight) {
    if (engine == Engine::kLit) {
      return draw_lit_scene(bench.shown, bench.camera, bench.shading, bench.light, band, false);
    }
  }
  if (engine == Engine::kDda) {
    const uint32_t hits =
        draw_dda(bench.grid, bench.camera, bench.face_grays, 0, band.first_row, band.rows, band.pixels.data);
    if (counts != nullptr) {
      counts->hits += hits;
    }
    return Status::kOk;
  }
  return render_band(bench.shown.scene.tree(), bench.shown.map, bench.camera, shading, band, counts);
}

/// What bands of ink are taken from: with light the depths come by the brick map.
[[gnu::noinline]] Status draw_ink(Bench* bench, Engine engine, RenderCounts* counts) {
  const Engine plain = engine == Engine::kLit ? Engine::kBrickMap : engine;
  return bench->ink.draw(
      bench->camera, bench->shown.scene.tree().bounds(),
      [&](const Band& band) { return draw(*bench, engine, bench->shading, band, counts); },
      [&](const Shading& depths, const Band& band) { return draw(*bench, plain, depths, band, nullptr); });
}

/// One frame from its camera to its last flush. With `crc` that of its bytes is computed too, and with
/// `counts` the rays are counted; the cost is of a frame without either.
[[gnu::noinline]] Status draw_frame(Bench* bench, Engine engine, uint32_t frame, uint32_t* crc,
                                    RenderCounts* counts) {
  const port::Display& screen = display();
  Status status = view_at(bench->orbit, bench->shown.scene.tree(), frame, {}, screen.width_px,
                          screen.height_px, &bench->camera);
  if (bench->ink.is_there && status == Status::kOk) {
    status = draw_ink(bench, engine, counts);
  }
  for (int32_t y = 0; y < screen.height_px && status == Status::kOk; y += bench->bands.rows) {
    const Band band = bench->bands.next(y, screen.height_px);
    status =
        bench->ink.is_there ? bench->ink.store(band) : draw(*bench, engine, bench->shading, band, counts);
    if (status == Status::kOk) {
      bench->bands.send(band);
      if (crc != nullptr) {
        *crc = crc32(band.pixels, *crc);
      }
    }
  }
  port::await_flush();
  return status;
}

void sort(uint32_t (&values)[kGoldenFrames]) {
  for (uint32_t i = 1; i < kGoldenFrames; ++i) {
    for (uint32_t k = i; k > 0 && values[k] < values[k - 1]; --k) {
      const uint32_t larger = values[k - 1];
      values[k - 1] = values[k];
      values[k] = larger;
    }
  }
}

/// Measures an engine and tells its lines. `exact`: whether its pictures were those of the first engine, or
/// it is the first. `*median` gets a frame's cost.
[[gnu::noinline]] Status measure(Bench* bench, Engine engine, bool* exact, uint32_t* median) {
  const port::Display& screen = display();
  const char* const name = name_of(engine);
  RenderCounts& counts = bench->counts;
  counts = {};
  for (uint32_t i = 0; i < kGoldenFrames; ++i) {
    const uint32_t frame = i * kGoldenStep;
    const uint32_t start = now(*bench);
    Status status = draw_frame(bench, engine, frame, nullptr, nullptr);
    bench->costs[i] = now(*bench) - start;
    uint32_t crc = 0;
    if (status == Status::kOk) {
      status = draw_frame(bench, engine, frame, &crc, &counts);
    }
    if (status != Status::kOk) {
      return status;
    }
    if (engine == Engine::kTree || kFastestOnly) {
      bench->crcs[i] = crc;
    }
    const bool is_lit = engine == Engine::kLit;
    *exact = *exact && (crc == bench->crcs[i] || engine == Engine::kDda || is_lit);
    if (engine != Engine::kDda) {
      put(name, is_lit ? ".lit_crc." : ".crc.", frame, ",", Hex{crc}, "\n");
    }
  }
  sort(bench->costs);
  // The mean of the middle two, rounded down.
  const uint32_t low = bench->costs[kGoldenFrames / 2 - 1];
  *median = low + (bench->costs[kGoldenFrames / 2] - low) / 2;
  const auto pixels = static_cast<uint32_t>(screen.width_px * screen.height_px);
  tell(name, "instructions_median", *median);
  tell(name, "instructions_min", bench->costs[0]);
  tell(name, "instructions_max", bench->costs[kGoldenFrames - 1]);
  tell(name, "instructions_a_ray", *median / pixels);
  if (bench->counts_instructions && *median >= 1000) {
    put(name, ".frames_a_second_estimate,");
    put_thousandths(port::facts().core_mhz * 1000000 / (*median / 1000), 2);
    put("\n");
  }
  if (engine == Engine::kLit) {
    return Status::kOk;
  }
  // Counts of eight small pictures fit in 32 bits.
  const auto hits = static_cast<uint32_t>(counts.hits);
  tell(name, "node_visits", static_cast<uint32_t>(counts.node_visits) / kGoldenFrames);
  put(name, ".coverage_percent,");
  // In thousandths of a percent; up to 2^20 pixels a picture.
  put_thousandths(hits / kGoldenFrames * 4000 / ((pixels + 24) / 25), 2);
  put("\n");
  return Status::kOk;
}

/// Traces the set of rays with one arithmetic width; false where that width does not take them.
[[gnu::noinline]] bool trace_set(const Bench& bench, Width width, uint32_t* rays, uint32_t* cost,
                                 uint32_t* visits, uint32_t* sum) {
  const port::Display& screen = display();
  TraceOptions options;
  options.width = width;
  for (int32_t y = kRayStep / 2; y < screen.height_px; y += kRayStep) {
    for (int32_t x = kRayStep / 2; x < screen.width_px; x += kRayStep) {
      const Ray ray = bench.camera.ray(x, y);
      Hit hit;
      const uint32_t start = now(bench);
      const Status status = closest_hit(bench.shown.scene.tree(), ray, &hit, options);
      *cost += now(bench) - start;
      if (status != Status::kOk) {
        return false;
      }
      ++*rays;
      *visits += hit.visits;
      // What the two widths must agree in, mixed.
      const auto mix = [sum](int32_t value) { *sum = *sum * 16777619U ^ static_cast<uint32_t>(value); };
      mix(static_cast<int32_t>(hit.kind));
      mix(hit.voxel.x);
      mix(hit.voxel.y);
      mix(hit.voxel.z);
      mix(hit.t_numerator);
      mix(hit.t_denominator);
      mix(hit.axis);
    }
  }
  return true;
}

/// Both widths on the rays of the first frame. Whether they agree.
[[gnu::noinline]] bool measure_rays(Bench* bench) {
  const port::Display& screen = display();
  if (view_at(bench->orbit, bench->shown.scene.tree(), 0, {}, screen.width_px, screen.height_px,
              &bench->camera) != Status::kOk) {
    return false;
  }
  uint32_t sums[2] = {};
  bool taken[2] = {};
  constexpr Width kWidths[] = {Width::k32, Width::k64};
  for (int i = 0; i < 2; ++i) {
    uint32_t rays = 0;
    uint32_t cost = 0;
    uint32_t visits = 0;
    taken[i] = trace_set(*bench, kWidths[i], &rays, &cost, &visits, &sums[i]);
    const char* const group = i == 0 ? "ray32" : "ray64";
    if (!taken[i] || rays == 0) {
      tell(group, "rays", 0);
      continue;
    }
    tell(group, "rays", rays);
    tell(group, "instructions_a_ray", cost / rays);
    tell(group, "node_visits_a_ray", visits / rays);
  }
  return !(taken[0] && taken[1]) || sums[0] == sums[1];
}

/// The baseline's grid, where the arena holds it and the picture is one that it draws.
[[gnu::noinline]] void make_grid(Bench* bench) {
  const port::Display& screen = display();
  const CompactTree& tree = bench->shown.scene.tree();
  if (screen.format != PixelFormat::kGray4 || !bench->shown.has_map || tree.level() > 6) {
    return;
  }
  const Bytes bits = bench->arena.take(bit_world_bytes(tree.level()));
  if (bits.empty() || !fill_bit_world(tree, bits, &bench->grid)) {
    bench->grid = {};
    return;
  }
  for (int face = 0; face < 6; ++face) {
    bench->face_grays[face] = static_cast<uint8_t>(bench->shading.face_light[face] >> 4);
  }
}

/// How often `cost` goes into `other`.
void tell_ratio(const char* name, uint32_t other, uint32_t cost) {
  if (cost >= 1000) {
    put(name);
    put_thousandths(other / (cost / 1000), 2);
    put("\n");
  }
}

}  // namespace

int bench() {
  Arena arena(port::arena());
  Bench* const bench = place<Bench>(&arena);
  if (bench == nullptr) {
    return refuse("the arena is too small");
  }
  bench->arena = arena;
  bench->ink.take(&bench->arena);
  if (const char* wrong = open_scene(&bench->shown)) {
    return refuse(wrong);
  }
  const port::Display& screen = display();
  int32_t rows = kBandRows;
  while (!bench->bands.take(&bench->arena, rows) && rows > band_row_multiple(screen.format)) {
    --rows;
  }
  if (bench->bands.memory.empty()) {
    return refuse("the arena does not hold a row of the picture");
  }
  if (const char* wrong = open_light(bench->shown.scene, &bench->light)) {
    return refuse(wrong);
  }
  const size_t without_map = bench->arena.used_bytes();
  open_map(&bench->shown, &bench->arena);
  prove_light(bench->shown, &bench->arena, &bench->light);
  tell_board_and_scene("bench", bench->shown);
  bench->orbit = orbit_of(bench->shown.scene);
  bench->shading = demo_shading(bench->shown.scene.palette());
  bench->counts_instructions = port::instructions() != 0;

  put("name,value\nboard,", port::facts().name, "\nunit,",
      bench->counts_instructions ? "instructions\n" : "microseconds\n");
  tell("width_px", static_cast<uint32_t>(screen.width_px));
  tell("height_px", static_cast<uint32_t>(screen.height_px));
  tell("frames", kGoldenFrames);
  tell("tree_bytes", bench->shown.scene.tree().size_bytes());
  tell("map_bytes", bench->shown.has_map ? bench->shown.map.size_bytes() : 0);

  bool exact = true;
  uint32_t tree_cost = 0;
  Status status = kFastestOnly ? Status::kOk : measure(bench, Engine::kTree, &exact, &tree_cost);
  if (status == Status::kOk && bench->shown.has_map) {
    uint32_t cost = 0;
    status = measure(bench, Engine::kBrickMap, &exact, &cost);
    tell_ratio("brick_map.times_faster_than_tree,", tree_cost, cost);
    if (!kFastestOnly) {
      make_grid(bench);
    }
    if (status == Status::kOk && bench->grid.bits != nullptr) {
      uint32_t dda_cost = 0;
      status = measure(bench, Engine::kDda, &exact, &dda_cost);
      tell_ratio("brick_map.times_faster_than_dda,", dda_cost, cost);
    }
  }
  if constexpr (kCanLight) {
    if (status == Status::kOk && bench->light.effects() != Effect::kNone) {
      uint32_t cost = 0;
      status = measure(bench, Engine::kLit, &exact, &cost);
    }
  }
  if (status != Status::kOk) {
    return refuse(status_text(status));
  }
  exact = (kFastestOnly || measure_rays(bench)) && exact;
  tell("arena_bytes", port::arena().size);
  tell("arena_used_bytes", bench->arena.used_bytes());  // the baseline's grid included
  tell("arena_used_without_map_bytes", without_map);
  tell("stack_limit_bytes", port::facts().stack_bytes);
  tell("stack_high_water_bytes", port::stack_high_water());
  put(exact ? "exact,yes\n" : "exact,no\n");
  return exact ? 0 : 1;
}

}  // namespace thimble::apps
