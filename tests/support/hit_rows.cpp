#include "support/hit_rows.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "support/run_command.h"

namespace thimble::tests {
namespace {

template <class Number>
Number whole(const std::string& text) {
  Number number = 0;
  const char* end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || next != end) {
    throw std::runtime_error("\"" + text + "\" is no whole number");
  }
  return number;
}

HitRow parse_row(const std::string& line, bool with_pixels) {
  const std::vector<std::string> columns = split(line);
  if (columns.size() != (with_pixels ? 17U : 15U)) {
    throw std::runtime_error("columns");
  }
  HitRow row;
  std::size_t at = 0;
  if (with_pixels) {
    row.px = whole<int>(columns[at++]);
    row.py = whole<int>(columns[at++]);
  }
  const int hit = whole<int>(columns[at++]);
  if (hit != 0 && hit != 1) {
    throw std::runtime_error("hit");
  }
  row.hit = hit == 1;
  if (row.hit) {
    for (int& index : row.voxel) {
      index = whole<int>(columns[at++]);
    }
    row.t = columns[at++];
    row.axis = whole<int>(columns[at++]);
  } else {
    for (int empty = 0; empty < 5; ++empty) {
      if (!columns[at++].empty()) {
        throw std::runtime_error("a miss with a voxel, t or axis");
      }
    }
  }
  row.nodes = whole<long>(columns[at++]);
  for (std::int64_t& number : row.ray.origin_q8) {
    number = whole<std::int64_t>(columns[at++]);
  }
  for (std::int64_t& number : row.ray.direction) {
    number = whole<std::int64_t>(columns[at++]);
  }
  if (row.hit) {
    row.material = columns[at].empty() ? -1 : whole<int>(columns[at]);
    ++at;
    row.distance = std::stod(columns[at++]);
  } else if (!columns[at].empty() || !columns[at + 1].empty()) {
    throw std::runtime_error("a miss with a material or distance");
  }
  return row;
}

}  // namespace

std::vector<HitRow> parse_hits(std::string_view csv, bool with_pixels) {
  const std::vector<std::string> lines = lines_of(csv);
  if (lines.empty() || lines.front() != (with_pixels ? std::string("px,py,") : std::string()) + kHitHeader) {
    throw std::runtime_error("the header line is not as it should be");
  }
  std::vector<HitRow> rows;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    try {
      rows.push_back(parse_row(lines[i], with_pixels));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("line " + std::to_string(i + 1) + ": " + error.what() + ": " + lines[i]);
    }
  }
  return rows;
}

std::string judge(const reference::BitGrid& grid, const HitRow& row) {
  const reference::Hit expected = reference::walk(grid, row.ray);
  std::array<char, 40> t{};
  std::snprintf(t.data(), t.size(), "%.17g", expected.t());
  const auto& way = row.ray.direction;
  const auto along = [&](std::size_t axis) { return static_cast<double>(way[axis]); };
  const double distance = expected.t() * std::hypot(along(0), along(1), along(2));
  const bool same =
      row.hit == expected.hit &&
      (!row.hit || (row.voxel == expected.voxel && row.t == t.data() && row.axis == expected.axis &&
                    std::abs(row.distance - distance) <= 1e-15 * distance));
  if (same) {
    return {};
  }
  return reference::describe(row.ray) + ": reference " + reference::describe(expected) + ", command " +
         (row.hit ? "voxel (" + std::to_string(row.voxel[0]) + ", " + std::to_string(row.voxel[1]) + ", " +
                        std::to_string(row.voxel[2]) + ") t " + row.t + " axis " + std::to_string(row.axis) +
                        " distance " + std::to_string(row.distance)
                  : "miss");
}

std::string as_xyz(const std::vector<reference::Voxel>& voxels) {
  std::string text;
  for (const reference::Voxel& voxel : voxels) {
    text += std::to_string(voxel[0]) + " " + std::to_string(voxel[1]) + " " + std::to_string(voxel[2]) + "\n";
  }
  return text;
}

}  // namespace thimble::tests
