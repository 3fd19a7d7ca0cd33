// thimble trace: rays from a file, hits to a file.
#include <limits>

#include "commands/commands.h"
#include "instruments/timed_frames.h"
#include "output/hit_rows.h"
#include "readers/formats.h"
#include "readers/text.h"
#include "scene/given_ray.h"
#include "scene/gpu_engine.h"
#include "scene/workers.h"

namespace thimble::tools {
namespace {

// ---- A file of rays, read in chunks that do not know of one another.

// The six numbers of a line, or nothing when it does not hold just six numbers. One that no double holds is infinite.
std::optional<std::array<double, 6>> parse_line(std::string_view line) {
  std::array<double, 6> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t comma = line.find(',');
    const NumberKind kind = parse_number(trimmed(line.substr(0, comma)), numbers[i]);
    if (kind == NumberKind::kGarbage || (comma == std::string_view::npos) != (i + 1 == numbers.size())) {
      return std::nullopt;
    }
    numbers[i] = kind == NumberKind::kFinite ? numbers[i] : std::numeric_limits<double>::infinity();
    line.remove_prefix(std::min(comma, line.size() - 1) + 1);
  }
  return numbers;
}

// About so many bytes a chunk, some thousand rays.
constexpr std::size_t kChunkBytes = 256 << 10;
constexpr std::size_t kChunkRows = 4096;

/// What is wrong with a line, or with a row of an array.
struct RayFault {
  std::size_t line = 0;  ///< counted from the chunk's first, which is 0
  std::string sentence;
};

class RayFile {
 public:
  /// One ray a line, ox,oy,oz,dx,dy,dz in voxels; a header line is allowed before, empty lines anywhere. Or a NumPy
  /// array, one ray a row. Looks at a few bytes a chunk.
  RayFile(const SharedBytes& file, const RayRules& rules) : file_(file), rules_(rules) {
    if (!looks_like_npy(file.text())) {
      find_lines();
      return;
    }
    table_ = read_npy_table(file);
    fail_if(table_->columns != 6, "rays are rows of six numbers, ox, oy, oz, dx, dy, dz; this array has ",
            table_->columns, " columns");
    first_line_ = 0;
    for (std::size_t row = 0; row < table_->rows;) {
      row = std::min<std::size_t>(row + kChunkRows, table_->rows);
      ends_.push_back(row);
    }
  }

  std::size_t chunks() const { return ends_.size(); }
  /// What part of the file is behind us where a chunk ends, up to 1.
  double part(std::size_t chunk) const {
    return static_cast<double>(ends_[chunk]) / static_cast<double>(ends_.back());
  }
  /// Where a fault is, by the lines or rows before its chunk.
  std::string place(std::size_t before, const RayFault& fault) const {
    return (table_ ? "row " : "line ") + std::to_string(first_line_ + before + fault.line);
  }

  /// Puts the rays of a chunk into `rays`, up to the first line that is none: then that is the answer. `lines` gets
  /// the number of its lines. Any number of threads at a time.
  std::optional<RayFault> read(std::size_t chunk, std::vector<Ray>* rays, std::size_t* lines) const {
    const std::size_t begin = chunk == 0 ? begin_ : ends_[chunk - 1];
    rays->clear();
    std::string fault;
    LineReader reader(table_ ? std::string_view() : file_.text().substr(begin, ends_[chunk] - begin));
    std::string_view line;
    for (*lines = 0; table_ ? *lines < ends_[chunk] - begin : reader.next(line); ++*lines) {
      if (!table_ && trimmed(line).empty()) {
        continue;
      }
      const auto numbers = table_ ? row_at(begin + *lines) : parse_line(line);
      fault = numbers ? quantised_ray(*numbers, rules_, &rays->emplace_back())
                      : "these are not the six numbers ox,oy,oz,dx,dy,dz";
      if (!fault.empty()) {
        return RayFault{*lines, std::move(fault)};
      }
    }
    return std::nullopt;
  }

 private:
  std::optional<std::array<double, 6>> row_at(std::size_t row) const {
    std::array<double, 6> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] = table_->at(row, i);
    }
    return numbers;
  }
  void find_lines() {
    const std::string_view text = file_.text();
    begin_ = mark_bytes(text);
    // Up to the first ray.
    LineReader lines(text.substr(begin_));
    const std::size_t front = begin_;
    bool header = false;
    for (std::string_view line; lines.next(line); begin_ = front + lines.offset(), ++first_line_) {
      if (!trimmed(line).empty()) {
        const std::vector<std::string_view> columns = comma_columns(line);
        if (header || parse_line(line) || !are_names(columns)) {
          break;
        }
        constexpr std::array<const char*, 6> kNames{"ox", "oy", "oz", "dx", "dy", "dz"};
        fail_at_line_if(misplaces(columns, kNames), first_line_,
                        "the columns are named in another order than ox,oy,oz,dx,dy,dz");
        header = true;
      }
    }
    for (std::size_t at = begin_; at < text.size();) {
      const std::size_t end = text.find('\n', std::min(at + kChunkBytes, text.size()));
      at = end == std::string_view::npos ? text.size() : end + 1;
      ends_.push_back(at);
    }
  }

  SharedBytes file_;
  RayRules rules_;
  std::optional<NumberTable> table_;
  std::size_t begin_ = 0;
  std::size_t first_line_ = 1;     // of the first chunk; rows are counted from 0
  std::vector<std::size_t> ends_;  // of the chunks, bytes or rows
};

