// thimble render: a scene as a picture.
#include <zlib.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <memory>

#include "commands/commands.h"
#include "commands/options.h"
#include "output/hit_csv.h"
#include "output/image.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "output/stats.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

struct RenderCommand {
  SceneOptions scene;
  EngineOptions engine;
  ViewOptions view;
  ShadeMode shade = ShadeMode::kDepth;
  bool shade_given = false;
  std::string output;
  std::string hits_path;
  std::string depth_path;
};

constexpr std::int32_t kMostBandRows = 16;

// Rows in a band: as many as a sixteenth of the budget holds.
std::int32_t band_rows(const RenderCommand& command, PixelFormat format) {
  std::uint64_t rows = kMostBandRows;
  if (command.scene.memory_bytes) {
    rows = std::min<std::uint64_t>(
        rows, *command.scene.memory_bytes / 16 / row_bytes(format, command.view.width_px));
  }
  return std::clamp(static_cast<std::int32_t>(rows), 1, command.view.height_px);
}

// Pixel by pixel once more, for the files that hold hits and distances.
void write_hits(const RenderCommand& command, const BuiltScene& built, const Camera& camera) {
  std::unique_ptr<OutputFile> csv;
  if (!command.hits_path.empty()) {
    csv = std::make_unique<OutputFile>(command.hits_path);
    csv->write(std::string("px,py,") + kHitColumns + "\n");
  }
  std::vector<float> distances;
  ProgressBar bar("writing hits", command.scene.quiet);
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    std::string text;
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      const Ray ray = camera.ray(x, y);
      Hit hit;
      if (built.closest_hit(ray, &hit, command.engine.trace_options()) != Status::kOk) {
        throw InputError("--engine " + command.engine.name + " does not take the rays of this camera");
      }
      if (csv) {
        text += std::to_string(x) + ',' + std::to_string(y) + ',';
        append_hit(&text, ray, hit);
      }
      if (!command.depth_path.empty()) {
        const double length =
            std::hypot(static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                       static_cast<double>(ray.direction.z));
        distances.push_back(hit.kind == HitKind::kHit ? static_cast<float>(hit_t(hit) * length)
                                                      : std::numeric_limits<float>::infinity());
      }
    }
    if (csv) {
      csv->write(text);
    }
    bar.update(static_cast<double>(y) / camera.height_px());
  }
  if (csv) {
    csv->commit();
  }
  if (!command.depth_path.empty()) {
    write_pfm(command.depth_path, camera.width_px(), camera.height_px(), distances);
  }
}

void run(const RenderCommand& command) {
  const ImageKind kind = image_kind(command.output);
  const PixelFormat format = pixel_format(kind);
  const std::int32_t width = command.view.width_px;
  const std::int32_t height = command.view.height_px;
  const std::int32_t rows = band_rows(command, format);
  const auto source = command.scene.open();
  const BuiltScene built = command.scene.build(*source, band_bytes(format, width, rows));
  const Camera camera = command.view.camera(built.level(), built.bounds());

  Shading shading;
  shading.mode = command.shade;
  shading.palette = Span<const Rgb8>(built.palette().data(), built.palette().size());
  const DepthRange range = depth_range(camera, built.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;

  Image image{width, height, format, std::vector<std::uint8_t>(band_bytes(format, width, height))};
  RenderCounts counts;
  ProgressBar bar("tracing", command.scene.quiet);
  double seconds = 0;
  for (std::int32_t y = 0; y < height; y += rows) {
    Band band;
    band.pixels = built.band();
    band.format = format;
    band.first_row = y;
    band.rows = std::min(rows, height - y);
    const auto start = std::chrono::steady_clock::now();
    if (built.render_band(camera, shading, band, &counts, command.engine.trace_options()) != Status::kOk) {
      throw InputError("--engine " + command.engine.name + " does not take the rays of this camera");
    }
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::size_t row = row_bytes(format, width);
    std::memcpy(image.pixels.data() + row * static_cast<std::size_t>(y), band.pixels.data,
                row * static_cast<std::size_t>(band.rows));
    bar.update(static_cast<double>(y) / height);
  }

  write_image(command.output, kind, image);
  if (!command.hits_path.empty() || !command.depth_path.empty()) {
    write_hits(command, built, camera);
  }

  Stats stats(command.scene.arguments.scene, *source, built);
  stats.frame_seconds = seconds;
  stats.rays = counts.rays;
  stats.hits = counts.hits;
  stats.node_visits = counts.node_visits;
  stats.engine = command.engine.resolved();
  const std::vector<std::uint8_t> pixels = file_pixels(image, kind);
  std::array<char, 9> crc{};
  std::snprintf(crc.data(), crc.size(), "%08lx", crc32_z(0, pixels.data(), pixels.size()));
  stats.frame_crc32 = crc.data();
  if (!command.scene.stats_path.empty()) {
    write_stats(command.scene.stats_path, stats);
  }
  if (!command.scene.quiet) {
    std::fprintf(
        stderr,
        "%s voxels in %s bytes (depth %d), at most %s bytes in use; %.3f s a frame, %s of %s rays hit\n",
        grouped(stats.voxels).c_str(), grouped(stats.tree_bytes).c_str(), stats.depth,
        grouped(stats.high_water_bytes).c_str(), seconds, grouped(stats.hits).c_str(),
        grouped(stats.rays).c_str());
    if (stats.solid_added != 0) {
      std::fprintf(stderr, "coarsened to fit: %s voxels of solid volume were added\n",
                   grouped(stats.solid_added).c_str());
    }
  }
}

}  // namespace

void add_render(CLI::App& app) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = app.add_subcommand("render", "draw a scene as a picture");
  command->scene.add_to(*sub);
  sub->add_option("-o,--output", command->output,
                  "the picture: .ppm, .pgm, .pbm or .png; - is a PPM on standard output")
      ->required()
      ->type_name("FILE");
  command->view.add_to(*sub);
  sub->add_option("--shade", command->shade, "depth, normal, color or mono")
      ->transform(CLI::CheckedTransformer(std::map<std::string, ShadeMode>{{"depth", ShadeMode::kDepth},
                                                                           {"normal", ShadeMode::kNormal},
                                                                           {"color", ShadeMode::kColor},
                                                                           {"mono", ShadeMode::kMono}},
                                          CLI::ignore_case))
      ->default_str("depth")
      ->type_name("MODE");
  sub->add_option("--hits", command->hits_path, std::string("a line a pixel: px,py,") + kHitColumns)
      ->type_name("FILE.csv");
  sub->add_option("--depth-image", command->depth_path,
                  "distance in voxels along the unit ray, +inf for a miss")
      ->type_name("FILE.pfm");
  command->engine.add_to(*sub);
  sub->callback([command] { run(*command); });
}

}  // namespace thimble::tools
