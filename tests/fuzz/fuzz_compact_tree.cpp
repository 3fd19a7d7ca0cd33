// libFuzzer target: the first 24 bytes choose a ray, the rest is a compact tree, or changes to one of level 9 or 5. Whatever
// it is, it is refused, or tracing it and making its brick map stay inside their bytes, end within the bound and give
// what makes sense; a tree that the validator passes too. The checksum is put right first, or no change would get
// past it.
//
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Iinclude -Itests -DTHIMBLE_DEEP_WORLDS
//       tests/fuzz/fuzz_compact_tree.cpp src/*.cpp -o fuzz_compact_tree
//   ./fuzz_compact_tree -max_len=2048 -timeout=10 corpus/
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "support/compact_damage.h"
#include "support/small_scene.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble;
  std::int32_t numbers[6] = {};
  if (size < sizeof numbers) {
    return 0;
  }
  std::memcpy(numbers, data, sizeof numbers);
  static const std::vector<std::uint8_t> scenes[] = {tests::small_scene(9), tests::small_scene(5)};
  ConstBytes sounds[2];
  for (int i = 0; i < 2; ++i) {
    BakedScene scene;
    (void)BakedScene::open({scenes[i].data(), scenes[i].size()}, &scene);
    sounds[i] = scene.section(SectionKind::kTree);
  }
  std::vector<std::uint8_t> bytes =
      tests::given_or_changed({data + sizeof numbers, size - sizeof numbers}, sounds);
  if (bytes.size() >= kCompactHeaderBytes) {
    tests::repair_checksum({bytes.data(), bytes.size()});
  }
  const ConstBytes view{bytes.data(), bytes.size()};
  const char* fault = CompactTree::validate(view);
  CompactTree tree;
  if (CompactTree::open(view, &tree) != Status::kOk) {
    if (fault == nullptr) {
      std::abort();
    }
    return 0;
  }
  if (tests::map_damaged(tree) != nullptr) {
    std::abort();
  }
  // Brought into the limits of the tree's own level.
  const std::int64_t world_q8 = std::int64_t{Q8::kOne} << tree.level();
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t origin = numbers[axis];
    const std::int64_t span = 9 * world_q8 + 1;
    ray.origin[axis] =
        Q8::from_raw(static_cast<std::int32_t>(((origin % span) + span) % span - 4 * world_q8));
    ray.direction[axis] = numbers[3 + axis] % (kMaxDirection + 1);
  }
  if (check_ray(ray, tree.level()) != Status::kOk) {
    return 0;  // no direction
  }
  if (tests::trace_damaged(tree, ray) != nullptr) {
    std::abort();
  }
  return 0;
}
