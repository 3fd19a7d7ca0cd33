// Every golden frame as an any-time frame: coarse at first, the same on every machine, and exact in the end.
#include "golden/golden_table.h"
#include "portable/golden_trees.h"
#include "portable/groups.h"
#include "thimble/base/memory.h"
#include "thimble/picture/anytime.h"

namespace thimble::portable {
namespace {

constexpr int kFrameCount = sizeof golden::kGoldenTable / sizeof golden::kGoldenTable[0];
// Visits at first, and how often that is doubled; what is left then is given at once.
constexpr uint32_t kFirstVisits = 200;
constexpr int kDoublings = 5;
// An AnytimeFrame of the widest machine.
constexpr uint32_t kObjectBytes = 320;

struct Object {
  static void* operator new(size_t, void* at) { return at; }
  static void operator delete(void*, void*) {}
  AnytimeFrame frame;
};
static_assert(sizeof(Object) <= kObjectBytes);

void run_frame(Check& check, int index) {
  const golden::Frame& shown = golden::frame(index);
  THIMBLE_REQUIRE_OK(CompactTree::open(golden_tree(shown.scene), &check.world.compact));
  THIMBLE_REQUIRE_OK(golden::set_up(shown, &check.camera, &check.shading));
  const Bytes memory =
      check.arena.take(anytime_bytes(shown.width_px, shown.height_px, shown.format), alignof(uint8_t));
  const Bytes object = check.arena.take(sizeof(Object));
  THIMBLE_REQUIRE(!memory.empty() && !object.empty());
  AnytimeFrame& frame = (new (object.data) Object)->frame;
  THIMBLE_REQUIRE_OK(
      AnytimeFrame::make(check.world.compact, check.camera, check.shading, shown.format, memory, &frame));
  uint32_t visits = kFirstVisits;
  for (int i = 0; i < kDoublings; ++i) {
    THIMBLE_REQUIRE_OK(frame.refine(check.world.compact, visits));
    check.note(crc32(frame.band(0, shown.height_px).pixels));
    check.note(frame.inexact());
    check.note(frame.mean_error_bound_q8());
    visits = static_cast<uint32_t>(frame.given_visits());
  }
  THIMBLE_REQUIRE_OK(frame.refine(check.world.compact, UINT32_MAX));
  THIMBLE_CHECK(frame.done());
  THIMBLE_EQUAL(crc32(frame.band(0, shown.height_px).pixels), golden::kGoldenTable[index].crc32);
  check.note(static_cast<int64_t>(frame.spent_visits()));
}

Case at(int index) {
  const golden::Frame& shown = golden::frame(index);
  const size_t bytes = anytime_bytes(shown.width_px, shown.height_px, shown.format);
  return {shown.name, kObjectBytes + static_cast<uint32_t>((bytes + 7) & ~size_t{7}), run_frame, index,
          "from coarse to fine"};
}

}  // namespace

const Group kAnytimeGroup = {"anytime", "cases_anytime.cpp", kFrameCount, at};

}  // namespace thimble::portable
