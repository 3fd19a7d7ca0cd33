/// @file cases.h
/// What `selftest` and `golden` share: they run cases (tests/portable) and report over the UART: a line a
/// topic, a line for each case that failed, the names of those whose memory this board does not have, and
///
///     result crc XXXXXXXX of N cases run
///     result crc XXXXXXXX of the N cases that every board runs
///     N skipped
///     N passed, N failed
#ifndef THIMBLE_PLATFORM_APPS_CASES_H
#define THIMBLE_PLATFORM_APPS_CASES_H

#include <stdint.h>

#include "portable/groups.h"
#include "thimble/base/memory.h"

namespace thimble::apps {

/// Runs the groups. The CRC-32s are those of tests/portable/result_crc.h: of all cases, which is compared
/// where none was skipped, and of those that every board runs; a board has `common_arena_bytes` for a case or
/// more. Returns the exit status.
int run_cases(const char* title, Span<const portable::Group* const> groups, uint32_t all_crc32,
              uint32_t common_crc32, uint32_t common_arena_bytes = portable::kCommonArenaBytes);

}  // namespace thimble::apps

#endif
