// The core's own test cases on the target (tests/portable): the same list and the same numbers on every board
// and on the host.
//
// The report goes over the UART: a line a topic, a line for each case that failed, the names of those whose
// memory this board does not have, and
//
//   result crc XXXXXXXX of N cases run
//   result crc XXXXXXXX of the N cases that every board runs
//   N skipped
//   N passed, N failed
//
// The second CRC is held to tests/portable/result_crc.h; so is the first where nothing was skipped.
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

void put_count(int count) {
  put_number(static_cast<uint32_t>(count));
}

void put_value(int64_t value) {
  if (value < 0) {
    put("-");
  }
  put_number(value < 0 ? 0 - static_cast<uint64_t>(value) : static_cast<uint64_t>(value));
}

void put_name(const Group& group, const Case& one) {
  put(group.name);
  put(": ");
  put(one.name);
  if (one.detail != nullptr) {
    put(" (");
    put(one.detail);
    put(")");
  }
}

void put_failure(const Group& group, const Case& one, const Failure& failure) {
  put("FAILED ");
  put_name(group, one);
  put("\n  ");
  put(failure.expression);
  put(" is ");
  put_value(failure.got);
  put(", wanted ");
  put_value(failure.wanted);
  put(" (");
  put(group.file);
  put(" or what it calls, line ");
  put_count(failure.line);
  put(")\n");
}

// Not inlined: its frame is all that lies between main and a case.
[[gnu::noinline]] void run_case(Runner& runner, const Group& group, int index) {
  const Case one = group.at(index);
  if (!runner.fits(one)) {
    return;
  }
  const Failure* failure = runner.run(one);
  if (failure != nullptr) {
    put_failure(group, one, *failure);
  }
}

void run_group(Runner& runner, const Group& group) {
  const int before = runner.passed() + runner.failed();
  for (int i = 0; i < group.count; ++i) {
    run_case(runner, group, i);
  }
  put(group.name);
  put(": ");
  put_count(runner.passed() + runner.failed() - before);
  put(" of ");
  put_count(group.count);
  put(" cases run\n");
}

int put_skipped(const Runner& runner) {
  int skipped = 0;
  for (const Group* group : portable::kGroups) {
    for (int i = 0; i < group->count; ++i) {
      const Case one = group->at(i);
      if (!runner.fits(one)) {
        ++skipped;
        put("skipped: ");
        put_name(*group, one);
        put(" needs ");
        put_number(one.arena_bytes + portable::runner_bytes());
        put(" bytes\n");
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
  put("FAILED result crc of ");
  put(of_what);
  put(" is ");
  put_hex(got);
  put(", wanted ");
  put_hex(wanted);
  put("\n");
  return 1;
}

}  // namespace

int selftest() {
  put("selftest on ");
  put(port::facts().name);
  put("\n");
  Runner* runner = Runner::make(port::arena());
  if (runner == nullptr || runner->case_bytes() < portable::kCommonArenaBytes) {
    put("this board lacks the memory that every board has for a case\n0 passed, 1 failed\n");
    return 1;
  }
  for (const Group* group : portable::kGroups) {
    run_group(*runner, *group);
  }
  const int skipped = put_skipped(*runner);
  int failed = runner->failed();
  failed +=
      judge_crc("the cases that every board runs", runner->common_crc32(), portable::kCommonResultCrc32);
  if (skipped == 0) {
    failed += judge_crc("all cases", runner->crc32(), portable::kResultCrc32);
  }
  put("result crc ");
  put_hex(runner->crc32());
  put(" of ");
  put_count(runner->passed() + runner->failed());
  put(" cases run\nresult crc ");
  put_hex(runner->common_crc32());
  put(" of the ");
  put_count(runner->common());
  put(" cases that every board runs\n");
  put_count(skipped);
  put(" skipped\n");
  put_count(runner->passed());
  put(" passed, ");
  put_count(failed);
  put(" failed\n");
  return failed == 0 ? 0 : 1;
}

}  // namespace thimble::apps
