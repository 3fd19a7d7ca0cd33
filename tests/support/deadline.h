/// Any-time frames (thimble/picture/anytime.h) under a deadline. The core has no clock, so the loop is here:
/// a slice of visits, a look at the time, another slice.
#pragma once

#include <chrono>
#include <cstdint>

#include "thimble/picture/anytime.h"

namespace thimble::testing {

/// Visits between two looks at the time: some 50 microseconds of a desktop.
inline constexpr std::uint32_t kSliceVisits = 4096;

/// Refines `frame`, begun for `structure`, until it is done or `is_over()` says so, which is called before
/// each slice. Errors: those of AnytimeFrame::refine.
template <class Structure, class IsOver>
Status refine_until(AnytimeFrame* frame, const Structure& structure, IsOver&& is_over,
                    std::uint32_t slice_visits = kSliceVisits) {
  Status status = Status::kOk;
  while (status == Status::kOk && !frame->done() && !is_over()) {
    status = frame->refine(structure, slice_visits);
  }
  return status;
}

/// The same for so long from now. It ends at most a slice late; the picture depends on the machine.
template <class Structure>
Status refine_for(AnytimeFrame* frame, const Structure& structure, std::chrono::microseconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  return refine_until(frame, structure, [end] { return std::chrono::steady_clock::now() >= end; });
}

}  // namespace thimble::testing
