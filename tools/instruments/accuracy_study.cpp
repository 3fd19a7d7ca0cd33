#include "instruments/accuracy_study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "output/hit_rows.h"
#include "output/units.h"
#include "readers/source.h"
#include "thimble/picture/anytime.h"

namespace thimble::tools {
namespace {

using Pixels = std::vector<std::uint8_t>;

// A setting, plain or of light, and why it is tried (AccuracyRow::group).
template <class Of>
struct Trial {
  std::string group;
  Of setting;
};

template <class Of>
struct Knob {
  const char* key;  // "cutoff"
  // What is tried with the other knobs where they stand by themselves, and together with those of the other knobs.
  std::vector<double> alone;
  std::vector<double> together;
  void (*set)(Of* setting, double value);
};

// `own`, each knob alone, every combination, `best`: each setting once.
template <class Of>
std::vector<Trial<Of>> trials_of(const Of& own, const std::vector<Knob<Of>>& knobs, const Of& best) {
  std::vector<Trial<Of>> trials{{"default", own}};
  // Each knob in turn multiplies the list.
  std::vector<Of> together{own};
  for (const Knob<Of>& knob : knobs) {
    for (const double value : knob.alone) {
      trials.push_back({knob.key, own});
      knob.set(&trials.back().setting, value);
    }
    std::vector<Of> next;
    for (const Of& setting : together) {
      for (const double value : knob.together) {
        next.push_back(setting);
        knob.set(&next.back(), value);
      }
    }
    together = std::move(next);
  }
  for (const Of& setting : together) {
    trials.push_back({"together", setting});
  }
  trials.push_back({"best", best});
  std::set<std::string> known;
  std::erase_if(trials, [&](const auto& trial) { return !known.insert(trial.setting.text()).second; });
  return trials;
}

// Depths less than the scene's own, by so many levels.
std::vector<double> shallower(int depth, int most) {
  std::vector<double> depths;
  for (int less = 1; less <= most && depth - less >= 1; ++less) {
    depths.push_back(depth - less);
  }
  return depths;
}

// The knobs of a plain picture in a scene of `depth`: one table. Whoever adds a knob adds a line to it, and to
// `Setting`.
std::vector<Knob<Setting>> plain_knobs(int depth) {
  std::vector<double> depths = shallower(depth, 2);
  depths.insert(depths.begin(), 0);
  return {{"depth", shallower(depth, 4), depths,
           [](Setting* setting, double levels) { setting->quality.max_depth = static_cast<int>(levels); }},
          {"cutoff",
           {0.5, 1, 2, 4, 8},
           {0, 1, 2, 4},
           [](Setting* setting, double pixels) {
             setting->quality.cutoff =
                 Q16::from_raw(static_cast<std::int32_t>(std::lround(pixels * Q16::kOne)));
           }},
          {"direction_bits",
           {8, 9, 10, 12, 16, 20},
           {0, 9},
           [](Setting* setting, double bits) { setting->direction_bits = static_cast<int>(bits); }},
          {"samples", {4, 9, 16, 36, 64}, {1, 4, 16}, [](Setting* setting, double samples) {
             setting->quality.across = static_cast<int>(std::lround(std::sqrt(samples)));
           }}};
}

template <int LightSetting::*kKnob>
void set_light(LightSetting* setting, double value) {
  setting->*kKnob = static_cast<int>(value);
}

// Draws lit pictures of a compact tree, which stays the caller's.
class LightStudio {
 public:
  LightStudio(const SceneSource& source, const BuiltScene& built, const EffectChoice& choice,
              const Camera& camera, const Shading& shading)
      : built_(built), camera_(camera), shading_(shading), lit_(source.lighting()), polished_(lit_) {
    const UsedMaterials used = used_materials(built.compact());
    effects_ = chosen_effects(lit_, used, choice);
    lit_.find_glow(built.compact());
    polished_.find_glow(built.compact());
    const LitScene scene = lit_.drawn(effects_);
    if ((effects_ & Effect::kAmbientOcclusion) != 0) {
      own_.occlusion_rays = scene.occlusion.rays;
    }
    if ((effects_ & Effect::kBranching) != 0) {
      own_.bounces = scene.bounces;
    }
    for (std::size_t material = 0; material < lit_.surfaces.size(); ++material) {
      const Surface& surface = lit_.surfaces[material];
      if ((effects_ & Effect::kMirror) != 0 && used.is[material] && surface.kind == SurfaceKind::kMetal &&
          surface.roughness != 0) {
        own_.roughness_rays = 4;
      }
      polished_.surfaces[material].roughness = 0;
    }
  }

