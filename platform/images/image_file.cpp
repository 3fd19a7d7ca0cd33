#include "image_file.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <initializer_list>
#include <iterator>
#include <map>

namespace thimble::platform {
namespace {

// ELF: its header, headers of programs and of sections, and these sections' names.
constexpr std::size_t kElfHeaderBytes = 52;
constexpr std::size_t kProgramHeaderBytes = 32;
constexpr std::uint32_t kPtLoad = 1;
constexpr std::uint32_t kReadAndRun = 5;
constexpr std::size_t kSectionHeaderBytes = 40;
constexpr std::uint32_t kBits = 1;
constexpr std::uint32_t kStrings = 3;
constexpr std::uint32_t kLoadedAndRun = 6;
constexpr std::string_view kNames("\0.text\0.shstrtab\0\0\0\0", 20);
constexpr std::string_view kElf32(
    "\x7F"
    "ELF\x01\x01\x01",
    7);

constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 20;

// UF2 (its specification): blocks of 512 bytes, here with a page of 256 each.
constexpr std::uint32_t kMagic = 0x0A324655;
constexpr std::uint32_t kSecondMagic = 0x9E5D5157;
constexpr std::uint32_t kLastMagic = 0x0AB16F30;
constexpr std::uint32_t kHasFamily = 0x2000;
constexpr std::size_t kBlockBytes = 512;
constexpr std::uint32_t kPageBytes = 256;

// RP2040 Datasheet, erratum E14: flash is written a sector at a time, and the boot ROM forgets to erase one that comes in
// part. So sectors come whole.
constexpr std::uint32_t kFlashStart = 0x10000000;
constexpr std::uint32_t kFlashEnd = 0x11000000;
constexpr std::uint32_t kSectorBytes = 4096;

using Pages = std::map<std::uint32_t, std::array<char, kPageBytes>>;

// Pages of what is loaded, zeros between; of flash, whole sectors.
Pages pages_of(const Program& program) {
  Pages pages;
  for (const Segment& segment : program.segments) {
    for (std::size_t i = 0; i < segment.bytes.size(); ++i) {
      const std::uint32_t at = segment.address + static_cast<std::uint32_t>(i);
      const std::uint32_t piece = at >= kFlashStart && at < kFlashEnd ? kSectorBytes : kPageBytes;
      if (i == 0 || at % piece == 0) {
        for (std::uint32_t page = at / piece * piece; page < at / piece * piece + piece; page += kPageBytes) {
          pages.try_emplace(page);
        }
      }
      pages[at / kPageBytes * kPageBytes][at % kPageBytes] = segment.bytes[i];
    }
  }
  return pages;
}

// A line of Intel HEX.
void put_record(std::string& text, std::uint32_t address, unsigned kind, std::string_view bytes) {
  std::string record{static_cast<char>(bytes.size()), static_cast<char>(address >> 8 & 0xFF),
                     static_cast<char>(address & 0xFF), static_cast<char>(kind)};
  record += bytes;
  unsigned sum = 0;
  text += ':';
  for (std::size_t i = 0; i <= record.size(); ++i) {
    const unsigned byte = i < record.size() ? static_cast<unsigned char>(record[i]) : -sum & 0xFF;
    sum += byte;
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02X", byte);
    text += digits.data();
  }
  text += "\r\n";
}

}  // namespace

std::uint32_t get_number(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = size; i > 0; --i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  }
  return value;
}

void put_number(std::string& bytes, std::size_t at, std::uint32_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes[at + i] = static_cast<char>(value >> (8 * i) & 0xFF);
  }
}

std::uint32_t boot_checksum(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFF;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint32_t>(static_cast<unsigned char>(byte)) << 24;
    for (int bit = 0; bit < 8; ++bit) {
      crc = crc << 1 ^ ((crc & 0x80000000) != 0 ? 0x04C11DB7 : 0);
    }
  }
  return crc;
}

Program read_elf(std::string_view file) {
  fail_if(file.size() < kElfHeaderBytes || file.substr(0, kElf32.size()) != kElf32,
          "is no ELF file of 32 bits, little-endian");
  Program program;
  program.machine = static_cast<std::uint16_t>(get_number(file, 18, 2));
  program.entry = get_number(file, 24, 4);
  program.flags = get_number(file, 36, 4);
  const std::size_t table = get_number(file, 28, 4);
  const std::size_t entry_bytes = get_number(file, 42, 2);
  const std::size_t entries = get_number(file, 44, 2);
  fail_if(
      entry_bytes < kProgramHeaderBytes || table > file.size() || entries * entry_bytes > file.size() - table,
      "has program headers that lie outside the file");
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t header = table + i * entry_bytes;
    Segment segment;
    segment.offset = get_number(file, header + 4, 4);
    segment.virtual_address = get_number(file, header + 8, 4);
    segment.address = get_number(file, header + 12, 4);
    const std::size_t size = get_number(file, header + 16, 4);
    if (get_number(file, header, 4) != kPtLoad || size == 0) {
      continue;
    }
    fail_if(segment.offset > file.size() || size > file.size() - segment.offset,
            "has a segment, " + std::to_string(i) + ", that lies outside the file");
    segment.bytes = file.substr(segment.offset, size);
    program.segments.push_back(std::move(segment));
  }
  std::sort(program.segments.begin(), program.segments.end(),
            [](const Segment& a, const Segment& b) { return a.address < b.address; });
  const auto meets = [](const Segment& a, const Segment& b) { return b.address < a.end(); };
  fail_if(
      std::adjacent_find(program.segments.begin(), program.segments.end(), meets) != program.segments.end(),
      "has two segments at one address");
  fail_if(program.segments.empty(), "holds nothing to load");
  fail_if(program.end() > UINT32_MAX, "has a segment beyond 4 GiB");
  return program;
}

