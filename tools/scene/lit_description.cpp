#include "scene/lit_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "output/units.h"
#include "readers/file_bytes.h"
#include "scene/scene_source.h"
#include "thimble/trace/secondary_ray.h"

namespace thimble::tools {
namespace {

constexpr double kHalvingsOfE = 1.4426950408889634;  // 1 / ln 2

// `value` within the limits, in units of 1 / one; NaN is the least.
std::uint16_t fixed(double value, double low, double high, double one) {
  const double clamped = std::isnan(value) ? low : std::clamp(value, low, high);
  return static_cast<std::uint16_t>(std::lround(clamped * one));
}
std::uint8_t share(double value) {
  return static_cast<std::uint8_t>(fixed(value, 0, 1, 255));
}
std::uint16_t q8(double value) {
  constexpr double kMost = 65535.0 / 256;
  const std::uint16_t result = fixed(value, 0, kMost, 256);
  return value > 0 && result == 0 ? std::uint16_t{1} : result;
}

// What else an effect needs to show anything.
EffectSet brought_by(EffectSet effects) {
  constexpr EffectSet kOfEmitters = Effect::kEmission | Effect::kDirectLight | Effect::kShadows;
  return effects | ((effects & Effect::kEmitterLight) != 0 ? kOfEmitters : Effect::kNone) |
         ((effects & Effect::kShadows) != 0 ? Effect::kDirectLight : Effect::kNone);
}

constexpr EffectSet kOfEveryScene = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion |
                                    Effect::kEmission | Effect::kEmitterLight | Effect::kSmoothNormals;
constexpr Light kDefaultSun{};
constexpr std::uint8_t kDefaultOcclusionRays = 8;
constexpr std::uint32_t kDefaultFogDensity = 65536 / 64;

// All that shines, each number by `scale`, which gets the most that it may become; `emit_only`: of surfaces only
// those of that kind glow.
template <class Scale>
void scale_light(LitDescription* lighting, const UsedMaterials& used, bool emit_only, const Scale& scale) {
  const auto scale_16 = [&](std::uint16_t value) {
    return static_cast<std::uint16_t>(scale(std::uint32_t{value}, std::uint32_t{UINT16_MAX}));
  };
  const auto scale_rgb = [&](Rgb8 color) {
    const auto one = [&](std::uint8_t value) {
      return static_cast<std::uint8_t>(scale(std::uint32_t{value}, std::uint32_t{UINT8_MAX}));
    };
    return Rgb8{one(color.r), one(color.g), one(color.b)};
  };
  for (std::vector<Light>* const lights : {&lighting->lights, &lighting->lights_and_glow}) {
    for (Light& light : *lights) {
      for (PackedU16& channel : light.color_q8) {
        channel = scale_16(channel);
      }
    }
  }
  LitScene& rest = lighting->rest;
  for (std::uint16_t& channel : rest.ambient_q8) {
    channel = scale_16(channel);
  }
  for (std::size_t i = 0; i < lighting->surfaces.size(); ++i) {
    Surface& surface = lighting->surfaces[i];
    if (used.is[i] && (!emit_only || surface.kind == SurfaceKind::kEmit)) {
      surface.emission_q8 = scale_16(surface.emission_q8);
    }
    if (used.is[i] && surface.kind == SurfaceKind::kMedia) {
      surface.albedo = scale_rgb(surface.albedo);
    }
  }
  rest.sky = {scale_rgb(rest.sky.zenith), scale_rgb(rest.sky.horizon), scale_rgb(rest.sky.ground)};
  rest.fog.color = scale_rgb(rest.fog.color);
}

constexpr std::size_t kNoteBytes = 12;
constexpr std::uint8_t kNoteVersion = 1;
// By their bits, the lowest first.
constexpr std::array kNoteFlags{&LookNote::is_mesh, &LookNote::is_points, &LookNote::has_colors,
                                &LookNote::has_own_light, &LookNote::has_own_sky};
constexpr std::size_t kOn = 4;
constexpr std::size_t kOff = 8;

// A face that shows: the voxel before it is empty.
struct GlowingFace {
  Vec3i voxel;
  int axis;
  int out;  // 1 or -1
  std::uint8_t material;

