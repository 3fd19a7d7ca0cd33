#include "readers/nbt.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace thimble::tools {
namespace {

NbtKind kind_of(ByteReader& reader) {
  const unsigned kind = reader.u8();
  if (kind > static_cast<unsigned>(NbtKind::kLongs)) {
    reader.fail("there is no tag of kind " + std::to_string(kind) + ", before byte offset " +
                std::to_string(reader.offset()));
  }
  return static_cast<NbtKind>(kind);
}

/// Bytes of one value, 0 where that is not the same for all.
std::uint64_t fixed_bytes(NbtKind kind) {
  constexpr std::array<std::uint8_t, 13> kBytes{0, 1, 2, 4, 8, 4, 8, 0, 0, 0, 0, 0, 0};
  return kBytes[static_cast<std::size_t>(kind)];
}

/// A list or a compound that is being passed over.
struct Open {
  NbtKind of;          ///< kEnd: a compound, whose entries say what they are
  std::uint32_t left;  ///< of a list
};

}  // namespace

NbtKind nbt_head(ByteReader& reader, std::string_view* name) {
  const NbtKind kind = kind_of(reader);
  *name = kind == NbtKind::kEnd ? std::string_view() : reader.text(reader.u16_be());
  return kind;
}

void nbt_skip(ByteReader& reader, NbtKind kind) {
  constexpr std::size_t kDeepest = 512;
  std::vector<Open> open;
  const auto skip_one = [&](NbtKind what) {
    if (fixed_bytes(what) != 0) {
      reader.skip(fixed_bytes(what));
    } else if (what == NbtKind::kText) {
      reader.text(reader.u16_be());
    } else if (what == NbtKind::kCompound) {
      open.push_back({NbtKind::kEnd, 0});
    } else if (what == NbtKind::kList) {
      NbtKind of = NbtKind::kEnd;
      const std::uint32_t count = nbt_list(reader, &of);
      if (fixed_bytes(of) != 0) {
        reader.skip(fixed_bytes(of) * count);
      } else if (count > 0) {
        open.push_back({of, count});
      }
    } else {
      nbt_array(reader, what);
    }
    if (open.size() > kDeepest) {
      reader.fail("tags are nested deeper than the limit of " + std::to_string(kDeepest));
    }
  };
  skip_one(kind);
  while (!open.empty()) {
    Open& last = open.back();
    if (last.of == NbtKind::kEnd) {
      std::string_view name;
      const NbtKind next = nbt_head(reader, &name);
      if (next == NbtKind::kEnd) {
        open.pop_back();
      } else {
        skip_one(next);
      }
    } else if (last.left == 0) {
      open.pop_back();
    } else {
      --last.left;
      skip_one(last.of);
    }
  }
}

void nbt_compound(ByteReader& reader, const std::function<void(NbtKind kind, std::string_view name)>& entry) {
  std::string_view name;
  for (NbtKind kind = nbt_head(reader, &name); kind != NbtKind::kEnd; kind = nbt_head(reader, &name)) {
    entry(kind, name);
  }
}

std::span<const std::uint8_t> nbt_array(ByteReader& reader, NbtKind kind) {
  const std::int32_t count = reader.i32_be();
  const std::uint64_t each = kind == NbtKind::kBytes ? 1 : (kind == NbtKind::kInts ? 4 : 8);
  if (count < 0) {
    reader.fail("an array of " + std::to_string(count) + " numbers, before byte offset " +
                std::to_string(reader.offset()));
  }
  return reader.take(each * static_cast<std::uint64_t>(count));
}

std::uint32_t nbt_list(ByteReader& reader, NbtKind* of) {
  *of = kind_of(reader);
  const std::int32_t count = reader.i32_be();
  if (count > 0 && *of == NbtKind::kEnd) {
    reader.fail("a list of " + std::to_string(count) + " nothings, before byte offset " +
                std::to_string(reader.offset()));
  }
  return static_cast<std::uint32_t>(std::max(count, 0));
}

std::int64_t nbt_integer(ByteReader& reader, NbtKind kind) {
  switch (kind) {
    case NbtKind::kByte:
      return reader.i8();
    case NbtKind::kShort:
      return reader.i16_be();
    case NbtKind::kInt:
      return reader.i32_be();
    case NbtKind::kLong:
      return static_cast<std::int64_t>(reader.u64_be());
    default:
      reader.fail("a tag before byte offset " + std::to_string(reader.offset()) + " is no whole number");
  }
}

}  // namespace thimble::tools
