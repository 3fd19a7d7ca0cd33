// thimble render: a scene as a picture.
#include <limits>

#include "commands/commands.h"
#include "commands/render_command.h"
#include "output/hit_rows.h"
#include "scene/animation.h"
#include "scene/gpu_engine.h"
#include "thimble/picture/ink.h"

namespace thimble::tools {
namespace {

constexpr std::int32_t kMostBandRows = 16;
constexpr std::int32_t kMostEdgeRows = 64;
// Samples of a lit picture that are drawn at once, about: the threads of a stream wait for one another at its end.
constexpr std::int32_t kMostSamplesAtOnce = 1 << 17;

// What drawing or tracing answered.
void check_camera(const RenderCommand& command, Status status) {
  fail_if(status != Status::kOk, "--engine ", command.engine.name, " does not take the rays of this camera");
}

// What belongs to the scene's own look and films only.
void check_look(const RenderCommand& command) {
  const bool look = takes_look(command);
  refuse_if(command.look.given && !look,
            "--background and --ground are for pictures in the scene's own look, without --shade, --effects, "
            "--structure, --cutoff, --max-depth and --board, by --engine auto and gpu");
  command.output.check(command.look.wishes.background.kind == BackgroundKind::kNone);
  refuse_if(command.output.is_film() &&
                (!look || !command.output.hits_path.empty() || !command.output.depth_path.empty() ||
                 (command.output.turntable != 0 && command.view.eye)),
            command.output.film_option(),
            " shows the scene's own look, without --shade, --effects, --structure, --cutoff, --max-depth, "
            "--board, --hits and --depth-image, by --engine auto and gpu",
            (command.output.turntable != 0 ? ", and from all sides, without --eye" : ""));
  if (names_page(command.output.path)) {
    check_page(command);
  }
  refuse_if(command.look.wishes.background.kind == BackgroundKind::kNone && !command.output.rows &&
                image_kind(command.output.path) != ImageKind::kPng,
            "--background none wants a .png, the one that holds what is transparent");
}

// What contradicts itself whatever the scene is.
void check_usage(const RenderCommand& command) {
  check_look(command);
  command.engine.check(command.quality.plain(),
                       takes_look(command) || command.effects.named() || command.effects.bounces,
                       command.quality.at_edges);
  refuse_if(command.quality.cuts() && command.scene.structure != StructureKind::kCompact,
            "--cutoff and --max-depth want --structure compact");
  refuse_if(command.look.is_ink() && (command.output.rows || command.output.is_film()),
            "--shade ink looks at whole pictures, without --rows, --part and what makes a film");
  refuse_if((command.effects.named() || command.effects.bounces) && !command.look.shade_name.empty() &&
                command.look.shade != ShadeMode::kColor,
            "--shade ", command.look.shade_name,
            " shows no light, and so no --effects, --normals and --bounces");
}

// An explicit --shade is drawn as such, unless --effects stands beside it.
EffectChoice effect_choice(const RenderCommand& command) {
  constexpr EffectChoice kNone{false, Effect::kNone};
  if (command.look.shade_name.empty() || command.effects.named()) {
    return command.effects.choice;
  }
  return command.effects.choice.is_given && command.look.shade == ShadeMode::kColor ? command.effects.choice
                                                                                    : kNone;
}

// What a lit picture cannot honour.
void check_lit(const RenderCommand& command, EffectSet effects) {
  const auto refuse = [&](bool is_wrong, const char* what) {
    refuse_if(is_wrong, "a picture with the effects ", effects_text(effects), " ", what,
              " (--effects none draws the scene without)");
  };
  refuse(command.scene.structure != StructureKind::kCompact, "wants --structure compact");
  refuse(command.engine.name == "wide" || command.engine.name == "ray32",
         "takes no --engine but auto, gpu and ray64");
  refuse(command.quality.cuts(), "takes no --cutoff and no --max-depth");
}

// What light does in the picture. Before the scene is built at least as much as then comes out.
struct Light {
  LitDescription lighting;
  EffectChoice choice;
  UsedMaterials used;
  EffectSet effects = Effect::kNone;