  EffectSet effects() const { return effects_; }

  // Every knob at its best.
  LightSetting best() const {
    LightSetting setting = own_;
    setting.occlusion_rays = own_.occlusion_rays < 0 ? -1 : 32;
    setting.bounces = own_.bounces < 0 ? -1 : kMaxBounces;
    return setting;
  }

  // All that the study tries, each once; none where no effect has a knob.
  std::vector<Trial<LightSetting>> trials() const {
    std::vector<Knob<LightSetting>> knobs;
    if (own_.occlusion_rays >= 0) {
      knobs.push_back(
          {"occlusion_rays", {0, 4, 8, 16, 32}, {0, 4, 8, 32}, set_light<&LightSetting::occlusion_rays>});
    }
    if (own_.roughness_rays >= 0) {
      knobs.push_back({"roughness_rays", {1, 4}, {1, 4}, set_light<&LightSetting::roughness_rays>});
    }
    if (own_.bounces >= 0) {
      knobs.push_back({"bounces", {0, 1, 2, 3, 4, 6, 8}, {0, 1, 2, 4, 8}, set_light<&LightSetting::bounces>});
    }
    return knobs.empty() ? std::vector<Trial<LightSetting>>() : trials_of(own_, knobs, best());
  }

  // Draws the whole picture into `pixels`, rows of kRgb888 without gaps, which are that large.
  // Throws InputError when the scene cannot be drawn.
  void draw(const LightSetting& setting, Pixels* pixels, RenderCounts* counts) const {
    const LitDescription& lit = setting.roughness_rays == 1 ? polished_ : lit_;
    EffectSet effects = effects_;
    LitScene scene = lit.drawn(effects);
    if (setting.occlusion_rays >= 0) {
      scene.occlusion.rays = static_cast<std::uint8_t>(setting.occlusion_rays);
    }
    if (setting.occlusion_rays == 0) {
      effects &= ~Effect::kAmbientOcclusion;
    }
    if (setting.bounces >= 0) {
      scene.bounces = static_cast<std::uint8_t>(setting.bounces);
    }
    Band band;
    band.pixels = {pixels->data(), pixels->size()};
    band.format = PixelFormat::kRgb888;
    band.rows = camera_.height_px();
    LitCounts lit_counts;
    fail_if(render_lit_band(effects, built_.compact(), camera_, shading_, scene, band, &lit_counts) !=
                Status::kOk,
            "its light cannot be drawn: too many lights, or rays of this camera that are too long");
    *counts = totals_of(lit_counts);
  }

 private:
  const BuiltScene& built_;
  Camera camera_;
  Shading shading_;
  LitDescription lit_;
  LitDescription polished_;
  EffectSet effects_ = Effect::kNone;
  LightSetting own_;
};

// A setting ready to be drawn.
struct Prepared {
  Camera camera;
  Camera fine;
  QualityFrame frame;
};

class AccuracyStudio {
 public:
  AccuracyStudio(const SceneSource& source, BuiltScene* built, const AccuracyOptions& options)
      : source_(source), built_(*built), options_(options), shape_{built->level(), built->bounds()} {
    camera_ = frame_scene(options.view, source, shape_).camera;
    shading_ = scene_shading(options.shade, {built->palette().data(), built->palette().size()}, camera_,
                             built->bounds());
    Quality cutting;
    cutting.max_depth = 1;
    colors_ = take_node_colors(built, cutting, shading_);
  }