// A section for each segment, since debuggers and objdump go by sections; before them one that is none, and then the names.
std::string elf_of(const Program& program) {
  const auto count = static_cast<std::uint32_t>(program.segments.size());
  const std::size_t sections = kElfHeaderBytes + count * kProgramHeaderBytes;
  const std::size_t names = sections + (count + 2) * kSectionHeaderBytes;
  std::string file(names, '\0');
  file.replace(0, kElf32.size(), kElf32);
  file += kNames;
  const auto put_words = [&file](std::size_t at, std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words) {
      put_number(file, at, word);
      at += 4;
    }
  };
  put_number(file, 16, 2, 2);  // a program that runs
  put_number(file, 18, program.machine, 2);
  put_number(file, 20, 1);
  put_number(file, 24, program.entry);
  put_words(28, {kElfHeaderBytes, static_cast<std::uint32_t>(sections), program.flags});
  put_number(file, 40, kElfHeaderBytes, 2);
  put_number(file, 42, kProgramHeaderBytes, 2);
  put_number(file, 44, count, 2);
  put_number(file, 46, kSectionHeaderBytes, 2);
  put_number(file, 48, count + 2, 2);
  put_number(file, 50, count + 1, 2);  // the names' section
  for (std::size_t i = 0; i < count; ++i) {
    const Segment& segment = program.segments[i];
    const auto offset = static_cast<std::uint32_t>(file.size());
    const auto size = static_cast<std::uint32_t>(segment.bytes.size());
    put_words(kElfHeaderBytes + i * kProgramHeaderBytes,
              {kPtLoad, offset, segment.virtual_address, segment.address, size, size, kReadAndRun, 4});
    put_words(sections + (i + 1) * kSectionHeaderBytes,
              {static_cast<std::uint32_t>(kNames.find(".text")), kBits, kLoadedAndRun,
               segment.virtual_address, offset, size, 0, 0, 4});
    file += segment.bytes;
    file.resize((file.size() + 3) / 4 * 4);
  }
  put_words(names - kSectionHeaderBytes,
            {static_cast<std::uint32_t>(kNames.find(".shstrtab")), kStrings, 0, 0,
             static_cast<std::uint32_t>(names), static_cast<std::uint32_t>(kNames.size()), 0, 0, 1});
  return file;
}

std::string bin_of(const Program& program) {
  const std::uint64_t start = program.segments.front().address;
  fail_if(program.end() - start > kMostBytes, "has segments more than 64 MiB apart");
  std::string file(static_cast<std::size_t>(program.end() - start), '\0');
  for (const Segment& segment : program.segments) {
    file.replace(static_cast<std::size_t>(segment.address - start), segment.bytes.size(), segment.bytes);
  }
  return file;
}

std::string hex_of(const Program& program) {
  constexpr std::uint32_t kLineBytes = 16;
  std::string text;
  std::uint32_t high = 0;
  const auto number = [](std::uint32_t value, int bytes) {  // the high byte first
    std::string big;
    for (int i = bytes - 1; i >= 0; --i) {
      big += static_cast<char>(value >> (8 * i) & 0xFF);
    }
    return big;
  };
  for (const Segment& segment : program.segments) {
    for (std::size_t done = 0; done < segment.bytes.size();) {
      const std::uint32_t at = segment.address + static_cast<std::uint32_t>(done);
      if (at >> 16 != high) {
        high = at >> 16;
        put_record(text, 0, 4, number(high, 2));
      }
      const std::size_t line =
          std::min<std::size_t>(kLineBytes - at % kLineBytes, segment.bytes.size() - done);
      put_record(text, at, 0, std::string_view(segment.bytes).substr(done, line));
      done += line;
    }
  }
  put_record(text, 0, 5, number(program.entry, 4));
  put_record(text, 0, 1, {});
  return text;
}

std::string uf2_of(const Program& program, std::uint32_t family) {
  const Pages pages = pages_of(program);
  std::string file;
  std::uint32_t number = 0;
  for (const auto& [address, page] : pages) {
    std::string block(kBlockBytes, '\0');
    const std::uint32_t words[] = {kMagic,
                                   kSecondMagic,
                                   kHasFamily,
                                   address,
                                   kPageBytes,
                                   number++,
                                   static_cast<std::uint32_t>(pages.size()),
                                   family};
    for (std::size_t i = 0; i < std::size(words); ++i) {
      put_number(block, 4 * i, words[i]);
    }
    block.replace(sizeof words, page.size(), page.data(), page.size());
    put_number(block, kBlockBytes - 4, kLastMagic);
    file += block;
  }
  return file;
}

}  // namespace thimble::platform
