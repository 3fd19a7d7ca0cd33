#include "common/scene_behind.h"

#include "common/say.h"
#include "thimble/bake/baked_scene.h"

namespace thimble {
namespace {

ConstBytes chosen;

const char* fault_of(ConstBytes bytes) {
  if (bytes.size < kBakedHeaderBytes || bytes.data[0] != 'T' || bytes.data[1] != 'M' ||
      bytes.data[2] != 'S') {
    return "there is none";
  }
  return BakedScene::validate(bytes);
}

}  // namespace

ConstBytes scene_behind(ConstBytes built_in) {
  if (chosen.empty()) {
    const ConstBytes behind{reinterpret_cast<const uint8_t*>(uintptr_t{kSceneMark.place}),
                            kSceneMark.end - kSceneMark.place};
    const char* const wrong = fault_of(behind);
    chosen = wrong == nullptr ? behind : built_in;
    if (wrong != nullptr) {
      say("scene behind the program: ");
      say(wrong);
      say("; shown is the built-in one\n");
    }
  }
  return chosen;
}

}  // namespace thimble