  // The setting's own cameras, or why there are none. Where the reference frames the scene, so do they.
  Prepared prepare(const Setting& setting) const {
    ViewWishes view = options_.view;
    view.direction_bits = setting.direction_bits;
    const Camera camera = frame_scene(view, source_, shape_).camera;
    const Camera fine = frame_scene(finer(view, setting.quality.across), source_, shape_).camera;
    return {camera, fine, QualityFrame(built_, setting.quality, camera, fine, shading_, colors_)};
  }

  LightStudio light(const EffectChoice& choice) const { return {source_, built_, choice, camera_, shading_}; }

  std::size_t picture_bytes() const {
    return band_bytes(PixelFormat::kRgb888, camera_.width_px(), camera_.height_px());
  }

  // Draws a lit picture; milliseconds.
  double draw(const LightStudio& light, const LightSetting& setting, Pixels* pixels,
              RenderCounts* counts) const {
    pixels->resize(picture_bytes());
    const FrameWatch watch;
    light.draw(setting, pixels, counts);
    return watch.ms();
  }

  // Draws the whole picture into `pixels`; milliseconds.
  double draw(const Prepared& prepared, const Quality& quality, Pixels* pixels, RenderCounts* counts) {
    const std::size_t row = row_bytes(PixelFormat::kRgb888, camera_.width_px());
    pixels->resize(picture_bytes());
    work_.resize(
        static_cast<std::size_t>(quality_band_bytes(quality, PixelFormat::kRgb888, camera_.width_px())));
    const BandPainter painter = square_painter(ray_sampler(prepared.frame, options()), prepared.fine,
                                               quality.across, PixelFormat::kRgb888, {});
    PaintCounts painted;
    const FrameWatch watch;
    for (std::int32_t y = 0; y < camera_.height_px(); ++y) {
      // A plain picture needs no copy: its rows are drawn where they belong.
      std::uint8_t* target = pixels->data() + row * static_cast<std::size_t>(y);
      const Bytes work = quality.across == 1 ? Bytes(target, row) : Bytes(work_.data(), work_.size());
      fail_if(painter.draw({work, PixelFormat::kRgb888, 0, y, 1}, &painted) != Status::kOk,
              "internal error: a row cannot be drawn");
      if (quality.across != 1) {
        std::copy_n(work_.data(), row, target);
      }
    }
    *counts = painted.all;
    return watch.ms();
  }

  // Refines a frame with so many visits in `memory`, which the picture is left in; milliseconds.
  double refine(const Camera& camera, std::uint32_t visits, Pixels* memory, AnytimeFrame* frame) const {
    memory->resize(anytime_bytes(camera.width_px(), camera.height_px(), PixelFormat::kRgb888));
    const FrameWatch watch;
    fail_if(AnytimeFrame::make(built_.compact(), camera, shading_, PixelFormat::kRgb888,
                               {memory->data(), memory->size()}, frame) != Status::kOk ||
                frame->refine(built_.compact(), visits, Width::k64) != Status::kOk,
            "internal error: a frame cannot be refined");
    const double ms = watch.ms();
    memory->resize(picture_bytes());
    return ms;
  }

  // Distances along the unit rays of the pixels' centres, negative for a miss.
  std::vector<double> distances(const Prepared& prepared) const {
    std::vector<double> result;
    for (std::int32_t y = 0; y < camera_.height_px(); ++y) {
      for (std::int32_t x = 0; x < camera_.width_px(); ++x) {
        const Ray ray = prepared.camera.ray(x, y);
        Hit hit;
        fail_if(prepared.frame.closest_hit(ray, &hit, options()) != Status::kOk,
                "internal error: a ray cannot be traced");
        result.push_back(hit.kind == HitKind::kHit ? hit_distance(ray, hit) : -1);
      }
    }
    return result;
  }

