/// @file options.h
/// The command line of thimble-fb.
#ifndef THIMBLE_PLATFORM_LINUX_OPTIONS_H
#define THIMBLE_PLATFORM_LINUX_OPTIONS_H

#include <stdint.h>

#include <optional>
#include <string>
#include <vector>

namespace thimble::linux_port {

struct Options {
  std::string scene;  ///< empty: none
  std::string app = "demo";
  std::string device = "/dev/fb0";
  std::string input = "/dev/input";
  std::string stand_in;     ///< a file in place of the device
  std::vector<int> layout;  ///< of the stand-in: width, height, bits a pixel, stride
  std::vector<int> size;    ///< of the picture, in pixels; empty: the largest that is magnified 4 times
  uint64_t memory = uint64_t{256} << 10;
  uint32_t frames = 0;  ///< 0: until asked to end
};

/// Reads the command line; `apps` names the applications in the help. Where that ends the program, it has said why
/// and returns the exit status: 0 after --help, 2 for wrong usage.
std::optional<int> read_options(int argc, char** argv, const std::string& apps, Options* options);

}  // namespace thimble::linux_port

#endif
