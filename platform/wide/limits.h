/// @file limits.h
/// What a caller may ask for. This header needs none of the packages that the rest of the wide renderer needs.
#ifndef THIMBLE_PLATFORM_WIDE_LIMITS_H
#define THIMBLE_PLATFORM_WIDE_LIMITS_H

namespace thimble::wide {

inline constexpr int kMaxThreads = 256;

}  // namespace thimble::wide

#endif
