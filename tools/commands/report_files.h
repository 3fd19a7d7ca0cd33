/// @file report_files.h
/// --csv, --json and --plot: what a study found, as data and as a picture.
#ifndef THIMBLE_TOOLS_COMMANDS_REPORT_FILES_H
#define THIMBLE_TOOLS_COMMANDS_REPORT_FILES_H

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "output/output_set.h"

namespace thimble::tools {

struct ReportPaths {
  std::string csv;
  std::string json;
  std::string plot;
};

class ReportFiles {
 public:
  /// Opens them, which must not be `scene`. Throws OutputError.
  ReportFiles(const ReportPaths& paths, const std::string& scene)
      : outputs_({paths.csv, paths.json, paths.plot}, {scene}) {}

  bool wants_plot() const { return outputs_[2] != nullptr; }
  /// Writes them (tables.h says what `rows` are) and gives them their names. Throws OutputError.
  void write(const nlohmann::ordered_json& rows, const std::string& plot);
  /// For people, unless data go to standard output.
  void print(const std::string& text) const { outputs_.print(text); }

 private:
  OutputSet outputs_;
};

}  // namespace thimble::tools

#endif
