// Every golden frame of tests/golden, drawn by the library that this is linked with; exit status 1 where a CRC differs.
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "golden/golden_table.h"
#include "golden/scenes.h"
using namespace thimble;
using namespace thimble::golden;

namespace {
alignas(8) std::uint8_t arena_bytes[std::size_t{256} << 10];
std::uint8_t band[std::size_t{61} * 37 * 3 + 4096];
}  // namespace

int main() {
  int wrong = 0;
  for (int f = 0; f < frame_count(); ++f) {
    const Frame& shown = frame(f);
    Arena arena{Bytes(arena_bytes)};
    World world;
    std::uint32_t crc = 0;
    Status status = build_scene(shown.scene, variant(0).structure, &arena, &world);
    if (status == Status::kOk) {
      status = frame_crc32(shown, world, variant(0).width, variant(0).band_rows, Bytes(band), &crc, nullptr);
    }
    if (status != Status::kOk || crc != kGoldenTable[f].crc32) {
      std::printf("%s: %s, %08lX, not %08lX\n", shown.name, status_text(status),
                  static_cast<unsigned long>(crc), static_cast<unsigned long>(kGoldenTable[f].crc32));
      ++wrong;
    }
  }
  std::printf("%d golden frames, %d wrong\n", frame_count(), wrong);
  return wrong == 0 && frame_count() > 0 ? 0 : 1;
}
