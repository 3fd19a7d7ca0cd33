/// CRC-32 of the golden frame of each format behind kRgb888 (tests/portable/cases_panels.cpp), one on every machine.
#pragma once

#include <stdint.h>

namespace thimble::golden {

struct PanelEntry {
  const char* format;
  uint32_t crc32;
};
inline constexpr PanelEntry kPanelTable[] = {
    {"rgb565_be", 0x8F74C7F5},   {"bgr565", 0x82565BEE},    {"rgb444", 0x26759A66},
    {"mono1_pages", 0x31C3F260}, {"gray4_low", 0x34427886}, {"gray2", 0x6E664801},
    {"paper3", 0xB8054594},      {"paper7", 0xBB7DB6DC},    {"rgb332", 0x209AB466},
};

}  // namespace thimble::golden
