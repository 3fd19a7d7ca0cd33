/// What stands behind a scene at a pixel: a colour, a gradient or nothing, and a ground of which only the shadow
/// is seen; and a picture's tone. Integers, and nothing of a system: the page draws by it, too.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/scene.h"
#include "thimble/picture/pixel.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

enum class BackgroundKind : uint8_t {
  kAuto,      ///< the scene's own sky, else the gradient
  kGradient,  ///< a soft one, from top to bottom
  kColor,
  kNone,  ///< transparent
};
struct Background {
  BackgroundKind kind = BackgroundKind::kAuto;
  Rgb8 color;  ///< kColor
};

/// The gradient, from top to bottom.
inline constexpr Rgb8 kSoftTop{150, 168, 190};
inline constexpr Rgb8 kSoftBottom{226, 224, 218};
inline constexpr Rgb8 kSoftMiddle{188, 196, 204};

/// The background's colour in row `y` of a picture.
Rgb8 backdrop_color(const Background& background, int32_t y, int32_t height_px);

/// A level ground at height `z`, in voxels.
struct Ground {
  bool is_there = false;
  int32_t z = 0;
  Vec3i toward_sun;    ///< whose shadow it shows, unless the sun stands below
  uint16_t reach = 8;  ///< voxels within which it darkens under the model
};

/// Light that a ray finds behind the scene: kFullShare as it is, less in shadow.
inline constexpr uint8_t kFullShare = 254;
/// A share for a ray that hits.
inline constexpr uint8_t kNothingBehind = 255;

/// Whether `ray` of a camera misses everything; then how much light the ground that it meets has, if any:
/// kFullShare less the sun's exact shadow, and less what the model closes off above. Up to 34 rays.
/// False where it hits.
bool light_behind(const CompactTree& tree, const Ground& ground, const Ray& ray, uint8_t* share);

/// The background's colour with that share of its light.
constexpr Rgb8 shaded(Rgb8 behind, uint8_t share) {
  const auto part = [share](uint32_t back) {
    return static_cast<uint8_t>((back * share + kFullShare / 2) / kFullShare);
  };
  return {part(behind.r), part(behind.g), part(behind.b)};
}

// The steps of light_behind, for who traces the rays of many pixels together.

/// Directions of about kAroundLength each, spread over the hemisphere above by the cosine of their angle with the
/// upright: a spiral that turns by the golden angle.
inline constexpr Vec3i kAround[] = {
    {16, 0, 127},    {-20, 19, 125},  {3, -36, 123},  {26, 34, 121},  {-47, -8, 119},  {45, -28, 116},
    {-15, 56, 114},  {-29, -55, 112}, {62, 23, 110},  {-64, 27, 107}, {31, -66, 105},  {23, 73, 102},
    {-69, -40, 100}, {81, -18, 97},   {-50, 70, 95},  {-11, -88, 92}, {70, 59, 89},    {-95, 4, 86},
    {69, -69, 83},   {-5, 100, 80},   {-66, -79, 77}, {104, 14, 73},  {-88, 61, 70},   {24, -107, 66},
    {56, 97, 62},    {-109, -35, 58}, {106, -49, 53}, {-46, 109, 48}, {-41, -114, 42}, {109, 57, 36},
    {-121, 32, 28},  {69, -107, 16}};
inline constexpr size_t kAroundCount = sizeof(kAround) / sizeof(kAround[0]);
inline constexpr int32_t kAroundLength = 128;

/// Where a ray from above meets the ground, if within where rays may start.
bool meets_ground(const CompactTree& tree, const Ground& ground, const Ray& ray, Vec3Q8* at);
/// Whether the model may close off light there.
bool is_near_model(const CompactTree& tree, const Ground& ground, const Vec3Q8& at);
/// Of 256: how much of the sky something at that point of a ray of kAround closes off; nothing beyond the reach.
int64_t closed_at(const RayPoint& entry, uint16_t reach);
/// Shares of what lies in the sun's shadow, and where the rays of kAround have closed off that sum.
uint8_t in_shadow(uint8_t share);
uint8_t in_corner(uint8_t share, int64_t closed_sum);

// A picture's exposure and its shoulder as a table (lit_description.h says how it belongs together).

/// Greys of a picture: how many pixels have each.
struct GrayCounts {
  uint32_t of[256] = {};
};

/// The brightest tenth of a picture is brought to this grey, within the limits of an exposure.
inline constexpr uint32_t kExposedGray = 208;
inline constexpr uint32_t kLeastExposureQ8 = 208;
inline constexpr uint32_t kMostExposureQ8 = 416;
/// A picture of at most so many pixels each way, of every so manyth, tells the exposure, and the rays of them all.
inline constexpr int32_t kExposurePx = 96;
/// A pixel has four samples where those of the picture take at most so many rays, else one.
inline constexpr uint64_t kMostLookRays = 100'000'000;

/// The grey, 1 at least, that one pixel in `part` has or exceeds; 0 of a picture of nothing.
uint32_t bright_gray(const GrayCounts& counts, uint64_t part);
/// How much to brighten a picture of these greys, drawn at two thirds: 256 is not at all. A picture of nothing is
/// not.
uint32_t exposure_q8(const GrayCounts& counts);
/// The exposure of a picture whose colours are those that are to be seen: none, and no shoulder.
inline constexpr uint32_t kOwnColorsQ8 = 512;
/// Nothing but what glows gives light: its colours are its own.
inline bool is_dark_but_for_glow(const LitScene& scene) {
  return scene.lights.empty() && scene.ambient_q8[0] + scene.ambient_q8[1] + scene.ambient_q8[2] == 0;
}

/// What becomes of each value of a channel drawn at two thirds. Never falls; 0 stays 0.
struct ToneTable {
  uint8_t of[256] = {};
  uint8_t operator[](size_t value) const { return of[value]; }
  Rgb8 operator()(Rgb8 color) const { return {of[color.r], of[color.g], of[color.b]}; }
};
ToneTable tone_table(uint32_t exposure_q8);

}  // namespace thimble::tools
