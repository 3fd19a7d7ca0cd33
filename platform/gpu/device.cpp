#define VOLK_IMPLEMENTATION
#include "gpu/device.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace thimble::gpu {
namespace {

// A driver is unloaded with its instance: what it leaked cannot be told from a leak of ours by then.
struct UnwatchedDriver {
#ifdef __SANITIZE_ADDRESS__
  UnwatchedDriver() {
    __lsan_disable();
  }
  ~UnwatchedDriver() {
    __lsan_enable();
  }
  UnwatchedDriver(const UnwatchedDriver&) = delete;
  UnwatchedDriver& operator=(const UnwatchedDriver&) = delete;
#endif
};

VkInstance make_instance() {
  static std::mutex mutex;
  const std::lock_guard<std::mutex> lock(mutex);
  if (volkInitialize() != VK_SUCCESS) {
    throw DeviceError("there is no Vulkan loader (libvulkan.so.1)");
  }
  auto application = vulkan<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "thimble";
  application.apiVersion = VK_API_VERSION_1_1;
  auto info = vulkan<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  VkInstance instance = VK_NULL_HANDLE;
  [[maybe_unused]] const UnwatchedDriver driver;
  const VkResult made = vkCreateInstance(&info, nullptr, &instance);
  if (made == VK_ERROR_INCOMPATIBLE_DRIVER) {
    throw DeviceError("there is no Vulkan driver");
  }
  require(made, "list its devices");
  volkLoadInstanceOnly(instance);
  return instance;
}

// A queue family with compute; the number of families where there is none.
std::uint32_t compute_family(VkPhysicalDevice device, std::uint32_t* timestamp_bits) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  std::uint32_t family = 0;
  while (family < count && (families[family].queueFlags & VK_QUEUE_COMPUTE_BIT) == 0) {
    ++family;
  }
  *timestamp_bits = family < count ? families[family].timestampValidBits : 0;
  return family < count ? family : UINT32_MAX;
}

VkPhysicalDeviceProperties properties_of(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(device, &properties);
  return properties;
}

DeviceInfo info_of(const VkPhysicalDeviceProperties& properties) {
  return {properties.deviceName, properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU};
}

// A GPU of its own first, software last.
int rank_of(VkPhysicalDevice device) {
  constexpr VkPhysicalDeviceType kOrder[] = {VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU,
                                             VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU,
                                             VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU};
  return static_cast<int>(std::ranges::find(kOrder, properties_of(device).deviceType) - kOrder);
}

// Those of Vulkan 1.1 with a queue for compute, the best first.
std::vector<VkPhysicalDevice> usable_devices(VkInstance instance) {
  [[maybe_unused]] const UnwatchedDriver driver;
  std::uint32_t count = 0;
  require(vkEnumeratePhysicalDevices(instance, &count, nullptr), "list the devices");
  std::vector<VkPhysicalDevice> devices(count);
  require(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "list the devices");
  devices.resize(count);
  const auto is_useless = [](VkPhysicalDevice device) {
    std::uint32_t bits = 0;
    return properties_of(device).apiVersion < VK_API_VERSION_1_1 ||
           compute_family(device, &bits) == UINT32_MAX;
  };
  std::erase_if(devices, is_useless);
  std::ranges::stable_sort(devices, {}, rank_of);
  return devices;
}

}  // namespace

void require(VkResult result, const char* what) {
  if (result == VK_SUCCESS) {
    return;
  }
  const bool memory = result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY;
  throw DeviceError(std::string("the GPU could not ") + what +
                    (memory ? ": out of memory" : " (Vulkan error " + std::to_string(result) + ")"));
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(mapped_, other.mapped_);
  std::swap(size_, other.size_);
}

Buffer::~Buffer() {
  if (device_ != VK_NULL_HANDLE) {
    vkDestroyBuffer(device_, buffer_, nullptr);
    vkFreeMemory(device_, memory_, nullptr);
  }
}