  LitScene scene() const { return lit_scene_for(lighting, used, effects); }  // views into `lighting`
};

Light light_of(const RenderCommand& command, const SceneSource& source) {
  Light light;
  light.lighting = command.effects.lighting(source.lighting());
  light.choice = effect_choice(command);
  light.effects = expected_effects(source, light.lighting, light.choice, &light.used);
  light.lighting.expect_glow();
  if (light.effects != Effect::kNone) {
    check_lit(command, light.effects);
  }
  return light;
}

// What of the budget is kept back for the picture.
BuildOptions drawing_bytes(const RenderCommand& command, const SceneSource& source, const Light& light,
                           PixelFormat format) {
  BuildOptions bytes;
  const Quality& quality = command.quality;
  const std::int32_t width = command.view.width_px;
  const bool is_lit = light.effects != Effect::kNone;
  const int threads = quality.at_edges && is_lit ? command.engine.threads : 1;
  const std::int32_t most = quality.plain()    ? kMostBandRows
                            : quality.at_edges ? kMostEdgeRows
                            : is_lit           ? std::max(1, kMostSamplesAtOnce / (width * quality.samples()))
                                               : 1;
  const auto row = static_cast<std::size_t>(quality_band_bytes(quality, format, width));
  bytes.band_bytes = quality_band_bytes(quality, format, width, band_rows(command, row, most), threads);
  bytes.least_band_bytes = quality_band_bytes(quality, format, width, 1, threads);
  const bool in_flash = command.scene.board != nullptr && source.baked() != nullptr;
  bytes.render_state_bytes =
      in_flash ? lit_render_bytes(light.effects) : lit_state_bytes(light.scene(), light.effects);
  return bytes;
}

// What a picture is drawn with, whoever draws it.
struct Subject {
  const RenderCommand& command;
  BuiltScene& built;
  PixelFormat format;
  Framing framing;
  Camera fine;  ///< the same view with so many times the pixels as there are samples across one
  Shading shading;

