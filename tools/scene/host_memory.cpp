#include "scene/host_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <new>

namespace thimble::tools {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;

std::size_t past_page(const uint8_t* address) {
  return reinterpret_cast<std::size_t>(address) & (kLargePage - 1);
}

// Begins at a large page where that may matter: nothing smaller can hold one.
uint8_t* reserve(std::size_t size) {
  const std::size_t more = size < kLargePage ? 0 : kLargePage;
  void* address = ::mmap(nullptr, size + more, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (address == MAP_FAILED) {
    return nullptr;
  }
  auto* const first = static_cast<uint8_t*>(address);
  if (more == 0) {
    return first;
  }
  // What is before and behind goes back.
  const std::size_t before = past_page(first) == 0 ? 0 : kLargePage - past_page(first);
  if (before != 0) {
    ::munmap(first, before);
  }
  uint8_t* const data = first + before;
  const std::size_t page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t end = (size + page - 1) / page * page;
  if (size + more - before > end) {
    ::munmap(data + end, size + more - before - end);
  }
  return data;
}

}  // namespace

void use_large_pages(Bytes bytes) {
  const std::size_t past = past_page(bytes.data);
  const std::size_t skipped = past == 0 ? 0 : kLargePage - past;
  if (bytes.size < skipped + kLargePage) {
    return;
  }
#ifdef MADV_HUGEPAGE
  // Advice: a system without large pages uses small ones.
  (void)::madvise(bytes.data + skipped, (bytes.size - skipped) / kLargePage * kLargePage, MADV_HUGEPAGE);
#endif
}

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

HostMemory::~HostMemory() {
  if (data_ != nullptr) {
    ::munmap(data_, size_);
  }
}

}  // namespace thimble::tools
