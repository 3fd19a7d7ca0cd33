// thimble render without a word on how: the scene's own look, as a picture or all around it as a film.
#include <zlib.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <vector>

#include "commands/render_command.h"
#include "host/packed_picture.h"
#include "host/y4m.h"
#include "output/gif.h"
#include "output/image.h"
#include "output/progress.h"
#include "output/units.h"
#include "scene/lit_setup.h"
#include "scene/look_picture.h"
#include "scene/palette.h"
#include "scene/scene_shape.h"

namespace thimble::tools {
namespace {

constexpr std::int32_t kMostRowsAtOnce = 64;

// A scene, and pictures of it in its own look.
class LookStudio {
 public:
  LookStudio(const RenderCommand& command, const SceneSource& source)
      : command_(command),
        source_(source),
        lighting_(command.effects.lighting(source)),
        wishes_(command.look),
        built_(build()),
        shape_(shape_of(built_)),
        facts_(facts_of(source, glowing(), shape_)) {}

  BuiltScene& built() { return built_; }
  const SceneShape& shape() const { return shape_; }
  const Look& look() const { return look_; }
  const Framing& framing() const { return framing_; }

  /// Takes up a view.
  void look_from(const Framing& framing) {
    framing_ = framing;
    look_ = default_look(facts_, wishes_, framing_, command_.view.width_px, command_.view.height_px);
    canvas_ = {&built_.compact(), &look_, &framing_, fine_camera(), built_.band(), command_.engine.threads};
    if (exposure_ == 0) {
      exposure_ = measured_exposure(canvas_);  // of the first view for all, so that a film does not flicker
    }
  }
  Painting paint(const Progress& progress) const {
    Painting painting;
    if (paint_look(canvas_, exposure_, progress, &painting) != Status::kOk) {
      throw InputError("its lights or surfaces are beyond the limits of a lit picture");
    }
    return painting;
  }
  std::uint32_t exposure() const { return exposure_; }

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
    wishes_.smooth = command_.effects.choice.smooth;
    lighting_.expect_glow();
    Framing any;
    any.kept.forward = {0, kMaxViewComponent, 0};
    const Look most = default_look(facts_expected(source_, lighting_), wishes_, any, 1, 1);
    const std::size_t row = look_work_bytes(command_.view.width_px, most.across);
    const auto more_threads = static_cast<std::uint64_t>(command_.engine.threads - 1);
    SceneOptions::DrawingBytes bytes;
    bytes.band = row * static_cast<std::size_t>(band_rows(command_, row, kMostRowsAtOnce));
    bytes.least_band = row;
    bytes.state =
        lit_state_bytes(most.lit_scene(), most.effects) + more_threads * lit_render_bytes(most.effects);
    return command_.scene.build(source_, bytes);
  }

  Camera fine_camera() {
    if (wishes_.across != 0) {
      (void)finer(command_.view, look_.across);  // too large a picture is told in its words
    }
    Camera camera;
    const auto set = [&] {
      const std::int32_t across = look_.across;
      return command_.view.width_px * across <= kMaxPicturePx &&
                     command_.view.height_px * across <= kMaxPicturePx
                 ? set_camera(framing_.kept, command_.view.width_px * across,
                              command_.view.height_px * across, built_.level(), &camera)
                 : Status::kOutOfRange;
    };
    if (set() != Status::kOk) {
      look_.across = 1;  // such a camera has no rays between the pixels'
      camera = framing_.camera;
    }
    return camera;
  }

