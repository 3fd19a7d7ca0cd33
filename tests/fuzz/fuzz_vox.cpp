// libFuzzer target: any bytes as a .vox file. Whatever they are, reading ends in a model that keeps its
// promises or in an InputError; anything else (another exception, a read outside the bytes, a hang) is a
// finding.
//
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Itools tests/fuzz/fuzz_vox.cpp
//       tools/readers/vox*.cpp tools/readers/file_bytes.cpp -lz -o fuzz_vox
//   ./fuzz_vox -max_len=8192 -timeout=10 -rss_limit_mb=512 corpus/
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "readers/formats.h"

namespace {

struct Enough {};  // thrown out of for_each: a small file may place very many voxels

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thimble::tools;
  try {
    const Source source = read_vox({{data, size}, nullptr}, {}, {});
    const auto& model = std::get<std::unique_ptr<VoxelModel>>(source);
    const auto sides = model->size();
    int visited = 0;
    model->for_each([&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
      if (x < 0 || y < 0 || z < 0 || x >= sides[0] || y >= sides[1] || z >= sides[2] || material == 0) {
        std::abort();
      }
      if (++visited == 1 << 16) {
        throw Enough{};
      }
    });
    if ((visited == 0) != (sides[0] == 0)) {
      std::abort();
    }
  } catch (const InputError& error) {
    if (error.what()[0] == '\0') {
      std::abort();
    }
  } catch (const Enough&) {
  }
  return 0;
}