 private:
  static TraceOptions options() { return {UINT32_MAX, Width::k64}; }

  const SceneSource& source_;
  const BuiltScene& built_;
  const AccuracyOptions& options_;
  SceneShape shape_;  // its bounds alone
  Camera camera_;
  Shading shading_;
  NodeColors colors_;
  Pixels work_;
};

void compare_pictures(const Pixels& picture, const Pixels& reference, AccuracyRow* row) {
  for (std::size_t i = 0; i < picture.size(); i += 3) {
    int most = 0;
    for (std::size_t channel = i; channel < i + 3; ++channel) {
      most = std::max(most, std::abs(int{picture[channel]} - int{reference[channel]}));
    }
    row->wrong_px += most > 0 ? 1U : 0U;
    row->visible_px += most > kVisibleDifference ? 1U : 0U;
  }
  row->psnr_db = psnr_db(picture, reference);
}

// The mean absolute difference of what a display shows in greys.
double mean_gray_error(const Pixels& picture, const Pixels& exact) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < exact.size(); i += 3) {
    const int gray = gray_of({picture[i], picture[i + 1], picture[i + 2]});
    sum += static_cast<std::uint64_t>(std::abs(gray - gray_of({exact[i], exact[i + 1], exact[i + 2]})));
  }
  return static_cast<double>(sum) * 3 / static_cast<double>(exact.size());
}

// A lit picture's work in plain ones, roughly: for the progress bar.
constexpr double kLitPicture = 4;

// The first step of any-time work: so many visits, and twice as many each time.
constexpr std::uint32_t kFirstVisits = 256;

// The setting with the most samples and bits that this view can have: a fine picture may be too large or too
// fine.
Prepared prepare_reference(const AccuracyStudio& studio, AccuracyStudy* study) {
  study->reference.direction_bits = kMaxDirectionBits;
  for (int across = kMaxSamplesAcross;; --across) {
    study->reference.quality.across = across;
    try {
      Prepared best = studio.prepare(study->reference);
      if (across < kMaxSamplesAcross) {
        study->notes.push_back("this view can have " + std::to_string(across * across) +
                               " samples a pixel at most: the reference has so many");
      }
      return best;
    } catch (const InputError&) {
      if (across == 1) {
        throw;
      }
    }
  }
}

// Rows for all settings that this view can have, and these settings ready to be drawn.
std::vector<Prepared> prepare_trials(const AccuracyStudio& studio, int level, AccuracyStudy* study) {
  std::vector<Prepared> prepared;
  std::vector<std::string> left_out;
  std::string reason;
  for (const auto& trial : trials_of({}, plain_knobs(level), study->reference)) {
    if (trial.setting.quality.across > study->reference.quality.across) {
      continue;
    }
    try {
      prepared.push_back(studio.prepare(trial.setting));
    } catch (const InputError& error) {
      left_out.push_back(trial.setting.text());
      reason = error.what();
      continue;
    }
    AccuracyRow& row = study->rows.emplace_back();
    row.group = trial.group;
    row.setting = trial.setting;
  }
  if (!left_out.empty()) {
    study->notes.push_back(
        left_out.front() +
        (left_out.size() == 1 ? " is" : " and " + std::to_string(left_out.size() - 1) + " more are") +
        " left out: " + reason);
  }
  return prepared;
}

