#include "linux/framebuffer.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/fb.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace thimble::linux_port {
namespace {

std::string with_reason(const std::string& sentence) {
  return sentence + ": " + strerror(errno);
}

Channel channel_of(const fb_bitfield& field) {
  return {field.offset, field.length};
}

}  // namespace

Framebuffer::~Framebuffer() {
  if (mapped_ != nullptr) {
    munmap(mapped_, mapped_bytes_);
  }
}

std::string Framebuffer::map(int file, size_t offset_bytes) {
  const size_t length = offset_bytes + layout_.bytes();
  void* at = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (at == MAP_FAILED) {
    return with_reason("cannot map its pixels");
  }
  mapped_ = at;
  mapped_bytes_ = length;
  bytes_ = Bytes(static_cast<uint8_t*>(at) + offset_bytes, layout_.bytes());
  return "";
}

std::string Framebuffer::open_device(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) {
    return with_reason("cannot open " + path);
  }
  fb_var_screeninfo variable{};
  fb_fix_screeninfo fixed{};
  std::string fault;
  if (ioctl(file, FBIOGET_VSCREENINFO, &variable) != 0 || ioctl(file, FBIOGET_FSCREENINFO, &fixed) != 0) {
    fault = path + " is not a framebuffer";
  } else if (fixed.type != FB_TYPE_PACKED_PIXELS) {
    fault = path + ": its pixels are not packed, so they cannot be drawn";
  } else {
    layout_.width_px = static_cast<int32_t>(variable.xres);
    layout_.height_px = static_cast<int32_t>(variable.yres);
    layout_.stride_bytes = fixed.line_length;
    layout_.bits_per_pixel = static_cast<int32_t>(variable.bits_per_pixel);
    layout_.red = channel_of(variable.red);
    layout_.green = channel_of(variable.green);
    layout_.blue = channel_of(variable.blue);
    const char* why = fault_of(layout_);
    // What is shown may begin anywhere in the memory (double buffering by panning).
    const size_t offset = fixed.line_length * size_t{variable.yoffset} +
                          size_t{variable.xoffset} * (variable.bits_per_pixel / 8);
    if (why != nullptr) {
      fault = path + ": " + why;
    } else if (offset + layout_.bytes() >
               fixed.smem_len + size_t{variable.xoffset} * (variable.bits_per_pixel / 8)) {
      fault = path + ": it says that it has less memory than its picture takes";
    } else {
      fault = map(file, offset);
      fault = fault.empty() ? fault : path + ": " + fault;
    }
  }
  close(file);
  return fault;
}

std::string Framebuffer::open_stand_in(const std::string& path, const Layout& layout) {
  if (const char* why = fault_of(layout)) {
    return path + ": " + why;
  }
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) {
    return with_reason("cannot open " + path);
  }
  layout_ = layout;
  std::string fault;
  const off_t there = lseek(file, 0, SEEK_END);
  // A file that is longer is somebody's; its end is left alone, and a shorter one grows. The blocks are taken
  // now: on a full disk a mapped write would end the program.
  const int full = there < static_cast<off_t>(layout.bytes())
                       ? posix_fallocate(file, 0, static_cast<off_t>(layout.bytes()))
                       : 0;
  if (full != 0) {
    errno = full;
    fault = with_reason("cannot make " + path + " as large as a screen");
  } else {
    fault = map(file, 0);
    fault = fault.empty() ? fault : path + ": " + fault;
  }
  close(file);
  return fault;
}

void Framebuffer::clear() {
  const size_t row = static_cast<size_t>(layout_.width_px) * static_cast<size_t>(layout_.bits_per_pixel / 8);
  for (int32_t y = 0; y < layout_.height_px; ++y) {
    memset(bytes_.data + layout_.stride_bytes * static_cast<size_t>(y), 0, row);
  }
}

}  // namespace thimble::linux_port
