/// Files that are either complete or not there: bytes go to a file beside the target that has no name, or a
/// temporary one where the system cannot do without, and takes the target's name at the end.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "output/file_place.h"

namespace thimble::tools {

/// An output that cannot be written; `what()` is the whole sentence, the file's name included.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One output. `-` is standard output, written straight on, and so is a name that leads to an open descriptor
/// (/dev/stdout, /dev/fd/3), whatever stands behind it. What exists and is no regular file (a device, a pipe) is
/// written to directly too. A symbolic link stays one: the file that it leads to is replaced, or made.
class OutputFile {
 public:
  /// What becomes of an empty file that is there: a caller that made it may read it by the descriptor that it has, as
  /// thumbnailers' do, or may hide the folder that it is in.
  enum class Empty : bool { kIsReplaced, kIsFilled };

  /// Opens `path` for writing. Throws OutputError (no such folder, no permission, ...).
  explicit OutputFile(const std::string& path, Empty empty = Empty::kIsReplaced);
  /// Without `commit` nothing is left behind.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws OutputError when the bytes cannot be written (disk full).
  void write(std::string_view text);
  void write(std::span<const unsigned char> bytes);
  /// Finishes the file and gives it its name. Throws OutputError, leaving a file of that name as it was.
  void commit();

  // The steps of `commit`, for several outputs of which all or none are to take their names (OutputSet).

  /// Hands all bytes to the system and closes the file, so that nothing is left but to name it. Throws OutputError.
  void finish();
  /// Whether it is then to be given its name: not what was written to directly.
  bool wants_name() const { return !temporary_.empty(); }
  /// Keeps what has the output's name under a hidden one. Throws OutputError. Signals are held until it is settled.
  void keep_old();
  /// Gives the file its name. Throws OutputError.
  void place();
  /// Takes `place` and `keep_old` back, or deletes what was kept.
  void undo();
  void settle();

  bool is_standard_output() const { return file_ == stdout; }

 private:
  [[noreturn]] void fail(int error) const;
  int open_unfinished();
  void name_unfinished(int descriptor);
  std::string hidden_name() const;
  void delete_unfinished();

  std::string path_;
  std::string target_;  ///< `path_` behind symbolic links
  std::string
      temporary_;     ///< empty when written to directly, while the file has no name, and once it is placed
  std::string kept_;  ///< what had the output's name before; empty for nothing
  bool is_nameless_ = false;
  bool is_placed_ = false;
  std::FILE* file_ = nullptr;
};

/// The files that one run writes: all of them whole, or none of them there. Opened before the work begins, so that a folder that is not there is known at once; named at the end.
class OutputSet {
 public:
  /// An output for each of `paths`; an empty one is not wanted. Throws OutputError when one cannot be opened,
  /// or when two are one file, or one is among `inputs` (OutputClaim). Nothing of a `sequence` is opened here, only
  /// claimed.
  OutputSet(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
            const std::vector<std::string>& sequence = {});

  /// The output of that path, by its place among `paths`; null where there is none.
  OutputFile* operator[](std::size_t index) const { return files_[index].get(); }
  /// Writes all that it is to hold, where there is one. Throws OutputError.
  void write(std::size_t index, std::string_view text) const;
  /// Finishes all of them, so that a full disk is found before any takes its name; then gives them their names. When
  /// one cannot take its name, those before it are taken back; a signal that ends the program waits for the end.
  /// Throws OutputError.
  void commit();
  /// For people, on standard output, unless that is among the paths: data want no table between them.
  void print(std::string_view text) const;

 private:
  OutputClaim claim_;
  std::vector<std::unique_ptr<OutputFile>> files_;
  bool has_standard_output_ = false;
};

/// Throws OutputError when something printed on standard output did not get there.
void check_standard_output();

}  // namespace thimble::tools
