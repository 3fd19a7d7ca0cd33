/// Named binary tags, the bytes that Minecraft's files are made of. Internal to the reader of schematics.
///
/// Source of the format: Markus Persson, "Named Binary Tag specification", 2011.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "readers/file_bytes.h"

namespace thimble::tools {

enum class NbtKind : std::uint8_t {
  kEnd,
  kByte,
  kShort,
  kInt,
  kLong,
  kFloat,
  kDouble,
  kBytes,
  kText,
  kList,
  kCompound,
  kInts,
  kLongs
};

/// Passes over a value of `kind`. Nesting is limited to 512, as the format has it; nothing is kept.
/// @throws InputError  a kind that there is not, values that the bytes do not hold
void nbt_skip(ByteReader& reader, NbtKind kind);

/// Reads the entries of a compound whose kind and name were read; `entry` reads each one's value, or passes
/// over it.
void nbt_compound(ByteReader& reader, const std::function<void(NbtKind kind, std::string_view name)>& entry);

/// A kind, and a name; `kEnd` has none.
NbtKind nbt_head(ByteReader& reader, std::string_view* name);

/// The bytes of an array of `kind`; its numbers begin with their highest byte.
std::span<const std::uint8_t> nbt_array(ByteReader& reader, NbtKind kind);

/// How many values of the kind `of` a list holds; they follow.
std::uint32_t nbt_list(ByteReader& reader, NbtKind* of);

/// A value of a kind that is a whole number.
std::int64_t nbt_integer(ByteReader& reader, NbtKind kind);

}  // namespace thimble::tools
