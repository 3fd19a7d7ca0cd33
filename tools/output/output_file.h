/// @file output_file.h
/// Files that are either complete or not there: bytes go to a file beside the target that has no name, or a
/// temporary one where the system cannot do without, and takes the target's name at the end.
#ifndef THIMBLE_TOOLS_OUTPUT_OUTPUT_FILE_H
#define THIMBLE_TOOLS_OUTPUT_OUTPUT_FILE_H

#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace thimble::tools {

/// An output that cannot be written; `what()` is the whole sentence, the file's name included.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One output. `-` is standard output, written straight on. What exists and is no regular file (a device, a
/// pipe) is written to directly too. A symbolic link stays one: the file that it leads to is replaced, or made.
class OutputFile {
 public:
  /// Opens `path` for writing. Throws OutputError (no such folder, no permission, ...).
  explicit OutputFile(const std::string& path);
  /// Without `commit` nothing is left behind.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws OutputError when the bytes cannot be written (disk full).
  void write(std::string_view text);
  void write(std::span<const unsigned char> bytes);
  /// Hands all bytes to the system, so that `commit` has little left that can fail. Throws OutputError.
  void flush();
  /// Flushes and gives the file its name. Throws OutputError, leaving a file of that name as it was.
  void commit();

 private:
  [[noreturn]] void fail(int error);
  int open_unfinished();
  void name_unfinished();

  std::string path_;
  std::string target_;     ///< `path_` behind symbolic links
  std::string temporary_;  ///< empty when written to directly, or while the file has no name
  bool is_nameless_ = false;
  std::FILE* file_ = nullptr;
};

/// Throws OutputError when something printed on standard output did not get there.
void check_standard_output();

/// Throws OutputError when two of `paths` are one file, or when one of them is among `inputs`: whoever writes
/// there last would win, and an input would be gone. Empty paths are skipped.
void check_distinct(std::span<const std::string> paths, std::span<const std::string> inputs);

/// Deletes the temporary file of the output being written, if any. Safe to call from a signal handler.
void discard_unfinished_output();

}  // namespace thimble::tools

#endif
