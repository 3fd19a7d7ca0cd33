/// A whole file in memory, and a cursor that reads numbers out of bytes without ever leaving them.
///
/// Every reader starts here: `load_file` turns a path into bytes (and a `.gz` into what it holds),
/// `ByteReader` walks binary formats. Both throw `InputError` whose sentence says where and why; neither
/// trusts a size that the file claims.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "readers/input_error.h"

namespace thimble::tools {

/// How many bytes a `FirstLook` sees at most.
inline constexpr std::size_t kFirstLookBytes = 4096;

/// Called once with a file's first bytes, inflated: the first `kFirstLookBytes`, or all of a shorter file.
/// What it throws ends the reading there and then, so that no file is loaded that nobody can read.
using FirstLook = std::function<void(std::span<const std::uint8_t> first)>;

/// What `load_file` refuses to exceed when the caller names no limit: 4 GiB after decompression.
inline constexpr std::uint64_t kFileLimitBytes = std::uint64_t{4} << 30;

/// Bytes as readers take them: a view and whatever keeps it alive. Copies share the bytes, so a reader whose result
/// streams from the file keeps one. The owner may be anything: a loaded file, a mapped one, or nothing at all when the
/// bytes outlive the result anyway (a fuzzer's input, a literal).
struct SharedBytes {
  std::span<const std::uint8_t> bytes;
  std::shared_ptr<const void> owner;  ///< keeps `bytes` valid; may be empty

  /// The same bytes as text, not terminated by a zero.
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

  /// Takes over `content` (moved, not copied, when it is a temporary).
  static SharedBytes own(std::string content) {
    auto kept = std::make_shared<const std::string>(std::move(content));
    return {{reinterpret_cast<const std::uint8_t*>(kept->data()), kept->size()}, kept};
  }
};

/// All bytes of the file `path`: a regular file, a pipe or a device such as `/dev/stdin`, read to its end
/// once.
///
/// What begins with the gzip signature (1f 8b) is inflated, whatever its name, all members of it; a name that
/// ends in `.gz` must begin so. The compressed bytes are never held as a whole, and the memory taken is at
/// most twice what came out plus 64 KiB, whatever the file's headers say.
///
/// @param limit_bytes  the most bytes accepted, counted after inflating; at least 1
/// @param look         may be empty
/// @throws InputError  the file cannot be opened or read (with the system's reason), is a directory or empty,
///   holds more than `limit_bytes` or than this machine has memory for, or its gzip data is truncated,
///   damaged or followed by something else; and what `look` throws. ShortageError where the system has no descriptor
///   or memory left to open it, OutputError where this run would overwrite it. Zero bytes after the last member are
///   padding and ignored, as gzip itself does.
SharedBytes load_file(const std::string& path, std::uint64_t limit_bytes = kFileLimitBytes,
                      const FirstLook& look = {});

/// Regular files of so many bytes or more are mapped, unless they are packed: only what is read of them takes memory, and
/// the system takes that back when it needs it. Their size is not limited. Nothing else may cut them off meanwhile.
inline constexpr std::uint64_t kMappedBytes = std::uint64_t{64} << 20;

/// What `load_file` gives; mapped where the file is large.
/// @param is_beside  another file names it: only a regular one is read, as by `load_beside`
SharedBytes load_shared(const std::string& path, const FirstLook& look, bool is_beside = false);

/// The same of a file that another file names, into `file`: a regular one, since nobody chose to wait for a pipe or a
/// device there.
/// @return what is wrong with it ("is empty"), or nothing: a scene is worth having without its pictures
/// @throws ShortageError, OutputError  as `load_file`
std::string load_beside(const std::string& path, std::uint64_t limit_bytes, SharedBytes& file);
/// The same of what a file at `path` calls `name`: from its folder on, with slashes of either kind; where that leads
/// nowhere, beside it by what is behind the last slash, for names of places on another machine.
/// @param name  becomes the one that the file was found by, with plain slashes
std::string load_named(const std::string& path, std::string& name, std::uint64_t limit_bytes,
                       SharedBytes& file);

/// What `inflate_bytes` takes: deflate with zlib's frame around it, with gzip's, or bare as in a .zip.
enum class Deflated : std::uint8_t { kZlib, kGzip, kBare };

/// `packed` inflated, all of one stream; bytes after it are ignored.
/// @param limit_bytes  the most bytes accepted
/// @param place        what errors call these bytes
/// @throws InputError  damaged or truncated data, more bytes than the limit
SharedBytes inflate_bytes(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t limit_bytes,
                          const std::string& place);
/// The first `count` bytes of what `packed` holds, or all where it holds fewer or is damaged behind them.
SharedBytes inflate_beginning(std::span<const std::uint8_t> packed, Deflated frame, std::uint64_t count);

/// A member of a `.zip`, stored or deflated; neither an encrypted one nor one in the form for more than 4 GiB (zip.cpp).
struct ZipMember {
  std::string_view name;
  std::uint64_t size_bytes = 0;  ///< as the directory says; unpacking holds it to that
  SharedBytes packed;
  bool is_deflated = false;
  std::uint32_t crc32 = 0;
};

/// The directory's members, in its order. They share the bytes of `file`.
/// @throws InputError  no directory, members that leave the file, a way of packing that is not read
std::vector<ZipMember> zip_members(const SharedBytes& file);

/// A member's bytes. @throws InputError  damaged data, another size or check sum than the directory says
SharedBytes zip_unpack(const ZipMember& member);
/// The first `count` of them, or all of a shorter member.
SharedBytes zip_beginning(const ZipMember& member, std::uint64_t count);

/// How a number is written in binary.
struct NumberType {
  char kind = 'f';             ///< u (or b, a truth), i (two's complement) or f (IEEE 754)
  std::size_t size_bytes = 4;  ///< 1, 2, 4 or 8; of f not 1
  friend bool operator==(const NumberType&, const NumberType&) = default;
};

/// The bits of a number of `size_bytes` at `first`.
inline std::uint64_t load_bits(const std::uint8_t* first, std::size_t size_bytes, bool is_big_endian) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size_bytes; ++i) {
    bits = bits << 8 | first[is_big_endian ? i : size_bytes - 1 - i];
  }
  return bits;
}

