#include "scene/default_look.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "output/units.h"
#include "readers/oct.h"
#include "scene/scene_source.h"
#include "thimble/trace/secondary_ray.h"

namespace thimble::tools {

const char* const kDefaultLookText =
    "Without --shade and --effects the scene decides. Colours, from a palette or of points and corners, are "
    "drawn as they are; meshes and surfaces without are clay. A sun stands over the viewer's left shoulder "
    "(the right one where the side on the right is more than twice as large), with exact shadows, occlusion, "
    "a soft gradient behind the scene, and under it a ground that only shows the shadow. Water has ripples. "
    "What a scene states itself (camera, lights, occlusion, sky, effects off) is kept. Round glass shows the "
    "slope of surfaces, not the faces of voxels. Points of which less than 50 % have 3 neighbours are stars: "
    "brightness and colour by depth and size on the picture. A pixel has 4 samples, or 1 where 4 would take "
    "more than 100,000,000 rays, counted in a small picture. The exposure follows the scene. --structure "
    "dense|pool, --engine, --cutoff, --max-depth and --board draw by --shade instead: colours where the "
    "scene "
    "has any, else depth.";

namespace {

constexpr std::uint16_t kAmbient[3] = {92, 98, 112};
constexpr std::uint8_t kOcclusionRays = 16;
// What mirrors and glass show around the scene.
constexpr Sky kStudio{{120, 142, 172}, {214, 218, 222}, {150, 146, 140}};

bool is_solid(const CompactTree& tree, const Vec3i& at) {
  return material_at(tree, at, nullptr);
}

bool has_neighbours(const CompactTree& tree, const Vec3i& at) {
  int found = 0;
  for (int place = 0; place < 27 && found < kSurfaceNeighbours; ++place) {
    const Vec3i offset{place % 3 - 1, place / 3 % 3 - 1, place / 9 - 1};
    found += offset != Vec3i{} && is_solid(tree, {at.x + offset.x, at.y + offset.y, at.z + offset.z}) ? 1 : 0;
  }
  return found == kSurfaceNeighbours;
}

// Per cent of the voxels, of up to 4,096 of them, that have neighbours.
int surface_share(const CompactTree& tree) {
  constexpr std::uint64_t kMost = 4096;
  constexpr std::uint64_t kMany = std::uint64_t{1} << 24;
  const std::uint64_t every = tree.voxel_count() / kMost + 1;
  std::uint64_t seen = 0;
  std::uint64_t asked = 0;
  std::uint64_t have = 0;
  if (tree.voxel_count() > kMany) {
    // Without a walk over all: those that are in no block are counted on from the nodes.
    const std::uint32_t last = tree.node_count() - 1;
    const std::uint64_t end = tree.first_child(last) + static_cast<unsigned>(std::popcount(tree.mask(last)));
    for (std::uint64_t number = tree.node_count(); number < end; number += every) {
      ++asked;
      have += has_neighbours(tree, corner_of(tree, static_cast<std::uint32_t>(number))) ? 1U : 0U;
    }
    const std::uint64_t blocks = (tree.voxel_count() - (end - tree.node_count())) / 8 / every;
    return static_cast<int>(100 * (have + blocks) / (asked + blocks));
  }
  walk_blocks(tree, [&](const Vec3i& corner, int level, std::uint8_t) {
    if (seen++ % every == 0) {
      ++asked;
      have += level > 0 || has_neighbours(tree, corner) ? 1U : 0U;
    }
  });
  return asked == 0 ? 100 : static_cast<int>(100 * have / asked);
}

// Whether a third of the faces of some glass or polished metal lie above a step of one voxel. Those of balls do, and show
// a mosaic unless light sees their slopes; panes and blocks end at once. Blocks of many voxels are flat, and not counted.
bool has_round_glass(const CompactTree& tree, const LitDescription& lighting) {
  constexpr int kOthers = 2;
  std::array<std::int32_t, kMaxSurfaces> balance{};
  const auto is_clear = [](const Surface& surface) {
    return surface.kind == SurfaceKind::kGlass ||
           (surface.kind == SurfaceKind::kMetal && surface.mirror >= 128 && surface.roughness == 0);
  };
  if (std::none_of(lighting.surfaces.begin(), lighting.surfaces.end(), is_clear)) {
    return false;
  }
  walk_blocks(tree, [&](const Vec3i& voxel, int level, std::uint8_t material) {
    if (level > 0 || !is_clear(lighting.surfaces[material])) {
      return;
    }
    const auto has = [&](Vec3i at, int axis, int by) {
      at[axis] += by;
      std::uint8_t found = 0;
      return material_at(tree, at, &found) && found == material;
    };
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      const int up = face % 2 == 0 ? -1 : 1;
      if (has(voxel, axis, up)) {
        continue;
      }
      bool has_step = false;
      for (int side = 0; side < 6; ++side) {
        Vec3i beside = voxel;
        beside[side / 2] += side % 2 == 0 ? -1 : 1;
        has_step = has_step || (side / 2 != axis && !has(beside, axis, 0) && has(beside, axis, -up));
      }
      balance[material] += has_step ? kOthers : -1;
    }
  });
  return std::any_of(balance.begin(), balance.end(), [](std::int32_t faces) { return faces > 0; });
}

// An axis of the picture as integers of 2^10.
Vec3i short_vector(const Real3& v) {
  constexpr double kLength = 1024;
  const double scale = kLength / std::sqrt(dot(v, v));
  return {to_fixed(v[0], scale), to_fixed(v[1], scale), to_fixed(v[2], scale)};
}

// Towards a sun behind the viewer, to a side and above: what is seen is lit, and no two sides of a corner
// alike. To the left, but where of the two upright sides of the box that are seen the one on the right takes more than
// twice the picture of the other, which would then lie in the dim.
Vec3i sun_over_shoulder(const SceneCamera& camera, const VoxelBox& box) {
  const PictureAxes axes(camera);
  const Vec3i right = short_vector(axes.right);
  const Vec3i up = short_vector(axes.up);
  const Vec3i forward = short_vector(axes.forward);
  std::int64_t seen[2];
  for (int axis = 0; axis < 2; ++axis) {
    seen[axis] = std::abs(std::int64_t{forward[axis]}) * (box.high[1 - axis] - box.low[1 - axis]);
  }
  const int larger = seen[1] > seen[0] ? 1 : 0;
  // Its normal points against the view; the picture's right is level.
  const std::int32_t normal = forward[larger] > 0 ? -1 : 1;
  const bool is_from_right =
      !box.empty() && seen[larger] > 2 * seen[1 - larger] && normal * right[larger] > 0;
  Vec3i sun;
  for (int axis = 0; axis < 3; ++axis) {
    sun[axis] = -7 * forward[axis] / 8 + (is_from_right ? 1 : -1) * (right[axis] / 2) + up[axis] / 2;
  }
  return sun;
}

std::uint16_t occlusion_reach(const VoxelBox& bounds) {
  const std::int32_t longest =
      std::max({bounds.high.x - bounds.low.x, bounds.high.y - bounds.low.y, bounds.high.z - bounds.low.z});
  return static_cast<std::uint16_t>(std::clamp(longest / 10, 4, 48));
}

SceneFacts facts_without_shape(const SceneSource& source, const LitDescription& lighting) {
  SceneFacts facts;
  facts.has_colors = source.has_colors();
  facts.is_points = source.is_point_set();
  facts.is_mesh = source.is_mesh() || source.is_landscape();
  facts.lighting = lighting;
  if (const std::optional<LookNote> note = source.look_note()) {
    facts.has_colors = note->has_colors;
    facts.is_points = note->is_points;
    facts.is_mesh = note->is_mesh;
    facts.lighting = without_rule(*note, lighting);
  }
  facts.palette = colors_of(source.palette());
  return facts;
}

// The rule's light, where the scene states none.
void add_sun(const SceneFacts& facts, const Framing& framing, LitDescription* lighting) {
  lighting->lights.assign(1, {false, sun_over_shoulder(framing.kept, facts.bounds), {196, 188, 172}});
  std::copy(std::begin(kAmbient), std::end(kAmbient), std::begin(lighting->rest.ambient_q8));
  lighting->rest.has_shadows = (facts.lighting.off & Effect::kShadows) == 0;
}

void use_clay(Look* look) {
  look->palette.assign(look->palette.size(), kClay);
  for (Surface& surface : look->lighting.surfaces) {
    surface.albedo = kClay;
  }
}

std::string look_text(const SceneFacts& facts, const Look& look, bool own_light) {
  if (look.kind == LookKind::kStars) {
    return concat("stars: ", facts.surface_share, " % of the points have ", kSurfaceNeighbours,
                  " neighbours, less than ", kSurfaceShare, " %");
  }
  std::string text = facts.has_colors ? "its colours" : "clay";
  text += own_light ? ", its own light" : ", a sun over the viewer's shoulder";
  text += ", effects " + effects_text(look.effects);
  return text + (look.ground.is_there ? ", a ground" : ", no ground");
}

double mean(const PackedU16 (&channels)[3]) {
  return (channels[0] + channels[1] + channels[2]) / 3.0;
}

}  // namespace