  const Camera& camera() const { return framing.camera; }
};

Subject subject_of(const RenderCommand& command, const SceneSource& source, BuiltScene* built,
                   PixelFormat format) {
  Subject subject{command, *built, format, {}, {}, {}};
  // What it is seen from must not depend on what traces it: other structures are framed by a compact tree of
  // the same voxels, a temporary, outside the budget.
  std::optional<BuiltScene> compact;
  if (built->structure() != StructureKind::kCompact && command.view.side != NamedView::kPaper &&
      !command.view.eye) {
    compact.emplace(source, BuildOptions{});
  }
  const SceneShape shape = shape_of(source, compact ? *compact : *built);
  subject.framing = frame_scene(command.view, source, shape);
  subject.fine = command.quality.across == 1
                     ? subject.framing.camera
                     : frame_scene(finer(command.view, command.quality.across), source, shape).camera;
  subject.shading = scene_shading(command.look.shade, {built->palette().data(), built->palette().size()},
                                  subject.camera(), built->bounds());
  return subject;
}

// The whole picture, or --rows of it.
Status paint_with(const BandPainter& painter, const Subject& subject, const Progress& progress,
                  Painting* painting) {
  const RowRange rows = subject.command.output.rows.value_or(RowRange{0, subject.camera().height_px()});
  return paint(painter, subject.camera().width_px(), rows, subject.format, progress, painting);
}

BandPainter painter_of(const Subject& subject, const Sampler& sampler, Bytes work) {
  const Quality& quality = subject.command.quality;
  return quality.at_edges ? edge_painter(sampler, subject.camera(), subject.fine, subject.format, work)
                          : square_painter(sampler, subject.fine, quality.across, subject.format, work);
}

// Throws InputError for a camera whose rays it does not take.
Painting paint_without_effects(const Subject& subject, const QualityFrame& frame, GpuEngine* gpu,
                               const Progress& progress) {
  const RenderCommand& command = subject.command;
  const EngineOptions& engine = command.engine;
  const BandPainter by_rays =
      painter_of(subject, ray_sampler(frame, engine.trace_options()), subject.built.band());
  Painting painting;
  const auto paint_or_fail = [&](const BandPainter& painter) {
    check_camera(command, paint_with(painter, subject, progress, &painting));
  };
  if (!command.quality.plain()) {
    paint_or_fail(by_rays);
    return painting;
  }
  if (gpu != nullptr) {
    paint_or_fail(gpu_painter(gpu, subject.camera(), subject.shading));
    painting.preparation_seconds = gpu->seconds();
    return painting;
  }
  // With --board the budget is the board's RAM, in which nothing of the host's is to stand unasked.
  const bool may_be_wide = command.scene.board == nullptr || engine.name == "wide";
  const auto wide = may_be_wide ? engine.wide_renderer(&subject.built, subject.camera().width_px(),
                                                       subject.camera().height_px())
                                : nullptr;
  Status status = Status::kTooFine;
  if (wide != nullptr) {
    status =
        paint_with(wide_painter(wide.get(), subject.camera(), subject.shading), subject, progress, &painting);
    check_camera(command, status == Status::kTooFine && engine.name == "auto" ? Status::kOk : status);
  }
  if (status != Status::kOk) {
    paint_or_fail(by_rays);
  }
  painting.preparation_seconds = wide != nullptr ? wide->seconds() : 0;
  return painting;
}

Painting paint_lit(const Subject& subject, const Light& light, GpuEngine* gpu, const Progress& progress) {
  LitPicture picture;
  picture.effects = light.effects;
  picture.scene = light.scene();
  const EngineOptions& engine = subject.command.engine;
  // With --board nothing of the host's stands in the board's RAM.
  const auto streams = subject.command.scene.board == nullptr && gpu == nullptr
                           ? engine.lit_streams(&subject.built, picture.effects, picture.scene)
                           : nullptr;
  picture.streams = gpu != nullptr ? gpu : streams.get();
  picture.threads = engine.lit_threads(&subject.built, picture.effects);
  // Streams write a pixel once, where it belongs.
  const bool needs_work = picture.streams == nullptr || subject.command.quality.across != 1;
  const Sampler sampler = lit_sampler(subject.built, subject.shading, picture);
  Painting painting;
  check_lit_limits(paint_with(painter_of(subject, sampler, needs_work ? subject.built.band() : Bytes()),
                              subject, progress, &painting));
  painting.preparation_seconds = picture.streams != nullptr ? picture.streams->seconds() : 0;
  return painting;
}

// What was drawn as tones, as ink for `format`.
Image inked(const Subject& subject, const Image& tones, PixelFormat format, const Progress& progress) {
  const std::int32_t width = tones.width_px;
  const std::int32_t height = tones.height_px;
  const Shading shading = scene_shading(ShadeMode::kDepth, {}, subject.camera(), subject.built.bounds());
  Painting depths;
  const QualityFrame frame(subject.built, {}, subject.camera(), subject.camera(), shading, {});
  check_camera(subject.command,
               paint(square_painter(ray_sampler(frame, subject.command.engine.trace_options()),
                                    subject.camera(), 1, PixelFormat::kGray8, subject.built.band()),
                     width, {0, height}, PixelFormat::kGray8, progress, &depths));
  std::vector<std::uint8_t> memory(ink_bytes(width, height));
  InkPicture ink;
  (void)InkPicture::make(width, height, {memory.data(), memory.size()}, &ink);  // of its size
  std::copy(tones.pixels.begin(), tones.pixels.end(), ink.tones().pixels.data);
  std::copy(depths.image.pixels.begin(), depths.image.pixels.end(), ink.depths().pixels.data);
  ink.finish();
  Image image{width, height, format, std::vector<std::uint8_t>(band_bytes(format, width, height))};
  (void)ink.store({{image.pixels.data(), image.pixels.size()}, format, 0, 0, height});
  return image;
}

Stats stats_of(const Subject& subject, const SceneSource& source, const Light& light,
               const Painting& painting) {
  const RenderCommand& command = subject.command;
  Stats stats(command.scene, source, subject.built);
  stats.take(painting);
  stats.effects = light.effects;
  if (light.effects != Effect::kNone) {
    stats.bounces = light.scene().bounces;
  }
  if (!command.quality.plain()) {
    stats.samples = command.quality.samples();
    stats.samples_at_edges = command.quality.at_edges;
    stats.cutoff_px = static_cast<double>(command.quality.cutoff.raw) / Q16::kOne;
  }
  if (command.quality.max_depth != 0) {
    stats.max_depth = command.quality.max_depth;
  }
  if (command.scene.board != nullptr) {
    stats.display_crc32 = crc_of(painting.image.pixels);
  }
  return stats;
}

// The part of a picture that --rows are, but for its size and place.
PartHeader part_of(const Subject& subject, const SceneSource& source, const Light& light) {
  const RenderCommand& command = subject.command;
  const Quality& quality = command.quality;
  const bool is_lit = light.effects != Effect::kNone;
  CrcSum options;
  options.add_all(command.look.shade, subject.format, quality.samples_key(), quality.cutoff.raw,
                  quality.max_depth);
  if (is_lit) {
    add_lighting(light.lighting, light.used, light.effects, subject.built.level(), &options);
  }
  PartHeader part = part_header(source, subject.built, {subject.framing}, options);
  part.has_finer_shades = is_lit && quality.across == 1 && subject.format == PixelFormat::kRgb888;
  return part;
}

// What is wrong with the options whatever the scene is; and what they leave to the display and the budget.
void prepare(RenderCommand& command) {
  check_usage(command);
  use_display(command.scene.board, &command.view);
  fail_if(command.quality.at_edges &&
              std::max(command.view.width_px, command.view.height_px) > kMaxPicturePx / kEdgeGrid,
          "--samples auto wants a picture of at most ", kMaxPicturePx / kEdgeGrid, " pixels a side");
  command.output.read_sizes(command.view, command.fov_given);
  command.engine.check_budget(command.scene.budget_bytes().has_value());
  command.engine.keep_to_budget(command.scene.budget_bytes().has_value());
}

// From a source to a picture: builder, tree, painter, output.
void draw(RenderCommand& command, const SceneSource& source, OutputSet& outputs) {
  const ImageKind kind = command.output.kind(ImageKind::kPpm);
  // A board's picture is drawn as its display takes it.
  const PixelFormat display =
      command.scene.board != nullptr ? command.scene.board->format : pixel_format(kind);
  const PixelFormat format = command.look.is_ink() ? PixelFormat::kGray8 : display;

  command.scene.build_threads = command.engine.threads;
  if (names_page(command.output.path)) {
    render_page(command, source, outputs);
    return;
  }
  if (takes_look(command)) {
    render_look(command, source, outputs);
    return;
  }
  if (command.look.shade_name.empty()) {
    command.look.shade = source.single_material() ? ShadeMode::kDepth : ShadeMode::kColor;
  }
  Light light = light_of(command, source);

  BuiltScene built = command.scene.build(source, drawing_bytes(command, source, light, format));
  if (light.effects != Effect::kNone) {
    light.used = used_materials(built.compact());
    light.effects = chosen_effects(light.lighting, light.used, light.choice);
    light.lighting.find_glow(built.compact());
  }

  const Subject subject = subject_of(command, source, &built, format);
  const NodeColors colors = take_node_colors(&built, command.quality, subject.shading);
  const QualityFrame frame(built, command.quality, subject.camera(), subject.fine, subject.shading, colors);
  ProgressBar bar("tracing", command.scene.quiet);
  const auto progress = [&](double done) { bar.update(done); };
  const auto gpu = command.engine.gpu(built, light.effects);
  Painting painting = light.effects == Effect::kNone
                          ? paint_without_effects(subject, frame, gpu.get(), progress)
                          : paint_lit(subject, light, gpu.get(), progress);
  if (command.look.is_ink()) {
    painting.image = inked(subject, painting.image, display, progress);
  }
  bar.clear();

  Stats stats = stats_of(subject, source, light, painting);
  write_frame(
      command, kind, painting.image, [&] { return part_of(subject, source, light); }, frame, gpu.get(),
      subject.camera(), &stats, outputs);
  if (command.scene.structure == StructureKind::kDense && command.look.shade == ShadeMode::kColor &&
      !source.single_material()) {
    print_notes({"a dense grid keeps no colors: the faces are drawn gray"}, command.scene.quiet);
  }
  finish(command, stats, subject.framing.note, outputs);
}

// From a file to a picture.
void run(const RenderCommand& given) {
  RenderCommand command = given;
  prepare(command);
  OutputSet outputs({command.output.whole_path(), command.output.hits_path, command.output.depth_path,
                     command.scene.stats_path},
                    {command.scene.arguments.scene, command.output.camera_path}, command.output.sequence());
  if (command.output.played) {
    command.scene.arguments.frame = static_cast<std::uint32_t>(command.output.played->first);
  }
  const auto source = command.scene.open();
  draw(command, *source, outputs);
}

// Pixel by pixel once more, for the files that hold hits and distances; by `gpu` if it is not null.
void write_hits(const RenderCommand& command, const QualityFrame& frame, GpuEngine* gpu, const Camera& camera,
                OutputSet& outputs) {
  const HitRows rows(command.output.hits_path, true, command.scene.structure != StructureKind::kDense);
  const auto width = static_cast<std::size_t>(camera.width_px());
  outputs.write(kHits, rows.beginning(width * static_cast<std::uint64_t>(camera.height_px())));
  std::vector<float> distances;
  std::vector<Ray> rays(width);
  std::vector<Hit> hits(width);
  ProgressBar bar("writing hits", command.scene.quiet);
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      rays[x] = camera.ray(static_cast<std::int32_t>(x), y);
      if (gpu == nullptr) {
        check_camera(command, frame.closest_hit(rays[x], &hits[x], command.engine.trace_options()));
      }
    }
    if (gpu != nullptr) {
      check_camera(command, gpu->trace({rays.data(), width}, {hits.data(), width}));
    }
    std::string text;
    for (std::size_t x = 0; x < width; ++x) {
      if (outputs[kHits] != nullptr) {
        rows.append(&text, rays[x], hits[x], static_cast<std::int32_t>(x), y);
      }
      if (outputs[kDepths] != nullptr) {
        distances.push_back(hits[x].kind == HitKind::kHit ? static_cast<float>(hit_distance(rays[x], hits[x]))
                                                          : std::numeric_limits<float>::infinity());
      }
    }
    outputs.write(kHits, text);
    bar.update(static_cast<double>(y) / camera.height_px());
  }
  if (outputs[kDepths] != nullptr) {
    write_pfm(outputs[kDepths], camera.width_px(), camera.height_px(), distances);
  }
}

