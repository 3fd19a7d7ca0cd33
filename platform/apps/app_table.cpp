#include "apps/app_table.h"

#include "apps/apps.h"

namespace thimble::apps {
namespace {

// One line each.
constexpr Application kApplications[] = {
    {"demo", demo, true, true, false, true},
    {"selftest", selftest, false, false},
    {"golden", golden, false, false},
    {"lit", lit, false, false},
    {"formats", formats, false, false},
    {"worlds", worlds, false, false},
    {"bricks", bricks, false, false},
    {"map_light", map_light, false, false},
    {"bench", bench, true, false},
#if __has_include("apps/particles.cpp")
    {"particles", particles, false, true},
#endif
    {"dig", dig, true, true},
    {"water", water, true, true, true},
    {"faults", faults, false, false},
    {nullptr, nullptr, false, false},  // so that the array is never empty
};

}  // namespace

Span<const Application> applications() {
  return {kApplications, sizeof kApplications / sizeof kApplications[0] - 1};
}

}  // namespace thimble::apps
