// thimble render without a word on how: the scene's own look, as a picture or a film.
#include "commands/render_command.h"
#include "scene/animation.h"
#include "scene/look_picture.h"

namespace thimble::tools {
namespace {

constexpr std::int32_t kMostRowsAtOnce = 64;

// A scene, and pictures of it in its own look.
class LookStudio {
 public:
  /// `first`: that of the film's first frame, where another is to look like it.
  LookStudio(const RenderCommand& command, const SceneSource& source, const LookStudio* first = nullptr)
      : command_(command),
        source_(source),
        lighting_(command.effects.lighting(source.lighting())),
        wishes_(command.look.wishes),
        built_(build()),
        shape_(first != nullptr ? first->shape_ : shape_of(source, built_)),
        facts_(facts_of(source, glowing(), shape_)),
        measured_(first != nullptr ? first->measured_ : std::nullopt) {}

  BuiltScene& built() { return built_; }
  const SceneShape& shape() const { return shape_; }
  const Look& look() const { return look_; }
  const Framing& framing() const { return framing_; }

  /// Takes up a view.
  void look_from(const Framing& framing) {
    framing_ = framing;
    look_ = default_look(facts_, wishes_, framing_);
    const bool is_lit = look_.kind == LookKind::kLit;
    refuse_if(!is_lit && command_.engine.name == "gpu",
              "--engine gpu does not draw points as stars; with --shade it draws their voxels");
    if (is_lit && streams_ == nullptr) {
      streams_ = command_.engine.lit_streams(&built_, look_.effects, look_.lit_scene());
    }
    if (wishes_.across != 0) {
      (void)finer(command_.view, look_.across);  // its error names too large a picture
    }
    canvas_ = {&built_.compact(),
               &look_,
               &framing_,
               fine_camera(framing_, &look_),
               work(),
               is_lit ? command_.engine.lit_threads(&built_, look_.effects) : command_.engine.threads,
               command_.output.rows.value_or(RowRange{}),
               streams_.get()};
    if (!measured_) {
      measured_ = measure_look(canvas_);  // of the first view for all, so that a film does not flicker
    }
    if (wishes_.across == 0 && !measured_->allows_four()) {
      look_.across = 1;
      canvas_.fine = framing_.camera;
    }
  }
  Painting paint(const Progress& progress) const {
    Painting painting;
    check_lit_limits(paint_look(canvas_, measured_->exposure_q8, progress, &painting));
    return painting;
  }
  const LookMeasure& measured() const { return *measured_; }
  double preparation_seconds() const { return streams_ != nullptr ? streams_->seconds() : 0; }

 private:
  // Lit by what glows in the tree as well.
  const LitDescription& glowing() {
    lighting_.find_glow(built_.compact());
    return lighting_;
  }

  // Keeps back what drawing takes before it is known how much that is: as for the most that the source may
  // hold.
  BuiltScene build() {
    wishes_.across = command_.quality.is_sampled ? command_.quality.across : 0;
    wishes_.at_edges = command_.quality.at_edges;
    wishes_.smooth = command_.effects.choice.smooth;
    lighting_.expect_glow();
    Framing any;
    any.kept.forward = {0, kMaxViewComponent, 0};
    const Look most = default_look(facts_expected(source_, lighting_), wishes_, any);
    const std::int32_t width = command_.view.width_px;
    const int threads = command_.engine.threads;
    BuildOptions bytes;
    bytes.render_state_bytes = lit_state_bytes(most.lit_scene(), most.effects);
    if (wishes_.at_edges) {
      bytes.least_band_bytes = look_edge_bytes(width, 1, threads);
      bytes.band_bytes =
          look_edge_bytes(width, band_rows(command_, bytes.least_band_bytes, kMostRowsAtOnce), threads);
      bytes.render_state_bytes += static_cast<std::uint64_t>(threads - 1) * lit_render_bytes(most.effects);
    } else {
      const std::size_t row = look_work_bytes(width, most.across);
      bytes.band_bytes = row * static_cast<std::size_t>(band_rows(command_, row, kMostRowsAtOnce));
      bytes.least_band_bytes = row;
    }
    return command_.scene.build(source_, bytes);
  }

  // Stars go through the whole tree for each part of the picture. Where there are many, all rows at once are
  // worth their bytes, if the budget has them.
  Bytes work() {
    constexpr std::uint32_t kMany = 1U << 16;
    if (look_.kind != LookKind::kStars || built_.compact().voxel_count() < kMany) {
      return built_.band();
    }
    if (whole_.empty()) {
      const std::size_t pixels = static_cast<std::size_t>(command_.view.width_px) *
                                 static_cast<std::size_t>(command_.view.height_px);
      whole_ = built_.arena().take(kStarBytes * pixels);
    }
    return whole_.empty() ? built_.band() : whole_;
  }

