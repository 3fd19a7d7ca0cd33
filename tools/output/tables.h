/// Rows of named values as CSV, and tables of a terminal.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "output/units.h"

namespace thimble::tools {

using JsonRow = nlohmann::ordered_json;

/// What a pointer or an optional leads to; null where it leads nowhere.
template <class Maybe>
JsonRow json_of(const Maybe& value) {
  return value ? JsonRow(*value) : JsonRow(nullptr);
}

/// Puts names with their values into an object, one after the other: "rays", rays, "hits", hits.
template <class Value, class... Rest>
void put_all(JsonRow* object, const std::string& name, const Value& value, const Rest&... rest) {
  (*object)[name] = value;
  if constexpr (sizeof...(rest) != 0) {
    put_all(object, rest...);
  }
}
/// The same for names that have nothing in them.
void put_nulls(JsonRow* object, std::initializer_list<const char*> names);

/// One object, for a file of its own. A file's name may hold bytes that are no UTF-8; they are replaced, not an error.
inline std::string json_text(const JsonRow& object) {
  return object.dump(2, ' ', false, JsonRow::error_handler_t::replace) + "\n";
}

/// An array of what `object_of` makes of each of `rows`.
template <class Rows, class ObjectOf>
JsonRow objects_of(const Rows& rows, const ObjectOf& object_of) {
  JsonRow objects = JsonRow::array();
  for (const auto& row : rows) {
    objects.push_back(object_of(row));
  }
  return objects;
}

/// An array of objects with the same names in the same order, at least one: a line of names, then a line
/// each. null is an empty cell; texts with commas, quotes or line feeds are quoted.
std::string csv_of(const JsonRow& rows);

using Cells = std::vector<std::string>;
/// Those of texts, and of numbers in decimal.
template <class... Pieces>
Cells cells_of(const Pieces&... pieces) {
  return {concat(pieces)...};
}
/// Columns two blanks apart, as wide as their widest cell; the first `left` of them begin at their left edge.
std::string columns_of(const std::vector<Cells>& rows, std::size_t left);
/// The same of `head` and of what `make` gives for each of `rows`, where that is not empty.
template <class Rows, class Make>
std::string table_of(const Cells& head, std::size_t left, const Rows& rows, const Make& make) {
  std::vector<Cells> table{head};
  for (const auto& row : rows) {
    if (Cells cells = make(row); !cells.empty()) {
      table.push_back(std::move(cells));
    }
  }
  return columns_of(table, left);
}

}  // namespace thimble::tools
