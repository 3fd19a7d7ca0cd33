// Statements of a `.scene` file: how the world is seen and lit.
#include <algorithm>

#include "readers/scene_statements.h"
#include "readers/text.h"
#include "thimble/light/scene.h"
#include "thimble/trace/ray.h"

namespace thimble::tools::statements {
namespace {

// Light of a colour times a brightness.
struct Tinted {
  Rgb8 tint;
  double brightness;

  Clause color(TextLine& line) {
    return {"color", [this, &line](const Word&) { tint = line.color(); }};
  }
  Clause brightness_of(TextLine& line) {
    constexpr double kMostBrightness = 100;
    return {"brightness",
            [this, &line](const Word&) { brightness = line.real("brightness", 0, kMostBrightness); }};
  }
  std::array<std::uint16_t, 3> color_q8() const {
    const auto channel = [this](std::uint8_t value) {
      return static_cast<std::uint16_t>(to_fixed(value / 255.0 * brightness, 256));
    };
    return {channel(tint.r), channel(tint.g), channel(tint.b)};
  }
};

std::array<double, 3> direction(TextLine& line, const Word& word) {
  const std::string name(word.text);
  const std::array<double, 3> result = line.three_reals(name, -kMostDirection, kMostDirection);
  if (largest(result) == 0) {
    fail_at(word.place, name, " 0 0 0 has no direction");
  }
  return result;
}

void read_light(TextLine& line, TextPlace place, SceneText* scene, bool is_point) {
  if (scene->lights.size() == kMaxLights) {
    fail_at(place, "there are more lights than the limit of ", kMaxLights);
  }
  Clauses clauses(is_point ? "lamp" : "sun", &line);
  Light light;
  light.is_point = is_point;
  Tinted tinted{{255, 255, 255}, 1};
  std::vector<Clause> known;
  if (is_point) {
    known.push_back({"at", [&](const Word&) {
                       const Vec3Q8 at = to_q8(line.three_reals("at", -kFar, kFar));
                       light.place = {at.x.raw, at.y.raw, at.z.raw};
                     }});
    known.push_back({"reach", [&](const Word&) {
                       light.reach = static_cast<std::uint16_t>(line.whole("reach", 1, 65535));
                     }});
  } else {
    known.push_back({"toward", [&](const Word& word) {
                       light.place = to_integers(direction(line, word), kMaxLightComponent);
                     }});
  }
  known.push_back(tinted.color(line));
  known.push_back(tinted.brightness_of(line));
  clauses.read(known);
  clauses.need(known.front().word);
  const auto color_q8 = tinted.color_q8();
  std::copy(color_q8.begin(), color_q8.end(), light.color_q8);
  scene->lights.push_back({light, place});
}

}  // namespace

void camera(TextLine& line, TextPlace place, SceneText* scene) {
  Clauses clauses("camera", &line);
  SceneCamera result;
  std::array<double, 3> eye{};
  std::array<double, 3> target{};
  std::array<double, 3> up{};
  const auto check_projection = [&](const Word& word) {
    if (clauses.has("fov") && clauses.has("span")) {
      fail_at(word.place, "fov is for perspective and span for parallel rays: there is one or the other");
    }
  };
  clauses.read({
      {"eye", [&](const Word&) { eye = line.three_reals("eye", -kFar, kFar); }},
      {"target", [&](const Word&) { target = line.three_reals("target", -kFar, kFar); }},
      {"up", [&](const Word& word) { up = direction(line, word); }},
      {"fov",
       [&](const Word& word) {
         result.fov_degrees = Q16::from_raw(to_fixed(line.real("fov", 1, 120), Q16::kOne));
         check_projection(word);
       }},
      {"span",
       [&](const Word& word) {
         result.is_perspective = false;
         result.span = Q14::from_raw(std::max(1, to_fixed(line.real("span", 0, 131071), Q14::kOne)));
         check_projection(word);
       }},
  });
  clauses.need("eye");
  clauses.need("target");
  const Real3 forward = minus(target, eye);
  result.eye = to_q8(eye);
  result.target = to_q8(target);
  if (largest(forward) == 0) {
    fail_at(place, "eye and target of the camera are the same point");
  }
  result.forward = to_integers(forward, kMaxViewComponent);
  result.up = largest(up) == 0 ? Vec3i{} : to_integers(up, kMaxViewComponent);
  scene->camera = result;
  scene->camera_place = place;
}

void sun(TextLine& line, TextPlace place, SceneText* scene) {
  read_light(line, place, scene, false);
}
void lamp(TextLine& line, TextPlace place, SceneText* scene) {
  read_light(line, place, scene, true);
}

void ambient(TextLine& line, TextPlace, SceneText* scene) {
  scene->has_ambient = true;
  Tinted tinted{{191, 213, 255}, 0.375};
  Clauses("ambient", &line).read({tinted.color(line), tinted.brightness_of(line)});
  const auto color_q8 = tinted.color_q8();
  std::copy(color_q8.begin(), color_q8.end(), scene->rest.ambient_q8);
}

void sky(TextLine& line, TextPlace, SceneText* scene) {
  Sky& sky = scene->rest.sky;
  scene->rest.has_sky = true;
  Clauses("sky", &line)
      .read({{"zenith", [&](const Word&) { sky.zenith = line.color(); }},
             {"horizon", [&](const Word&) { sky.horizon = line.color(); }},
             {"ground", [&](const Word&) { sky.ground = line.color(); }}});
}

void fog(TextLine& line, TextPlace, SceneText* scene) {
  Fog& fog = scene->rest.fog;
  Clauses clauses("fog", &line);
  clauses.read({{"color", [&](const Word&) { fog.color = line.color(); }},
                {"density", [&](const Word&) {
                   const double density = line.real("density", 0, kMostDensity);
                   fog.density_q16 =
                       static_cast<std::uint32_t>(std::max(to_fixed(density, 65536), density > 0 ? 1 : 0));
                 }}});
  clauses.need("density");
}

void occlusion(TextLine& line, TextPlace, SceneText* scene) {
  Occlusion& result = scene->rest.occlusion;
  result.rays = 8;
  Clauses("occlusion", &line)
      .read({{"rays",
              [&](const Word& word) {
                const std::int32_t rays = line.whole("rays", 4, 32);
                if (rays != 4 && rays != 8 && rays != 16 && rays != 32) {
                  fail_at(word.place, "rays is ", rays, ", it must be 4, 8, 16 or 32");
                }
                result.rays = static_cast<std::uint8_t>(rays);
              }},
             {"reach",
              [&](const Word&) { result.reach = static_cast<std::uint16_t>(line.whole("reach", 1, 4096)); }},
             {"strength", [&](const Word&) { result.strength = line.share("strength"); }}});
}

void effects(TextLine& line, TextPlace, SceneText* scene) {
  constexpr EffectSet kEffectsOfLight = Effect::kShadows | Effect::kEmitterLight;
  const Word which = line.word();
  if (which.text != "on" && which.text != "off") {
    fail_at(which.place, "effects needs on or off", which.empty() ? "" : ", not " + quoted(which.text));
  }
  EffectSet& set = which.text == "on" ? scene->on : scene->off;
  bool any = false;
  for (; !any || !line.at_end(); any = true) {
    const Word word = line.word();
    EffectSet found = Effect::kNone;
    std::string known;
    for (int bit = 0; bit < Effect::kCount; ++bit) {
      const std::string_view name = effect_name(EffectSet{1} << bit);
      found |= name == word.text ? EffectSet{1} << bit : Effect::kNone;
      known += (bit == 0 ? "" : ", ") + std::string(name);
    }
    if (found == Effect::kNone) {
      fail_at(word.place,
              word.empty() ? "the name of an effect is missing" : quoted(word.text) + " is no effect",
              "; there are ", known);
    }
    if (((scene->on | scene->off) & found) != 0) {
      fail_at(word.place, word.text, " is turned on or off twice");
    }
    set |= found;
    if ((scene->off & Effect::kDirectLight) != 0 && (scene->on & kEffectsOfLight) != 0) {
      fail_at(word.place,
              "without direct-light there are no shadows and no emitter-light: one is on, the other off");
    }
  }
}

}  // namespace thimble::tools::statements
