#include "instruments/hard_case_report.h"

#include <array>
#include <cstdio>

#include "output/units.h"

namespace thimble::tools {
namespace {

// This tracer's own: its two widths.
constexpr std::size_t kOwn = 2;
// float and double, without and with an epsilon.
constexpr std::size_t kArithmetics = 4;

HardCaseRow all_cases(const std::vector<HardCaseRow>& cases) {
  HardCaseRow all;
  all.name = "all";
  for (const HardCaseRow& row : cases) {
    all.rays += row.rays;
    all.hits += row.hits;
    for (std::size_t i = 0; i < kTracers; ++i) {
      all.wrong[i] += row.wrong[i];
      all.wrong_face[i] += row.wrong_face[i];
    }
  }
  return all;
}

std::string four_digits(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

// The names that all rows have, with nothing in them.
JsonRow empty_object(const char* row) {
  JsonRow object;
  object["row"] = row;
  for (const char* name :
       {"case", "level", "tracer", "traversal", "arithmetic", "epsilon_voxels", "rays", "hits", "wrong",
        "wrong_face", "operation", "bound_name", "unit", "error", "bound", "cases"}) {
    object[name] = nullptr;
  }
  return object;
}

double epsilon_of(const TracerName& tracer) {
  return !tracer.has_epsilon ? 0 : std::string(tracer.arithmetic) == "float" ? 1e-4 : kDoubleEpsilon;
}

void add_case(const HardCaseRow& row, JsonRow* rows) {
  for (std::size_t i = 0; i < kTracers; ++i) {
    const TracerName& tracer = tracer_names()[i];
    JsonRow object = empty_object("rays");
    object["case"] = row.name;
    object["level"] = row.level == 0 ? JsonRow(nullptr) : JsonRow(row.level);
    object["tracer"] = tracer.key;
    object["traversal"] = tracer.traversal;
    object["arithmetic"] = tracer.arithmetic;
    object["epsilon_voxels"] = epsilon_of(tracer);
    object["rays"] = row.rays;
    object["hits"] = row.hits;
    object["wrong"] = row.wrong[i];
    object["wrong_face"] = row.wrong_face[i];
    rows->push_back(object);
  }
}

std::string of_rays(std::uint64_t part, std::uint64_t rays) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.3f",
                rays == 0 ? 0.0 : 100 * static_cast<double>(part) / static_cast<double>(rays));
  return text.data();
}

std::string totals_table(const HardCaseRow& all) {
  std::vector<Cells> rows{{"traversal", "arithmetic", "epsilon", "wrong", "%", "wrong face", "%"}};
  for (std::size_t i = 0; i < kTracers; ++i) {
    const TracerName& tracer = tracer_names()[i];
    rows.push_back({tracer.traversal, tracer.arithmetic,
                    tracer.has_epsilon ? four_digits(epsilon_of(tracer)) : "-", grouped(all.wrong[i]),
                    of_rays(all.wrong[i], all.rays), grouped(all.wrong_face[i]),
                    of_rays(all.wrong_face[i], all.rays)});
  }
  return grouped(all.rays) + " near-degenerate rays, " + grouped(all.hits) +
         " of which hit, judged by exact arithmetic (epsilon in voxels;\nwrong: another voxel, a miss or a "
         "hit "
         "too many; wrong face: the right voxel by another face)\n" +
         columns_of(rows, 2);
}

// One traversal of textbooks at a time, the columns of four arithmetics.
std::string cases_table(const std::vector<HardCaseRow>& cases, std::size_t first) {
  std::vector<Cells> rows{{std::string("rays wrong: ") + tracer_names()[first].traversal, "rays", "thimble"}};
  for (std::size_t i = first; i < first + kArithmetics; ++i) {
    const TracerName& tracer = tracer_names()[i];
    rows.front().push_back(std::string(tracer.arithmetic) + (tracer.has_epsilon ? ", epsilon" : ""));
  }
  for (const HardCaseRow& row : cases) {
    Cells cells{row.name, grouped(row.rays), grouped(row.wrong[0] + row.wrong[1])};
    for (std::size_t i = first; i < first + kArithmetics; ++i) {
      cells.push_back(grouped(row.wrong[i]));
    }
    rows.push_back(cells);
  }
  return "\n" + columns_of(rows, 1);
}

std::string operations_table(const std::vector<OperationError>& operations) {
  std::vector<Cells> rows{{"operation", "bound", "unit", "largest", "allowed"}};
  for (const OperationError& found : operations) {
    rows.push_back(
        {found.operation, found.bound_name, found.unit, four_digits(found.error), four_digits(found.bound)});
  }
  return "\nthe largest error of each fixed-point operation against exact arithmetic, and what its "
         "header\nallows\n" +
         columns_of(rows, 3);
}

}  // namespace

JsonRow hard_case_objects(const HardCaseStudy& study) {
  JsonRow rows = JsonRow::array();
  for (const HardCaseRow& row : study.cases) {
    add_case(row, &rows);
  }
  add_case(all_cases(study.cases), &rows);
  for (const OperationError& found : study.operations) {
    JsonRow object = empty_object("operation");
    object["operation"] = found.operation;
    object["bound_name"] = found.bound_name;
    object["unit"] = found.unit;
    object["error"] = found.error;
    object["bound"] = found.bound;
    object["cases"] = found.cases;
    rows.push_back(object);
  }
  return rows;
}

std::string hard_case_tables(const HardCaseStudy& study) {
  std::string text = totals_table(all_cases(study.cases));
  for (std::size_t first = kOwn; first < kTracers; first += kArithmetics) {
    text += cases_table(study.cases, first);
  }
  return text + operations_table(study.operations);
}

std::string hard_case_fault(const HardCaseStudy& study) {
  const HardCaseRow all = all_cases(study.cases);
  for (std::size_t i = 0; i < kOwn; ++i) {
    if (const std::uint64_t wrong = all.wrong[i] + all.wrong_face[i]; wrong != 0) {
      return grouped(wrong) + " of " + grouped(all.rays) + " rays go wrong in " +
             tracer_names()[i].arithmetic;
    }
  }
  for (const OperationError& found : study.operations) {
    if (!(found.error <= found.bound)) {
      return found.operation + " is off by " + four_digits(found.error) + ", " + found.bound_name +
             " allows " + four_digits(found.bound);
    }
  }
  return {};
}

}  // namespace thimble::tools
