/// @file accuracy_report.h
/// What `thimble accuracy SCENE` found, for people, for machines and as a plot.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_ACCURACY_REPORT_H
#define THIMBLE_TOOLS_INSTRUMENTS_ACCURACY_REPORT_H

#include <string>

#include "instruments/accuracy_study.h"
#include "output/tables.h"

namespace thimble::tools {

/// An object a row, all with the same names: the settings, then the frames stopped early.
JsonRow accuracy_objects(const AccuracyStudy& study);

/// Tables of at most 100 columns: of settings tried together only those on the front.
std::string accuracy_tables(const AccuracyStudy& study, CostAxis axis);

/// Error against cost, the front marked and named.
std::string accuracy_plot(const AccuracyStudy& study, CostAxis axis, const std::string& scene);

/// What --for-ms and --for-error answer: a line "options: ..." and what they give, or an InputError that says
/// what is the nearest that can be had.
std::string answer_for_ms(const AccuracyStudy& study, double ms);
std::string answer_for_error(const AccuracyStudy& study, double rms);

}  // namespace thimble::tools

#endif
