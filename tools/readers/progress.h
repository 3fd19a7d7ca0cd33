/// @file progress.h
/// How readers, and what builds from them, say how far they are.
#ifndef THIMBLE_TOOLS_READERS_PROGRESS_H
#define THIMBLE_TOOLS_READERS_PROGRESS_H

#include <functional>

namespace thimble::tools {

/// Called now and then while reading: fraction done, 0..1. May throw to cancel.
using Progress = std::function<void(double)>;

}  // namespace thimble::tools

#endif
