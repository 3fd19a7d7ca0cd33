// Edges: where the next pixel to the right or below shows another face of about the same grey, this one is dark. A
// display of few greys cannot tell such faces apart otherwise.
#include "../../base/integers.h"
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"
#include "thimble/trace/secondary_ray.h"

namespace thimble::lit {
namespace {

// Faces that look one way are two where one lies so many pixels' sizes behind the other.
constexpr uint32_t kPixelsBehind = 4;
// Two faces that meet are wide enough to tell apart where each extends for so many pixels' sizes: else steps, leaves
// and gravel would be black.
constexpr uint32_t kPixelsWide = 2;
// Greys that are closer than this look the same.
constexpr uint32_t kSameGray = 26 * kLevel;
// What is left of the light on an edge, of 256.
constexpr uint32_t kLeftOnEdge = 48;

// What a ray turns or moves by from one pixel to the next.
Vec3i pixel_step(const Camera& camera, bool down) {
  const Camera::Vec3Q32& step = down ? camera.affine().step_y : camera.affine().step_x;
  return {Camera::rounded(step.x), Camera::rounded(step.y), Camera::rounded(step.z)};
}

// The size of a pixel where the ray met something, in 1/256 voxel.
uint32_t pixel_q8(const Camera& camera, const Vec3i& step, const Hit& hit) {
  uint32_t most = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t component = magnitude_32(step[axis]);
    most = component > most ? component : most;
  }
  if (!camera.is_perspective() || most == 0) {
    return most;
  }
  return static_cast<uint32_t>(
      distance_q8({static_cast<int32_t>(most), 0, 0}, hit.t_numerator, hit.t_denominator));
}

// Whether the face extends for so many voxels, to either side along an axis.
bool goes_on(const CompactTree& tree, const Spot& spot, int axis, int32_t voxels) {
  Vec3i behind{spot.at.x.floor(), spot.at.y.floor(), spot.at.z.floor()};
  behind[spot.face.axis] -= spot.face.negative ? 0 : 1;
  const int32_t middle = behind[axis];
  for (int side = 0; side < 2; ++side) {
    behind[axis] = middle + (side == 0 ? voxels : -voxels);
    Vec3i before = behind;
    before[spot.face.axis] += spot.face.negative ? -1 : 1;
    if (material_at(tree, behind, nullptr) && !material_at(tree, before, nullptr)) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool meets_edge(Frame& frame, const Ray& ray, const Hit& hit, const Spot& spot, bool down, Spot* beyond) {
  const Vec3i step = pixel_step(frame.camera, down);
  PendingRay next;
  next.ray = ray;
  for (int axis = 0; axis < 3; ++axis) {
    if (frame.camera.is_perspective()) {
      next.ray.direction[axis] += step[axis];
    } else {
      next.ray.origin[axis].raw += step[axis];
    }
  }
  Meeting meeting;
  count_ray(frame, LitRayKind::kPrimary);
  meet_solid(frame, next, &meeting);
  if (!meeting.found || meeting.hit.axis < 0 || is_clear(frame, meeting.hit.material)) {
    return false;
  }
  *beyond = spot_of(frame, next, meeting);
  const uint32_t size_q8 = pixel_q8(frame.camera, step, hit);
  const int axis = spot.face.axis;
  const int other = beyond->face.axis;
  if (axis == other) {
    const uint32_t behind = magnitude_32(spot.at[axis].raw - beyond->at[axis].raw);
    return behind > 0 && behind / kPixelsBehind >= size_q8;
  }
  const uint32_t voxels = size_q8 / (Q8::kOne / kPixelsWide);
  const auto wide = static_cast<int32_t>(voxels);
  return goes_on(frame.tree, spot, other, wide) && goes_on(frame.tree, *beyond, axis, wide);
}

bool is_same_gray(const Color& one, const Color& other) {
  uint32_t gray[2];
  for (int i = 0; i < 2; ++i) {
    const Color& color = i == 0 ? one : other;
    const uint32_t sum = 77 * color.c[0] + 150 * color.c[1] + 29 * color.c[2];
    gray[i] = (sum >> 8) < kWhite ? sum >> 8 : kWhite;
  }
  return (gray[0] < gray[1] ? gray[1] - gray[0] : gray[0] - gray[1]) < kSameGray;
}

void darken_edge(Weight* weight) {
  for (uint16_t& channel : weight->c) {
    channel = static_cast<uint16_t>(channel * kLeftOnEdge >> 8);
  }
}

}  // namespace thimble::lit
