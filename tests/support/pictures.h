/// Pictures as stb_image reads them, which knows nothing of the writers here.
#pragma once

#include <string>
#include <vector>

namespace thimble::tests {

struct ReadPicture {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::string> frames;  ///< each its pixels' bytes, row by row
  std::vector<int> delays_ms;       ///< of a film
};

/// A PNG with the channels that it has, or a GIF with three; the test fails where it is neither.
ReadPicture read_png(const std::string& file);
ReadPicture read_gif(const std::string& file);

}  // namespace thimble::tests
