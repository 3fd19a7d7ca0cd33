#include "scene/display_look.h"

#include <algorithm>
#include <array>
#include <vector>

#include "scene/lit_setup.h"
#include "scene/tone.h"
#include "thimble/light/render.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

constexpr std::int32_t kMostLookedAt = 96;
// Of a display of few greys: what its brightest twentieth becomes, and the most exposure; what glares is dimmed by so
// much, and looked at again.
constexpr std::uint32_t kBrightGray = 244;
constexpr std::uint32_t kMostQ8 = 1024;
constexpr std::uint32_t kGlaring = 250;
constexpr std::uint32_t kDimmedQ8 = 144;
constexpr int kMostTurns = 4;

// Greys of what the camera sees that is solid, and of the sky behind it.
std::array<std::uint32_t, 256> seen_grays(const CompactTree& tree, const Camera& camera,
                                          const Shading& shading, const LitScene& scene, EffectSet effects) {
  std::array<std::uint32_t, 256> counts{};
  std::vector<std::uint8_t> row(static_cast<std::size_t>(camera.width_px()) * 3);
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    const Band band{{row.data(), row.size()}, PixelFormat::kRgb888, 0, y, 1};
    if (render_lit_band(effects, tree, camera, shading, scene, band) != Status::kOk) {
      return {};
    }
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      Hit hit;
      if ((effects & Effect::kSky) != 0 ||
          (closest_hit(tree, camera.ray(x, y), &hit) == Status::kOk && hit.kind == HitKind::kHit)) {
        const std::uint8_t* const pixel = row.data() + 3 * static_cast<std::size_t>(x);
        counts[(77U * pixel[0] + 150U * pixel[1] + 29U * pixel[2]) >> 8] += 1;
      }
    }
  }
  return counts;
}

// The grey that a share of what is seen, 1 in `part`, has or exceeds; 0 where nothing is seen.
std::uint32_t bright_gray(const std::array<std::uint32_t, 256>& counts, std::uint64_t part) {
  std::uint64_t total = 0;
  for (const std::uint32_t count : counts) {
    total += count;
  }
  std::uint64_t above = 0;
  for (std::uint32_t gray = 256; total != 0 && gray-- > 0;) {
    above += counts[gray];
    if (part * above >= total) {
      return std::max(1U, gray);
    }
  }
  return 0;
}

}  // namespace

bool has_few_grays(PixelFormat format) {
  return is_gray(format) && format != PixelFormat::kGray8;
}

void suit_display(const DisplayFacts& display, const CompactTree& tree, const SceneCamera& camera,
                  Span<const Rgb8> palette, const UsedMaterials& used, EffectSet effects,
                  LitDescription* lit) {
  Camera view;
  if (set_camera(camera, display.width_px, display.height_px, tree.level(), &view) != Status::kOk) {
    return;
  }
  const std::int32_t longest = std::max(display.width_px, display.height_px);
  const Camera looked = view.thinned((longest + kMostLookedAt - 1) / kMostLookedAt);
  Shading shading;
  shading.palette = palette;
  const bool few = has_few_grays(display.format);
  // What glares is one white: how bright it is shows when it is dimmed.
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const LitScene scene = lit_scene_for(*lit, used, effects);
    const std::uint32_t gray =
        bright_gray(seen_grays(tree, looked, shading, scene, effects & ~Effect::kEdges), few ? 20 : 10);
    if (gray == 0) {
      return;
    }
    const bool glares = few && gray >= kGlaring;
    const std::uint32_t exposure =
        glares ? kDimmedQ8
        : few  ? std::min(kBrightGray * 256 / gray, kMostQ8)
               : std::clamp(kExposedGray * 256 / gray, kLeastExposureQ8, kMostExposureQ8);
    expose_light(exposure, used, lit);
    if (!glares) {
      return;
    }
  }
}

}  // namespace thimble::tools
