/// What a caller may ask for. This header needs none of the packages that the rest of the wide renderer needs.
#pragma once

namespace thimble::wide {

inline constexpr int kMaxThreads = 256;

}  // namespace thimble::wide