  // Its middle, and a little before it, in voxels.
  double place(int of, double before = 0) const {
    return voxel[of] + (of == axis ? (out > 0 ? 1 : 0) + out * before : 0.5);
  }
};

std::vector<GlowingFace> glowing_faces(const CompactTree& tree, const std::vector<Surface>& surfaces) {
  std::vector<GlowingFace> faces;
  const auto glows = [](const Surface& surface) {
    return surface.kind == SurfaceKind::kEmit && surface.emission_q8 != 0;
  };
  if (std::none_of(surfaces.begin(), surfaces.end(), glows)) {
    return faces;
  }
  walk_blocks(tree, [&](const Vec3i& corner, int level, std::uint8_t material) {
    const Surface& surface = surfaces[material];
    if (!glows(surface)) {
      return;
    }
    const std::int32_t side = std::int32_t{1} << level;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int out : {-1, 1}) {
        for (std::int32_t u = 0; u < side; ++u) {
          for (std::int32_t v = 0; v < side; ++v) {
            Vec3i voxel = corner;
            voxel[axis] += out > 0 ? side - 1 : 0;
            voxel[axis == 0 ? 1 : 0] += u;
            voxel[axis == 2 ? 1 : 2] += v;
            Vec3i before = voxel;
            before[axis] += out;
            if (!material_at(tree, before, nullptr)) {
              faces.push_back({voxel, axis, out, material});
            }
          }
        }
      }
    }
  });
  return faces;
}

using Cube = std::array<std::int32_t, 3>;
Cube cube_of(const GlowingFace& face, int k) {
  return {face.voxel.x >> k, face.voxel.y >> k, face.voxel.z >> k};
}

Light lamp_of(const CompactTree& tree, const std::vector<Surface>& surfaces,
              const std::vector<const GlowingFace*>& faces) {
  std::array<double, 3> middle{};
  std::array<double, 3> outwards{};
  std::array<double, 3> shine{};
  const auto area = static_cast<double>(faces.size());
  for (const GlowingFace* face : faces) {
    const Surface& surface = surfaces[face->material];
    const std::array<std::uint8_t, 3> albedo{surface.albedo.r, surface.albedo.g, surface.albedo.b};
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<std::size_t>(i);
      middle[at] += face->place(i) / area;
      shine[at] += albedo[at] / 255.0 * surface.emission_q8;
    }
    outwards[static_cast<std::size_t>(face->axis)] += face->out / area;
  }
  const double one_way = std::min(1.0, std::hypot(outwards[0], outwards[1], outwards[2]));
  Light lamp;
  lamp.is_point = true;
  lamp.reach = 1;
  std::array<std::int32_t, 3> place{};
  for (std::size_t i = 0; i < 3; ++i) {
    lamp.color_q8[i] = static_cast<std::uint16_t>(
        std::clamp(std::lround(shine[i] / M_PI * (1 + one_way)), long{0}, long{65535}));
    place[i] = static_cast<std::int32_t>(std::floor((middle[i] + outwards[i] / 2) * Q8::kOne));
  }
  // Within something that does not glow nothing would come out of it: before the nearest face instead.
  std::uint8_t material = 0;
  if (material_at(tree, {place[0] >> Q8::kBits, place[1] >> Q8::kBits, place[2] >> Q8::kBits}, &material) &&
      surfaces[material].kind != SurfaceKind::kEmit) {
    const auto distance = [&](const GlowingFace* face) {
      return std::hypot(face->place(0) - middle[0], face->place(1) - middle[1], face->place(2) - middle[2]);
    };
    const GlowingFace* nearest = *std::min_element(
        faces.begin(), faces.end(),
        [&](const GlowingFace* a, const GlowingFace* b) { return distance(a) < distance(b); });
    for (std::size_t i = 0; i < 3; ++i) {
      place[i] = static_cast<std::int32_t>(std::floor(nearest->place(static_cast<int>(i), 0.5) * Q8::kOne));
    }
  }
  lamp.place = {place[0], place[1], place[2]};
  return lamp;
}

}  // namespace