  const RenderCommand& command_;
  const SceneSource& source_;
  LitDescription lighting_;
  LookWishes wishes_;
  BuiltScene built_;
  Bytes whole_;  // for sums of all pixels
  SceneShape shape_;
  SceneFacts facts_;
  Framing framing_;
  Look look_;
  LookCanvas canvas_;
  std::unique_ptr<LitStreams> streams_;
  std::optional<LookMeasure> measured_;  // once there is a view
};

void print_look(const RenderCommand& command, const SceneSource& source, const LookStudio& studio) {
  if (command.look.verbose) {
    const Look& look = studio.look();
    std::string text = look.text;
    if (look.kind == LookKind::kLit && look.at_edges) {
      text += ", samples where edges are";
    } else if (look.kind == LookKind::kLit) {
      const auto across = static_cast<std::uint64_t>(look.across);
      text += ", " + counted(across * across, "sample") + " a pixel (" + grouped(studio.measured().rays) +
              " rays for four, which are taken up to " + grouped(kMostLookRays) + ")";
    }
    const std::uint32_t exposure = studio.measured().exposure_q8;
    std::fprintf(stderr, "look: %s; exposure %s\n", text.c_str(),
                 exposure == kOwnColorsQ8 ? "none" : fixed(exposure / 256.0, 2).c_str());
    if (source.color_error() > 0) {
      std::fprintf(stderr, "colors: 255 at most; a channel differs by %s of 255 (root of the mean square)\n",
                   fixed(source.color_error(), 2).c_str());
    }
  }
}

Stats stats_of(const RenderCommand& command, const SceneSource& source, LookStudio& studio,
               const Painting& painting) {
  Stats stats(command.scene, source, studio.built());
  stats.take(painting);
  stats.build_seconds += studio.preparation_seconds();
  if (studio.look().kind == LookKind::kLit) {
    stats.effects = studio.look().effects;
    stats.bounces = studio.look().lit_scene().bounces;
    stats.samples = studio.look().across * studio.look().across;
    stats.samples_at_edges = studio.look().at_edges;
  } else {
    stats.effects = Effect::kNone;
  }
  return stats;
}

// The part of a picture or of a film that is drawn, but for what it holds. The look and the exposure are those of the
// first picture of the whole.
PartHeader part_of(const SceneSource& source, LookStudio& studio, const std::vector<Framing>& framings,
                   std::int32_t first_frame = 0) {
  CrcSum options;
  add_look(studio.look(), studio.built().level(), &options);
  options.add_all(first_frame, studio.measured().exposure_q8);
  return part_header(source, studio.built(), framings, options);
}

void render_picture(const RenderCommand& command, const SceneSource& source, LookStudio& studio,
                    OutputSet& outputs) {
  studio.look_from(frame_scene(command.view, source, studio.shape()));
  ProgressBar bar("tracing", command.scene.quiet);
  const Painting painting = studio.paint([&](double done) { bar.update(done); });
  bar.clear();
  const ImageKind kind = command.output.kind(ImageKind::kPng);
  const Camera& camera = studio.framing().camera;
  const QualityFrame frame(studio.built(), {}, camera, camera, {}, {});
  Stats stats = stats_of(command, source, studio, painting);
  write_frame(
      command, kind, painting.image, [&] { return part_of(source, studio, {studio.framing()}); }, frame,
      nullptr, camera, &stats, outputs);
  print_look(command, source, studio);
  finish(command, stats, studio.framing().note, outputs);
}

// One of the frames that a film plays, counted from its first.
std::unique_ptr<SceneSource> open_frame(const RenderCommand& command, std::int64_t number) {
  SceneArguments arguments = command.scene.arguments;
  *arguments.frame += static_cast<std::uint32_t>(number);
  try {
    return open_scene(arguments);
  } catch (const InputError& error) {
    throw InputError("frame ", *arguments.frame, ": ", error.what());
  }
}

// A film's frames, each drawn on demand.
class Filming {
 public:
  Filming(const RenderCommand& command, LookStudio& studio, std::vector<Framing> framings)
      : command_(command),
        studio_(studio),
        framings_(std::move(framings)),
        bar_("filming", command.scene.quiet) {
    studio_.look_from(framings_[0]);  // the exposure of all
  }
  const std::vector<Framing>& framings() const { return framings_; }
  const Image& draw(std::size_t number) {
    bar_.update(static_cast<double>(number) / static_cast<double>(framings_.size()));
    if (command_.output.played && number != 0) {
      const auto source = open_frame(command_, static_cast<std::int64_t>(number));
      LookStudio studio(command_, *source, &studio_);
      paint(studio, number);
    } else {
      paint(studio_, number);
    }
    return last_.image;
  }
  // The same for one that counts.
  const Image& shoot(std::size_t number) {
    draw(number);
    crc_.add(last_.image.pixels);
    seconds_ += last_.seconds;
    ++shot_;
    return last_.image;
  }
  std::uint32_t crc() const { return crc_.value(); }
  // The last one, with the mean time of all.
  Painting end() {
    bar_.clear();
    last_.seconds = seconds_ / std::max(1, shot_);
    return std::move(last_);
  }

