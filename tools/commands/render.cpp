// thimble render: a scene as a picture.
#include <zlib.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/options.h"
#include "commands/stats.h"
#include "output/hit_csv.h"
#include "output/image.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

struct RenderCommand {
  SceneOptions scene;
  EngineOptions engine;
  ViewOptions view;
  ShadeMode shade = ShadeMode::kDepth;
  std::string output;
  std::string hits_path;
  std::string depth_path;
};

constexpr std::int32_t kMostBandRows = 16;

// Rows in a band: as many as a sixteenth of the budget holds, fewer when the scene needs the room.
std::int32_t band_rows(const RenderCommand& command, PixelFormat format) {
  std::uint64_t rows = kMostBandRows;
  if (const auto budget = command.scene.budget_bytes()) {
    rows = std::min<std::uint64_t>(rows, *budget / 16 / row_bytes(format, command.view.width_px));
  }
  return std::clamp(static_cast<std::int32_t>(rows), 1, command.view.height_px);
}

// Pixel by pixel once more, for the files that hold hits and distances.
void write_hits(const RenderCommand& command, const BuiltScene& built, const Camera& camera, OutputFile* csv,
                OutputFile* pfm) {
  if (csv != nullptr) {
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
      if (csv != nullptr) {
        text += std::to_string(x) + ',' + std::to_string(y) + ',';
        append_hit(&text, ray, hit);
      }
      if (pfm != nullptr) {
        const double length =
            std::hypot(static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                       static_cast<double>(ray.direction.z));
        distances.push_back(hit.kind == HitKind::kHit ? static_cast<float>(hit_t(hit) * length)
                                                      : std::numeric_limits<float>::infinity());
      }
    }
    if (csv != nullptr) {
      csv->write(text);
    }
    bar.update(static_cast<double>(y) / camera.height_px());
  }
  if (pfm != nullptr) {
    write_pfm(pfm, camera.width_px(), camera.height_px(), distances);
  }
}

// Opened before the work begins, so that a folder that is not there is known at once.
std::unique_ptr<OutputFile> open_output(const std::string& path) {
  return path.empty() ? nullptr : std::make_unique<OutputFile>(path);
}

