/// @file ray_file.h
/// A file of rays, read in chunks that do not know of one another.
#ifndef THIMBLE_TOOLS_COMMANDS_RAY_FILE_H
#define THIMBLE_TOOLS_COMMANDS_RAY_FILE_H

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "thimble/trace/ray.h"

namespace thimble::tools {

/// How lines become rays.
struct RayRules {
  int level = 0;           ///< of the world
  int direction_bits = 0;  ///< 0: as the core allows
  bool only_32 = false;    ///< refuses rays that 32-bit products do not take
};

/// What is wrong with a line.
struct RayFault {
  std::size_t line = 0;  ///< counted from the chunk's first, which is 0
  std::string sentence;
};

class RayFile {
 public:
  /// `text` outlives it: one ray a line, ox,oy,oz,dx,dy,dz in voxels; a header line is allowed before, empty lines
  /// anywhere. Looks at a few bytes a chunk.
  RayFile(std::string_view text, const RayRules& rules);

  std::size_t chunks() const { return ends_.size(); }
  /// Where a chunk ends in the text.
  std::size_t end(std::size_t chunk) const { return ends_[chunk]; }
  /// The line of the file that the first chunk begins with, from 1 on.
  std::size_t first_line() const { return first_line_; }

  /// Puts the rays of a chunk into `rays`, up to the first line that is none: then that is the answer. `lines` gets
  /// the number of its lines. Any number of threads at a time.
  std::optional<RayFault> read(std::size_t chunk, std::vector<Ray>* rays, std::size_t* lines) const;

 private:
  std::string_view text_;
  RayRules rules_;
  std::size_t begin_ = 0;
  std::size_t first_line_ = 1;
  std::vector<std::size_t> ends_;
};

}  // namespace thimble::tools

#endif