double load_any_number(const std::uint8_t* first, const NumberType& type, bool is_big_endian);

/// The number at `first`, NaN included.
inline double load_number(const std::uint8_t* first, const NumberType& type, bool is_big_endian) {
  // What most files hold, and many of them.
  if (std::endian::native == std::endian::little && type == NumberType{} && !is_big_endian) {
    float number = 0;
    std::memcpy(&number, first, sizeof number);
    return static_cast<double>(number);
  }
  return load_any_number(first, type, is_big_endian);
}

/// A cursor over bytes that somebody else owns. Each read checks that its bytes are there and moves past
/// them; a read that does not fit throws and leaves the cursor where it was.
///
/// Plain names read little endian, `_be` ones big endian; neither needs alignment. Floating-point numbers are
/// IEEE 754 and come back as they stand, NaN included.
class ByteReader {
 public:
  /// @param place         what errors call these bytes ("XYZI chunk at byte offset 44"); it is kept as a copy
  /// @param first_offset  offset in the file of `bytes[0]`, so that errors name positions in the file
  explicit ByteReader(std::span<const std::uint8_t> bytes, std::string_view place = "the file",
                      std::uint64_t first_offset = 0)
      : bytes_(bytes), place_(place), first_offset_(first_offset) {}

  std::uint8_t u8() { return *take(1).data(); }
  std::int8_t i8() { return static_cast<std::int8_t>(u8()); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(little(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(little(4)); }
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  std::uint64_t u64() { return little(8); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }

  std::uint16_t u16_be() { return static_cast<std::uint16_t>(big(2)); }
  std::int16_t i16_be() { return static_cast<std::int16_t>(u16_be()); }
  std::uint32_t u32_be() { return static_cast<std::uint32_t>(big(4)); }
  std::int32_t i32_be() { return static_cast<std::int32_t>(u32_be()); }
  std::uint64_t u64_be() { return big(8); }

  /// Offset in the file of the next byte.
  std::uint64_t offset() const { return first_offset_ + next_; }
  std::size_t remaining() const { return bytes_.size() - next_; }
  const std::string& place() const { return place_; }

  void skip(std::uint64_t count) { take(count); }
  /// Passes over `magic`. @throws InputError  other bytes are there: the file "is no WHAT"
  void expect(std::string_view magic, const char* what);
  /// The next `count` bytes as they are; the view lives as long as the bytes.
  std::span<const std::uint8_t> take(std::uint64_t count);
  std::string_view text(std::uint64_t count) {
    const auto bytes = take(count);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// The next `count` bytes as a range of their own, which no read leaves; this cursor moves past them.
  ByteReader sub(std::uint64_t count, std::string_view place);

  /// Throws InputError "PLACE: SENTENCE", a sentence of these pieces.
  template <class... Pieces>
  [[noreturn]] void fail(const Pieces&... pieces) const {
    throw InputError(place_, ": ", pieces...);
  }
  /// Throws it where `is_wrong`.
  template <class... Pieces>
  void fail_if(bool is_wrong, const Pieces&... pieces) const {
    tools::fail_if(is_wrong, place_, ": ", pieces...);
  }

 private:
  std::uint64_t little(std::size_t count) { return load_bits(take(count).data(), count, false); }
  std::uint64_t big(std::size_t count) { return load_bits(take(count).data(), count, true); }

  std::span<const std::uint8_t> bytes_;
  std::string place_;
  std::uint64_t first_offset_ = 0;
  std::size_t next_ = 0;
};

}  // namespace thimble::tools