// ----

struct TraceCommand {
  SceneOptions scene;
  EngineOptions engine;
  std::string rays_path;
  std::string output = "-";
  int direction_bits = 0;
  int threads = 1;
};

constexpr int kOnTheWall = 2;  // what FrameWatch takes for more threads than one

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
  std::size_t line = 0;
  std::size_t count = 0;
  for (const Judged& chunk : chunks) {
    if (chunk.fault) {
      throw OutputError(command.rays_path + ": " + file.place(line, *chunk.fault) + ": " +
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
void trace_chunk(const RayFile& file, std::size_t chunk, const BuiltScene& built, const FirstHits& wide,
                 GpuEngine* gpu, const TraceOptions& options, const HitRows& rows, Tracing* tracing,
                 std::string* lines) {
  std::size_t count = 0;
  (void)file.read(chunk, &tracing->rays, &count);  // judged before
  const std::vector<Ray>& rays = tracing->rays;
  std::vector<Hit>& hits = tracing->hits;
  hits.resize(rays.size());
  const FrameWatch watch(kOnTheWall);
  if (gpu != nullptr) {
    (void)gpu->trace({rays.data(), rays.size()}, {hits.data(), hits.size()});
  } else if (wide) {
    (void)wide({rays.data(), rays.size()}, {hits.data(), hits.size()});
  } else {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      (void)built.closest_hit(rays[i], &hits[i], options);
    }
  }
  tracing->seconds += watch.seconds();
  lines->clear();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rows.append(lines, rays[i], hits[i]);
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
  const RayFile file = about(command.rays_path, [&] {
    const auto look = [](std::span<const std::uint8_t> first) {
      if (!looks_like_npy(SharedBytes{first, nullptr}.text())) {
        refuse_zero_bytes(first, "rays, one a line");
      }
    };
    return RayFile(load_file(command.rays_path, kFileLimitBytes, look),
                   {built.level(), command.direction_bits, command.engine.name == "ray32"});
  });
  Stats stats(command.scene, *source, built);
  stats.counts.all.rays = judge(command, file);
  FirstHits wide;
  if (stats.counts.all.rays >= kRaysForMap && command.engine.name == "auto" &&
      command.scene.board == nullptr) {
    wide = wide_first_hits(&built);
    stats.budget_bytes = built.budget_bytes();
    stats.high_water_bytes = built.high_water_bytes();
  }
  const auto gpu = command.engine.gpu(built);
  stats.engine = command.engine.resolved(wide != nullptr);
  stats.threads = command.threads;
  const HitRows rows(command.output, false, built.structure() != StructureKind::kDense);
  output.write(rows.beginning(stats.counts.all.rays));
  ProgressBar bar("tracing", command.scene.quiet);
  const FrameWatch watch(kOnTheWall);
  const auto threads = static_cast<std::size_t>(command.threads);
  std::vector<Tracing> workers(threads);
  std::vector<std::string> lines(8 * threads);
  for (std::size_t first = 0; first < file.chunks(); first += lines.size()) {
    const std::size_t count = std::min(lines.size(), file.chunks() - first);
    each_task(count, command.threads, [&](std::size_t task, std::size_t worker) {
      trace_chunk(file, first + task, built, wide, gpu.get(), command.engine.trace_options(), rows,
                  &workers[worker], &lines[task]);
    });
    for (std::size_t task = 0; task < count; ++task) {
      output.write(lines[task]);
    }
    bar.update(file.part(first + count - 1));
  }
  stats.frame_seconds = watch.seconds();
  stats.trace_seconds = 0;
  for (const Tracing& worker : workers) {
    stats.counts.all.hits += worker.hit_count;
    stats.counts.all.node_visits += worker.visits;
    *stats.trace_seconds += worker.seconds;
  }
  outputs.write(1, stats_text(stats));
  outputs.commit();
}

}  // namespace

void add_trace(CLI::App& app) {
  CLI::App* sub = add_command(app, "trace", "Trace rays from a file.");
  TraceCommand* const command = options_for<TraceCommand>(*sub, run);
  command->scene.add_to(*sub);
  add_path_option(
      *sub, "--rays", "FILE.csv|.npy", &command->rays_path,
      "one ray a line: ox,oy,oz,dx,dy,dz in voxels; a header line is allowed; or a NumPy array, a ray "
      "a row of six numbers")
      ->required();
  add_path_option(*sub, "-o,--output", "FILE.csv|.npy", &command->output,
                  std::string("a header line, then one line a ray: ") + kHitColumns +
                      "; point = q-origin / 256 + t * q-direction, in voxels; a dense grid keeps no "
                      "material" +
                      kHitArray + "; - is standard output, lines")
      ->default_str("-");
  add_direction_bits(*sub, &command->direction_bits);
  command->engine.add_ray_engines_to(*sub);
  add_threads(*sub, &command->threads, "threads that read, trace and write");
}

}  // namespace thimble::tools