std::vector<Light> glow_lamps(const CompactTree& tree, const std::vector<Surface>& surfaces,
                              std::size_t most) {
  const std::vector<GlowingFace> faces = glowing_faces(tree, surfaces);
  std::vector<Light> lamps;
  if (most == 0 || faces.empty()) {
    return lamps;
  }
  std::map<Cube, std::vector<const GlowingFace*>> cubes;
  for (int k = 0; k == 0 || cubes.size() > most; ++k) {
    cubes.clear();
    for (const GlowingFace& face : faces) {
      cubes[cube_of(face, k)].push_back(&face);
      if (cubes.size() > most) {
        break;
      }
    }
  }
  for (const auto& [cube, of_cube] : cubes) {
    lamps.push_back(lamp_of(tree, surfaces, of_cube));
  }
  return lamps;
}

UsedMaterials used_materials(const SceneSource& source) {
  if (source.baked() != nullptr) {
    return used_materials(source.baked()->tree());
  }
  UsedMaterials used;
  if (source.single_material() && source.points() != 0) {
    used.is[0] = true;
    return used;
  }
  source.stream([&](auto, auto, auto, std::uint8_t material) { used.is[material] = true; }, {});
  return used;
}

LitScene LitDescription::lit_scene() const {
  LitScene scene = rest;
  scene.surfaces = {surfaces.data(), surfaces.size()};
  scene.lights = {lights.data(), lights.size()};
  return scene;
}

LitScene LitDescription::drawn(EffectSet effects) const {
  LitScene scene = lit_scene();
  const bool glows = (effects & Effect::kEmitterLight) != 0;
  if (glows && !lights_and_glow.empty()) {
    scene.lights = {lights_and_glow.data(), lights_and_glow.size()};
  }
  return with_defaults(scene, effects, has_own_ambient || glows);
}

void LitDescription::find_glow(const CompactTree& tree) {
  if (has_baked_glow) {
    return;
  }
  const std::vector<Light> lamps =
      glow_lamps(tree, surfaces, std::min(kMostGlowLamps, kMaxLights - std::min(kMaxLights, lights.size())));
  lights_and_glow = lights;
  lights_and_glow.insert(lights_and_glow.end(), lamps.begin(), lamps.end());
}

void LitDescription::expect_glow() {
  if (!has_baked_glow) {
    lights_and_glow = lights;
    lights_and_glow.resize(std::min(kMaxLights, lights.size() + kMostGlowLamps));
  }
}

Surface surface_of(const Material& material) {
  Surface surface;
  surface.albedo = {material.color.r, material.color.g, material.color.b};
  surface.kind = material.kind;
  surface.roughness = share(material.roughness);
  surface.mirror = share(material.metalness > 0 ? material.metalness : material.weight);
  surface.index_q12 = fixed(material.ior, kMinIndexQ12 / 4096.0, kMaxIndexQ12 / 4096.0, 4096);
  if (material.kind == SurfaceKind::kMedia) {
    surface.density_q8 = std::max<std::uint16_t>(1, q8(material.density * kHalvingsOfE));
  } else {
    // Even the clearest shows its colour within some tens of voxels; an opaque one within a few.
    constexpr double kClearest = 1.0 / 16;
    surface.density_q8 =
        q8(kClearest + material.attenuation + (1 - std::clamp(material.transparency, 0.0, 1.0)) / 4);
  }
  const double power = material.emission > 0 ? material.emission : material.weight;
  surface.emission_q8 = q8(power * std::exp2(std::clamp(material.flux, 0.0, 8.0)));
  return surface;
}

