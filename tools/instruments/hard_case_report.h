/// @file hard_case_report.h
/// What `thimble accuracy --hard-cases` found, for people and for machines.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_HARD_CASE_REPORT_H
#define THIMBLE_TOOLS_INSTRUMENTS_HARD_CASE_REPORT_H

#include <cstdint>
#include <string>
#include <vector>

#include "instruments/hard_cases.h"
#include "instruments/operation_errors.h"
#include "output/tables.h"

namespace thimble::tools {

struct HardCaseStudy {
  std::vector<HardCaseRow> cases;
  std::vector<OperationError> operations;
};

/// A row a case and tracer, one a tracer over all cases, then one an operation; all with the same names.
JsonRow hard_case_objects(const HardCaseStudy& study);
/// Tables of at most 100 columns.
std::string hard_case_tables(const HardCaseStudy& study);
/// A sentence about what must not be, or nothing: a ray or a face that this tracer got wrong, an operation
/// beyond its bound.
std::string hard_case_fault(const HardCaseStudy& study);

}  // namespace thimble::tools

#endif
