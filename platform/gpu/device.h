/// A Vulkan device for compute: the loader is opened at run time, so a program starts where there is none.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "gpu/renderer.h"

namespace thimble::gpu {

/// Throws DeviceError, which says what was to be done, for anything but VK_SUCCESS.
void require(VkResult result, const char* what);

/// A structure of Vulkan's, all of it 0 but its type.
template <class Structure>
Structure vulkan(VkStructureType type) {
  Structure made{};
  made.sType = type;
  return made;
}

class Buffer {
 public:
  Buffer() = default;
  Buffer(VkDevice device, VkBuffer buffer, VkDeviceMemory memory, void* mapped, VkDeviceSize size)
      : device_(device), buffer_(buffer), memory_(memory), mapped_(mapped), size_(size) {}
  Buffer(Buffer&& from) noexcept { swap(from); }
  Buffer& operator=(Buffer&& from) noexcept {
    swap(from);
    return *this;
  }
  ~Buffer();

  VkBuffer get() const { return buffer_; }
  VkDeviceSize size() const { return size_; }
  /// Null for memory that only the device sees.
  std::uint32_t* words() const { return static_cast<std::uint32_t*>(mapped_); }

 private:
  void swap(Buffer& other) noexcept;

  VkDevice device_ = VK_NULL_HANDLE;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  void* mapped_ = nullptr;
  VkDeviceSize size_ = 0;
};

/// What a buffer's memory is for.
enum class Memory : std::uint8_t {
  kDevice,    ///< read and written by kernels
  kWritten,   ///< written by the host, a little, and read by kernels
  kReadBack,  ///< copied to, or from, and read by the host
};

class Device {
 public:
  /// The best device: a GPU before a software driver. Reads outside a buffer stay inside it. Throws DeviceError.
  Device();
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice get() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t family() const { return family_; }
  const DeviceInfo& info() const { return info_; }
  /// The largest buffer that a kernel may see.
  VkDeviceSize most_bytes() const { return most_bytes_; }
  /// Seconds a tick; 0: it has no timestamps.
  double tick_seconds() const { return tick_seconds_; }

  /// Throws DeviceError where there is no such memory left.
  Buffer make_buffer(VkDeviceSize bytes, VkBufferUsageFlags usage, Memory memory) const;

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkPhysicalDeviceMemoryProperties memory_{};
  std::uint32_t family_ = 0;
  DeviceInfo info_;
  VkDeviceSize most_bytes_ = 0;
  double tick_seconds_ = 0;
};

}  // namespace thimble::gpu
