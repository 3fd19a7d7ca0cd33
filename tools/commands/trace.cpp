// thimble trace: rays from a file, hits to a file.
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>

#include "boards/board_table.h"
#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/engine_options.h"
#include "commands/scene_options.h"
#include "commands/stats.h"
#include "commands/view_options.h"
#include "output/hit_csv.h"
#include "output/output_set.h"
#include "output/progress.h"
#include "output/units.h"
#include "readers/file_bytes.h"
#include "scene/built_scene.h"
#include "scene/scene_source.h"

namespace thimble::tools {
namespace {

struct TraceCommand {
  SceneOptions scene;
  EngineOptions engine;
  std::string rays_path;
  std::string output = "-";
  int direction_bits = 0;
};

[[noreturn]] void fail(const std::string& path, std::size_t line, const std::string& sentence) {
  throw OutputError(path + ": line " + std::to_string(line) + ": " + sentence);
}

// The six numbers of a line, or nothing when it does not hold just six numbers.
std::optional<std::array<double, 6>> parse_line(std::string_view line) {
  std::array<double, 6> numbers{};
  const char* at = line.data();
  const char* end = at + line.size();
  const auto skip_blanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t')) {
      ++at;
    }
  };
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    skip_blanks();
    if (end - at > 1 && *at == '+' && at[1] != '-') {
      ++at;
    }
    const auto [next, error] = std::from_chars(at, end, numbers[i]);
    if (error == std::errc::result_out_of_range) {
      // Too large or too small for a double: infinite or zero, which the caller judges.
      numbers[i] = std::strtod(std::string(at, next).c_str(), nullptr);
    } else if (error != std::errc{}) {
      return std::nullopt;
    }
    at = next;
    skip_blanks();
    if (i + 1 < numbers.size() && (at == end || *at++ != ',')) {
      return std::nullopt;
    }
  }
  return at == end ? std::optional(numbers) : std::nullopt;
}

// The ray as it is traced: origin to the nearest 1/256 voxel; a direction of integers within the limit as it
// is, any other scaled so that its largest component is the limit. A zero component stays zero.
Ray quantise(const std::array<double, 6>& numbers, int level, int direction_bits, const std::string& path,
             std::size_t line) {
  const double low = static_cast<double>(kMinOriginWorlds) * (1 << level);
  const double high = static_cast<double>(kMaxOriginWorlds) * (1 << level);
  for (const double number : numbers) {
    if (!std::isfinite(number)) {
      fail(path, line, "a ray has a coordinate that is not a finite number");
    }
  }
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = numbers[static_cast<std::size_t>(axis)];
    if (value < low || value > high) {
      fail(path, line,
           "the origin's " + shortest(value) + " is outside the accepted " + shortest(low) + " to " +
               shortest(high) + " (-4 to 5 world sizes)");
    }
    ray.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(std::lround(value * Q8::kOne)));
  }
  double largest = 0;
  bool whole = true;
  for (std::size_t i = 3; i < 6; ++i) {
    largest = std::max(largest, std::abs(numbers[i]));
    whole = whole && numbers[i] == std::trunc(numbers[i]);
  }
  if (largest == 0) {
    fail(path, line, "the direction is zero");
  }
  const double limit = direction_bits == 0 ? kMaxDirection : (1 << direction_bits) - 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = numbers[static_cast<std::size_t>(axis) + 3];
    const double scaled = whole && largest <= limit ? value : value / largest * limit;
    ray.direction[axis] = static_cast<std::int32_t>(std::lround(scaled));
  }
  return ray;
}

// Whether a line holds names only: a header. A line with a number among its columns is a ray gone wrong.
bool is_header(std::string_view line) {
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view column = line.substr(0, comma);
    column.remove_prefix(std::min(column.find_first_not_of(" \t+"), column.size()));
    double number = 0;
    if (std::from_chars(column.data(), column.data() + column.size(), number).ec !=
        std::errc::invalid_argument) {
      return false;
    }
    if (comma == std::string_view::npos) {
      return true;
    }
    line.remove_prefix(comma + 1);
  }
}

// Calls `visit` with each ray of the file; throws for the first line that is none.
void for_each_ray(const TraceCommand& command, std::string_view text, int level,
                  const std::function<void(const Ray&, std::size_t line, std::size_t offset)>& visit) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::size_t at = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  std::size_t line_number = 0;
  bool first = true;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++line_number;
    if (!line.empty() && line.back() == '\r') {
      line.remove_suffix(1);
    }
    if (line.find_first_not_of(" \t") == std::string_view::npos) {
      continue;
    }
    const auto numbers = parse_line(line);
    const bool header = !numbers && first && is_header(line);
    first = false;
    if (header) {
      continue;
    }
    if (!numbers) {
      fail(command.rays_path, line_number, "these are not the six numbers ox,oy,oz,dx,dy,dz");
    }
    visit(quantise(*numbers, level, command.direction_bits, command.rays_path, line_number), line_number, at);
  }
}

void run(const TraceCommand& command) {
  OutputSet outputs({command.output, command.scene.stats_path},
                    {command.scene.arguments.scene, command.rays_path});
  OutputFile& output = *outputs[0];
  const auto source = command.scene.open();
  const BuiltScene built = command.scene.build(*source);
  FileBytes bytes;
  try {
    bytes = load_file(command.rays_path);
  } catch (const InputError& error) {
    throw OutputError(command.rays_path + ": " + error.what());
  }
  const std::string_view text = bytes.text();
  const TraceOptions options = command.engine.trace_options();

  // All rays are judged before the first answer is written: standard output cannot be taken back.
  for_each_ray(command, text, built.level(), [&](const Ray& ray, std::size_t line, std::size_t) {
    if (command.engine.name == "ray32" && !accepts_32(ray, built.level())) {
      fail(command.rays_path, line, "--engine ray32 does not take this ray; auto does");
    }
  });
  output.write(std::string(kHitColumns) + "\n");
  ProgressBar bar("tracing", command.scene.quiet);
  Stats stats(command.scene.arguments.scene, *source, built);
  stats.engine = command.engine.resolved(false);
  if (command.scene.board != nullptr) {
    stats.board = command.scene.board->name;
  }
  std::string lines;
  const auto start = std::chrono::steady_clock::now();
  for_each_ray(command, text, built.level(), [&](const Ray& ray, std::size_t line, std::size_t offset) {
    Hit hit;
    if (built.closest_hit(ray, &hit, options) != Status::kOk) {
      fail(command.rays_path, line, "--engine " + command.engine.name + " does not take this ray");
    }
    append_hit(&lines, ray, hit);
    ++stats.rays;
    stats.hits += hit.kind == HitKind::kHit ? 1U : 0U;
    stats.node_visits += hit.visits;
    constexpr std::size_t kFlushBytes = 1 << 20;
    if (lines.size() > kFlushBytes) {
      output.write(lines);
      lines.clear();
      bar.update(static_cast<double>(offset) / static_cast<double>(text.size()));
    }
  });
  stats.frame_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  output.write(lines);
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
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
