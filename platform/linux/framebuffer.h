/// A Linux framebuffer (/dev/fb0), or a plain file that stands in for one.
#pragma once

#include <string>

#include "linux/pixels.h"

namespace thimble::linux_port {

/// The mapped bytes of a screen. Unmapped when it ends.
class Framebuffer {
 public:
  Framebuffer() = default;
  Framebuffer(const Framebuffer&) = delete;
  Framebuffer& operator=(const Framebuffer&) = delete;
  ~Framebuffer();

  /// Maps the device and asks it for its layout. Empty, or a sentence that says what is wrong.
  std::string open_device(const std::string& path);
  /// Makes a file of layout.bytes() zeros, or takes one that is there, and maps it.
  std::string open_stand_in(const std::string& path, const Layout& layout);

  const Layout& layout() const { return layout_; }
  Bytes bytes() const { return bytes_; }
  /// All pixels black; the slack at the rows' ends stays.
  void clear();

 private:
  std::string map(int file, size_t offset_bytes);

  Layout layout_;
  Bytes bytes_;
  void* mapped_ = nullptr;
  size_t mapped_bytes_ = 0;
};

}  // namespace thimble::linux_port
