// libFuzzer target: any bytes as a .scene file. It becomes a scene within every stated limit, or an
// InputError that begins with a place; no other file is opened.
//
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Iinclude -Itools
//       tests/fuzz/fuzz_scene_text.cpp tools/readers/{scene_text,text}.cpp tools/output/units.cpp
//       src/*.cpp -o fuzz_scene_text
//   ./fuzz_scene_text -max_len=4096 -timeout=10 corpus/
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <variant>

#include "readers/formats.h"
#include "readers/scene_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  using namespace thimble::tools;
  const auto require = [](bool condition) {
    if (!condition) {
      std::abort();
    }
  };
  try {
    const Source source = read_scene_text({{data, size}, nullptr}, {}, {});
    const SceneText& scene = *std::get<std::shared_ptr<const SceneText>>(source);
    require(!scene.parts.empty() && scene.parts.size() <= kSceneTextParts);
    require(scene.materials.size() <= kSceneTextMaterials && scene.lights.size() <= kMaxLights);
    for (const SceneText::Part& part : scene.parts) {
      require(part.kind == SceneText::PartKind::kModel || part.material < scene.materials.size());
      require(part.axis[0] != part.axis[1] && part.axis[1] != part.axis[2] && part.axis[0] != part.axis[2]);
      require(part.axis[0] < 3 && part.axis[1] < 3 && part.axis[2] < 3);
      for (const std::int16_t material : part.replaced) {
        require(material < static_cast<std::int16_t>(scene.materials.size()));
      }
    }
    for (const SceneText::NamedSurface& material : scene.materials) {
      require(material.surface.index_q12 >= kMinIndexQ12 && material.surface.index_q12 <= kMaxIndexQ12);
    }
    for (const SceneText::PlacedLight& light : scene.lights) {
      require(light.light.is_point || !(light.light.place == PackedVec3i()));
      require(light.light.reach != 0);
    }
    require((scene.on & scene.off) == 0 && scene.rest.bounces <= kMaxBounces);
  } catch (const InputError& error) {
    const std::string what = error.what();
    require(what.starts_with("line ") || what.starts_with("holds "));
    require(what.find('\n') == std::string::npos);
  }
  return 0;
}