 private:
  void paint(LookStudio& studio, std::size_t number) {
    studio.look_from(framings_[number]);
    last_ = studio.paint({});
  }

  const RenderCommand& command_;
  LookStudio& studio_;
  std::vector<Framing> framings_;
  ProgressBar bar_;
  Painting last_;
  CrcSum crc_;
  double seconds_ = 0;
  int shot_ = 0;
};

void write_part(const RenderCommand& command, PartHeader header, Filming& filming, OutputFile* file) {
  header.kind = command.output.film_kind();
  header.width_px = static_cast<std::uint32_t>(command.view.width_px);
  header.height_px = static_cast<std::uint32_t>(command.view.height_px);
  header.first = static_cast<std::uint32_t>(command.output.frames->first);
  header.count = static_cast<std::uint32_t>(command.output.frames->count);
  header.all = static_cast<std::uint32_t>(filming.framings().size());
  PartWriter part(file, header);
  for (std::size_t i = 0; i < header.count; ++i) {
    part.add(filming.shoot(header.first + i).pixels);
  }
  part.end();
}

// The camera of each frame.
std::vector<Framing> film_framings(const RenderCommand& command, const SceneSource& source,
                                   const SceneShape& shape) {
  const RenderOutput& output = command.output;
  if (!output.played) {
    return output.turntable != 0 ? frame_turns(command.view, shape, output.turntable)
                                 : frame_path(output.camera_path, output.cameras, shape);
  }
  const std::int64_t last = output.played->first + output.played->count - 1;
  fail_if(source.frames() == 1, "it has one frame, which is a picture; --frames plays several");
  fail_if(last >= std::int64_t{source.frames()}, "there is no frame ", last, " for --frames; the last is ",
          source.frames() - 1);
  // What is wrong with a later frame is said before the first is drawn.
  const RowRange drawn = output.frames.value_or(RowRange{0, output.played->count});
  for (std::int64_t i = std::max(drawn.first, 1); i < std::int64_t{drawn.first} + drawn.count; ++i) {
    open_frame(command, i);
  }
  return std::vector<Framing>(static_cast<std::size_t>(output.played->count),
                              frame_scene(command.view, source, shape));
}

void render_film(const RenderCommand& command, const SceneSource& source, LookStudio& studio,
                 OutputSet& outputs) {
  Filming filming(command, studio, film_framings(command, source, studio.shape()));
  const std::string note = filming.framings().front().note;
  if (command.output.frames) {
    write_part(command,
               part_of(source, studio, filming.framings(), command.output.played.value_or(RowRange{}).first),
               filming, outputs[kPicture]);
  } else {
    Film film(outputs[kPicture], command.output.path, command.output.film_kind(), filming.framings().size(),
              [&](std::size_t number) { return filming.draw(number); });
    for (std::size_t i = 0; i < filming.framings().size(); ++i) {
      film.add(filming.shoot(i));
    }
    film.end();
  }
  const Painting last = filming.end();
  Stats stats = stats_of(command, source, studio, last);
  stats.frame_crc32 = crc_text(filming.crc());
  print_look(command, source, studio);
  finish(command, stats, note, outputs);
}

}  // namespace

LookPicture draw_look(const RenderCommand& command, const SceneSource& source) {
  LookStudio studio(command, source);
  studio.look_from(frame_scene(command.view, source, studio.shape()));
  Painting painting = studio.paint({});
  Stats stats = stats_of(command, source, studio, painting);
  stats.frame_crc32 = crc_of(painting.image.pixels);
  return {std::move(painting.image), studio.framing().kept, studio.framing().note, std::move(stats)};
}

void render_look(const RenderCommand& command, const SceneSource& source, OutputSet& outputs) {
  LookStudio studio(command, source);
  if (command.output.is_film()) {
    render_film(command, source, studio, outputs);
  } else {
    render_picture(command, source, studio, outputs);
  }
}

}  // namespace thimble::tools
