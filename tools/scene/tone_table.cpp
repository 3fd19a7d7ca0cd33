#include "scene/tone_table.h"

namespace thimble::tools {

uint32_t bright_gray(const GrayCounts& counts, uint64_t part) {
  uint64_t total = 0;
  for (const uint32_t count : counts.of) {
    total += count;
  }
  uint64_t above = 0;
  for (uint32_t gray = 256; total != 0 && gray-- > 0;) {
    above += counts.of[gray];
    if (part * above >= total) {
      return gray == 0 ? 1 : gray;
    }
  }
  return 0;
}

uint32_t exposure_q8(const GrayCounts& counts) {
  const uint32_t gray = bright_gray(counts, 10);
  if (gray == 0) {
    return 256;
  }
  const uint32_t exposure = kExposedGray * 256 * 2 / (3 * gray);
  return exposure < kLeastExposureQ8  ? kLeastExposureQ8
         : exposure > kMostExposureQ8 ? kMostExposureQ8
                                      : exposure;
}

ToneTable tone_table(uint32_t exposure_q8) {
  const bool is_exposed = exposure_q8 != kOwnColorsQ8;
  const uint32_t brightness_q8 = is_exposed ? exposure_q8 : 256;
  const uint32_t knee = is_exposed ? 200 : 255;
  const uint32_t rest = 255 - knee;
  ToneTable table;
  for (uint32_t value = 0; value < 256; ++value) {
    const uint32_t bright = (value * brightness_q8 * 3 + 256) / 512;
    const uint32_t over = bright > knee ? bright - knee : 0;
    table.of[value] = static_cast<uint8_t>(over == 0 ? bright : knee + rest * over / (over + rest));
  }
  return table;
}

}  // namespace thimble::tools
