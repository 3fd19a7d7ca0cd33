#include "output/output_set.h"

#include "output/held_signals.h"

namespace thimble::tools {

OutputSet::OutputSet(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
                     const std::vector<std::string>& sequence)
    : claim_(paths, inputs, sequence) {
  for (const std::string& path : paths) {
    files_.push_back(path.empty() ? nullptr : std::make_unique<OutputFile>(path));
    has_standard_output_ = has_standard_output_ || (!path.empty() && files_.back()->is_standard_output());
  }
}

void OutputSet::commit() {
  std::vector<OutputFile*> files;
  for (const auto& file : files_) {
    if (file != nullptr) {
      file->finish();
      if (file->wants_name()) {
        files.push_back(file.get());
      }
    }
  }
  const HeldSignals held;
  try {
    for (OutputFile* file : files) {
      if (files.size() > 1) {
        file->keep_old();
      }
      file->place();
    }
  } catch (const OutputError&) {
    for (OutputFile* file : files) {
      file->undo();
    }
    throw;
  }
  for (OutputFile* file : files) {
    file->settle();
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