LookNote note_of(const SceneFacts& facts) {
  const LitDescription& lit = facts.lighting;
  return {.is_mesh = facts.is_mesh,
          .is_points = facts.is_points,
          .has_colors = facts.has_colors,
          .has_own_light = states_light(lit),
          .has_own_sky = lit.rest.has_sky,
          .on = lit.on,
          .off = lit.off};
}

bool states_light(const LitDescription& lighting) {
  const LitScene plain;
  return !lighting.lights.empty() || (lighting.off & Effect::kDirectLight) != 0 ||
         !std::equal(std::begin(plain.ambient_q8), std::end(plain.ambient_q8),
                     std::begin(lighting.rest.ambient_q8));
}

SceneFacts facts_expected(const SceneSource& source, const LitDescription& lighting) {
  SceneFacts facts = facts_without_shape(source, lighting);
  expected_effects(source, facts.lighting, {}, &facts.used);
  if (source.look_note()) {
    facts.lighting.expect_glow();
  }
  return facts;
}

SceneFacts facts_of(const SceneSource& source, const LitDescription& lighting, const SceneShape& shape) {
  SceneFacts facts = facts_without_shape(source, lighting);
  facts.bounds = shape.bounds;
  if (source.look_note()) {
    facts.lighting.find_glow(*shape.tree);
  }
  facts.used = used_materials(*shape.tree);
  facts.surface_share = facts.is_points ? surface_share(*shape.tree) : 100;
  facts.has_round_glass = has_round_glass(*shape.tree, facts.lighting);
  return facts;
}

