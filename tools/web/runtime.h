/// What Debian's C++ library for WebAssembly lacks and the readers use; included before every file of the
/// module.
///
/// Its std::from_chars takes no floating point. The overload here takes what the standard's does: no blanks,
/// no `+`, no `0x`; and rounds as it does, since the C library's strtod is exact.
#pragma once

#include <charconv>

namespace std {

from_chars_result from_chars(const char* first, const char* last, double& value);

}  // namespace std
