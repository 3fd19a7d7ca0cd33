#include "host/guarded_bytes.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <new>

namespace thimble::host {
namespace {

constexpr std::uint8_t kPattern = 0x5A;
// A slip by an index is small; a slip by a whole picture is caught too.
constexpr std::size_t kGuardBytes = std::size_t{1} << 20;

std::size_t page_bytes() {
  return static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

GuardedBytes::GuardedBytes(std::size_t size, std::uint8_t fill) : size_(size) {
  const std::size_t page = page_bytes();
  const std::size_t inner = (size + page - 1) / page * page;
  mapped_bytes_ = inner + 2 * kGuardBytes;
  void* const mapping = ::mmap(nullptr, mapped_bytes_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapping == MAP_FAILED) {
    throw std::bad_alloc();
  }
  mapping_ = static_cast<std::uint8_t*>(mapping);
  std::uint8_t* const usable = mapping_ + kGuardBytes;
  first_ = usable + inner - size;
  if (inner != 0 && ::mprotect(usable, inner, PROT_READ | PROT_WRITE) != 0) {
    ::munmap(mapping, mapped_bytes_);
    throw std::bad_alloc();
  }
  std::fill(usable, first_, kPattern);
  std::fill(first_, first_ + size, fill);
}

GuardedBytes::~GuardedBytes() {
  ::munmap(mapping_, mapped_bytes_);
}

void GuardedBytes::make_read_only() {
  std::uint8_t* const usable = mapping_ + kGuardBytes;
  ::mprotect(usable, mapped_bytes_ - 2 * kGuardBytes, PROT_READ);
}

bool GuardedBytes::front_is_whole() const {
  return std::all_of(mapping_ + kGuardBytes, first_, [](std::uint8_t byte) { return byte == kPattern; });
}

std::optional<std::ptrdiff_t> GuardedBytes::offset_of(std::uintptr_t address) const {
  const auto low = reinterpret_cast<std::uintptr_t>(mapping_);
  if (address < low || address - low >= mapped_bytes_) {
    return std::nullopt;
  }
  return static_cast<std::ptrdiff_t>(address - low) - (first_ - mapping_);
}

}  // namespace thimble::host
