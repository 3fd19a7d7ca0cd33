/// Files of programs for chips: a linked one (ELF, 32 bits, little-endian) read, and what loaders and drives take written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace thimble::platform {

/// What is wrong with a file; completes "FILE ...".
class ImageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
inline void fail_if(bool is_wrong, const std::string& what) {
  if (is_wrong) {
    throw ImageError(what);
  }
}

/// Bytes that a loader brings to an address.
struct Segment {
  std::uint32_t address = 0;
  std::uint32_t virtual_address = 0;  ///< where the program uses them
  std::size_t offset = 0;             ///< in the file that was read
  std::string bytes;

  std::uint64_t end() const { return std::uint64_t{address} + bytes.size(); }
};

struct Program {
  std::vector<Segment> segments;  ///< by address, at least one
  std::uint16_t machine = 0;      ///< of ELF, as are the other two
  std::uint32_t flags = 0;
  std::uint32_t entry = 0;

  std::uint64_t end() const { return segments.back().end(); }
};

/// Throws ImageError for what is no ELF file of that kind, lies outside the file or on other segments, or has no bytes.
Program read_elf(std::string_view file);

/// The checksum of the RP2040's second stage, for the first 252 bytes (RP2040 Datasheet, 2.8.1).
std::uint32_t boot_checksum(std::string_view bytes);

// Files of a program. The same bytes for the same program.

/// Its segments, a section each, without names for a debugger.
std::string elf_of(const Program& program);
/// From the first byte to the last, zeros between segments. Throws ImageError above 64 MiB.
std::string bin_of(const Program& program);
/// Intel HEX: 16 bytes a line.
std::string hex_of(const Program& program);
/// Blocks for a chip of that family (../uf2/README.md); of the RP2040's flash whole sectors.
std::string uf2_of(const Program& program, std::uint32_t family);

/// Numbers as these files hold them.
std::uint32_t get_number(std::string_view bytes, std::size_t at, std::size_t size);
void put_number(std::string& bytes, std::size_t at, std::uint32_t value, std::size_t size = 4);

}  // namespace thimble::platform