bool parse_background(std::string_view text, Background* background) {
  if (text == "none" || text == "gradient") {
    background->kind = text == "none" ? BackgroundKind::kNone : BackgroundKind::kGradient;
    return true;
  }
  const auto number = number_in<std::uint32_t>(text, 16);
  if (text.size() != 6 || !number) {
    return false;
  }
  const std::uint32_t color = *number;
  background->kind = BackgroundKind::kColor;
  background->color = {static_cast<std::uint8_t>(color >> 16), static_cast<std::uint8_t>(color >> 8 & 255U),
                       static_cast<std::uint8_t>(color & 255U)};
  return true;
}

LitScene Look::lit_scene() const {
  return lit_scene_for(lighting, used, effects);
}

Look default_look(const SceneFacts& facts, const LookWishes& wishes, const Framing& framing) {
  Look look;
  look.lighting = facts.lighting;
  look.used = facts.used;
  look.palette = facts.palette;
  look.has_own_colors = facts.has_colors;
  look.background = wishes.background;
  LitDescription& lighting = look.lighting;
  const EffectSet off = lighting.off;
  const bool own_light = states_light(lighting);
  if (!own_light) {
    add_sun(facts, framing, &lighting);
    // What glows stays behind the sun that came instead of the lights.
    const std::vector<Light>& found = facts.lighting.lights_and_glow;
    const auto own = static_cast<std::ptrdiff_t>(std::min(found.size(), facts.lighting.lights.size()));
    lighting.lights_and_glow = lighting.lights;
    lighting.lights_and_glow.insert(lighting.lights_and_glow.end(), found.begin() + own, found.end());
  }
  if (is_clay(facts)) {
    use_clay(&look);
  }
  look.ground.reach = occlusion_reach(facts.bounds);
  if (lighting.rest.occlusion.rays == 0 && (off & Effect::kAmbientOcclusion) == 0) {
    lighting.rest.occlusion = {kOcclusionRays, 200, look.ground.reach};
  }
  // Where the core draws air or water the sky is its own as well.
  const EffectSet called = called_for(lighting, facts.used);
  const bool has_air = (called & (Effect::kWater | Effect::kFog)) != 0;
  const bool own_sky = lighting.rest.has_sky;
  const bool reflects = (called & (Effect::kMirror | Effect::kGlass | Effect::kWater)) != 0;
  if (!own_sky && (off & Effect::kSky) == 0 && (reflects || has_air)) {
    lighting.rest.has_sky = true;
    lighting.rest.sky = kStudio;
  }
  look.has_backdrop = !has_air && (!own_sky || wishes.background.kind != BackgroundKind::kAuto);
  if (look.background.kind == BackgroundKind::kAuto) {
    look.background.kind = BackgroundKind::kGradient;
  }
  const bool is_bent = facts.is_mesh || facts.is_points || facts.has_round_glass;
  const bool smooth = wishes.smooth.value_or(is_bent && (off & Effect::kSmoothNormals) == 0);
  look.effects = called_for(lighting, facts.used) | (smooth ? Effect::kSmoothNormals : Effect::kNone);
  if (!smooth && wishes.smooth) {
    look.effects &= ~Effect::kSmoothNormals;
  }
  if ((look.effects & Effect::kWater) != 0 && (off & Effect::kRipples) == 0) {
    look.effects |= Effect::kRipples;
  }
  const bool has_sun = !lighting.lights.empty() && !lighting.lights[0].is_point;
  look.ground.toward_sun = has_sun ? Vec3i(lighting.lights[0].place) : Vec3i{0, 0, 1};
  look.ground.z = facts.bounds.low.z;
  look.ground.is_there = look.has_backdrop && wishes.ground.value_or(!own_light) && !facts.bounds.empty();
  look.kind = facts.forms_surface() ? LookKind::kLit : LookKind::kStars;

  look.at_edges = wishes.at_edges;
  look.across = wishes.across != 0 ? wishes.across : 2;
  dim(&lighting, look.used);
  look.text = look_text(facts, look, own_light);
  return look;
}

