// The table of rays: each row is a case, traced in every structure and width.
#include "portable/groups.h"
#include "portable/rays.h"
#include "portable/scene.h"

namespace thimble::portable {
namespace {

constexpr Width kWidths[] = {Width::k64, Width::k32, Width::kAuto};

// One structure, every width that takes the ray.
void trace_in(Check& check, int structure, const RayCase& wanted) {
  const Ray ray = wanted.ray();
  for (const Width width : kWidths) {
    check.options.width = width;
    if (width == Width::k32 && !accepts_32(ray, wanted.scene->level)) {
      THIMBLE_EQUAL(closest(check, structure, ray, check.options), Status::kOutOfRange);
      continue;
    }
    THIMBLE_REQUIRE_OK(closest(check, structure, ray, check.options));
    expect_hit(check, check.hit, ray.direction, wanted);
    HitKind kind = HitKind::kStepLimit;
    uint32_t visits = 0;
    THIMBLE_REQUIRE_OK(any(check, structure, ray, &kind, &visits, check.options));
    THIMBLE_EQUAL(kind, check.hit.kind);
    THIMBLE_EQUAL(visits, check.hit.visits);
  }
}

void run(Check& check, int index) {
  const RayCase& wanted = ray_cases()[static_cast<size_t>(index)];
  THIMBLE_REQUIRE(build(check, *wanted.scene));
  const int first = wanted.scene->level <= kMaxDenseLevel ? 0 : 1;
  for (int structure = first; structure < 3; ++structure) {
    trace_in(check, structure, wanted);
  }
}

Case at(int index) {
  const RayCase& row = ray_cases()[static_cast<size_t>(index)];
  return {row.name, scene_bytes(row.scene->level, row.scene->pool_nodes), run, index, nullptr};
}

}  // namespace

const Group kRayGroup = {"ray", "rays.cpp", kRayCaseCount, at};

}  // namespace thimble::portable