// Rows for twice the work again and again until the frame is done. `exact`: the finished picture.
void add_work_rows(AccuracyStudio& studio, const Prepared& plain, const Pixels& exact, AccuracyStudy* study) {
  Pixels memory;
  for (std::uint32_t visits = kFirstVisits; study->work.empty() || study->work.back().inexact_px != 0;
       visits *= 2) {
    AnytimeFrame frame;
    studio.refine(plain.camera, visits, &memory, &frame);
    WorkRow& row = study->work.emplace_back();
    row.given_visits = visits;
    row.inexact_px = frame.inexact();
    row.error_bound_grays = frame.mean_error_bound_q8() / 256.0;
    row.mean_error_grays = mean_gray_error(memory, exact);
    row.picture.group = "anytime";
    if (visits > UINT32_MAX / 2) {
      study->notes.emplace_back("any-time frames end at " + grouped(visits) + " node visits here");
      return;
    }
  }
}

// What is drawn once a round.
struct Frame {
  AccuracyRow* row;
  double work;  // in pictures of one sample
  const Pixels& reference;
  std::function<double(Pixels* picture, RenderCounts* counts)> draw;  // milliseconds
};

// Draws all frames by turns and sets their rows' times; in the first round also counts and errors.
void draw_rounds(const std::vector<Frame>& frames, int rounds, const Progress& progress) {
  double all = 0;
  for (const Frame& frame : frames) {
    all += frame.work * rounds;
  }
  std::vector<std::vector<double>> milliseconds(frames.size());
  Pixels picture;
  double done = 0;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      AccuracyRow* const row = frames[i].row;
      RenderCounts counts;
      milliseconds[i].push_back(frames[i].draw(&picture, &counts));
      if (round == 0) {
        row->counts = counts;
        compare_pictures(picture, frames[i].reference, row);
      }
      done += frames[i].work;
      progress(done / all);
    }
  }
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].row->set_times(milliseconds[i]);
  }
}

}  // namespace

double psnr_db(const Pixels& picture, const Pixels& reference) {
  std::uint64_t squares = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const int difference = int{picture[i]} - int{reference[i]};
    squares += static_cast<std::uint64_t>(difference * difference);
  }
  if (squares == 0) {
    return std::numeric_limits<double>::infinity();
  }
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(picture.size()) / static_cast<double>(squares));
}

double rms_of(double psnr_db) {
  return 255 * std::pow(10, -psnr_db / 20);
}

double psnr_of(double rms) {
  return rms == 0 ? std::numeric_limits<double>::infinity() : 20 * std::log10(255 / rms);
}

double cost_of(const AccuracyRow& row, CostAxis axis) {
  return axis == CostAxis::kTime     ? row.ms_median
         : axis == CostAxis::kVisits ? static_cast<double>(row.counts.node_visits)
                                     : row.lm3s_instructions;
}

void mark_front(std::vector<AccuracyRow>* rows, CostAxis axis) {
  const double as_cheap = axis == CostAxis::kTime ? 1 + kTimeNoise : 1;
  for (AccuracyRow& row : *rows) {
    const double cost = cost_of(row, axis);
    row.front = std::none_of(rows->begin(), rows->end(), [&](const AccuracyRow& other) {
      return (other.psnr_db > row.psnr_db && cost_of(other, axis) <= cost * as_cheap) ||
             (other.psnr_db == row.psnr_db && cost_of(other, axis) < cost);
    });
  }
}

const AccuracyRow* best_within(const std::vector<AccuracyRow>& rows, double ms) {
  const AccuracyRow* best = nullptr;
  for (const AccuracyRow& row : rows) {
    if (row.ms_median <= ms && (best == nullptr || row.psnr_db > best->psnr_db ||
                                (row.psnr_db == best->psnr_db && row.ms_median < best->ms_median))) {
      best = &row;
    }
  }
  return best;
}

const AccuracyRow* fastest_with(const std::vector<AccuracyRow>& rows, double psnr_db) {
  const AccuracyRow* best = nullptr;
  for (const AccuracyRow& row : rows) {
    if (row.psnr_db >= psnr_db && (best == nullptr || row.ms_median < best->ms_median)) {
      best = &row;
    }
  }
  return best;
}