// For a person: what the scene takes, and what came of it.
void print_summary(const Stats& stats) {
  std::fprintf(stderr,
               "%s in %s bytes (depth %d), at most %s bytes in use; %.3f s a frame, %s of %s rays hit\n",
               counted(stats.voxels, "voxel").c_str(), grouped(stats.tree_bytes).c_str(), stats.depth,
               grouped(stats.high_water_bytes).c_str(), stats.frame_seconds,
               grouped(stats.counts.all.hits).c_str(), grouped(stats.counts.all.rays).c_str());
  if (stats.bounces) {
    std::string rays;
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      if (stats.counts.lit.rays[kind] != 0) {
        rays += (rays.empty() ? "" : ", ") + grouped(stats.counts.lit.rays[kind]) + " " +
                ray_kind_name(static_cast<LitRayKind>(kind));
      }
    }
    std::fprintf(stderr, "lit: %s; rays: %s\n", effects_text(*stats.effects).c_str(), rays.c_str());
  }
  if (stats.solid_added != 0) {
    std::fprintf(stderr, "coarsened to fit: %s of solid volume added\n",
                 counted(stats.solid_added, "voxel").c_str());
  }
}

// What can be wished of the scene's own look.
void add_look(CLI::App& app, RenderCommand* command) {
  add_text_option(
      app, "--background", "none|RRGGBB|gradient",
      [command](const std::string& text) {
        const bool is_known = parse_background(text, &command->look.wishes.background);
        return is_known ? "" : "is not none, gradient or six hex digits";
      },
      "what stands behind the scene; none is transparent, in a .png (default: the scene's sky, else a soft "
      "gradient, black behind stars)");
  add_choice_option(
      app, "--ground", {{"auto", std::nullopt}, {"on", true}, {"off", false}}, &command->look.wishes.ground,
      "a ground under the scene that shows nothing but its shadow; auto: where the scene states no light");
  command->output.add_films(app);
  add_flag(app, "--verbose", &command->look.verbose, "say on standard error what the scene's look came to");
}

}  // namespace