  const RenderCommand& command_;
  const SceneSource& source_;
  LitDescription lighting_;
  LookWishes wishes_;
  BuiltScene built_;
  SceneShape shape_;
  SceneFacts facts_;
  Framing framing_;
  Look look_;
  LookCanvas canvas_;
  std::uint32_t exposure_ = 0;
};

void print_look(const RenderCommand& command, const LookStudio& studio) {
  if (command.verbose) {
    std::array<char, 32> exposure{};
    std::snprintf(exposure.data(), exposure.size(), "%.2f", studio.exposure() / 256.0);
    std::fprintf(stderr, "look: %s; exposure %s\n", studio.look().text.c_str(), exposure.data());
  }
}

Stats stats_of(const RenderCommand& command, const SceneSource& source, LookStudio& studio,
               const Painting& painting) {
  Stats stats(command.scene.arguments.scene, source, studio.built());
  stats.frame_seconds = painting.seconds;
  stats.rays = painting.counts.all.rays;
  stats.hits = painting.counts.all.hits;
  stats.node_visits = painting.counts.all.node_visits;
  stats.engine = painting.engine;
  stats.threads = painting.threads;
  if (studio.look().kind == LookKind::kLit) {
    stats.effects = studio.look().effects;
    stats.bounces = studio.look().lit_scene().bounces;
    stats.lit_counts = painting.counts.lit;
    stats.samples = studio.look().across * studio.look().across;
  } else {
    stats.effects = Effect::kNone;
  }
  return stats;
}

std::uint32_t add_crc(std::uint32_t crc, const std::vector<std::uint8_t>& bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

void end(const RenderCommand& command, const Stats& stats, const std::string& note, OutputSet& outputs) {
  if (outputs[kStats] != nullptr) {
    outputs[kStats]->write(stats_text(stats));
  }
  outputs.commit();
  if (!command.scene.quiet) {
    print_summary(stats, note);
  }
}

void render_picture(const RenderCommand& command, const SceneSource& source, LookStudio& studio,
                    OutputSet& outputs) {
  studio.look_from(frame_scene(command.view, source, studio.shape()));
  ProgressBar bar("tracing", command.scene.quiet);
  const Painting painting = studio.paint([&](double done) { bar.update(done); });
  bar.clear();
  const ImageKind kind = image_kind(command.output).value_or(ImageKind::kPpm);
  const Image shown = converted(painting.image, pixel_format(kind));
  write_image(outputs[kPicture], kind, shown);
  if (outputs[kHits] != nullptr || outputs[kDepths] != nullptr) {
    const Camera& camera = studio.framing().camera;
    const QualityFrame frame(studio.built(), {}, camera, camera, {}, {});
    write_hits(command, frame, camera, outputs[kHits], outputs[kDepths]);
  }
  Stats stats = stats_of(command, source, studio, painting);
  stats.frame_crc32 = crc_text(add_crc(0, file_pixels(shown, kind)));
  print_look(command, studio);
  end(command, stats, studio.framing().note, outputs);
}

// What a GIF shows of pictures: one palette, and the entry of each pixel. An ordered dither of a bin's width
// hides the steps of a gradient, and stands still from frame to frame.
class GifColors {
 public:
  explicit GifColors(const std::vector<Painting>& samples) : map_(histogram_of(samples)) {
    for (std::size_t i = 0; i < colors_.size(); ++i) {
      const Rgb color = map_.palette()[i].color;
      colors_[i] = {color.r, color.g, color.b};
    }
  }
  const GifPalette& palette() const { return colors_; }
  std::vector<std::uint8_t> indices(const Image& image) const {
    std::vector<std::uint8_t> result;
    for_pixels(image, [&](Rgb color) { result.push_back(map_.index(color)); });
    return result;
  }

 private:
  template <class Visit>
  static void for_pixels(const Image& image, const Visit& visit) {
    for (std::int32_t y = 0; y < image.height_px; ++y) {
      for (std::int32_t x = 0; x < image.width_px; ++x) {
        const std::uint8_t* rgb = image.pixels.data() + 3 * (static_cast<std::size_t>(y) *
                                                                 static_cast<std::size_t>(image.width_px) +
                                                             static_cast<std::size_t>(x));
        const int nudge = static_cast<int>(bayer_rank(x, y)) / 8 - 4;
        const auto nudged = [nudge](int value) {
          return static_cast<std::uint8_t>(std::clamp(value + nudge, 0, 255));
        };
        visit(Rgb{nudged(rgb[0]), nudged(rgb[1]), nudged(rgb[2])});
      }
    }
  }
  static ColorHistogram histogram_of(const std::vector<Painting>& samples) {
    ColorHistogram histogram;
    for (const Painting& painting : samples) {
      for_pixels(painting.image, [&](Rgb color) { histogram.add(color); });
    }
    return histogram;
  }

  PaletteMap map_;
  GifPalette colors_{};
};

// The film's bytes, frame by frame.
class Film {
 public:
  Film(OutputFile* file, bool is_gif, int frames) : file_(file), is_gif_(is_gif), frames_(frames) {}
  void begin(const std::vector<Painting>& samples) {
    const Image& first = samples.front().image;
    if (is_gif_) {
      colors_ = std::make_unique<GifColors>(samples);
      file_->write(gif_header(first.width_px, first.height_px, colors_->palette()));
    } else {
      const int rate = std::clamp(frames_ / kSeconds, 1, 60);
      file_->write(host::y4m_header(first.width_px, first.height_px, false, rate));
    }
  }
  void add(const Image& image) {
    const int hundredths = std::clamp(100 * kSeconds / frames_, 2, 100);
    file_->write(is_gif_ ? gif_frame(image.width_px, image.height_px, colors_->indices(image), hundredths)
                         : host::y4m_color_frame({image.pixels.data(), image.width_px, image.height_px}));
  }
  void end() {
    if (is_gif_) {
      file_->write(gif_end());
    }
  }

 private:
  static constexpr int kSeconds = 6;

  OutputFile* file_;
  bool is_gif_;
  int frames_;
  std::unique_ptr<GifColors> colors_;
};

void render_film(const RenderCommand& command, const SceneSource& source, LookStudio& studio,
                 OutputSet& outputs) {
  const std::vector<Framing> framings = frame_turns(command.view, studio.shape(), command.turntable);
  ProgressBar bar("filming", command.scene.quiet);
  const auto frame = [&](std::size_t i) {
    studio.look_from(framings[i]);
    bar.update(static_cast<double>(i) / static_cast<double>(framings.size()));
    return studio.paint({});
  };
  // The palette comes from a few frames all around, which are then drawn once more.
  const bool is_gif = command.output.ends_with(".gif");
  std::vector<Painting> samples;
  for (std::size_t i = 0; i < (is_gif ? std::size_t{4} : std::size_t{1}); ++i) {
    samples.push_back(frame(i * framings.size() / 4));
  }
  Film film(outputs[kPicture], is_gif, command.turntable);
  film.begin(samples);
  Painting last = std::move(samples.front());
  samples.clear();
  double seconds = 0;
  std::uint32_t crc = 0;
  for (std::size_t i = 0; i < framings.size(); ++i) {
    last = frame(i);
    film.add(last.image);
    crc = add_crc(crc, last.image.pixels);
    seconds += last.seconds;
  }
  film.end();
  bar.clear();
  last.seconds = seconds / static_cast<double>(framings.size());
  Stats stats = stats_of(command, source, studio, last);
  stats.frame_crc32 = crc_text(crc);
  print_look(command, studio);
  end(command, stats, framings.front().note, outputs);
}

}  // namespace

void render_look(const RenderCommand& command, const SceneSource& source, OutputSet& outputs) {
  LookStudio studio(command, source);
  if (command.turntable != 0) {
    render_film(command, source, studio, outputs);
  } else {
    render_picture(command, source, studio, outputs);
  }
}

}  // namespace thimble::tools
