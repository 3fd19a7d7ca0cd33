/// @file optics.h
/// Directions and light in integers: unit vectors, mirrors, refraction, Fresnel, absorption, and the fixed
/// patterns that stand in for chance. The same numbers on every machine.
///
/// Formats
///   unit vectors  Q14: 16384 is 1; their length is within kUnitLengthError of it
///   factors       Q16: 65536 is 1
///   indices       Q12: 4096 is 1
///
/// Every function rounds magnitudes, so mirrored or turned input gives mirrored or turned output. The bounds
/// named `...Error...` are those of the function against exact arithmetic on the very integers that it is
/// given; test_optics.cpp sweeps each against long double. Nothing here divides 64 bits. What takes
/// more than a few dozen instructions says so.
///
/// Sources: Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994 (reflectance); Shirley
/// and Chiu, "A Low Distortion Map Between Disk and Square", 1997 (why equal areas of the disc give cosine
/// distribution); the laws of Snell and of Beer and Lambert.
#ifndef THIMBLE_LIGHT_HOST_OPTICS_H
#define THIMBLE_LIGHT_HOST_OPTICS_H

#include <stddef.h>
#include <stdint.h>

#include "../../base/vec.h"

namespace thimble {

inline constexpr int32_t kUnitQ14 = 1 << 14;
inline constexpr uint32_t kOneQ16 = 1U << 16;
inline constexpr uint32_t kOneQ12 = 1U << 12;

/// Components that `shorten` leaves: at most this in magnitude (15 bits).
inline constexpr int32_t kMaxShort = (1 << 15) - 1;

// Bounds. Urad: 10^-6 rad.
inline constexpr uint32_t kShortenErrorUrad = 53;   ///< sqrt(3)/2 units of 2^14; 0 up to 15 bits
inline constexpr uint32_t kUnitErrorUrad = 106;     ///< of `unit_q14`, shortening included
inline constexpr int32_t kUnitLengthError = 2;      ///< | |unit| - 16384 |
inline constexpr uint32_t kReflectErrorUrad = 100;  ///< at a bent normal; at an axis it is exact
inline constexpr uint32_t kRefractErrorUrad = 130;  ///< ratios 1/4 .. 4, at an axis and a bent normal
inline constexpr uint32_t kSchlickErrorQ16 = 3;     ///< of `fresnel_q16` against Schlick's formula
inline constexpr uint32_t kNormalErrorQ16 = 2;      ///< of `r0_q16`
inline constexpr uint32_t kTransmittanceErrorQ16 = 2;
inline constexpr uint32_t kDistanceErrorPpm = 85;  ///< of `distance_q8`, and half a unit

/// `direction` (at most 20 bits a component) with at most 15: halved until it fits, each component rounded to
/// nearest once. Zero stays zero, the largest component stays above 2^14 - 1; a direction that fits already
/// is unchanged.
Vec3i shorten(const Vec3i& direction);

/// Length of a vector of components up to kMaxShort, to the nearest integer: the sum of squares fits 32 bits.
/// 16 steps.
uint32_t length_of(const Vec3i& vector);

/// `direction` (at most 20 bits a component, not all 0) at length 16384. A direction along an axis, or one
/// whose components are equal or opposite, stays so exactly. One root, three 32-bit divisions. Zero gives
/// zero.
Vec3i unit_q14(const Vec3i& direction);

/// Product of two vectors of length up to 2^15 each, as if the second were a unit: their cosine in Q14 for
/// two units. Rounded to nearest.
int32_t dot_q14(const Vec3i& a, const Vec3i& unit_q14);

/// At a face of `axis`: a change of sign, exact for any direction.
constexpr Vec3i reflect(Vec3i direction, int axis) {
  direction[axis] = -direction[axis];
  return direction;
}
/// At a surface with a bent normal, of either sign: `direction` up to kMaxShort a component and of the same
/// length after it, so a component may reach 2^16. Whether the result leaves the face itself is for
/// `leaves_face` (secondary_ray.h) to say.
Vec3i reflect(const Vec3i& direction, const Vec3i& normal_q14);

/// n1 / n2 for light that goes from index n1 to n2, both in 1 .. 65535: rounded to nearest, clamped to
/// kMinEtaQ12 .. kMaxEtaQ12; exactly kOneQ12 for equal indices.
inline constexpr uint32_t kMinEtaQ12 = kOneQ12 / 4;
inline constexpr uint32_t kMaxEtaQ12 = kOneQ12 * 4;
uint32_t eta_q12(uint32_t n1_q12, uint32_t n2_q12);

/// Light that goes through a face of `axis` by Snell's law. `unit` has a length within 64 of 16384; `out`
/// gets the same length, to a unit or two. `eta_q12` (kMinEtaQ12 .. kMaxEtaQ12; clamped) is n1 / n2.
///
/// False, and `out` untouched, on total reflection: with c the component along the axis, a and b the others,
///
///   eta_q12^2 * (a^2 + b^2) >= 2^24 * (a^2 + b^2 + c^2)
///
/// in exact integers; also for c = 0, which goes nowhere. Otherwise the component along the axis keeps its
/// sign and is not 0. kOneQ12 is no surface: true, and `unit` itself, always. One 32-bit root, 64-bit
/// products.
bool refract(const Vec3i& unit, int axis, uint32_t eta_q12, Vec3i* out);
/// The same at a bent normal of either sign, which has a length within 16 of 16384. With D = unit . normal,
/// N = normal . normal, L = unit . unit it is false for D = 0 and for
///
///   eta_q12^2 * (64 * L - floor(64 * D^2 / N)) >= 2^24 * 64 * L
///
/// One division of 64 bits by shifting besides, about 35 steps. `out` lies on the far side of the bent
/// surface or in it; whether it enters the face itself is for `enters_face` (secondary_ray.h) to say.
bool refract(const Vec3i& unit, const Vec3i& normal_q14, uint32_t eta_q12, Vec3i* out);

/// The share of light reflected at normal incidence between two indices (0 .. 65535, not both 0):
/// ((n1 - n2) / (n1 + n2))^2. Exactly 0 for equal indices, at least 1 for others.
uint32_t r0_q16(uint32_t n1_q12, uint32_t n2_q12);

/// The share of light reflected at an angle: r0 + (1 - r0) (1 - cos)^5, 0 .. 65536, falling with the cosine.
/// What goes through is kOneQ16 less it, so that both together are 1. Exactly 0 for `r0_q16` 0 (equal
/// indices). `cos_q14` is the smaller one of the two cosines at the surface, that in the thinner medium, of
/// either sign: taken as a magnitude, above 16384 as 16384.
uint32_t fresnel_q16(int32_t cos_q14, uint32_t r0_q16);

/// What is left of light after so many halvings: 2^-(halvings / 65536). 65536 at 0, never rising, 1 at 16
/// halvings and 0 from 17 on. A table of 65 entries, straight lines between.
uint32_t transmittance_q16(uint32_t halvings_q16);

/// Length in 1/256 voxel of the way from a ray's origin to t = t_numerator / t_denominator, with the terms as
/// in `Hit`: numerator 0 .. 2^24, denominator 256 times a component of `direction`, or 1 for t = 0. Clamped
/// to INT32_MAX. One root, two 32-bit divisions.
int32_t distance_q8(const Vec3i& direction, int32_t t_numerator, int32_t t_denominator);
/// The same, and |unit_q14(direction)[axis]|, at most 2^14, by the same root and one division more.
int32_t distance_q8(const Vec3i& direction, int32_t t_numerator, int32_t t_denominator, int axis,
                    uint32_t* cosine_q14);

/// Directions of a hemisphere round +z in 1/127, cosine distributed: the first 4, 8, 16 and 32 have equal
/// shares of the disc below them each, and their sideways components add up to 0. None lies in the plane.
struct PatternDirection {
  int8_t x;
  int8_t y;
  int8_t z;
};
inline constexpr int kOcclusionDirections = 32;
inline constexpr PatternDirection kOcclusionPattern[kOcclusionDirections] = {
    {84, 45, 84},  {-45, 84, 84},  {-84, -45, 84},  {45, -84, 84},   //
    {24, 80, 95},  {-80, 24, 95},  {-24, -80, 95},  {80, -24, 95},   //
    {114, 11, 55}, {-11, 114, 55}, {-114, -11, 55}, {11, -114, 55},  //
    {35, 43, 114}, {-43, 35, 114}, {-35, -43, 114}, {43, -35, 114},  //
    {50, 93, 71},  {-93, 50, 71},  {-50, -93, 71},  {93, -50, 71},   //
    {68, 21, 105}, {-21, 68, 105}, {-68, -21, 105}, {21, -68, 105},  //
    {95, 78, 32},  {-78, 95, 32},  {-95, -78, 32},  {78, -95, 32},   //
    {3, 32, 123},  {-32, 3, 123},  {-3, -32, 123},  {32, -3, 123},   //
};
/// Lengths of these, all of them within 1 of it.
inline constexpr int32_t kOcclusionLength = 127;

/// A direction of the pattern (0 .. 31) round the outer normal of a face: z becomes `axis`, negative for a
/// face that looks to smaller coordinates, x and y the next axes in turn.
constexpr Vec3i occlusion_direction(int index, int axis, bool towards_smaller) {
  const PatternDirection& from = kOcclusionPattern[index];
  Vec3i direction;
  direction[axis] = towards_smaller ? -int32_t{from.z} : int32_t{from.z};
  direction[axis == 2 ? 0 : axis + 1] = int32_t{from.x};
  direction[axis == 0 ? 2 : axis - 1] = int32_t{from.y};
  return direction;
}

/// A mirrored direction (about Q14 units) bent a little, as the facets of a rough metal do: `index` 0 .. 3,
/// the four offsets adding up to 0; `roughness` 0 (none) to 255 (by up to 0.54 of the length, 33 degrees).
inline constexpr int kRoughnessRays = 4;
constexpr Vec3i roughen(const Vec3i& unit, uint8_t roughness, int index) {
  // The corners of a tetrahedron.
  const int32_t step = 20 * int32_t{roughness};
  return {unit.x + (index == 0 || index == 1 ? step : -step),
          unit.y + (index == 0 || index == 2 ? step : -step),
          unit.z + (index == 0 || index == 3 ? step : -step)};
}

}  // namespace thimble

#endif