Material material_of(const Surface& surface) {
  Material material;
  material.color = {surface.albedo.r, surface.albedo.g, surface.albedo.b};
  material.kind = surface.kind;
  material.roughness = surface.roughness / 255.0;
  material.metalness = surface.mirror / 255.0;
  material.ior = surface.index_q12 / 4096.0;
  material.density = surface.density_q8 / 256.0;
  material.emission = std::min(1.0, surface.emission_q8 / 256.0);
  return material;
}

std::string LitDescription::name_of(std::uint8_t material) const {
  const auto named = material_names.find(material);
  return named == material_names.end() ? std::to_string(material) : named->second;
}

std::vector<Rgb8> colors_of(const Palette& palette) {
  std::vector<Rgb8> colors;
  for (const Material& material : palette) {
    colors.push_back({material.color.r, material.color.g, material.color.b});
  }
  return colors;
}

LitDescription describe_palette(const Palette& palette) {
  LitDescription lit;
  std::transform(palette.begin(), palette.end(), lit.surfaces.begin(), surface_of);
  return lit;
}

LitDescription describe_unlit(const Palette& palette) {
  LitDescription lit = describe_palette(palette);
  for (Surface& surface : lit.surfaces) {
    surface.kind = SurfaceKind::kEmit;
    surface.emission_q8 = 256;
  }
  std::fill(std::begin(lit.rest.ambient_q8), std::end(lit.rest.ambient_q8), std::uint16_t{0});
  lit.has_own_ambient = true;
  lit.on = Effect::kDirectLight;
  lit.off = Effect::kEmitterLight | Effect::kShadows | Effect::kAmbientOcclusion | Effect::kSmoothNormals;
  return lit;
}

LitDescription describe_baked(const BakedLighting& lighting, const Palette& palette) {
  LitDescription lit = describe_palette(palette);
  std::copy(lighting.scene.surfaces.begin(), lighting.scene.surfaces.end(), lit.surfaces.begin());
  lit.lights.assign(lighting.scene.lights.begin(), lighting.scene.lights.end());
  lit.rest = lighting.scene;
  lit.rest.surfaces = {};
  lit.rest.lights = {};
  lit.lights_and_glow = lit.lights;
  lit.has_baked_glow = true;
  lit.has_own_ambient = lit.lights.empty() && (lighting.effects & Effect::kDirectLight) != 0;
  lit.on = lighting.effects;
  lit.off = Effect::kAll & ~lighting.effects;
  return lit;
}

EffectSet called_for(const LitDescription& lit, const UsedMaterials& used) {
  EffectSet set = effects_of(lit.lit_scene(), &used.is) | lit.on;
  if ((set & ~lit.off & Effect::kEmission) != 0) {
    set |= Effect::kEmitterLight;
  }
  if ((lit.off & (Effect::kEmission | Effect::kDirectLight)) != 0) {
    set &= ~Effect::kEmitterLight;
  }
  set = brought_by(set & ~lit.off) & ~lit.off;
  return (set & Effect::kDirectLight) != 0 ? set : set & ~Effect::kShadows;
}

void check_lit_limits(Status status) {
  fail_if(status != Status::kOk, "its lights or surfaces are beyond the limits of a lit picture");
}

LitDescription EffectWishes::lighting(LitDescription lit) const {
  lit.rest.bounces = bounces.value_or(lit.rest.bounces);
  return lit;
}

std::optional<EffectChoice> parse_effects(std::string_view text) {
  EffectChoice choice;
  choice.is_given = true;
  if (text == "auto") {
    return choice;
  }
  choice.automatic = false;
  if (text == "none") {
    return choice;
  }
  if (text == "all") {
    choice.effects = kOfEveryScene;
    choice.on_top = true;
    return choice;
  }
  for (;;) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view name = text.substr(0, comma);
    EffectSet found = name == "ao" ? Effect::kAmbientOcclusion : Effect::kNone;
    for (int bit = 0; bit < Effect::kCount; ++bit) {
      const EffectSet effect = EffectSet{1} << bit;
      found |= name == effect_name(effect) ? effect : Effect::kNone;
    }
    if (found == Effect::kNone || (choice.effects & found) != 0) {
      return std::nullopt;
    }
    choice.effects |= found;
    if (comma == text.size()) {
      return choice;
    }
    text.remove_prefix(comma + 1);
  }
}

