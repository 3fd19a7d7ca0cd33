// thimble render: a scene as a picture.
#include <zlib.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "commands/arguments.h"
#include "commands/commands.h"
#include "commands/effect_options.h"
#include "commands/options.h"
#include "commands/stats.h"
#include "output/hit_csv.h"
#include "output/image.h"
#include "output/output_file.h"
#include "output/progress.h"
#include "output/units.h"
#include "scene/lit_setup.h"
#include "scene/painter.h"
#include "scene/painting.h"

namespace thimble::tools {
namespace {

struct RenderCommand {
  SceneOptions scene;
  EngineOptions engine;
  ViewOptions view;
  Quality quality;
  EffectOptions effects;
  ShadeMode shade = ShadeMode::kDepth;
  std::string shade_name;  ///< empty unless given
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
void write_hits(const RenderCommand& command, const QualityFrame& frame, const Camera& camera,
                OutputFile* csv, OutputFile* pfm) {
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
      if (frame.closest_hit(ray, &hit, command.engine.trace_options()) != Status::kOk) {
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

[[noreturn]] void fail_camera(const RenderCommand& command) {
  throw InputError("--engine " + command.engine.name + " does not take the rays of this camera");
}

// What contradicts itself whatever the scene is.
void check_usage(const RenderCommand& command) {
  const bool wide = command.engine.name == "wide";
  if (wide && !command.quality.plain()) {
    refuse_usage(
        "--engine wide draws one sample a pixel at full depth, without --samples, --cutoff and --max-depth");
  }
  if (wide && (command.effects.named() || command.effects.bounces)) {
    refuse_usage("--engine wide draws without --effects and --bounces");
  }
  if (command.effects.named() && !command.shade_name.empty() && command.shade != ShadeMode::kColor) {
    refuse_usage("--shade " + command.shade_name + " shows no light, and so no --effects");
  }
}

// An explicit --shade is drawn as such, unless effects are asked for beside it.
EffectChoice effect_choice(const RenderCommand& command) {
  constexpr EffectChoice kNone{false, Effect::kNone};
  if (command.shade_name.empty() || command.effects.named()) {
    return command.effects.choice;
  }
  return command.effects.given && command.shade == ShadeMode::kColor ? command.effects.choice : kNone;
}

// What a lit picture cannot honour.
void check_lit(const RenderCommand& command, EffectSet effects) {
  const auto refuse = [&](const std::string& what) {
    refuse_usage("a picture with the effects " + effects_text(effects) + " " + what +
                 " (--effects none draws the scene without)");
  };
  if (command.scene.structure != StructureKind::kCompact) {
    refuse("wants --structure compact");
  }
  if (command.engine.name != "auto") {
    refuse("takes no --engine but auto");
  }
  if (command.quality.cuts()) {
    refuse("takes no --cutoff and no --max-depth");
  }
}

// What a picture is drawn with, whoever draws it.
struct Subject {
  const RenderCommand& command;
  BuiltScene& built;
  const QualityFrame& frame;
  const Camera& camera;
  const Camera& fine;  ///< `camera` with so many times the pixels as there are samples across one
  const Shading& shading;
  PixelFormat format;
};

// Throws InputError for a camera whose rays it does not take.
Painting paint_without_effects(const Subject& subject, const Progress& progress) {
  const RenderCommand& command = subject.command;
  const std::int32_t width = subject.camera.width_px();
  const std::int32_t height = subject.camera.height_px();
  Painting painting;
  const auto painted = [&](const std::unique_ptr<Painter>& painter) {
    return paint(*painter, width, height, subject.format, progress, &painting);
  };
  const TraceOptions options = command.engine.trace_options();
  if (!command.quality.plain()) {
    if (painted(make_quality_painter(subject.built, subject.frame, options)) != Status::kOk) {
      fail_camera(command);
    }
    return painting;
  }
  // With --board the budget is the board's RAM, in which nothing of the host's is to stand unasked.
  const bool may_be_wide = command.scene.board == nullptr || command.engine.name == "wide";
  if (may_be_wide && command.engine.prepare(&subject.built, width, height)) {
    const Status status =
        painted(make_wide_painter(subject.built, subject.camera, subject.shading, command.engine.threads));
    if (status == Status::kOk) {
      return painting;
    }
    if (status != Status::kTooFine || command.engine.name != "auto") {
      fail_camera(command);
    }
  }
  if (painted(make_ray_painter(subject.built, subject.camera, subject.shading, subject.format, options)) !=
      Status::kOk) {
    fail_camera(command);
  }
  return painting;
}

Painting paint_lit(const Subject& subject, const LitPicture& picture, const Progress& progress) {
  Painting painting;
  const auto painter =
      make_lit_painter(subject.built, subject.fine, subject.shading, subject.format, picture);
  if (paint(*painter, subject.camera.width_px(), subject.camera.height_px(), subject.format, progress,
            &painting) != Status::kOk) {
    throw InputError("its lights or surfaces are beyond the limits of a lit picture");
  }
  return painting;
}

// For a person: what the scene takes, and what came of it.
void print_summary(const Stats& stats, const std::string& note) {
  if (!note.empty()) {
    std::fprintf(stderr, "note: %s\n", note.c_str());
  }
  std::fprintf(stderr,
               "%s %s in %s bytes (depth %d), at most %s bytes in use; %.3f s a frame, %s of %s rays hit\n",
               grouped(stats.voxels).c_str(), stats.voxels == 1 ? "voxel" : "voxels",
               grouped(stats.tree_bytes).c_str(), stats.depth, grouped(stats.high_water_bytes).c_str(),
               stats.frame_seconds, grouped(stats.hits).c_str(), grouped(stats.rays).c_str());
  if (stats.lit_counts) {
    std::string rays;
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      if (stats.lit_counts->rays[kind] != 0) {
        rays += (rays.empty() ? "" : ", ") + grouped(stats.lit_counts->rays[kind]) + " " +
                ray_kind_name(static_cast<LitRayKind>(kind));
      }
    }
    std::fprintf(stderr, "lit: %s; rays: %s\n", effects_text(*stats.effects).c_str(), rays.c_str());
  }
  if (stats.solid_added != 0) {
    std::fprintf(stderr, "coarsened to fit: %s %s of solid volume added\n",
                 grouped(stats.solid_added).c_str(), stats.solid_added == 1 ? "voxel" : "voxels");
  }
}

void run(const RenderCommand& given) {
  RenderCommand command = given;
  check_usage(command);
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
  const auto source = command.scene.open();
  const bool plain = command.quality.plain();

  const LitDescription lighting = command.effects.lighting(*source);
  const EffectChoice choice = effect_choice(command);
  UsedMaterials used;
  EffectSet effects = expected_effects(*source, lighting, choice, &used);
  if (effects != Effect::kNone) {
    check_lit(command, effects);
  }
  const bool in_flash = command.scene.board != nullptr && source->baked() != nullptr;
  // Each thread that draws with effects keeps rays of its own.
  const auto more_threads = static_cast<std::uint64_t>(command.engine.threads - 1);
  const std::uint64_t state_bytes =
      (effects != Effect::kNone ? more_threads * lit_render_bytes(effects) : 0) +
      (in_flash ? lit_render_bytes(effects)
                : lit_state_bytes(lit_scene_for(lighting, used, effects), effects));

  const std::uint64_t quality_bytes = quality_band_bytes(command.quality, format, width);
  command.scene.build_threads = command.engine.threads;
  BuiltScene built = command.scene.build(
      *source, plain ? band_bytes(format, width, band_rows(command, format)) : quality_bytes,
      plain ? band_bytes(format, width, 1) : quality_bytes, state_bytes);
  std::string note;
  const Camera camera = command.view.camera(*source, built.level(), built.bounds(), &note);

  Shading shading;
  shading.mode = command.shade;
  shading.palette = Span<const Rgb8>(built.palette().data(), built.palette().size());
  const DepthRange range = depth_range(camera, built.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;

  const NodeColors colors = take_node_colors(&built, command.quality, shading);
  const Camera fine =
      command.quality.across == 1
          ? camera
          : command.view.finer(command.quality.across).camera(*source, built.level(), built.bounds());
  const QualityFrame frame(built, command.quality, camera, fine, shading, colors);
  const Subject subject{command, built, frame, camera, fine, shading, format};
  LitPicture lit;
  if (effects != Effect::kNone) {
    used = used_materials(built.compact());
    lit.effects = effects = chosen_effects(lighting, used, choice);
    lit.scene = lit_scene_for(lighting, used, effects);
    lit.across = command.quality.across;
    lit.threads = command.engine.threads;
  }
  ProgressBar bar("tracing", command.scene.quiet);
  const auto update = [&](double done) { bar.update(done); };
  const Painting painting =
      effects == Effect::kNone ? paint_without_effects(subject, update) : paint_lit(subject, lit, update);
  bar.clear();

  const Image shown = converted(painting.image, pixel_format(kind));
  write_image(picture.get(), kind, shown);
  if (hits_file != nullptr || depth_file != nullptr) {
    write_hits(command, frame, camera, hits_file.get(), depth_file.get());
  }

  Stats stats(command.scene.arguments.scene, *source, built);
  stats.frame_seconds = painting.seconds;
  stats.rays = painting.counts.all.rays;
  stats.hits = painting.counts.all.hits;
  stats.node_visits = painting.counts.all.node_visits;
  stats.engine = painting.engine;
  stats.threads = painting.threads;
  stats.box_tests = painting.counts.wide.candidates;
  stats.exact_tests = painting.counts.wide.exact;
  const std::vector<std::uint8_t> pixels = file_pixels(shown, kind);
  stats.frame_crc32 = crc_text(static_cast<std::uint32_t>(crc32_z(0, pixels.data(), pixels.size())));
  stats.effects = effects;
  if (effects != Effect::kNone) {
    stats.bounces = lit.scene.bounces;
    stats.lit_counts = painting.counts.lit;
  }
  if (!plain) {
    stats.samples = command.quality.samples();
    stats.cutoff_px = static_cast<double>(command.quality.cutoff.raw) / Q16::kOne;
  }
  if (command.quality.max_depth != 0) {
    stats.max_depth = command.quality.max_depth;
  }
  if (command.scene.board != nullptr) {
    stats.board = command.scene.board->name;
    stats.display_crc32 = crc_text(
        static_cast<std::uint32_t>(crc32_z(0, painting.image.pixels.data(), painting.image.pixels.size())));
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
    print_summary(stats, note);
  }
}

}  // namespace

void add_render(CLI::App& app) {
  auto command = std::make_shared<RenderCommand>();
  CLI::App* sub = add_command(app, "render", "Draw a scene as a picture.");
  command->scene.add_to(*sub);
  add_text_option(
      *sub, "-o,--output", "FILE",
      [command](const std::string& text) {
        command->output = text;
        return image_kind(text) ? "" : "does not end in .ppm, .pgm, .pbm or .png";
      },
      "the picture, .ppm, .pgm, .pbm or .png by its ending; - is a PPM on standard output")
      .required();
  command->view.add_to(*sub);
  add_choice_option(
      *sub, "--shade", {"depth", "normal", "color", "mono"},
      [command](std::size_t index) {
        constexpr std::array kModes{ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor,
                                    ShadeMode::kMono};
        constexpr std::array kNames{"depth", "normal", "color", "mono"};
        command->shade = kModes[index];
        command->shade_name = kNames[index];
      },
      "brightness by distance, the face's direction, the palette in one light, or white where anything is; "
      "given without --effects it draws none")
      .default_str("depth");
  add_path_option(
      *sub, "--hits", "FILE.csv", &command->hits_path,
      std::string("what the ray of each pixel's centre hits, a line a pixel, row by row from the top left: "
                  "px,py,") +
          kHitColumns + ", as trace writes them");
  add_path_option(*sub, "--depth-image", "FILE.pfm", &command->depth_path,
                  "distance in voxels along the unit ray as float32, +inf for a miss");
  command->effects.add_to(*sub,
                          "; what calls for none is drawn by --shade; --structure compact and --engine auto "
                          "only");
  add_quality(*sub, &command->quality);
  command->engine.add_to(*sub);
  when_chosen(*sub, [command] { run(*command); });
}

}  // namespace thimble::tools
