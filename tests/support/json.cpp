#include "support/json.h"

#include "support/run_command.h"

namespace thimble::tests {

Json parse_json(const std::string& text) {
  return Json::parse(text);
}
Json read_json(const std::string& path) {
  return parse_json(read_text(path));
}

}  // namespace thimble::tests
