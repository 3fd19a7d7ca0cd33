/// Rows of named values as CSV, and tables of a terminal.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "output/units.h"

namespace thimble::tools {

using JsonRow = nlohmann::ordered_json;

/// What a pointer or an optional leads to; null where it leads nowhere.
template <class Maybe>
JsonRow json_of(const Maybe& value) {
  return value ? JsonRow(*value) : JsonRow(nullptr);
}

/// An array of objects with the same names in the same order, at least one: a line of names, then a line
/// each. null is an empty cell; texts with commas, quotes or line feeds are quoted.
std::string csv_of(const JsonRow& rows);

using Cells = std::vector<std::string>;
/// Columns two blanks apart, as wide as their widest cell; the first `left` of them begin at their left edge.
std::string columns_of(const std::vector<Cells>& rows, std::size_t left);

}  // namespace thimble::tools
