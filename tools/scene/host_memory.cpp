#include "scene/host_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <new>

namespace thimble::tools {
namespace {

uint8_t* reserve(std::size_t size) {
  void* const address =
      ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return address == MAP_FAILED ? nullptr : static_cast<uint8_t*>(address);
}

}  // namespace

HostMemory::HostMemory(std::size_t size) : size_(size) {
  if (size != 0) {
    data_ = reserve(size);
    if (data_ == nullptr) {
      throw std::bad_alloc();
    }
  }
}

HostMemory HostMemory::largest() {
  HostMemory memory;
  for (std::size_t size = std::size_t{64} << 30; size >= std::size_t{1} << 20; size /= 2) {
    memory.data_ = reserve(size);
    if (memory.data_ != nullptr) {
      memory.size_ = size;
      return memory;
    }
  }
  throw std::bad_alloc();
}

void HostMemory::keep(std::size_t size) {
  constexpr std::size_t kPage = 4096;
  const std::size_t kept = (size + kPage - 1) / kPage * kPage;
  if (kept < size_) {
    ::madvise(data_ + kept, size_ - kept, MADV_DONTNEED);
  }
}

HostMemory::~HostMemory() {
  if (data_ != nullptr) {
    ::munmap(data_, size_);
  }
}

}  // namespace thimble::tools
