// `thimble effects`: every effect a row, its figures those of two pictures, its files well formed.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>

#include "boards/effect_flash.h"
#include "scene/lit_description.h"
#include "support/check_command.h"
#include "support/json.h"
#include "thimble/light/render.h"

namespace {

using namespace thimble::tests;
using thimble::EffectSet;
namespace tools = thimble::tools;

constexpr const char* kRoom = R"(depth 5
camera eye -20 -26 34 target 16 16 6 fov 45
sun toward -5 -9 16
lamp at 26 6 14 color 255 220 180 reach 12
occlusion rays 4 reach 6
fog color 200 205 210 density 0.015625
material floor color 170 150 130
material mirror metal color 230 230 230 mirror 0.9
material glow emit color 255 210 150 emission 1.5
material mist media color 200 210 220 density 0.05
box floor from 0 0 0 to 32 32 2
box mirror from 18 20 2 to 28 24 16
box mist from 14 4 2 to 20 12 9
ball glow at 26 26 5 radius 3
)";

Json rows_of(const std::string& scene, const Words& more = {}) {
  const TemporaryFolder folder;
  const CommandResult result = check_done(Words{"effects", scene, "--size", "48x36", "--frames", "1",
                                                "--quiet", "--json", folder.path("e.json")} +
                                          more);
  CHECK(result.err.empty());
  const Json rows = read_json(folder.path("e.json"));
  REQUIRE(rows.size() == thimble::Effect::kCount);
  for (int bit = 0; bit < thimble::Effect::kCount; ++bit) {
    CHECK(rows[static_cast<std::size_t>(bit)]["effect"] == thimble::effect_name(EffectSet{1} << bit));
  }
  return rows;
}

// What `thimble render` counts of the same picture with a set of effects.
Json counts_of(const std::string& scene, EffectSet effects) {
  const TemporaryFolder folder;
  check_done({"render", scene, "--size", "48x36", "--shade", "color", "--engine", "ray64", "--effects",
              tools::effects_text(effects), "--quiet", "-o", folder.path("a.ppm"), "--stats",
              folder.path("a.json")});
  return read_json(folder.path("a.json"));
}

void check_nothing(const Json& row) {
  CAPTURE(row.dump());
  CHECK(row["called_for"] == 0);
  CHECK(row["why"] == "");
  for (const auto& [name, value] : row.items()) {
    if (name == "with_ms" || name == "without_ms") {
      CHECK(value.is_null());
    } else if (value.is_number()) {
      CHECK(value == 0);
    }
  }
}

TEST_CASE("effects: what is not called for -> exactly 0 rays, nodes, time, RAM and flash") {
  for (const Json& row : rows_of("spheres")) {
    check_nothing(row);
  }
  int none = 0;
  for (const Json& row : rows_of("water")) {
    if (row["called_for"] == 0) {
      check_nothing(row);
      ++none;
    } else {
      CHECK(row["flash_bytes"] > 0);
      CHECK(row["why"] != "");
    }
  }
  CHECK(none == 9);
}