LitDescription baked_look(const SceneFacts& facts, const Framing& framing) {
  LitDescription lighting = facts.lighting;
  if (!states_light(lighting) && facts.forms_surface()) {
    add_sun(facts, framing, &lighting);
  }
  if ((facts.is_mesh || facts.is_points) && facts.forms_surface()) {
    lighting.on |= Effect::kSmoothNormals & ~lighting.off;
  }
  return lighting;
}

bool add_baked_sky(const SceneFacts& facts, LitDescription* lighting) {
  if (lighting->rest.has_sky || (lighting->off & Effect::kSky) != 0 || states_light(facts.lighting) ||
      !facts.forms_surface()) {
    return false;
  }
  lighting->rest.has_sky = true;
  lighting->rest.sky = {kSoftTop, kSoftTop, kSoftMiddle};
  return true;
}

void quick_light(const LitScene& scene, std::uint16_t (&face_light)[6]) {
  constexpr double kLamps = 100;
  double lights[6];
  for (int face = 0; face < 6; ++face) {
    double& light = lights[face];
    light = (scene.ambient_q8[0] + scene.ambient_q8[1] + scene.ambient_q8[2]) / 3.0;
    bool has_lamps = scene.lights.size == 0;
    for (const Light& each : scene.lights) {
      const Vec3i place = each.place;
      const double length = std::hypot(static_cast<double>(place.x), place.y, place.z);
      const double along = (face % 2 == 0 ? -1.0 : 1.0) * place[face / 2];
      has_lamps = has_lamps || each.is_point;
      light += each.is_point || length == 0 ? 0 : std::max(0.0, along / length) * mean(each.color_q8);
    }
    light += has_lamps ? kLamps : 0;
  }
  const double most = std::max(256.0, *std::max_element(std::begin(lights), std::end(lights)));
  std::transform(std::begin(lights), std::end(lights), std::begin(face_light),
                 [most](double light) { return static_cast<std::uint16_t>(256 * light / most); });
}

ToneTable quick_tone(const Look& look, std::uint32_t exposure_q8) {
  return tone_table(exposure_q8 == kOwnColorsQ8 ? exposure_q8
                                                : exposure_q8 * (look.has_backdrop ? 7U : 8U) / 8);
}

QuickLook quick_look(const Look& look, const ToneTable& tone) {
  QuickLook quick{};
  quick_light(look.lit_scene(), quick.face_light);
  const unsigned most =
      std::max<unsigned>(1, *std::max_element(std::begin(quick.face_light), std::end(quick.face_light)));
  for (std::uint16_t& light : quick.face_light) {
    light = static_cast<std::uint16_t>(256U * light / most);
  }
  const auto toned = [&](std::uint8_t channel) { return tone[channel * most / 256]; };
  for (const Rgb8 color : look.palette) {
    quick.palette.push_back({toned(color.r), toned(color.g), toned(color.b)});
  }
  return quick;
}

}  // namespace thimble::tools
