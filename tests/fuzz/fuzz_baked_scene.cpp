// libFuzzer target: the first 12 bytes choose a direction, the rest is a baked scene. Whatever it is, it is
// refused, or using it stays inside its bytes, ends within the bound and gives answers that make sense. The
// checksums are put right first, or no change would get past them.
//
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Iinclude -Itests
//       tests/fuzz/fuzz_baked_scene.cpp src/*.cpp -o fuzz_baked_scene
//   ./fuzz_baked_scene -max_len=2048 -timeout=10 corpus/
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "support/baked_damage.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  std::int32_t numbers[3] = {};
  if (size < sizeof numbers) {
    return 0;
  }
  std::memcpy(numbers, data, sizeof numbers);
  const std::size_t scene_size = size - sizeof numbers;
  const std::unique_ptr<std::uint8_t[]> bytes(new std::uint8_t[scene_size]);
  std::memcpy(bytes.get(), data + sizeof numbers, scene_size);
  tests::repair_baked_checksums({bytes.get(), scene_size});
  if (tests::use_damaged({bytes.get(), scene_size}, {numbers[0], numbers[1], numbers[2]}) != nullptr) {
    std::abort();
  }
  return 0;
}
