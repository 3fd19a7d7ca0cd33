// libFuzzer target: the first 12 bytes choose a direction, the rest is a baked scene, or changes to one of level 9 or, with
// light, of level 5, with its brick map. Whatever it is, it is refused, or using it stays inside its bytes, ends within the
// bound and gives answers that make sense. The checksums are put right first, or no change would get past them.
//
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Iinclude -Itests -DTHIMBLE_DEEP_WORLDS
//       tests/fuzz/fuzz_baked_scene.cpp src/*.cpp -o fuzz_baked_scene
//   ./fuzz_baked_scene -max_len=4096 -timeout=10 corpus/
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "support/baked_damage.h"
#include "support/small_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  std::int32_t numbers[3] = {};
  if (size < sizeof numbers) {
    return 0;
  }
  std::memcpy(numbers, data, sizeof numbers);
  static const std::vector<std::uint8_t> deep = tests::small_scene(9);
  static const std::vector<std::uint8_t> small = tests::small_scene(5);
  std::vector<std::uint8_t> scene =
      tests::given_or_changed({data + sizeof numbers, size - sizeof numbers},
                              {{deep.data(), deep.size()}, {small.data(), small.size()}});
  tests::repair_baked_checksums({scene.data(), scene.size()});
  if (tests::use_damaged({scene.data(), scene.size()}, {numbers[0], numbers[1], numbers[2]}) != nullptr) {
    std::abort();
  }
  return 0;
}
