/// @file read_any.h
/// Which reader reads which file: the one table of scene formats that come as bytes.
///
/// A new format is a new file beside this one and a row in the table of `read_any.cpp`.
#ifndef THIMBLE_TOOLS_READERS_READ_ANY_H
#define THIMBLE_TOOLS_READERS_READ_ANY_H

#include <string>
#include <string_view>

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// One format.
struct ReaderRow {
  const char* endings;  ///< lower case with their points, separated by blanks; may be empty
  const char* name;     ///< what the format is called in help and errors
  Source (*read)(const SharedBytes& file, const Progress& progress);
  /// Recognises the format by its first bytes, for files with another ending or none; may be null.
  bool (*looks_like)(std::span<const std::uint8_t> bytes);
};

/// The table's rows, in the order in which they are tried.
std::span<const ReaderRow> reader_rows();

/// The row whose ending `path` has, in any case and before a final `.gz`; otherwise the first one that
/// recognises `bytes`; null when there is none. An ending decides alone: a broken `.ply` is a broken `.ply`.
const ReaderRow* find_reader(std::string_view path, std::span<const std::uint8_t> bytes);

/// All endings of the table, as ".off, .ply, ..." for errors and help.
std::string reader_endings();

/// Reads `file`, the contents of `path` already decompressed.
/// @throws InputError  no reader knows the file, or the reader's own errors
Source read_any(std::string_view path, const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
