#include "commands/report_files.h"

#include "output/tables.h"

namespace thimble::tools {

void ReportFiles::write(const nlohmann::ordered_json& rows, const std::string& plot) {
  if (outputs_[0] != nullptr) {
    outputs_[0]->write(csv_of(rows));
  }
  if (outputs_[1] != nullptr) {
    outputs_[1]->write(rows.dump(2) + "\n");
  }
  if (outputs_[2] != nullptr) {
    outputs_[2]->write(plot);
  }
  outputs_.commit();
}

}  // namespace thimble::tools
