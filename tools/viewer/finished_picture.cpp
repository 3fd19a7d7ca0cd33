#include "viewer/finished_picture.h"

#include <algorithm>
#include <cmath>

#include "scene/lit_setup.h"
#include "thimble/light/render.h"
#include "thimble/tree/octree.h"
#include "viewer/magnify.h"

namespace thimble::tools::viewer {
namespace {

// What a scene without light of its own gets.
constexpr EffectSet kPlainLight =
    Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion | Effect::kSky;
// What costs no rays of its own.
constexpr EffectSet kQuick = Effect::kDirectLight | Effect::kEmission | Effect::kWater | Effect::kFog |
                             Effect::kSky | Effect::kDepthCue;

double mean(const PackedU16 (&channels)[3]) {
  return (channels[0] + channels[1] + channels[2]) / 3.0;
}

// The light of a face in the open, for pictures without shadows: what comes from everywhere, the suns by their
// angles, and a share for lamps, wherever they hang.
void quick_light(const LitScene& scene, std::uint16_t (&face_light)[6]) {
  constexpr double kLamps = 100;
  for (int face = 0; face < 6; ++face) {
    double light = (scene.ambient_q8[0] + scene.ambient_q8[1] + scene.ambient_q8[2]) / 3.0;
    bool has_lamps = scene.lights.size == 0;
    for (const Light& each : scene.lights) {
      const Vec3i place = each.place;
      const double length = std::hypot(static_cast<double>(place.x), place.y, place.z);
      const double along = (face % 2 == 0 ? -1.0 : 1.0) * place[face / 2];
      has_lamps = has_lamps || each.is_point;
      light += each.is_point || length == 0 ? 0 : std::max(0.0, along / length) * mean(each.color_q8);
    }
    face_light[face] = static_cast<std::uint16_t>(std::min(256.0, light + (has_lamps ? kLamps : 0)));
  }
}

void check(Status status) {
  if (status != Status::kOk) {
    throw InputError("its lights or surfaces are beyond the limits of a lit picture");
  }
}

}  // namespace

FinishedLook::FinishedLook(std::shared_ptr<const OpenScene> scene, const LookWishes& wishes)
    : scene_(std::move(scene)), lighting_(scene_->source->lighting()) {
  lighting_.rest.bounces = wishes.bounces.value_or(lighting_.rest.bounces);
  used_ = used_materials(scene_->tree());
  choose(wishes);
  lit_ = lit_scene_for(lighting_, used_, effects_);
  quick_effects_ = effects_ & kQuick;
  quick_ = lit_scene_for(lighting_, used_, quick_effects_);
  empty_bytes_.resize(4096);
  Arena arena(Bytes(empty_bytes_.data(), empty_bytes_.size()));
  Octree octree;
  if (Octree::make(scene_->level(), 16, arena, &octree) != Status::kOk ||
      CompactTree::make(octree, arena, &empty_) != Status::kOk) {
    throw InputError("internal error: there is no empty world");
  }
}

void FinishedLook::choose(const LookWishes& wishes) {
  const bool asks = wishes.effects || wishes.shade;
  EffectChoice choice = wishes.effects.value_or(EffectChoice{});
  if (!asks) {
    const EffectSet called = chosen_effects(lighting_, used_, choice);
    constexpr EffectSet kFromElsewhere = Effect::kDirectLight | Effect::kEmission | Effect::kDepthCue;
    if ((called & kFromElsewhere) == 0 && !scene_->source->is_point_set()) {
      choice = {false, called | kPlainLight};
      words_ = {"--effects", effects_text(choice.effects)};
    }
  } else if (!wishes.effects) {
    choice = {false, Effect::kNone};  // a --shade that is given shows no light
  }
  if (wishes.effects) {
    words_.insert(words_.end(), {"--effects", wishes.effects_word});
  }
  if (wishes.shade) {
    words_.insert(words_.end(), {"--shade", wishes.shade_word});
  }
  effects_ = chosen_effects(lighting_, used_, choice);
  mode_ = wishes.shade.value_or(ShadeMode::kDepth);
  if (wishes.bounces) {
    words_.insert(words_.end(), {"--bounces", std::to_string(*wishes.bounces)});
  }
  across_ = wishes.across.value_or(2);
  words_.insert(words_.end(), {"--samples", std::to_string(across_ * across_)});
}

FinishedPicture::FinishedPicture(std::shared_ptr<const FinishedLook> look, const ViewWishes& wishes)
    : look_(std::move(look)) {
  const OpenScene& scene = *look_->scene_;
  const VoxelBox bounds = scene.built->bounds();
  framing_ = frame_scene(wishes, *scene.source, scene.level(), bounds);
  fine_ = across() == 1 ? framing_.camera
                        : frame_scene(finer(wishes, across()), *scene.source, scene.level(), bounds).camera;
  shading_.mode = look_->mode_;
  shading_.palette = Span<const Rgb8>(scene.built->palette().data(), scene.built->palette().size());
  const DepthRange range = depth_range(camera(), bounds);
  shading_.near_q8 = range.near_q8;
  shading_.far_q8 = range.far_q8;
  quick_shading_ = shading_;
  if (look_->effects_ != Effect::kNone) {
    quick_shading_.mode = ShadeMode::kColor;
    quick_light(look_->lit_, quick_shading_.face_light);
  }
}

Framing framed_from(const OpenScene& scene, const ViewWishes& wishes, const Real3& forward) {
  ViewWishes whole = wishes;
  whole.placed = true;
  whole.eye.reset();
  whole.target.reset();
  whole.up.reset();
  whole.span.reset();
  whole.forward = forward;
  return frame_box(whole, scene.level(), scene.built->bounds());
}

namespace {

Band row_of(const Camera& camera, std::int32_t row, std::uint8_t* rgb) {
  return {Bytes(rgb, row_bytes(PixelFormat::kRgb888, camera.width_px())), PixelFormat::kRgb888, 0, row, 1};
}

}  // namespace

// Of the picture of every `step`-th pixel, 0: of the finished one.
void FinishedPicture::draw_row(int step, std::int32_t y, std::uint8_t* rgb) const {
  const CompactTree& tree = look_->scene_->tree();
  const auto draw_band = [&](const Camera& camera, const Band& band) {
    check(look_->effects_ == Effect::kNone
              ? render_band(tree, camera, shading_, band)
              : render_lit_band(look_->effects_, tree, camera, shading_, look_->lit_, band));
  };
  const int many = across();
  if (step != 0 || many == 1) {
    const Camera thin = camera().thinned(std::max(step, 1));
    draw_band(thin, row_of(thin, y, rgb));
    return;
  }
  thread_local std::vector<std::uint8_t> samples;
  samples.resize(samples_bytes(width_px(), many));
  const Bytes fine(samples.data(), samples.size());
  draw_band(fine_, {fine, PixelFormat::kRgb888, 0, y * many, many});
  check(average_samples(fine, many, width_px(), y, PixelFormat::kRgb888,
                        Bytes(rgb, row_bytes(PixelFormat::kRgb888, width_px()))));
}

bool FinishedPicture::draw(int step, wide::Threads* threads, std::vector<std::uint8_t>* rgb,
                           const GoesOn& goes_on) const {
  constexpr std::int32_t kRowsAThread = 2;
  const int every = std::max(step, 1);
  const std::int32_t rows = thinned_px(height_px(), every);
  const std::size_t line = 3 * static_cast<std::size_t>(thinned_px(width_px(), every));
  rgb->resize(line * static_cast<std::size_t>(rows));
  const std::int32_t chunk = kRowsAThread * threads->count();
  for (std::int32_t first = 0; first < rows; first += chunk) {
    const std::int32_t count = std::min(chunk, rows - first);
    threads->each(count, [&](int i) {
      draw_row(step, first + i, rgb->data() + line * static_cast<std::size_t>(first + i));
    });
    if (!goes_on(first + count)) {
      return false;
    }
  }
  return true;
}

bool FinishedPicture::is_plain() const {
  return (look_->effects_ & Effect::kWater) == 0;
}

bool FinishedPicture::has_behind() const {
  return (look_->effects_ & Effect::kSky) != 0;
}

void FinishedPicture::draw_quick_row(int step, std::int32_t row, std::uint8_t* rgb) const {
  const Camera thin = camera().thinned(step);
  const CompactTree& tree = look_->scene_->tree();
  check(look_->quick_effects_ == Effect::kNone
            ? render_band(tree, thin, quick_shading_, row_of(thin, row, rgb))
            : render_lit_band(look_->quick_effects_, tree, thin, quick_shading_, look_->quick_,
                              row_of(thin, row, rgb)));
}

void FinishedPicture::draw_behind_row(int step, std::int32_t row, std::uint8_t* rgb) const {
  const Camera thin = camera().thinned(step);
  check(render_lit_band(Effect::kSky, look_->empty_, thin, quick_shading_, look_->lit_,
                        row_of(thin, row, rgb)));
}

}  // namespace thimble::tools::viewer