void finish(const RenderCommand& command, const Stats& stats, const std::string& note, OutputSet& outputs) {
  outputs.write(kStats, stats_text(stats));
  outputs.commit();
  print_notes({note}, command.scene.quiet);
  if (!command.scene.quiet) {
    print_summary(stats);
  }
}

void render(RenderCommand command, const SceneSource& source) {
  refuse_if(command.output.is_film() || command.output.rows || !command.output.hits_path.empty() ||
                !command.output.depth_path.empty() || !command.scene.stats_path.empty(),
            "films, --rows, --hits, --depth-image and --stats are files, which only the command writes");
  prepare(command);
  OutputSet outputs({"", "", "", ""}, {});
  draw(command, source, outputs);
}

void write_frame(const RenderCommand& command, ImageKind kind, const Image& image,
                 const std::function<PartHeader()>& part, const QualityFrame& frame, GpuEngine* gpu,
                 const Camera& camera, Stats* stats, OutputSet& outputs) {
  const Image shown = converted(image, pixel_format(kind));
  if (command.output.rows) {
    write_rows(outputs[kPicture], part(), shown, camera.height_px());
  } else if (command.output.take) {
    command.output.take(shown);
  } else {
    write_image(outputs[kPicture], kind, shown);
  }
  if (outputs[kHits] != nullptr || outputs[kDepths] != nullptr) {
    write_hits(command, frame, gpu, camera, outputs);
  }
  stats->frame_crc32 = crc_of(file_pixels(shown, kind));
}