std::vector<DeviceInfo> devices() {
  std::vector<DeviceInfo> infos;
  try {
    VkInstance instance = make_instance();
    for (VkPhysicalDevice device : usable_devices(instance)) {
      infos.push_back(info_of(properties_of(device)));
    }
    vkDestroyInstance(instance, nullptr);
  } catch (const DeviceError&) {
    // None, then.
  }
  return infos;
}

Device::Device() : instance_(make_instance()) {
  const std::vector<VkPhysicalDevice> usable = usable_devices(instance_);
  if (usable.empty()) {
    vkDestroyInstance(instance_, nullptr);
    throw DeviceError("there is no Vulkan device");
  }
  physical_ = usable.front();
  const VkPhysicalDeviceProperties properties = properties_of(physical_);
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  info_ = info_of(properties);
  most_bytes_ = properties.limits.maxStorageBufferRange;
  std::uint32_t timestamp_bits = 0;
  family_ = compute_family(physical_, &timestamp_bits);
  tick_seconds_ = timestamp_bits != 0 ? 1e-9 * static_cast<double>(properties.limits.timestampPeriod) : 0;
  VkPhysicalDeviceFeatures wanted{};
  wanted.robustBufferAccess = VK_TRUE;
  const float priority = 1;
  auto queue = vulkan<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto info = vulkan<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.pEnabledFeatures = &wanted;
  const VkResult made = vkCreateDevice(physical_, &info, nullptr, &device_);
  if (made != VK_SUCCESS) {
    vkDestroyInstance(instance_, nullptr);
    require(made, "be opened");
  }
  volkLoadDevice(device_);
  vkGetDeviceQueue(device_, family_, 0, &queue_);
}

Device::~Device() {
  vkDestroyDevice(device_, nullptr);
  vkDestroyInstance(instance_, nullptr);
}

Buffer Device::make_buffer(VkDeviceSize bytes, VkBufferUsageFlags usage, Memory memory) const {
  auto info = vulkan<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = bytes;
  info.usage = usage;
  VkBuffer buffer = VK_NULL_HANDLE;
  require(vkCreateBuffer(device_, &info, nullptr, &buffer), "make a buffer");
  VkMemoryRequirements needed;
  vkGetBufferMemoryRequirements(device_, buffer, &needed);
  // What is wished for, and what will do.
  constexpr VkMemoryPropertyFlags kHost =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
  const VkMemoryPropertyFlags most = memory == Memory::kDevice    ? kLocal
                                     : memory == Memory::kWritten ? kHost | kLocal
                                                                  : kHost | kCached;
  const VkMemoryPropertyFlags least = memory == Memory::kDevice ? most : kHost;
  VkResult result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  VkDeviceMemory allocated = VK_NULL_HANDLE;
  for (const VkMemoryPropertyFlags flags : {most, least}) {
    for (std::uint32_t type = 0; type < memory_.memoryTypeCount && result != VK_SUCCESS; ++type) {
      if ((needed.memoryTypeBits >> type & 1U) == 0 ||
          (memory_.memoryTypes[type].propertyFlags & flags) != flags) {
        continue;
      }
      auto allocation = vulkan<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
      allocation.allocationSize = needed.size;
      allocation.memoryTypeIndex = type;
      result = vkAllocateMemory(device_, &allocation, nullptr, &allocated);
    }
  }
  void* mapped = nullptr;
  if (result == VK_SUCCESS) {
    result = vkBindBufferMemory(device_, buffer, allocated, 0);
  }
  if (result == VK_SUCCESS && memory != Memory::kDevice) {
    result = vkMapMemory(device_, allocated, 0, VK_WHOLE_SIZE, 0, &mapped);
  }
  Buffer made(device_, buffer, allocated, mapped, bytes);
  require(result, "give memory");
  return made;
}

}  // namespace thimble::gpu
