// Source of the format: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification".
#include <algorithm>

#include "readers/file_bytes.h"
#include "readers/text.h"
#include "thimble/base/memory.h"

namespace thimble::tools {
namespace {

constexpr std::uint32_t kEndSignature = 0x06054b50;
constexpr std::uint32_t kEntrySignature = 0x02014b50;
constexpr std::uint32_t kLocalSignature = 0x04034b50;
constexpr std::size_t kEndBytes = 22;
constexpr std::size_t kLongestComment = 65535;

/// Offset of the record that ends the directory: the last one that its comment has room behind.
std::size_t find_end(std::span<const std::uint8_t> file) {
  const std::size_t last = file.size() < kEndBytes ? 0 : file.size() - kEndBytes;
  for (std::size_t back = 0; back <= std::min(last, kLongestComment) && file.size() >= kEndBytes; ++back) {
    ByteReader end(file.subspan(last - back, kEndBytes));
    const bool is_end = end.u32() == kEndSignature;
    end.skip(kEndBytes - 6);
    if (is_end && end.u16() <= back) {
      return last - back;
    }
  }
  throw InputError("the archive has no directory at its end: it is truncated or no .zip");
}

}  // namespace

std::vector<ZipMember> zip_members(const SharedBytes& archive) {
  const std::span<const std::uint8_t> file = archive.bytes;
  const std::size_t end_offset = find_end(file);
  ByteReader end(file.subspan(end_offset), "the end of the archive", end_offset);
  end.skip(10);
  const unsigned count = end.u16();
  const std::uint64_t directory_bytes = end.u32();
  const std::uint32_t directory_offset = end.u32();
  fail_if(count == UINT16_MAX || directory_offset == UINT32_MAX,
          "the archive's directory is a large one (Zip64), which is not read");
  // A program that unpacks itself may stand before the archive.
  const std::uint64_t archive_bytes = directory_offset + directory_bytes;
  const std::uint64_t begin = end_offset - std::min<std::uint64_t>(archive_bytes, end_offset);
  ByteReader whole(file, "the archive");
  whole.skip(begin + directory_offset);
  std::vector<ZipMember> members;
  for (unsigned i = 0; i < count; ++i) {
    const std::string place = concat("entry ", i + 1, " of the archive's directory");
    const std::uint32_t signature = whole.u32();
    fail_if(signature != kEntrySignature, place, " is none, before byte offset ", whole.offset());
    whole.skip(4);
    const unsigned flags = whole.u16();
    const unsigned method = whole.u16();
    whole.skip(4);
    ZipMember member;
    member.crc32 = whole.u32();
    const std::uint32_t packed_bytes = whole.u32();
    member.size_bytes = whole.u32();
    const unsigned name_bytes = whole.u16();
    const std::uint64_t extra_bytes = std::uint64_t{whole.u16()} + whole.u16();
    whole.skip(8);
    const std::uint32_t local_offset = whole.u32();
    member.name = whole.text(name_bytes);
    whole.skip(extra_bytes);
    const bool is_packed_otherwise = method != 0 && method != 8;
    fail_if((flags & 1U) != 0 || is_packed_otherwise || member.size_bytes == UINT32_MAX ||
                packed_bytes == UINT32_MAX || local_offset == UINT32_MAX,
            "the member ", quoted(member.name),
            (flags & 1U) != 0     ? " is encrypted"
            : is_packed_otherwise ? concat(" is packed in a way (", method, ") that is not read")
                                  : " is larger than 4 GiB");
    member.is_deflated = method == 8;
    ByteReader local(file, "the member " + quoted(member.name));
    local.skip(begin + local_offset);
    local.fail_if(local.u32() != kLocalSignature, "none is at byte offset ", local_offset);
    local.skip(22);
    const std::uint64_t before = std::uint64_t{local.u16()} + local.u16();
    local.skip(before);
    member.packed = {local.take(packed_bytes), archive.owner};
    members.push_back(member);
  }
  return members;
}

SharedBytes zip_unpack(const ZipMember& member) {
  const std::string place = "the member " + quoted(member.name);
  SharedBytes file = member.packed;
  if (member.is_deflated) {
    const auto most = std::max<std::uint64_t>(1, member.size_bytes);
    file = inflate_bytes(member.packed.bytes, Deflated::kBare, most, place);
  }
  fail_if(file.bytes.size() != member.size_bytes, place, " has ", file.bytes.size(), " bytes, not the ",
          member.size_bytes, " of the directory");
  fail_if(crc32({file.bytes.data(), file.bytes.size()}) != member.crc32, place,
          " is damaged: the directory has another check sum");
  return file;
}

SharedBytes zip_beginning(const ZipMember& member, std::uint64_t count) {
  const auto packed = member.packed.bytes;
  return member.is_deflated
             ? inflate_beginning(packed, Deflated::kBare, count)
             : SharedBytes{packed.first(std::min(static_cast<std::size_t>(count), packed.size())), nullptr};
}

}  // namespace thimble::tools