TEST_CASE("effects: rays of each kind and nodes -> those of two pictures by render") {
  const TemporaryFolder folder;
  for (const std::string& scene : {std::string("water"), folder.write("a.scene", kRoom)}) {
    CAPTURE(scene);
    const Json rows = rows_of(scene);
    EffectSet all = 0;
    for (int bit = 0; bit < thimble::Effect::kCount; ++bit) {
      all |= rows[static_cast<std::size_t>(bit)]["called_for"] == 1 ? EffectSet{1} << bit : 0U;
    }
    for (const Json& row : rows) {
      if (row["called_for"] == 0) {
        continue;
      }
      CAPTURE(row.dump());
      const EffectSet effect = tools::parse_effects(row["effect"].get<std::string>())->effects;
      if (effect == thimble::Effect::kShadows && (all & thimble::Effect::kEmitterLight) != 0) {
        continue;  // render gives what glows shadows, asked or not
      }
      const EffectSet with = effect == thimble::Effect::kDirectLight ? all & ~thimble::Effect::kShadows : all;
      const Json more = counts_of(scene, with);
      const Json less = counts_of(scene, with & ~effect);
      const auto difference = [&](const char* of, const std::string& kind) {
        return more[of][kind].get<std::int64_t>() - less[of][kind].get<std::int64_t>();
      };
      std::int64_t rays = 0;
      std::int64_t visits = 0;
      for (int kind = 0; kind < thimble::kLitRayKinds; ++kind) {
        const std::string name = tools::ray_kind_name(static_cast<thimble::LitRayKind>(kind));
        CHECK(row[name + "_rays"] == difference("rays_by_kind", name));
        rays += difference("rays_by_kind", name);
        visits += difference("node_visits_by_kind", name);
      }
      CHECK(row["rays"] == rays);
      CHECK(row["node_visits"] == visits);
      CHECK(row["q25_ms"] <= row["ms"]);
      CHECK(row["ms"] <= row["q75_ms"]);
      CHECK(row["with_ms"] > 0);
      CHECK(row["without_ms"] > 0);
      for (const thimble::EffectFlash& flash : thimble::kEffectFlash) {
        if (flash.effect == effect) {
          CHECK(row["flash_bytes"] == flash.bytes);
        }
      }
    }
  }
}

TEST_CASE("effects: RAM -> the rays that wait and the tables that only this effect needs") {
  const TemporaryFolder folder;
  const Json rows = rows_of(folder.write("a.scene", kRoom));
  const auto ram = [&](EffectSet effect) {
    std::size_t bit = 0;
    while (EffectSet{1} << bit != effect) {
      ++bit;
    }
    return rows[bit]["ram_bytes"].get<std::size_t>();
  };
  namespace lit = thimble;
  CHECK(ram(lit::Effect::kDirectLight) == 2 * sizeof(lit::Light));
  CHECK(ram(lit::Effect::kShadows) == 0);
  CHECK(ram(lit::Effect::kAmbientOcclusion) == 0);
  CHECK(ram(lit::Effect::kFog) == 0);
  // The table of surfaces is there for the others too.
  CHECK(ram(lit::Effect::kEmission) == 0);
  CHECK(ram(lit::Effect::kMirror) ==
        lit::lit_render_bytes(lit::Effect::kMirror) - lit::lit_render_bytes(lit::Effect::kFog));

  const Json alone = rows_of(folder.write("b.scene", "material m emit\nbox m from 0 0 0 to 2 2 2\n"));
  CHECK(alone[3]["effect"] == "emission");
  CHECK(alone[3]["ram_bytes"] == sizeof(lit::Surface));
}

TEST_CASE("effects: why -> the material, the lights, the line of the scene") {
  const TemporaryFolder folder;
  std::string all;
  for (const Json& row : rows_of(folder.write("a.scene", kRoom))) {
    all += row["why"].get<std::string>() + "\n";
  }
  CHECK(all ==
        "1 distant light, 1 lamp\nits lights cast shadows\n4 rays a face, 6 voxels far\nmaterial glow is "
        "emissive\n"
        "material mirror is metal\n\nmaterial mist is cloud\n\nair that halves light in 64 voxels\n\n\n\n"
        "material glow is emissive\n\n\n");
  const Json asked = rows_of("spheres", {"--effects", "sky,shadows"});
  CHECK(asked[0]["why"] == "asked for");
  CHECK(asked[1]["why"] == "asked for");
  CHECK(asked[9]["called_for"] == 1);
  check_nothing(asked[2]);
}

TEST_CASE("effects: wrong usage -> status 2 and a sentence") {
  for (const Words& more : {Words{"--frames", "0"},
                            {"--frames", "x"},
                            {"--effects", "gloss"},
                            {"--bounces", "9"},
                            {"--memory", "64K"}}) {
    check_refused(Words{"effects", "spheres"} + more, 2, {more[0]});
  }
  check_refused({"effects"}, 2, {"SCENE"});
}

}  // namespace
