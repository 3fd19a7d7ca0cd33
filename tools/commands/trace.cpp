// thimble trace: rays from a file, hits to a file.
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/engine_options.h"
#include "commands/ray_file.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "commands/view_options.h"
#include "output/hit_csv.h"
#include "output/output_set.h"
#include "output/progress.h"
#include "readers/file_bytes.h"
#include "scene/built_scene.h"
#include "scene/gpu_engine.h"
#include "scene/scene_source.h"
#include "scene/wide_rays.h"
#include "scene/workers.h"

namespace thimble::tools {
namespace {

struct TraceCommand {
  SceneOptions scene;
  EngineOptions engine;
  std::string rays_path;
  std::string output = "-";
  int direction_bits = 0;
  int threads = 1;
};

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Files with so many rays are worth the map.
constexpr std::size_t kRaysForMap = 100000;

// Judges all rays before the first answer is written, since standard output cannot be taken back: throws for the
// first line that is none. Returns their number.
std::size_t judge(const TraceCommand& command, const RayFile& file) {
  struct Judged {
    std::optional<RayFault> fault;
    std::size_t lines = 0;
    std::size_t rays = 0;
  };
  std::vector<Judged> chunks(file.chunks());
  std::vector<std::vector<Ray>> rays(static_cast<std::size_t>(command.threads));
  each_task(chunks.size(), command.threads, [&](std::size_t task, std::size_t worker) {
    chunks[task].fault = file.read(task, &rays[worker], &chunks[task].lines);
    chunks[task].rays = rays[worker].size();
  });
  std::size_t line = file.first_line();
  std::size_t count = 0;
  for (const Judged& chunk : chunks) {
    if (chunk.fault) {
      throw OutputError(command.rays_path + ": line " + std::to_string(line + chunk.fault->line) + ": " +
                        chunk.fault->sentence);
    }
    line += chunk.lines;
    count += chunk.rays;
  }
  return count;
}

// What a worker keeps from chunk to chunk.
struct Tracing {
  std::vector<Ray> rays;
  std::vector<Hit> hits;
  std::uint64_t hit_count = 0;
  std::uint64_t visits = 0;
  double seconds = 0;  // of tracing alone
};

// Traces the rays of a chunk and writes their lines.
void trace_chunk(const RayFile& file, std::size_t chunk, const BuiltScene& built, const WideRays* wide,
                 GpuEngine* gpu, const TraceOptions& options, Tracing* tracing, std::string* lines) {
  std::size_t count = 0;
  (void)file.read(chunk, &tracing->rays, &count);  // judged before
  const std::vector<Ray>& rays = tracing->rays;
  std::vector<Hit>& hits = tracing->hits;
  hits.resize(rays.size());
  const auto start = Clock::now();
  if (gpu != nullptr) {
    (void)gpu->trace({rays.data(), rays.size()}, {hits.data(), hits.size()});
  } else if (wide != nullptr) {
    (void)wide->first_hit({rays.data(), rays.size()}, {hits.data(), hits.size()});
  } else {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      (void)built.closest_hit(rays[i], &hits[i], options);
    }
  }
  tracing->seconds += seconds_since(start);
  lines->clear();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    append_hit(lines, rays[i], hits[i]);
    tracing->hit_count += hits[i].kind == HitKind::kHit ? 1U : 0U;
    tracing->visits += hits[i].visits;
  }
}

void run(const TraceCommand& command) {
  command.engine.check_budget(command.scene.budget_bytes().has_value());
  OutputSet outputs({command.output, command.scene.stats_path},
                    {command.scene.arguments.scene, command.rays_path});
  OutputFile& output = *outputs[0];
  const auto source = command.scene.open();
  BuiltScene built = command.scene.build(*source);
  FileBytes bytes;
  try {
    bytes = load_file(command.rays_path);
  } catch (const InputError& error) {
    throw OutputError(command.rays_path + ": " + error.what());
  }
  const std::string_view text = bytes.text();
  const RayFile file(text, {built.level(), command.direction_bits, command.engine.name == "ray32"});
  Stats stats(command.scene.arguments.scene, *source, built);
  stats.rays = judge(command, file);
  std::unique_ptr<WideRays> wide;
  if (stats.rays >= kRaysForMap && command.engine.name == "auto" && command.scene.board == nullptr) {
    wide = WideRays::make(&built);
    stats.budget_bytes = built.budget_bytes();
    stats.high_water_bytes = built.high_water_bytes();
  }
  const auto gpu = command.engine.gpu(built);
  stats.engine = command.engine.resolved(wide != nullptr);
  stats.threads = command.threads;
  if (command.scene.board != nullptr) {
    stats.board = command.scene.board->name;
  }
  output.write(std::string(kHitColumns) + "\n");
  ProgressBar bar("tracing", command.scene.quiet);
  const auto start = Clock::now();
  const auto threads = static_cast<std::size_t>(command.threads);
  std::vector<Tracing> workers(threads);
  std::vector<std::string> lines(8 * threads);
  for (std::size_t first = 0; first < file.chunks(); first += lines.size()) {
    const std::size_t count = std::min(lines.size(), file.chunks() - first);
    each_task(count, command.threads, [&](std::size_t task, std::size_t worker) {
      trace_chunk(file, first + task, built, wide.get(), gpu.get(), command.engine.trace_options(),
                  &workers[worker], &lines[task]);
    });
    for (std::size_t task = 0; task < count; ++task) {
      output.write(lines[task]);
    }
    bar.update(static_cast<double>(file.end(first + count - 1)) / static_cast<double>(text.size()));
  }
  stats.frame_seconds = seconds_since(start);
  stats.trace_seconds = 0;
  for (const Tracing& worker : workers) {
    stats.hits += worker.hit_count;
    stats.node_visits += worker.visits;
    *stats.trace_seconds += worker.seconds;
  }
  if (outputs[1] != nullptr) {
    outputs[1]->write(stats_text(stats));
  }
  outputs.commit();
}

}  // namespace

void add_trace(CLI::App& app) {
  auto command = std::make_shared<TraceCommand>();
  CLI::App* sub = add_command(app, "trace", "Trace rays from a file.");
  command->scene.add_to(*sub);
  add_path_option(*sub, "--rays", "FILE.csv", &command->rays_path,
                  "one ray a line: ox,oy,oz,dx,dy,dz in voxels; a header line is allowed")
      .required();
  add_path_option(*sub, "-o,--output", "FILE.csv", &command->output,
                  std::string("a header line, then one line a ray: ") + kHitColumns +
                      "; point = q-origin / 256 + t * q-direction, in voxels; - is standard output")
      .default_str("-");
  add_direction_bits(*sub, &command->direction_bits);
  command->engine.add_ray_engines_to(*sub);
  add_threads(*sub, &command->threads, "threads that read, trace and write");
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
