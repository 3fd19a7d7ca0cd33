/// CRC-32s of the lit pictures of tests/portable/cases_lit.cpp, one on every machine. They change with the
/// picture that the effects define, and only then.
#pragma once

#include <stdint.h>

#include "thimble/picture/pixel.h"

namespace thimble::golden {

struct LitEntry {
  PixelFormat format;
  uint32_t crc32;
};
inline constexpr LitEntry kLitTable[] = {
    {PixelFormat::kGray4, 0x38736972},  {PixelFormat::kMono1, 0x64719B2F},
    {PixelFormat::kRgb565, 0xC5BCED4C}, {PixelFormat::kRgb888, 0x40498B68},
    {PixelFormat::kRgb888, 0x0D538346}, {PixelFormat::kGray4, 0xC032489E},
    {PixelFormat::kRgb888, 0x9F3DE24B},
};

}  // namespace thimble::golden
