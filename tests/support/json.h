/// JSON that the command wrote. It is parsed by one file, since its parser takes a second to compile.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace thimble::tests {

/// It keeps the order of keys.
using Json = nlohmann::ordered_json;

Json parse_json(const std::string& text);
Json read_json(const std::string& path);

}  // namespace thimble::tests
