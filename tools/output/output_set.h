/// The files that one run writes: all of them whole, or none of them there.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "output/file_place.h"
#include "output/output_file.h"

namespace thimble::tools {

/// Opened before the work begins, so that a folder that is not there is known at once; named at the end.
class OutputSet {
 public:
  /// An output for each of `paths`; an empty one is not wanted. Throws OutputError when one cannot be opened,
  /// or when two are one file, or one is among `inputs` (OutputClaim). Nothing of a `sequence` is opened here, only
  /// claimed.
  OutputSet(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
            const std::vector<std::string>& sequence = {});

  /// The output of that path, by its place among `paths`; null where there is none.
  OutputFile* operator[](std::size_t index) const { return files_[index].get(); }
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

}  // namespace thimble::tools