bool takes_look(const RenderCommand& command) {
  return command.look.shade_name.empty() && !command.effects.choice.is_given &&
         command.scene.structure == StructureKind::kCompact &&
         (command.engine.name == "auto" || command.engine.name == "gpu") && !command.quality.cuts() &&
         command.scene.board == nullptr;
}

std::int32_t band_rows(const RenderCommand& command, std::size_t row_bytes, std::int32_t most) {
  auto rows = static_cast<std::uint64_t>(most);
  if (const auto budget = command.scene.budget_bytes()) {
    rows = std::min<std::uint64_t>(rows, *budget / 16 / row_bytes);
  }
  return std::clamp(static_cast<std::int32_t>(rows), 1, command.view.height_px);
}

void add_render_options(CLI::App& app, RenderCommand* command) {
  command->scene.add_to(app);
  add_path_option(
      app, "-o,--output", "FILE", &command->output.path,
      std::string("the picture, ") + kImageEndings +
          " by its ending; - is a PPM on standard output; with --turntable, --camera-path or --frames a " +
          kFilmEndings +
          "; .html: one file that shows the scene to turn it by hand, or by itself with --turntable")
      ->required();
  add_picture_view(app, &command->view);
  add_shade(
      app, &command->look.shade,
      "brightness by distance (the paper's), the face's direction, the palette in one light, white "
      "where anything is, or ink: black, a pattern and white with outlines, for displays of one bit; given "
      "without --effects it draws none",
      &command->look.shade_name, true);
  add_look(app, command);
  add_path_option(
      app, "--hits", "FILE.csv|.npy", &command->output.hits_path,
      std::string("what the ray of each pixel's centre hits, a line a pixel, row by row from the top "
                  "left: px,py and the columns that trace writes") +
          kHitArray);
  add_path_option(app, "--depth-image", "FILE.pfm", &command->output.depth_path,
                  "distance in voxels along the unit ray as float32, +inf for a miss");
  add_effect_options(app, &command->effects,
                     "; what calls for none is drawn by --shade; --structure compact and --engine auto only",
                     "the scene's own look; none with --shade; else auto");
  add_quality(app, &command->quality);
  command->engine.add_to(app);
  also_check(app, [command, &app] {
    command->fov_given = is_given(app, "--fov");
    command->look.given = is_given(app, "--background") || is_given(app, "--ground");
  });
}

void add_render(CLI::App& app) {
  CLI::App* sub = add_command(app, "render", "Draw a scene as a picture.");
  RenderCommand* const command = options_for<RenderCommand>(*sub, run);
  add_render_options(*sub, command);
  add_paragraph_below(*sub, kDefaultLookText);
}

}  // namespace thimble::tools
