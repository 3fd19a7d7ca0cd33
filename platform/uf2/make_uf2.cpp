// Makes of a linked image (ELF, 32 bits, little-endian) what is dragged onto a board's drive:
//
//   make_uf2 IMAGE.elf IMAGE.uf2 FAMILY      FAMILY: the chip's number in hexadecimal, 0xE48BFF56 for the RP2040
//
// An image that begins at 0x10000000 has the RP2040's second stage first, whose last word is the checksum of
// the 252 bytes before it: it is written into the ELF file, so that every file made from that has it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

namespace {

using Bytes = std::string;

// UF2 (its specification): blocks of 512 bytes, here with a page of 256 each.
constexpr std::uint32_t kMagic = 0x0A324655;
constexpr std::uint32_t kSecondMagic = 0x9E5D5157;
constexpr std::uint32_t kLastMagic = 0x0AB16F30;
constexpr std::uint32_t kHasFamily = 0x2000;
constexpr std::size_t kBlockBytes = 512;
constexpr std::uint32_t kPageBytes = 256;

// RP2040 Datasheet, 2.8.1 (second stage) and erratum E14: flash is written a sector at a time, and the boot
// ROM forgets to erase one that comes in part. So sectors come whole.
constexpr std::uint32_t kFlashStart = 0x10000000;
constexpr std::uint32_t kFlashEnd = 0x11000000;
constexpr std::uint32_t kSectorBytes = 4096;
constexpr std::size_t kSealedBytes = 252;

// Program headers of ELF.
constexpr std::uint32_t kPtLoad = 1;
constexpr std::size_t kElfHeaderBytes = 52;
constexpr std::size_t kProgramHeaderBytes = 32;

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "make_uf2: %s\n", why.c_str());
  std::exit(1);
}

std::uint32_t get(const Bytes& bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i > 0; --i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  }
  return value;
}

void put(Bytes& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[at + i] = static_cast<char>(value >> (8 * i) & 0xFF);
  }
}

// The CRC-32 of the boot ROM: 0x04C11DB7, not reflected, all bits set at first, nothing done at the end.
std::uint32_t boot_crc32(const Bytes& bytes, std::size_t at, std::size_t size) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + i])) << 24;
    for (int bit = 0; bit < 8; ++bit) {
      crc = crc << 1 ^ ((crc & 0x80000000) != 0 ? 0x04C11DB7 : 0);
    }
  }
  return crc;
}

struct Segment {
  std::uint32_t address = 0;
  std::size_t offset = 0;  // in the file
  std::size_t size = 0;
};

// By address, those that a loader must bring.
std::map<std::uint32_t, Segment> segments_of(const Bytes& elf, const std::string& name) {
  if (elf.size() < kElfHeaderBytes || elf.compare(0, 6,
                                                  "\x7F"
                                                  "ELF\x01\x01") != 0) {
    fail(name + " is no ELF file of 32 bits, little-endian");
  }
  const std::size_t table = get(elf, 28, 4);
  const std::size_t entry_bytes = get(elf, 42, 2);
  const std::size_t entries = get(elf, 44, 2);
  if (entry_bytes < kProgramHeaderBytes || table > elf.size() || entries * entry_bytes > elf.size() - table) {
    fail(name + ": its program headers lie outside the file");
  }
  std::map<std::uint32_t, Segment> segments;
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t header = table + i * entry_bytes;
    Segment segment;
    segment.offset = get(elf, header + 4, 4);
    segment.address = get(elf, header + 12, 4);
    segment.size = get(elf, header + 16, 4);
    if (get(elf, header, 4) != kPtLoad || segment.size == 0) {
      continue;
    }
    if (segment.offset > elf.size() || segment.size > elf.size() - segment.offset) {
      fail(name + ": segment " + std::to_string(i) + " lies outside the file");
    }
    if (!segments.emplace(segment.address, segment).second) {
      fail(name + ": two segments at one address");
    }
  }
  if (segments.empty()) {
    fail(name + " holds nothing to load");
  }
  return segments;
}

// Whether the second stage was there to be sealed.
bool seal(Bytes& elf, const Segment& first, const std::string& name) {
  if (first.address != kFlashStart) {
    return false;
  }
  if (first.size < kPageBytes) {
    fail(name + ": the second stage takes 256 bytes, the first segment has " + std::to_string(first.size));
  }
  const std::size_t at = first.offset + kSealedBytes;
  const std::uint32_t crc = boot_crc32(elf, first.offset, kSealedBytes);
  const std::uint32_t there = get(elf, at, 4);
  if (there != 0 && there != crc) {
    fail(name + ": there is code where the checksum of the second stage goes");
  }
  put(elf, at, crc);
  return true;
}

bool is_flash(std::uint32_t address) {
  return address >= kFlashStart && address < kFlashEnd;
}

using Pages = std::map<std::uint32_t, std::array<char, kPageBytes>>;

// Pages of what is loaded, zeros between; of flash, whole sectors.
Pages pages_of(const Bytes& elf, const std::map<std::uint32_t, Segment>& segments) {
  Pages pages;
  for (const auto& [address, segment] : segments) {
    for (std::size_t i = 0; i < segment.size; ++i) {
      const std::uint32_t at = address + static_cast<std::uint32_t>(i);
      const std::uint32_t piece = is_flash(at) ? kSectorBytes : kPageBytes;
      if (i == 0 || at % piece == 0) {
        for (std::uint32_t page = at / piece * piece; page < at / piece * piece + piece; page += kPageBytes) {
          pages.try_emplace(page);
        }
      }
      pages[at / kPageBytes * kPageBytes][at % kPageBytes] = elf[segment.offset + i];
    }
  }
  return pages;
}

Bytes uf2_of(const Pages& pages, std::uint32_t family) {
  Bytes file;
  std::uint32_t number = 0;
  for (const auto& [address, page] : pages) {
    Bytes block(kBlockBytes, '\0');
    const std::uint32_t words[] = {kMagic,
                                   kSecondMagic,
                                   kHasFamily,
                                   address,
                                   kPageBytes,
                                   number++,
                                   static_cast<std::uint32_t>(pages.size()),
                                   family};
    for (std::size_t i = 0; i < std::size(words); ++i) {
      put(block, 4 * i, words[i]);
    }
    block.replace(sizeof words, page.size(), page.data(), page.size());
    put(block, kBlockBytes - 4, kLastMagic);
    file += block;
  }
  return file;
}

void write(const std::string& name, const Bytes& bytes) {
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
  Bytes elf((std::istreambuf_iterator<char>(file)), {});
  if (!file) {
    fail(std::string("cannot read ") + argv[1]);
  }
  const std::map<std::uint32_t, Segment> segments = segments_of(elf, argv[1]);
  if (seal(elf, segments.begin()->second, argv[1])) {
    write(argv[1], elf);
  }
  write(argv[2], uf2_of(pages_of(elf, segments), static_cast<std::uint32_t>(family)));
  return 0;
}