std::string effects_text(EffectSet effects) {
  return effects == Effect::kNone ? "none" : joined(effect_list(effects), ",");
}

std::vector<std::string> effect_list(EffectSet effects) {
  std::vector<std::string> names;
  for (int bit = 0; bit < Effect::kCount; ++bit) {
    if ((effects >> bit & 1U) != 0) {
      names.emplace_back(effect_name(EffectSet{1} << bit));
    }
  }
  return names;
}

std::string effect_names() {
  return effects_text(Effect::kAll);
}

EffectSet chosen_effects(const LitDescription& lit, const UsedMaterials& used, const EffectChoice& choice) {
  const EffectSet asked = brought_by(choice.effects);
  const EffectSet set = choice.automatic ? called_for(lit, used)
                        : choice.on_top  ? asked | called_for(lit, used)
                                         : asked;
  if (!choice.smooth) {
    return set;
  }
  return *choice.smooth ? set | Effect::kSmoothNormals : set & ~Effect::kSmoothNormals;
}

LitScene with_defaults(LitScene scene, EffectSet effects, bool sunless) {
  const auto wanted = [effects](EffectSet effect) { return (effects & effect) != 0; };
  if (wanted(Effect::kDirectLight) && scene.lights.empty() && !sunless) {
    scene.lights = {&kDefaultSun, 1};
  }
  scene.has_shadows = scene.has_shadows || wanted(Effect::kShadows);
  scene.has_sky = scene.has_sky || wanted(Effect::kSky);
  scene.has_depth_cue = scene.has_depth_cue || wanted(Effect::kDepthCue);
  if (wanted(Effect::kAmbientOcclusion) && scene.occlusion.rays == 0) {
    scene.occlusion.rays = kDefaultOcclusionRays;
  }
  if (wanted(Effect::kFog) && scene.fog.density_q16 == 0) {
    scene.fog.density_q16 = kDefaultFogDensity;
  }
  return scene;
}

std::vector<std::uint8_t> lighting_section(const LitDescription& lit, const UsedMaterials& used,
                                           EffectSet effects, int level) {
  if (effects == Effect::kNone) {
    return {};
  }
  BakedLighting lighting;
  lighting.effects = effects;
  LitScene& scene = lighting.scene;
  scene = lit_scene_for(lit, used, effects);
  const LitScene plain;
  const auto unwanted = [effects](EffectSet effect) { return (effects & effect) == 0; };
  scene.has_shadows = scene.has_shadows && !unwanted(Effect::kShadows);
  scene.has_depth_cue = scene.has_depth_cue && !unwanted(Effect::kDepthCue);
  if (unwanted(Effect::kAmbientOcclusion)) {
    scene.occlusion = plain.occlusion;
  }
  if (unwanted(Effect::kFog)) {
    scene.fog = plain.fog;
  }
  if (unwanted(Effect::kSky)) {
    scene.has_sky = false;
    scene.sky = plain.sky;
  }
  if (unwanted(Effect::kWater)) {
    scene.has_water = false;
    scene.water = plain.water;
    scene.water_material = plain.water_material;
  }
  std::vector<std::uint8_t> bytes(lighting_bytes(scene));
  fail_if(bytes.empty() || BakedLighting::make(lighting, level, {bytes.data(), bytes.size()}) != Status::kOk,
          "its lights, surfaces or water are beyond the limits of a baked scene");
  return bytes;
}

void dim(LitDescription* lighting, const UsedMaterials& used) {
  scale_light(lighting, used, false, [](std::uint32_t value, std::uint32_t) { return (2 * value + 1) / 3; });
}

void expose_light(std::uint32_t exposure_q8, const UsedMaterials& used, LitDescription* lighting) {
  scale_light(lighting, used, true, [exposure_q8](std::uint32_t value, std::uint32_t most) {
    return std::min((value * exposure_q8 + 128) >> 8, most);
  });
}