AccuracyStudy study_accuracy(const SceneSource& source, BuiltScene* built, const AccuracyOptions& options,
                             const Progress& progress) {
  AccuracyStudio studio(source, built, options);
  AccuracyStudy study;
  study.pixels =
      static_cast<std::uint64_t>(options.view.width_px) * static_cast<std::uint64_t>(options.view.height_px);
  const Prepared best = prepare_reference(studio, &study);
  const std::vector<Prepared> prepared = prepare_trials(studio, built->level(), &study);

  // The picture of the defaults, and what it is worked out in.
  Setting defaults;
  const Prepared plain = studio.prepare(defaults);
  Pixels exact;
  RenderCounts unused;
  studio.draw(plain, defaults.quality, &exact, &unused);
  add_work_rows(studio, plain, exact, &study);

  const LightStudio light = studio.light(options.effects);
  study.effects = light.effects();
  study.light_reference = light.best();
  for (const auto& trial : light.trials()) {
    AccuracyRow& row = study.light.emplace_back();
    row.group = trial.group;
    row.light = trial.setting;
  }
  Pixels light_reference;
  if (!study.light.empty()) {
    studio.draw(light, study.light_reference, &light_reference, &unused);
  }
  Pixels reference;
  studio.draw(best, study.reference.quality, &reference, &unused);

  std::vector<Frame> frames;
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    const Quality& quality = study.rows[i].setting.quality;
    frames.push_back({&study.rows[i], static_cast<double>(quality.samples()), reference,
                      [&studio, &quality, &setting = prepared[i]](Pixels* picture, RenderCounts* counts) {
                        return studio.draw(setting, quality, picture, counts);
                      }});
  }
  for (WorkRow& row : study.work) {
    frames.push_back({&row.picture, 1, reference, [&](Pixels* picture, RenderCounts* counts) {
                        AnytimeFrame frame;
                        const auto visits = static_cast<std::uint32_t>(row.given_visits);
                        const double ms = studio.refine(plain.camera, visits, picture, &frame);
                        *counts = frame.counts();
                        return ms;
                      }});
  }
  for (AccuracyRow& row : study.light) {
    frames.push_back({&row, kLitPicture, light_reference, [&](Pixels* picture, RenderCounts* counts) {
                        return studio.draw(light, row.light, picture, counts);
                      }});
  }
  draw_rounds(frames, options.rounds, progress);
  const std::vector<double> distances = studio.distances(best);
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    AccuracyRow& row = study.rows[i];
    const Quality& quality = row.setting.quality;
    row.lm3s_instructions = chip_instructions(row.counts, quality.cuts(), quality.samples());
    row.compare_distances(studio.distances(prepared[i]), distances);
  }
  mark_front(&study.rows, options.axis);
  // Instructions are not estimated for light.
  mark_front(&study.light, options.axis == CostAxis::kInstructions ? CostAxis::kVisits : options.axis);
  return study;
}

std::array<double, 4> Setting::values() const {
  return {static_cast<double>(quality.max_depth), static_cast<double>(quality.cutoff.raw) / Q16::kOne,
          static_cast<double>(direction_bits), quality.across == 1 ? 0.0 : quality.samples()};
}

std::string Setting::text() const {
  constexpr std::array kOptions{" --max-depth ", " --cutoff ", " --direction-bits ", " --samples "};
  std::string text;
  for (std::size_t i = 0; i < kOptions.size(); ++i) {
    text += values()[i] == 0 ? "" : kOptions[i] + shortest(values()[i]);
  }
  return text.substr(text.empty() ? 0 : 1);
}

std::string LightSetting::text() const {
  std::string result;
  for (const auto& [name, value] : {std::pair{"occlusion rays ", occlusion_rays},
                                    {"roughness rays ", roughness_rays},
                                    {"bounces ", bounces}}) {
    result += value < 0 ? "" : (result.empty() ? "" : ", ") + (name + std::to_string(value));
  }
  return result;
}

}  // namespace thimble::tools
