/// Files that are read where they lie, instead of being held in memory.
#pragma once

#include <cstdint>
#include <string>

#include "readers/file_bytes.h"

namespace thimble::tools {

/// Regular files of so many bytes or more are mapped, unless they are packed: only what is read of them takes memory, and
/// the system takes that back when it needs it. Their size is not limited. Nothing else may cut them off meanwhile.
inline constexpr std::uint64_t kMappedBytes = std::uint64_t{64} << 20;

/// What `load_file` gives, as readers share it; mapped where the file is large.
/// @param is_beside  another file names it: only a regular one is read, as by `load_beside`
SharedBytes load_shared(const std::string& path, const FirstLook& look, bool is_beside = false);

}  // namespace thimble::tools
