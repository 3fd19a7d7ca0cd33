/// Which reader reads which file: the one table of scene formats that come as bytes.
///
/// A new format is a new file beside this one, its reader in formats.h, and a row in the table of `read_any.cpp`.
#pragma once

#include "readers/formats.h"

namespace thimble::tools {

/// How a file of a format begins.
enum class Beginning : std::uint8_t {
  kAny,    ///< anyhow
  kText,   ///< with text
  kMagic,  ///< as `looks_like` says, or it is none
};

/// One format.
struct ReaderRow {
  const char* endings;  ///< lower case with their points, separated by blanks; may be empty
  const char* name;     ///< what the format is called in help and errors
  FormatReader* read;
  FormatLook* looks_like;  ///< counts for more than the name; null where the first bytes do not tell
  Beginning beginning = Beginning::kAny;
  std::string_view magic{};  ///< what a file begins with, in place of `looks_like`
  bool knows(std::string_view text) const {
    return magic.empty() ? looks_like != nullptr && looks_like(text) : text.starts_with(magic);
  }
};

/// The table's rows, in the order in which they are tried.
std::span<const ReaderRow> reader_rows();

/// The first row that recognises `text`, the first bytes of the file; otherwise the one whose ending `path` has, in any
/// case and before a final `.gz`, `.zst` or `.xz`; null when there is none. So what a file holds counts for more than its
/// name, and a `.ply` that no reader recognises is a broken `.ply`.
const ReaderRow* find_reader(std::string_view path, std::string_view text);

/// Refuses a file by its first bytes where these suffice for it.
/// @throws InputError  no reader knows the file, or the one that does says how such a file begins
void check_beginning(std::string_view path, std::span<const std::uint8_t> first);

/// Reads `file`, the contents of `options.path` already decompressed. `progress` ends with 1.
/// @throws InputError  no reader knows the file, `frame` of a format that has none, or the reader's
///   own errors
Source read_any(const ReadOptions& options, const SharedBytes& file, const Progress& progress = {});

/// Loads the file and reads it. A file that no reader knows is refused by its first bytes.
Source read_scene_file(const ReadOptions& options, const Progress& progress = {});

}  // namespace thimble::tools
