/// The members of a `.zip`, for formats that are one. Stored and deflated members; neither encrypted ones nor
/// the form for more than 4 GiB.
///
/// Source of the format: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification".
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "readers/file_bytes.h"

namespace thimble::tools {

struct ZipMember {
  std::string_view name;
  std::uint64_t size_bytes = 0;  ///< as the directory says; unpacking holds it to that
  std::span<const std::uint8_t> packed;
  bool is_deflated = false;
};

/// The directory's members, in its order. Views into `file`.
/// @throws InputError  no directory, members that leave the file, a way of packing that is not read
std::vector<ZipMember> zip_members(std::span<const std::uint8_t> file);

/// A member's bytes. @throws InputError  damaged data, another size than the directory says
FileBytes zip_unpack(const ZipMember& member);
/// The first `count` of them, or all of a shorter member.
FileBytes zip_beginning(const ZipMember& member, std::uint64_t count);

}  // namespace thimble::tools
