/// Where a path leads, whatever it is called, and what of a run may not be one file.
#pragma once

#include <sys/stat.h>

#include <string>
#include <vector>

namespace thimble::tools {

/// Where a path leads: `-` to standard output, others behind symbolic links, whether or not anything stands there.
struct FilePlace {
  explicit FilePlace(const std::string& path);

  std::string path;            ///< as it was given
  std::string target;          ///< behind links; `path` where it leads to an open descriptor
  int descriptor = -1;         ///< of this process, which the path leads to (/dev/stdout, /dev/fd/N); else -1
  bool is_descriptor = false;  ///< it leads to an open descriptor of this process or of another one
  int error = 0;               ///< why `info` tells nothing; 0 where it does
  struct stat info {};
};

/// The outputs of a run, which are not to be what it reads, nor one another.
class OutputClaim {
 public:
  /// Throws OutputError when two of `paths` are one file, for whoever writes there last would win, or when one of them
  /// is among `inputs` or what was read before (below). Empty paths are skipped.
  /// `sequence`: further outputs, whose names differ from one another and are not compared.
  OutputClaim(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
              const std::vector<std::string>& sequence = {});
  ~OutputClaim();
  OutputClaim(const OutputClaim&) = delete;
  OutputClaim& operator=(const OutputClaim&) = delete;

 private:
  std::vector<FilePlace> places_;
};

/// Whoever opens a file to read it says so before it reads. Throws OutputError when it is an output of this run: it
/// would be gone in the end. Any number of threads at a time.
void claim_input(const std::string& path);

}  // namespace thimble::tools
