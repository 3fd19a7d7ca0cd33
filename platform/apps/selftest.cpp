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

void say(const char* text) {
  size_t length = 0;
  while (text[length] != '\0') {
    ++length;
  }
  port::write({reinterpret_cast<const uint8_t*>(text), length});
}

void say_hex(uint32_t value) {
  char digits[9] = {};
  for (int i = 7; i >= 0; --i) {
    digits[i] = "0123456789ABCDEF"[value & 15U];
    value >>= 4;
  }
  say(digits);
}

void say_number(uint32_t value) {
  char digits[11] = {};
  int first = 10;
  do {
    --first;
    digits[first] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  say(digits + first);
}
void say_count(int value) {
  say_number(static_cast<uint32_t>(value));
}

// In decimal where 32 bits hold it, which spares a board the 64-bit division.
void say_value(int64_t value) {
  if (value >= INT32_MIN && value <= INT32_MAX) {
    if (value < 0) {
      say("-");
    }
    say_number(static_cast<uint32_t>(value < 0 ? -value : value));
    return;
  }
  say("0x");
  say_hex(static_cast<uint32_t>(static_cast<uint64_t>(value) >> 32));
  say_hex(static_cast<uint32_t>(value));
}

void say_name(const Group& group, const Case& one) {
  say(group.name);
  say(": ");
  say(one.name);
  if (one.detail != nullptr) {
    say(" (");
    say(one.detail);
    say(")");
  }
}

void say_failure(const Group& group, const Case& one, const Failure& failure) {
  say("FAILED ");
  say_name(group, one);
  say("\n  ");
  say(failure.expression);
  say(" is ");
  say_value(failure.got);
  say(", wanted ");
  say_value(failure.wanted);
  say(" (");
  say(group.file);
  say(" or what it calls, line ");
  say_count(failure.line);
  say(")\n");
}

// Not inlined: its frame is all that lies between main and a case.
[[gnu::noinline]] void run_case(Runner& runner, const Group& group, int index) {
  const Case one = group.at(index);
  if (!runner.fits(one)) {
    return;
  }
  const Failure* failure = runner.run(one);
  if (failure != nullptr) {
    say_failure(group, one, *failure);
  }
}

void run_group(Runner& runner, const Group& group) {
  const int before = runner.passed() + runner.failed();
  for (int i = 0; i < group.count; ++i) {
    run_case(runner, group, i);
  }
  say(group.name);
  say(": ");
  say_count(runner.passed() + runner.failed() - before);
  say(" of ");
  say_count(group.count);
  say(" cases run\n");
}

int say_skipped(const Runner& runner) {
  int skipped = 0;
  for (const Group* group : portable::kGroups) {
    for (int i = 0; i < group->count; ++i) {
      const Case one = group->at(i);
      if (!runner.fits(one)) {
        ++skipped;
        say("skipped: ");
        say_name(*group, one);
        say(" needs ");
        say_number(one.arena_bytes + portable::runner_bytes());
        say(" bytes\n");
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
  say("FAILED result crc of ");
  say(of_what);
  say(" is ");
  say_hex(got);
  say(", wanted ");
  say_hex(wanted);
  say("\n");
  return 1;
}

}  // namespace

int selftest() {
  say("selftest on ");
  say(port::facts().name);
  say("\n");
  Runner* runner = Runner::make(port::arena());
  if (runner == nullptr || runner->case_bytes() < portable::kCommonArenaBytes) {
    say("this board lacks the memory that every board has for a case\n0 passed, 1 failed\n");
    return 1;
  }
  for (const Group* group : portable::kGroups) {
    run_group(*runner, *group);
  }
  const int skipped = say_skipped(*runner);
  int failed = runner->failed();
  failed += judge_crc("the cases that every board runs", runner->common_crc32(), portable::kCommonResultCrc32);
  if (skipped == 0) {
    failed += judge_crc("all cases", runner->crc32(), portable::kResultCrc32);
  }
  say("result crc ");
  say_hex(runner->crc32());
  say(" of ");
  say_count(runner->passed() + runner->failed());
  say(" cases run\nresult crc ");
  say_hex(runner->common_crc32());
  say(" of the ");
  say_count(runner->common());
  say(" cases that every board runs\n");
  say_count(skipped);
  say(" skipped\n");
  say_count(runner->passed());
  say(" passed, ");
  say_count(failed);
  say(" failed\n");
  return failed == 0 ? 0 : 1;
}

}  // namespace thimble::apps
