#include "host/app_table.h"

#include "apps/apps.h"

namespace thimble::host {
namespace {

// One line each. The ones that a source tree may come without ask whether they are there.
constexpr Application kApplications[] = {
    {"demo", apps::demo, true, true},
    {"selftest", apps::selftest, false, false},
    {"golden", apps::golden, false, false},
    {"bench", apps::bench, true, false},
#if __has_include("apps/particles.cpp")
    {"particles", apps::particles, false, true},
#endif
    {"faults", apps::faults, false, false},
    {nullptr, nullptr, false, false},  // so that the array is never empty
};

}  // namespace

Span<const Application> applications() {
  return {kApplications, sizeof kApplications / sizeof kApplications[0] - 1};
}

}  // namespace thimble::host
