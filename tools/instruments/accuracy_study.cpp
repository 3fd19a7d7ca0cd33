#include "instruments/accuracy_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "instruments/timed_frames.h"
#include "output/hit_csv.h"
#include "output/units.h"
#include "readers/source.h"
#include "thimble/picture/anytime.h"

namespace thimble::tools {
namespace {

// A setting ready to be drawn.
struct Prepared {
  Camera camera;
  QualityFrame frame;
};

class AccuracyStudio {
 public:
  AccuracyStudio(const SceneSource& source, BuiltScene* built, const AccuracyOptions& options)
      : source_(source), built_(*built), options_(options) {
    camera_ = frame_scene(options.view, source, built->level(), built->bounds()).camera;
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
    const Camera camera = frame_scene(view, source_, built_.level(), built_.bounds()).camera;
    const Camera fine =
        frame_scene(finer(view, setting.quality.across), source_, built_.level(), built_.bounds()).camera;
    return {camera, QualityFrame(built_, setting.quality, camera, fine, shading_, colors_)};
  }

  LightStudio light(const EffectChoice& choice) const { return {source_, built_, choice, camera_, shading_}; }

  // Draws a lit picture; milliseconds.
  static double draw(const LightStudio& light, const LightSetting& setting, std::vector<std::uint8_t>* pixels,
                     RenderCounts* counts) {
    const Stopwatch watch;
    light.draw(setting, pixels, counts);
    return watch.ms();
  }

  std::size_t row_bytes_of() const { return row_bytes(PixelFormat::kRgb888, camera_.width_px()); }

  // Draws the whole picture into `pixels`; milliseconds.
  double draw(const Prepared& prepared, const Quality& quality, std::vector<std::uint8_t>* pixels,
              RenderCounts* counts) {
    const std::size_t row = row_bytes_of();
    pixels->resize(row * static_cast<std::size_t>(camera_.height_px()));
    work_.resize(
        static_cast<std::size_t>(quality_band_bytes(quality, PixelFormat::kRgb888, camera_.width_px())));
    const Stopwatch watch;
    for (std::int32_t y = 0; y < camera_.height_px(); ++y) {
      // A plain picture needs no copy: its rows are drawn where they belong.
      std::uint8_t* target = pixels->data() + row * static_cast<std::size_t>(y);
      const Bytes work = quality.across == 1 ? Bytes(target, row) : Bytes(work_.data(), work_.size());
      if (prepared.frame.draw_row(y, PixelFormat::kRgb888, work, counts, options()) != Status::kOk) {
        throw InputError("internal error: a row cannot be drawn");
      }
      if (quality.across != 1) {
        std::copy_n(work_.data(), row, target);
      }
    }
    return watch.ms();
  }

  // Refines a frame with so many visits, in memory of its own; milliseconds.
  double refine(const Camera& camera, std::uint32_t visits, std::vector<std::uint8_t>* memory,
                AnytimeFrame* frame) const {
    memory->resize(anytime_bytes(camera.width_px(), camera.height_px(), PixelFormat::kRgb888));
    const Stopwatch watch;
    if (AnytimeFrame::make(built_.compact(), camera, shading_, PixelFormat::kRgb888,
                           {memory->data(), memory->size()}, frame) != Status::kOk ||
        frame->refine(built_.compact(), visits, Width::k64) != Status::kOk) {
      throw InputError("internal error: a frame cannot be refined");
    }
    return watch.ms();
  }

