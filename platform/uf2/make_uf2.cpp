// Makes of a linked image (ELF, 32 bits, little-endian) what is dragged onto a board's drive:
//
//   make_uf2 IMAGE.elf IMAGE.uf2 FAMILY      FAMILY: the chip's number in hexadecimal, 0xE48BFF56 for the RP2040
//
// An image that begins at 0x10000000 has the RP2040's second stage first, whose last word is the checksum of
// the 252 bytes before it: it is written into the ELF file, so that every file made from that has it.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "../images/image_file.h"

namespace {

using thimble::platform::fail_if;
using thimble::platform::ImageError;
using thimble::platform::Program;
using thimble::platform::Segment;

constexpr std::uint32_t kFlashStart = 0x10000000;
constexpr std::size_t kStageBytes = 256;
constexpr std::size_t kSealedBytes = 252;

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "make_uf2: %s\n", why.c_str());
  std::exit(1);
}

// Whether the second stage was there to be sealed.
bool seal(std::string& elf, Segment& first) {
  if (first.address != kFlashStart) {
    return false;
  }
  fail_if(first.bytes.size() < kStageBytes, "has " + std::to_string(first.bytes.size()) +
                                                " bytes in its first segment; the second stage takes 256");
  const std::uint32_t crc = thimble::platform::boot_checksum(first.bytes.substr(0, kSealedBytes));
  const std::uint32_t there = thimble::platform::get_number(first.bytes, kSealedBytes, 4);
  fail_if(there != 0 && there != crc, "has code where the checksum of the second stage goes");
  thimble::platform::put_number(first.bytes, kSealedBytes, crc);
  thimble::platform::put_number(elf, first.offset + kSealedBytes, crc);
  return true;
}

void write(const std::string& name, const std::string& bytes) {
  std::ofstream file(name, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    fail("cannot write " + name);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: make_uf2 IMAGE.elf IMAGE.uf2 FAMILY\n");
    return 2;
  }
  char* end = nullptr;
  const unsigned long family = std::strtoul(argv[3], &end, 16);
  if (end == argv[3] || *end != '\0' || family > 0xFFFFFFFF) {
    fail(std::string(argv[3]) + " is no family: a number of 32 bits in hexadecimal");
  }
  std::ifstream file(argv[1], std::ios::binary);
  std::string elf((std::istreambuf_iterator<char>(file)), {});
  if (!file) {
    fail(std::string("cannot read ") + argv[1]);
  }
  try {
    Program program = thimble::platform::read_elf(elf);
    if (seal(elf, program.segments.front())) {
      write(argv[1], elf);
    }
    write(argv[2], thimble::platform::uf2_of(program, static_cast<std::uint32_t>(family)));
  } catch (const ImageError& error) {
    fail(std::string(argv[1]) + " " + error.what());
  }
  return 0;
}
