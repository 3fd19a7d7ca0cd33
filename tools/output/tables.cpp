#include "output/tables.h"

#include <algorithm>

namespace thimble::tools {
namespace {

std::string csv_cell(const JsonRow& value) {
  if (value.is_null()) {
    return {};
  }
  if (!value.is_string()) {
    return value.dump();
  }
  auto plain = value.get<std::string>();
  if (plain.find_first_of(",\"\n") == std::string::npos) {
    return plain;
  }
  std::string quoted = "\"";
  for (const char c : plain) {
    quoted += c == '"' ? "\"\"" : std::string(1, c);
  }
  return quoted + "\"";
}

}  // namespace

void put_nulls(JsonRow* object, std::initializer_list<const char*> names) {
  for (const char* const name : names) {
    (*object)[name] = nullptr;
  }
}

std::string csv_of(const JsonRow& rows) {
  std::string text;
  for (const auto& [name, value] : rows.front().items()) {
    text += (text.empty() ? "" : ",") + name;
  }
  for (const JsonRow& row : rows) {
    text += '\n';
    const char* separator = "";
    for (const auto& [name, value] : row.items()) {
      text += separator + csv_cell(value);
      separator = ",";
    }
  }
  return text + "\n";
}

std::string columns_of(const std::vector<Cells>& rows, std::size_t left) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Cells& cells : rows) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      widths[i] = std::max(widths[i], cells[i].size());
    }
  }
  std::string text;
  for (const Cells& cells : rows) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string gap(widths[i] - cells[i].size(), ' ');
      line += (i == 0 ? "" : "  ") + (i < left ? cells[i] + gap : gap + cells[i]);
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace thimble::tools