  // Distances along the unit rays of the pixels' centres, negative for a miss.
  std::vector<double> distances(const Prepared& prepared) const {
    std::vector<double> result;
    for (std::int32_t y = 0; y < camera_.height_px(); ++y) {
      for (std::int32_t x = 0; x < camera_.width_px(); ++x) {
        const Ray ray = prepared.camera.ray(x, y);
        Hit hit;
        if (prepared.frame.closest_hit(ray, &hit, options()) != Status::kOk) {
          throw InputError("internal error: a ray cannot be traced");
        }
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
  Camera camera_;
  Shading shading_;
  NodeColors colors_;
  std::vector<std::uint8_t> work_;
};

void compare_pictures(const std::vector<std::uint8_t>& picture, const std::vector<std::uint8_t>& reference,
                      AccuracyRow* row) {
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
double mean_gray_error(const std::uint8_t* picture, const std::vector<std::uint8_t>& exact) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < exact.size(); i += 3) {
    const int gray = gray_of({picture[i], picture[i + 1], picture[i + 2]});
    sum += static_cast<std::uint64_t>(std::abs(gray - gray_of({exact[i], exact[i + 1], exact[i + 2]})));
  }
  return static_cast<double>(sum) * 3 / static_cast<double>(exact.size());
}

// All rows one after the other.
AccuracyRow& row_of(AccuracyStudy* study, std::size_t index) {
  if (index < study->rows.size()) {
    return study->rows[index];
  }
  index -= study->rows.size();
  return index < study->work.size() ? study->work[index].picture : study->light[index - study->work.size()];
}

// A lit picture's work in plain ones, roughly: for the progress bar.
constexpr double kLitPicture = 4;

// The first step of any-time work: so many visits, and twice as many each time.
constexpr std::uint32_t kFirstVisits = 256;

// The setting with the most samples and bits that this view can have: a fine picture may be too large or too
// fine.
Prepared prepare_reference(const AccuracyStudio& studio, AccuracyStudy* study) {
  for (int across = kMaxSamplesAcross;; --across) {
    study->reference = best_setting(across);
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
  for (const Trial& trial : trials(level, study->reference.quality.across)) {
    try {
      prepared.push_back(studio.prepare(trial.setting));
    } catch (const InputError& error) {
      left_out.push_back(trial.setting.options());
      reason = error.what();
      continue;
    }
    AccuracyRow row;
    row.trial = trial;
    study->rows.push_back(row);
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
void add_work_rows(AccuracyStudio& studio, const Prepared& plain, const std::vector<std::uint8_t>& exact,
                   AccuracyStudy* study) {
  std::vector<std::uint8_t> memory;
  for (std::uint32_t visits = kFirstVisits; study->work.empty() || study->work.back().inexact_px != 0;
       visits *= 2) {
    AnytimeFrame frame;
    studio.refine(plain.camera, visits, &memory, &frame);
    WorkRow row;
    row.given_visits = visits;
    row.inexact_px = frame.inexact();
    row.error_bound_grays = frame.mean_error_bound_q8() / 256.0;
    row.mean_error_grays = mean_gray_error(memory.data(), exact);
    row.picture.trial.group = "anytime";
    row.picture.counts = frame.counts();
    study->work.push_back(row);
    if (visits > UINT32_MAX / 2) {
      study->notes.emplace_back("any-time frames end at " + grouped(visits) + " node visits here");
      return;
    }
  }
}

// Draws the study's rows and sets their times; in round 0 also their counts and errors.
struct Comparison {
  AccuracyStudio& studio;
  int rounds;
  const std::function<void(double)>& progress;
  AccuracyStudy* study;
  std::vector<std::uint8_t> reference = {};
  std::vector<double> reference_distances = {};
  std::vector<std::uint8_t> picture = {};
  std::vector<std::uint8_t> memory = {};
  std::vector<std::vector<double>> milliseconds = {};  // of all rows, in the order of `row_of`
  double done = 0;                                     // pictures of one sample
  double all = 1;

  void draw_reference(const Prepared& best) {
    double rays =
        static_cast<double>(study->work.size()) + kLitPicture * static_cast<double>(study->light.size());
    for (const AccuracyRow& row : study->rows) {
      rays += row.trial.setting.quality.samples();
    }
    const double reference_rays = study->reference.quality.samples();
    all = reference_rays + rays * rounds;
    milliseconds.resize(study->rows.size() + study->work.size() + study->light.size());
    RenderCounts unused;
    studio.draw(best, study->reference.quality, &reference, &unused);
    reference_distances = studio.distances(best);
    advance(reference_rays);
  }

  void draw_settings(int round, const std::vector<Prepared>& prepared) {
    for (std::size_t i = 0; i < study->rows.size(); ++i) {
      AccuracyRow& row = study->rows[i];
      RenderCounts counts;
      const Quality& quality = row.trial.setting.quality;
      milliseconds[i].push_back(studio.draw(prepared[i], quality, &picture, &counts));
      if (round == 0) {
        row.counts = counts;
        row.lm3s_instructions = chip_instructions(counts, quality.cuts(), quality.samples());
        compare_pictures(picture, reference, &row);
        row.compare_distances(studio.distances(prepared[i]), reference_distances);
      }
      advance(quality.samples());
    }
  }

  void draw_work(int round, const Prepared& plain, std::size_t picture_bytes) {
    for (std::size_t i = 0; i < study->work.size(); ++i) {
      WorkRow& row = study->work[i];
      AnytimeFrame frame;
      milliseconds[study->rows.size() + i].push_back(
          studio.refine(plain.camera, static_cast<std::uint32_t>(row.given_visits), &memory, &frame));
      if (round == 0) {
        picture.assign(memory.begin(), memory.begin() + static_cast<std::ptrdiff_t>(picture_bytes));
        compare_pictures(picture, reference, &row.picture);
      }
      advance(1);
    }
  }

  void draw_light(int round, const LightStudio& light, const std::vector<std::uint8_t>& light_reference) {
    picture.resize(light_reference.size());
    for (std::size_t i = 0; i < study->light.size(); ++i) {
      AccuracyRow& row = study->light[i];
      RenderCounts counts;
      milliseconds[study->rows.size() + study->work.size() + i].push_back(
          AccuracyStudio::draw(light, row.light, &picture, &counts));
      if (round == 0) {
        row.counts = counts;
        compare_pictures(picture, light_reference, &row);
      }
      advance(kLitPicture);
    }
  }

  void set_times() const {
    for (std::size_t i = 0; i < milliseconds.size(); ++i) {
      row_of(study, i).set_times(milliseconds[i]);
    }
  }

  void advance(double more) {
    done += more;
    if (progress) {
      progress(done / all);
    }
  }
};

}  // namespace

double psnr_db(const std::vector<std::uint8_t>& picture, const std::vector<std::uint8_t>& reference) {
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
                             const std::function<void(double)>& progress) {
  AccuracyStudio studio(source, built, options);
  AccuracyStudy study;
  study.pixels =
      static_cast<std::uint64_t>(options.view.width_px) * static_cast<std::uint64_t>(options.view.height_px);
  const Prepared best = prepare_reference(studio, &study);
  const std::vector<Prepared> prepared = prepare_trials(studio, built->level(), &study);

  // The picture of the defaults, and what it is worked out in.
  Setting defaults;
  const Prepared plain = studio.prepare(defaults);
  std::vector<std::uint8_t> exact;
  RenderCounts unused;
  studio.draw(plain, defaults.quality, &exact, &unused);
  add_work_rows(studio, plain, exact, &study);

  const LightStudio light = studio.light(options.effects);
  study.effects = light.effects();
  study.light_reference = light.best();
  std::vector<std::uint8_t> light_reference(exact.size());
  for (const LightTrial& trial : light.trials()) {
    AccuracyRow row;
    row.trial.group = trial.group;
    row.light = trial.setting;
    study.light.push_back(row);
  }
  if (!study.light.empty()) {
    light.draw(study.light_reference, &light_reference, &unused);
  }

  Comparison comparison{studio, options.rounds, progress, &study};
  comparison.draw_reference(best);
  for (int round = 0; round < options.rounds; ++round) {
    comparison.draw_settings(round, prepared);
    comparison.draw_work(round, plain, exact.size());
    comparison.draw_light(round, light, light_reference);
  }
  comparison.set_times();
  mark_front(&study.rows, options.axis);
  // Instructions are not estimated for light.
  mark_front(&study.light, options.axis == CostAxis::kInstructions ? CostAxis::kVisits : options.axis);
  return study;
}

namespace {

// Depths less than the scene's own, by so many levels.
std::vector<double> shallower(int depth, int most) {
  std::vector<double> depths;
  for (int less = 1; less <= most && depth - less >= 1; ++less) {
    depths.push_back(depth - less);
  }
  return depths;
}

}  // namespace

const std::vector<Knob>& knobs() {
  static const std::vector<Knob> kKnobs{
      {"depth", "--max-depth", "levels", "levels of the tree that are looked at",
       [](int depth) { return shallower(depth, 4); },
       [](int depth) {
         std::vector<double> depths = shallower(depth, 2);
         depths.insert(depths.begin(), 0);
         return depths;
       },
       [](Setting* setting, double value) { setting->quality.max_depth = static_cast<int>(value); },
       [](const Setting& setting) { return static_cast<double>(setting.quality.max_depth); }},
      {"cutoff", "--cutoff", "pixels", "blocks that cover less of a pixel are not looked into",
       [](int) {
         return std::vector<double>{0.5, 1, 2, 4, 8};
       },
       [](int) {
         return std::vector<double>{0, 1, 2, 4};
       },
       [](Setting* setting, double value) {
         setting->quality.cutoff = Q16::from_raw(static_cast<std::int32_t>(std::lround(value * Q16::kOne)));
       },
       [](const Setting& setting) { return static_cast<double>(setting.quality.cutoff.raw) / Q16::kOne; }},
      {"direction_bits", "--direction-bits", "bits", "bits of a ray's direction",
       [](int) { return std::vector<double>{8, 9, 10, 12, 16, 20}; },
       [](int) {
         return std::vector<double>{0, 9};
       },
       [](Setting* setting, double value) { setting->direction_bits = static_cast<int>(value); },
       [](const Setting& setting) { return static_cast<double>(setting.direction_bits); }},
      {"samples", "--samples", "rays a pixel", "samples a pixel",
       [](int) {
         return std::vector<double>{4, 9, 16, 36, 64};
       },
       [](int) {
         return std::vector<double>{1, 4, 16};
       },
       [](Setting* setting, double value) {
         setting->quality.across = static_cast<int>(std::lround(std::sqrt(value)));
       },
       [](const Setting& setting) {
         return setting.quality.across == 1 ? 0.0 : static_cast<double>(setting.quality.samples());
       }},
  };
  return kKnobs;
}

std::string Setting::options() const {
  std::string text;
  for (const Knob& knob : knobs()) {
    if (const double value = knob.get(*this); value != 0) {
      text += (text.empty() ? "" : " ") + std::string(knob.option) + " " + shortest(value);
    }
  }
  return text;
}

Setting best_setting(int most_across) {
  Setting setting;
  setting.quality.across = most_across;
  setting.direction_bits = kMaxDirectionBits;
  return setting;
}

std::vector<Trial> trials(int depth, int most_across) {
  std::vector<Trial> result;
  std::set<std::string> known;
  const auto add = [&](const std::string& group, const Setting& setting) {
    if (setting.quality.across <= most_across && known.insert(setting.options()).second) {
      result.push_back({group, setting});
    }
  };
  add("default", {});
  for (const Knob& knob : knobs()) {
    for (const double value : knob.alone(depth)) {
      Setting setting;
      knob.set(&setting, value);
      add(knob.key, setting);
    }
  }
  // Every combination: each knob in turn multiplies the list.
  std::vector<Setting> together(1);
  for (const Knob& knob : knobs()) {
    std::vector<Setting> next;
    for (const Setting& setting : together) {
      for (const double value : knob.together(depth)) {
        next.push_back(setting);
        knob.set(&next.back(), value);
      }
    }
    together = std::move(next);
  }
  for (const Setting& setting : together) {
    add("together", setting);
  }
  add("best", best_setting(most_across));
  return result;
}

std::string LightSetting::text() const {
  std::string result;
  const auto add = [&](const char* name, int value) {
    if (value >= 0) {
      result += (result.empty() ? "" : ", ") + std::string(name) + " " + std::to_string(value);
    }
  };
  add("occlusion rays", occlusion_rays);
  add("roughness rays", roughness_rays);
  add("bounces", bounces);
  return result;
}

LightStudio::LightStudio(const SceneSource& source, const BuiltScene& built, const EffectChoice& choice,
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
  }
  for (Surface& surface : polished_.surfaces) {
    surface.roughness = 0;
  }
}

LightSetting LightStudio::best() const {
  LightSetting setting = own_;
  setting.occlusion_rays = own_.occlusion_rays < 0 ? -1 : 32;
  setting.bounces = own_.bounces < 0 ? -1 : kMaxBounces;
  return setting;
}

std::vector<LightTrial> LightStudio::trials() const {
  std::vector<LightTrial> result;
  if (own_ == LightSetting{}) {
    return result;
  }
  const auto add = [&](const char* group, const LightSetting& setting) {
    if (std::none_of(result.begin(), result.end(),
                     [&](const LightTrial& trial) { return trial.setting == setting; })) {
      result.push_back({group, setting});
    }
  };
  struct LightKnob {
    const char* key;
    int LightSetting::*value;
    std::vector<int> alone;
    std::vector<int> together;
  };
  const std::array<LightKnob, 3> knobs{{
      {"occlusion_rays", &LightSetting::occlusion_rays, {0, 4, 8, 16, 32}, {0, 4, 8, 32}},
      {"roughness_rays", &LightSetting::roughness_rays, {1, 4}, {1, 4}},
      {"bounces", &LightSetting::bounces, {0, 1, 2, 3, 4, 6, 8}, {0, 1, 2, 4, 8}},
  }};
  add("default", own_);
  std::vector<LightSetting> together{own_};
  for (const LightKnob& knob : knobs) {
    if (own_.*knob.value < 0) {
      continue;
    }
    for (const int value : knob.alone) {
      LightSetting setting = own_;
      setting.*knob.value = value;
      add(knob.key, setting);
    }
    std::vector<LightSetting> next;
    for (const LightSetting& setting : together) {
      for (const int value : knob.together) {
        next.push_back(setting);
        next.back().*knob.value = value;
      }
    }
    together = std::move(next);
  }
  for (const LightSetting& setting : together) {
    add("together", setting);
  }
  add("best", best());
  return result;
}

void LightStudio::draw(const LightSetting& setting, std::vector<std::uint8_t>* pixels,
                       RenderCounts* counts) const {
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
  if (render_lit_band(effects, built_.compact(), camera_, shading_, scene, band, &lit_counts) !=
      Status::kOk) {
    throw InputError("its light cannot be drawn: too many lights, or rays of this camera that are too long");
  }
  *counts = totals_of(lit_counts);
}

}  // namespace thimble::tools
