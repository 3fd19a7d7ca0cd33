// The applications that run cases (tests/portable) on the target: the same lists and the same numbers on every board and
// on the host. They report over the UART: a line a topic, a line for each case that failed, the names of those whose
// memory this board does not have, and
//
//     result crc XXXXXXXX of N cases run
//     result crc XXXXXXXX of the N cases that every board runs
//     N skipped
//     N passed, N failed
//
// Several, because all together fit into no small chip's flash.
#include "apps/apps.h"
#include "apps/text.h"
#include "port.h"
#include "portable/groups.h"
#include "portable/result_crc.h"
#include "portable/runner.h"

namespace thimble::apps {
namespace {

using portable::Case;
using portable::Failure;
using portable::Group;
using portable::Runner;

// Where a place is slow, one of so many cases of a long group is run, and the results of all are not compared.
#ifdef THIMBLE_CASE_STEP
constexpr int kCaseStep = THIMBLE_CASE_STEP;
#else
constexpr int kCaseStep = 1;
#endif
constexpr int kLongGroup = 200;

constexpr int step_of(const Group& group) {
  return kCaseStep == 1 || group.count < kLongGroup ? 1 : kCaseStep;
}

void put_count(int count) {
  put(static_cast<uint32_t>(count));
}

void put_value(int64_t value) {
  if (value < 0) {
    put("-");
  }
  put(value < 0 ? 0 - static_cast<uint64_t>(value) : static_cast<uint64_t>(value));
}

// Where there are no names (THIMBLE_TERSE_CASES) the number, counted from 0 in the group's file.
void put_name(const Group& group, const Case& one, int number) {
  put(group.name);
  if (one.name == nullptr) {
    put(" case ");
    put_count(number);
    return;
  }
  put(": ", one.name);
  if (one.detail != nullptr) {
    put(" (", one.detail);
    if (one.times > 1) {
      put(" ");
      put_count(one.index);
    }
    put(")");
  }
}

void put_what(const portable::What& what) {
#ifdef THIMBLE_TERSE_CASES
  put("line ", what.line);
#else
  put(what.text);
#endif
}

[[gnu::noinline]] void put_failure(const Group& group, const Case& one, int number, const Failure& failure) {
  put("FAILED ");
  put_name(group, one, number);
  put("\n  ");
  put_what(failure.what);
  put(" is ");
  put_value(failure.got);
  put(", wanted ");
  put_value(failure.wanted);
  put(" (", group.file);
  put(" or what it calls)\n");
}

// Not inlined: its frame is all that lies between main and a case.
[[gnu::noinline]] void run_case(Runner& runner, const Group& group, int index) {
  const Case one = group.at(index);
  if (!runner.fits(one)) {
    return;
  }
  const Failure* failure = runner.run(one);
  if (failure != nullptr) {
    put_failure(group, one, index, *failure);
  }
}

[[gnu::noinline]] void put_group(const Runner& runner, const Group& group) {
  int run = 0;
  for (int i = 0; i < group.count; i += step_of(group)) {
    run += runner.fits(group.at(i)) ? 1 : 0;
  }
  put(group.name, ": ");
  put_count(run);
  put(" of ");
  put_count(group.count);
  put(" cases run\n");
}

int put_skipped(const Runner& runner, Span<const Group* const> groups) {
  int skipped = 0;
  for (const Group* group : groups) {
    for (int i = 0; i < group->count; i += step_of(*group)) {
      const Case one = group->at(i);
      if (!runner.fits(one)) {
        ++skipped;
        put("skipped: ");
        put_name(*group, one, i);
        put(" needs ", one.arena_bytes + portable::runner_bytes(), " bytes\n");
      }
    }
  }
  return skipped;
}

// Returns how many more failures that is.
int judge_crc(const char* of_what, uint32_t got, uint32_t wanted) {
  if (got == wanted) {
    return 0;
  }
  put("FAILED result crc of ", of_what, " is ", Hex{got}, ", wanted ", Hex{wanted}, "\n");
  return 1;
}

// What is said at the end; returns the exit status.
[[gnu::noinline]] int put_results(const Runner& runner, Span<const Group* const> groups, uint32_t all_crc32,
                                  uint32_t common_crc32) {
  const int skipped = put_skipped(runner, groups);
  bool is_whole = true;
  if constexpr (kCaseStep != 1) {
    for (const Group* group : groups) {
      is_whole = is_whole && step_of(*group) == 1;
    }
  }
  int failed = runner.failed();
  if (is_whole) {
    failed += judge_crc("the cases that every board runs", runner.common_crc32(), common_crc32);
  }
  if (is_whole && skipped == 0) {
    failed += judge_crc("all cases", runner.crc32(), all_crc32);
  }
  put("result crc ", Hex{runner.crc32()}, " of ");
  put_count(runner.passed() + runner.failed());
  put(" cases run\nresult crc ", Hex{runner.common_crc32()}, " of the ");
  put_count(runner.common());
  put(is_whole ? " cases that every board runs\n" : " cases among them that every board runs\n");
  put_count(skipped);
  put(" skipped\n");
  put_count(runner.passed());
  put(" passed, ");
  put_count(failed);
  put(" failed\n");
  return failed == 0 ? 0 : 1;
}

// The CRC-32s are those of result_crc.h: of all cases, which is compared where none was skipped, and of those that every
// board runs; a board has `common_arena_bytes` for a case or more. Returns the exit status.
int run_cases(const char* title, Span<const Group* const> groups, uint32_t all_crc32, uint32_t common_crc32,
              uint32_t common_arena_bytes = portable::kCommonArenaBytes) {
  put(title, " on ", port::facts().name, "\n");
  Runner* runner = Runner::make(port::arena());
  if (runner == nullptr || runner->case_bytes() < common_arena_bytes) {
    put("this board lacks the memory that every board has for a case\n0 passed, 1 failed\n");
    return 1;
  }
  for (const Group* group : groups) {
    for (int i = 0; i < group->count; i += step_of(*group)) {
      run_case(*runner, *group, i);
    }
    put_group(*runner, *group);
  }
  return put_results(*runner, groups, all_crc32, common_crc32);
}

}  // namespace

int selftest() {
  return run_cases("selftest", portable::kCoreGroups, portable::kCoreCrc32, portable::kCoreCrc32);
}

// From compact trees in flash and, where the RAM holds them, from octrees and dense grids that are built here.
int golden() {
  return run_cases("golden", portable::kGoldenGroups, portable::kGoldenCrc32, portable::kCommonGoldenCrc32);
}

// In an image that has them: PANEL_FORMATS=0x3fe0 of build.sh.
int formats() {
  return run_cases("formats", portable::kPanelGroups, portable::kPanelCrc32, portable::kPanelCrc32);
}

int lit() {
  return run_cases("lit", portable::kLitGroups, portable::kLitCrc32, portable::kLitCrc32,
                   portable::kLitArenaBytes);
}

int worlds() {
  return run_cases("worlds", portable::kWorldGroups, portable::kWorldCrc32, portable::kWorldCrc32);
}

int bricks() {
#ifdef THIMBLE_DEEP_WORLDS
  constexpr uint32_t kAll = portable::kBrickCrc32;
#else
  constexpr uint32_t kAll = portable::kCommonBrickCrc32;
#endif
  return run_cases("bricks", portable::kBrickGroups, kAll, portable::kCommonBrickCrc32,
                   portable::kLitArenaBytes);
}

int map_light() {
  return run_cases("map_light", portable::kMapLightGroups, portable::kMapLightCrc32, portable::kMapLightCrc32,
                   portable::kLitArenaBytes);
}

}  // namespace thimble::apps