std::vector<std::uint8_t> look_section(const LookNote& note) {
  std::vector<std::uint8_t> bytes(kNoteBytes);
  bytes[0] = kNoteVersion;
  for (std::size_t i = 0; i < kNoteFlags.size(); ++i) {
    bytes[1] = static_cast<std::uint8_t>(bytes[1] | (note.*kNoteFlags[i] ? 1U << i : 0U));
  }
  put_little(bytes.data() + kOn, note.on);
  put_little(bytes.data() + kOff, note.off);
  return bytes;
}

std::optional<LookNote> read_look_note(ConstBytes section) {
  if (section.size != kNoteBytes || section.data[0] != kNoteVersion) {
    return std::nullopt;
  }
  LookNote note;
  for (std::size_t i = 0; i < kNoteFlags.size(); ++i) {
    note.*kNoteFlags[i] = (section.data[1] >> i & 1U) != 0;
  }
  note.on = static_cast<EffectSet>(load_bits(section.data + kOn, 4, false)) & Effect::kAll;
  note.off = static_cast<EffectSet>(load_bits(section.data + kOff, 4, false)) & Effect::kAll;
  return note;
}

LitDescription without_rule(const LookNote& note, LitDescription baked) {
  baked.on = note.on;
  baked.off = note.off;
  const LitScene plain;
  if (!note.has_own_sky) {
    baked.rest.has_sky = plain.has_sky;
    baked.rest.sky = plain.sky;
  }
  if (!note.has_own_light) {
    baked.lights.clear();
    baked.lights_and_glow.clear();
    baked.has_baked_glow = false;
    baked.has_own_ambient = false;
    std::copy(std::begin(plain.ambient_q8), std::end(plain.ambient_q8), std::begin(baked.rest.ambient_q8));
    baked.rest.has_shadows = plain.has_shadows;
  }
  return baked;
}

EffectSet expected_effects(const SceneSource& source, const LitDescription& lit, const EffectChoice& choice,
                           UsedMaterials* used) {
  UsedMaterials all;
  std::fill(std::begin(all.is), std::end(all.is), true);
  *used = all;
  const EffectSet most = chosen_effects(lit, all, choice);
  if (most == Effect::kNone || most == chosen_effects(lit, {}, choice)) {
    return most;
  }
  *used = used_materials(source);
  return chosen_effects(lit, *used, choice);
}

LitScene lit_scene_for(const LitDescription& lit, const UsedMaterials& used, EffectSet effects) {
  LitScene scene = lit.drawn(effects);
  if ((effects & Effect::kDirectLight) == 0) {
    scene.lights = {};
  }
  constexpr EffectSet kOfMaterials = Effect::kEmission | Effect::kMirror | Effect::kGlass | Effect::kMedia;
  std::size_t count = 0;
  for (std::size_t i = 0; (effects & kOfMaterials) != 0 && i < scene.surfaces.size; ++i) {
    count = used.is[i] && scene.surfaces[i].kind != SurfaceKind::kDiffuse ? i + 1 : count;
  }
  scene.surfaces.size = count;
  return scene;
}

std::size_t lit_state_bytes(const LitScene& scene, EffectSet effects) {
  const std::size_t tables = scene.surfaces.size * sizeof(Surface) + scene.lights.size * sizeof(Light);
  return lit_render_bytes(effects) + (effects == Effect::kNone ? 0 : tables);
}

RenderCounts totals_of(const LitCounts& counts) {
  RenderCounts all;
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    all.rays += counts.rays[kind];
    all.hits += counts.hits[kind];
    all.node_visits += counts.node_visits[kind];
  }
  all.step_limited = counts.step_limited;
  return all;
}

const char* ray_kind_name(LitRayKind kind) {
  constexpr std::array<const char*, kLitRayKinds> kNames{"primary", "shadow", "occlusion", "mirror",
                                                         "glass",   "media",  "water"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace thimble::tools
