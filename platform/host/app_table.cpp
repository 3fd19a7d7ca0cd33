#include "host/app_table.h"

#include "apps/apps.h"

namespace thimble::host {
namespace {

// One line each. A source tree may come without some of them.
constexpr Application kApplications[] = {
#if __has_include("apps/demo.cpp")
    {"demo", apps::demo, true, true},
#endif
#if __has_include("apps/selftest.cpp")
    {"selftest", apps::selftest, false, false},
#endif
#if __has_include("apps/bench.cpp")
    {"bench", apps::bench, true, false},
#endif
#if __has_include("apps/particles.cpp")
    {"particles", apps::particles, false, true},
#endif
    {nullptr, nullptr, false, false},  // so that the array is never empty
};

}  // namespace

Span<const Application> applications() {
  return {kApplications, sizeof kApplications / sizeof kApplications[0] - 1};
}

}  // namespace thimble::host
