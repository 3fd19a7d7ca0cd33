// Nanoseconds a ball and step of the particle world, beside a uniform grid and Box2D 2.4 (where it is
// installed).
//
//   make bench BENCH_ARGS=--benchmark_filter=particles
//
// `Time` is that of a step; the counters are a_ball (processor time of a ball and step) and collisions (of
// the engine's own counting, a step). What is compared side by side, by turns, with quality and accuracy
// beside it, is the program thimble_particle_table (particles/main.cpp).
#include <benchmark/benchmark.h>

#include <string>

#include "benchmarks/particles/engine.h"

namespace thimble::benchmarks {
namespace {

void particles(benchmark::State& state, const std::string& engine_name, const std::string& scene_name,
               int balls) {
  const Scene scene = make_scene(scene_name, balls);
  // A fall is started again when it has lasted for 60 steps, so that all balls keep moving.
  const int lifetime = scene_name == "falling" ? 60 : 1 << 30;
  auto engine = make_engine(engine_name, scene);
  double collisions = 0;
  int age = 0;
  for (auto _ : state) {
    engine->step();
    if (++age == lifetime) {
      state.PauseTiming();
      collisions += static_cast<double>(engine->collisions());
      engine = make_engine(engine_name, scene);
      age = 0;
      state.ResumeTiming();
    }
  }
  collisions += static_cast<double>(engine->collisions());
  const double steps = static_cast<double>(state.iterations());
  state.counters["a_ball"] =
      benchmark::Counter(steps * balls, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  state.counters["collisions"] = collisions / steps;
}

const bool kRegistered = [] {
  for (const std::string& engine : engine_names()) {
    for (const std::string scene : {"gas", "falling"}) {
      for (const int balls : {693, 10000}) {
        benchmark::RegisterBenchmark(
            ("particles/" + engine + "/" + scene + "/" + std::to_string(balls)).c_str(),
            [=](benchmark::State& state) { particles(state, engine, scene, balls); })
            ->Unit(benchmark::kMicrosecond)
            ->MinTime(0.2);
      }
    }
  }
  return true;
}();

}  // namespace
}  // namespace thimble::benchmarks
