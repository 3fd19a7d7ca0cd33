#include "apps/app_table.h"

#include "apps/apps.h"

namespace thimble::apps {
namespace {

constexpr const char* kDemoKeys =
    "t  turns by itself, or not\nl  light on, off\nh  holds a rate of frames\nb  builds a scene in RAM\n"
    "S  back to the baked scene\np  the picture over the UART\nc  CRC-32 of frames\nq  ends\n";
#if __has_include("apps/particles.cpp")
constexpr const char* kParticlesKeys =
    "W A S D  gravity; 0 none\nr  begins again\nc  CRC-32 of the state\nq  ends\n";
#endif
constexpr const char* kDigKeys = "D u  digs, puts a ball\nq  ends\n";
constexpr const char* kWaterKeys =
    "x b  touches, drops a ball\nm  rain\n+ -  nearer, farther\nt  turns by itself, or not\n"
    "k  lays the water to rest\no  draws every band\ni  counters over the UART\nq  ends\n";

// One line each.
constexpr Application kApplications[] = {
    {"demo", demo, true, true, false, true, kDemoKeys},
    {"selftest", selftest, false, false},
    {"golden", golden, false, false},
    {"lit", lit, false, false},
    {"formats", formats, false, false},
    {"worlds", worlds, false, false},
    {"bricks", bricks, false, false},
    {"map_light", map_light, false, false},
    {"bench", bench, true, false},
#if __has_include("apps/particles.cpp")
    {"particles", particles, false, true, false, false, kParticlesKeys},
#endif
    {"dig", dig, true, true, false, false, kDigKeys},
    {"water", water, true, true, true, false, kWaterKeys},
    {"faults", faults, false, false},
    {nullptr, nullptr, false, false},  // so that the array is never empty
};

}  // namespace

Span<const Application> applications() {
  return {kApplications, sizeof kApplications / sizeof kApplications[0] - 1};
}

const Application* find_application(const char* name) {
  for (const Application& application : applications()) {
    if (__builtin_strcmp(application.name, name) == 0) {
      return &application;
    }
  }
  return nullptr;
}

}  // namespace thimble::apps