void run(const RenderCommand& given) {
  RenderCommand command = given;
  command.view.use_display(command.scene.board);
  const ImageKind kind = image_kind(command.output).value_or(ImageKind::kPpm);
  const std::array<std::string, 4> outputs{command.output, command.hits_path, command.depth_path,
                                           command.scene.stats_path};
  check_distinct(outputs, {&command.scene.arguments.scene, 1});
  std::array<std::unique_ptr<OutputFile>, 4> files;
  std::transform(outputs.begin(), outputs.end(), files.begin(), open_output);
  const auto& [picture, hits_file, depth_file, stats_file] = files;

  // A board's picture is drawn as its display takes it.
  const PixelFormat format =
      command.scene.board != nullptr ? command.scene.board->format : pixel_format(kind);
  const std::int32_t width = command.view.width_px;
  const std::int32_t height = command.view.height_px;
  const auto source = command.scene.open();
  SceneOptions scene = command.scene;
  scene.build_threads = command.engine.threads;
  BuiltScene built = scene.build(*source, band_bytes(format, width, band_rows(command, format)),
                                 band_bytes(format, width, 1));
  // At least a byte a row: a picture is at least a pixel wide.
  const std::size_t one_row = std::max<std::size_t>(1, row_bytes(format, width));
  const auto rows = static_cast<std::int32_t>(built.band().size / one_row);
  std::string note;
  const Camera camera = command.view.camera(*source, built.level(), built.bounds(), &note);

  Shading shading;
  shading.mode = command.shade;
  shading.palette = Span<const Rgb8>(built.palette().data(), built.palette().size());
  const DepthRange range = depth_range(camera, built.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;

  bool is_wide = command.engine.prepare(&built, width, height);

  Image image{width, height, format, std::vector<std::uint8_t>(band_bytes(format, width, height))};
  RenderCounts counts;
  wide::Counts work;
  ProgressBar bar("tracing", command.scene.quiet);
  double seconds = 0;
  const std::size_t line = row_bytes(format, width);
  for (std::int32_t y = 0; is_wide && y < height; y += built.wide_rows()) {
    Band band;
    band.rows = std::min(built.wide_rows(), height - y);
    band.pixels =
        Bytes(image.pixels.data(), image.pixels.size())
            .subspan(line * static_cast<std::size_t>(y), line * static_cast<std::size_t>(band.rows));
    band.format = format;
    band.first_row = y;
    const auto start = std::chrono::steady_clock::now();
    const Status status = built.render_wide(camera, shading, band, &counts, &work);
    if (status == Status::kTooFine && command.engine.name == "auto") {
      is_wide = false;  // rays draw it all
      counts = {};
      work = {};
    } else if (status != Status::kOk) {
      throw InputError("--engine " + command.engine.name + " does not take the rays of this camera");
    }
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    bar.update(static_cast<double>(y) / height);
  }
  for (std::int32_t y = 0; !is_wide && y < height; y += rows) {
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
    std::memcpy(image.pixels.data() + line * static_cast<std::size_t>(y), band.pixels.data,
                line * static_cast<std::size_t>(band.rows));
    bar.update(static_cast<double>(y) / height);
  }

  bar.clear();
  const Image shown = converted(image, pixel_format(kind));
  write_image(picture.get(), kind, shown);
  if (hits_file != nullptr || depth_file != nullptr) {
    write_hits(command, built, camera, hits_file.get(), depth_file.get());
  }

  Stats stats(command.scene.arguments.scene, *source, built);
  stats.frame_seconds = seconds;
  stats.rays = counts.rays;
  stats.hits = counts.hits;
  stats.node_visits = counts.node_visits;
  stats.engine = command.engine.resolved(is_wide);
  stats.threads = is_wide ? command.engine.threads : 1;
  stats.box_tests = work.candidates;
  stats.exact_tests = work.exact;
  const std::vector<std::uint8_t> pixels = file_pixels(shown, kind);
  stats.frame_crc32 = crc_text(static_cast<std::uint32_t>(crc32_z(0, pixels.data(), pixels.size())));
  if (command.scene.board != nullptr) {
    stats.board = command.scene.board->name;
    stats.display_crc32 =
        crc_text(static_cast<std::uint32_t>(crc32_z(0, image.pixels.data(), image.pixels.size())));
  }
  if (stats_file != nullptr) {
    stats_file->write(stats_text(stats));
  }
  for (const auto& file : files) {
    if (file != nullptr) {
      file->flush();  // a full disk is found before any of them takes its name
    }
  }
  for (const auto& file : files) {
    if (file != nullptr) {
      file->commit();
    }
  }
  if (!command.scene.quiet) {
    if (!note.empty()) {
      std::fprintf(stderr, "note: %s\n", note.c_str());
    }
    std::fprintf(stderr,
                 "%s %s in %s bytes (depth %d), at most %s bytes in use; %.3f s a frame, %s of %s rays hit\n",
                 grouped(stats.voxels).c_str(), stats.voxels == 1 ? "voxel" : "voxels",
                 grouped(stats.tree_bytes).c_str(), stats.depth, grouped(stats.high_water_bytes).c_str(),
                 seconds, grouped(stats.hits).c_str(), grouped(stats.rays).c_str());
    if (stats.solid_added != 0) {
      std::fprintf(stderr, "coarsened to fit: %s %s of solid volume added\n",
                   grouped(stats.solid_added).c_str(), stats.solid_added == 1 ? "voxel" : "voxels");
    }
  }
}

}  // namespace

void add_render(CLI::App& app) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = app.add_subcommand("render", "Draw a scene as a picture.");
  command->scene.add_to(*sub);
  add_text_option(
      *sub, "-o,--output", "FILE",
      [command](const std::string& text) {
        command->output = text;
        return image_kind(text) ? "" : "does not end in .ppm, .pgm, .pbm or .png";
      },
      "the picture, .ppm, .pgm, .pbm or .png by its ending; - is a PPM on standard output")
      ->required();
  command->view.add_to(*sub);
  add_choice_option(
      *sub, "--shade", {"depth", "normal", "color", "mono"},
      [command](std::size_t index) {
        constexpr std::array kModes{ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor,
                                    ShadeMode::kMono};
        command->shade = kModes[index];
      },
      "brightness by distance, the face's direction, the palette in one light, or white where anything is")
      ->default_str("depth");
  add_path_option(*sub, "--hits", "FILE.csv", &command->hits_path,
                  std::string("what each pixel's ray hits, a line a pixel, row by row from the top left: "
                              "px,py,") +
                      kHitColumns + ", as trace writes them");
  add_path_option(*sub, "--depth-image", "FILE.pfm", &command->depth_path,
                  "distance in voxels along the unit ray as float32, +inf for a miss");
  command->engine.add_to(*sub);
  sub->callback([command] { run(*command); });
}

}  // namespace thimble::tools
