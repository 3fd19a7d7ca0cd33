// Milliseconds a frame of the paper's workload, beside what could be used instead: an exact raster loop,
// Embree, NanoVDB (where they are installed), and the core ray by ray. All draw by turns.
//
//   make bench BENCH_ARGS=--benchmark_filter=peers
//   make bench BENCH_ARGS="--benchmark_filter=peers --benchmark_out=F.csv --benchmark_out_format=csv"
//
// `Time` is this renderer's frame; the counters are each peer's time over it, and how many of its pixels show
// another voxel than the core. All rows of both tables, CSV, JSON and a plot: the program thimble_peer_table
// (peers/main.cpp).
#include <benchmark/benchmark.h>

#include <string>

#include "benchmarks/peers/contest.h"

namespace thimble::benchmarks {
namespace {

void peers(benchmark::State& state, const std::string& scene, std::uint64_t points, bool orthographic) {
  Contest contest(scene, points, 6'000'000'000);
  Result result;
  for ([[maybe_unused]] const auto _ : state) {
    result = contest.run(orthographic, 3);
    state.SetIterationTime(result.entrants[0].ms * 1e-3);
  }
  for (const Entrant& entrant : result.entrants) {
    state.counters[entrant.name + " x"] = entrant.ms / result.entrants[0].ms;
    state.counters[entrant.name + " px"] = static_cast<double>(entrant.differing_px);
  }
}

const bool kRegistered = [] {
  for (const std::string scene : {"points", "cluster"}) {
    for (const std::uint64_t points : {1'000ULL, 100'000ULL, 1'000'000ULL, 10'000'000ULL}) {
      for (const bool orthographic : {false, true}) {
        const std::string name = "peers/" + scene + ":" + std::to_string(points) +
                                 (orthographic ? "/orthographic" : "/perspective");
        benchmark::RegisterBenchmark(
            name.c_str(), [=](benchmark::State& state) { peers(state, scene, points, orthographic); })
            ->UseManualTime()
            ->Iterations(1)
            ->Unit(benchmark::kMillisecond);
      }
    }
  }
  return true;
}();

}  // namespace
}  // namespace thimble::benchmarks
