#include "output/output_set.h"

#include <algorithm>
#include <iterator>

namespace thimble::tools {

OutputSet::OutputSet(const std::vector<std::string>& paths, const std::vector<std::string>& inputs)
    : has_standard_output_(std::find(paths.begin(), paths.end(), "-") != paths.end()) {
  std::vector<std::string> named;
  std::copy_if(inputs.begin(), inputs.end(), std::back_inserter(named),
               [](const std::string& input) { return !input.empty(); });
  check_distinct(paths, named);
  for (const std::string& path : paths) {
    files_.push_back(path.empty() ? nullptr : std::make_unique<OutputFile>(path));
  }
}

void OutputSet::commit() {
  for (const auto& file : files_) {
    if (file != nullptr) {
      file->flush();
    }
  }
  for (const auto& file : files_) {
    if (file != nullptr) {
      file->commit();
    }
  }
}

void OutputSet::print(std::string_view text) const {
  if (!has_standard_output_) {
    OutputFile output("-");
    output.write(text);
    output.commit();
  }
}

}  // namespace thimble::tools
