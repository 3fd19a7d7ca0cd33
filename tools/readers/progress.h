/// How readers, and what builds from them, say how far they are.
#pragma once

#include <functional>

namespace thimble::tools {

/// Called now and then while reading: fraction done, 0..1. May throw to cancel.
using Progress = std::function<void(double)>;
/// Calls it, unless it is empty.
inline void tell(const Progress& progress, double done) {
  if (progress) {
    progress(done);
  }
}

}  // namespace thimble::tools
