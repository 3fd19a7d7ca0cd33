#include "thimble/picture/cutoff.h"

#include "../base/bits.h"
#include "../base/wide_arithmetic.h"
#include "../trace/crossings.h"
#include "../trace/descent.h"
#include "../trace/path_cache.h"
#include "../trace/width.h"
#include "band.h"

namespace thimble {
namespace {

// The rule of a cut-off for one ray: the walk stops at nodes that are cut.
class RayCut {
 public:
  RayCut(const Cutoff& cutoff, const MirroredRay& ray) : level_(cutoff.level()) {
    axis_ = ray.direction.y > ray.direction.x ? 1 : 0;
    axis_ = ray.direction.z > ray.direction[axis_] ? 2 : axis_;
    reach_q8_ = cutoff.reach_q8(ray.direction[axis_]);
  }

  bool stops_at(const MirroredRay& ray, uint32_t index, int level) {
    stopped_ = level <= level_ || ray.distance(axis_, low_) >> level >= reach_q8_;
    node_ = index;
    return stopped_;
  }
  void keep(int level) { lows_[level] = low_; }
  void go_back(int level) { low_ = lows_[level]; }
  void enter(unsigned octant, int level) { low_ |= static_cast<int32_t>((octant >> axis_ & 1U) << level); }

  // Whether the walk was stopped, and at which node.
  bool stopped() const { return stopped_; }
  uint32_t node() const { return node_; }

 private:
  int32_t reach_q8_;
  int level_;
  int axis_;         // of the largest direction component
  int32_t low_ = 0;  // the node's lower plane on that axis, in voxels
  int32_t lows_[kMaxLevel + 1];
  uint32_t node_ = 0;
  bool stopped_ = false;
};

// Not inlined, so that a ray takes the stack of its own width only.
template <class Int, class Unsigned>
[[gnu::noinline]] CutHit walk_cut(const CompactTree& tree, const MirroredRay& ray, const Cutoff& cutoff,
                                  uint32_t max_visits, DirectionPath<Unsigned>* cache) {
  RayCut cut(cutoff, ray);
  CutHit result;
  result.hit = walk_octree<Int>(CompactNodes{tree}, ray, {max_visits, false}, cut, cache);
  result.cut = cut.stopped();
  result.node = cut.stopped() ? cut.node() : 0;
  return result;
}

Status trace_cut(const CompactTree& tree, const Ray& ray, const Cutoff& cutoff, const TraceOptions& options,
                 CutHit* hit, PathCache* cache) {
  const Status status = check_ray(ray, tree.level());
  if (status != Status::kOk) {
    return status;
  }
  bool narrow = false;
  if (!choose_width(options.width, &narrow, [&] { return accepts_32(ray, tree.level()); })) {
    return Status::kOutOfRange;
  }
  const MirroredRay mirrored(ray, int32_t{1} << tree.level(), tree.bounds());
  *hit =
      narrow
          ? walk_cut<int32_t, uint32_t>(tree, mirrored, cutoff, options.max_visits, cache->of(uint32_t{0}))
          : walk_cut<int64_t, uint64_t>(tree, mirrored, cutoff, options.max_visits, cache->of(uint64_t{0}));
  return Status::kOk;
}

}  // namespace

Status Cutoff::set(const Camera& camera, Q16 pixels) {
  if (pixels.raw < 0 || pixels > kMaxCutoff) {
    return Status::kOutOfRange;
  }
  if (camera.width_px() == 0) {
    return Status::kBadArgument;
  }
  *this = Cutoff();
  if (pixels.raw == 0) {
    return Status::kOk;
  }
  // The length of a step from pixel to pixel: `length` * 2^scale in 32.32, with 31 or 32 bits.
  const Camera::Vec3Q32& step = camera.affine().step_x;
  uint64_t largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint64_t size = magnitude(step[axis]);
    largest = size > largest ? size : largest;
  }
  if (largest == 0) {  // no pixel has any width
    return Status::kOk;
  }
  const int scale = bit_width(largest) - 31;
  uint64_t squares = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint64_t size = magnitude(step[axis]);
    const uint64_t part = scale > 0 ? shift_rounded(size, scale) : size << -scale;
    squares += part * part;  // below 3 * 2^62
  }
  const uint64_t part = wide_product_u(square_root_rounded(squares), static_cast<uint32_t>(pixels.raw));
  if (!camera.is_perspective()) {
    // 2^level voxels against part * 2^scale in 1/2^48 of 1/256 voxel.
    for (int level = 1; level <= kMaxLevel; ++level) {
      const int bit = level + 56 - scale;
      if (bit < 0 || (bit < 63 && uint64_t{1} << bit < part)) {
        level_ = static_cast<uint8_t>(level);
      }
    }
    return Status::kOk;
  }
  // reach = 2^56 * largest / (part * 2^scale), part made 32 bits long: the factor has 31.
  const int surplus = bit_width(part) - 32;
  const uint64_t divisor = surplus > 0 ? shift_rounded(part, surplus) : part << -surplus;
  const int shift = 62 + surplus + scale - 56;
  if (shift >= 0) {  // else nothing is ever that far away
    factor_ = static_cast<uint32_t>(divide(uint64_t{1} << 62, divisor));
    shift_ = static_cast<uint8_t>(shift < 63 ? shift : 63);
  }
  return Status::kOk;
}

Status Cutoff::set_level(int level) {
  if (level < 0 || level > kMaxLevel) {
    return Status::kOutOfRange;
  }
  level_ = level > level_ ? static_cast<uint8_t>(level) : level_;
  return Status::kOk;
}

int32_t Cutoff::reach_q8(int32_t largest) const {
  if (factor_ == 0) {
    return INT32_MAX;
  }
  const uint64_t reach = (wide_product_u(static_cast<uint32_t>(largest), factor_) >> shift_) + 1;
  return reach < INT32_MAX ? static_cast<int32_t>(reach) : INT32_MAX;
}

Status closest_hit_cut(const CompactTree& tree, const Ray& ray, const Cutoff& cutoff, CutHit* hit,
                       const TraceOptions& options) {
  PathCache cache;
  return trace_cut(tree, ray, cutoff, options, hit, &cache);
}

Status render_band_cut(const CompactTree& tree, const Camera& camera, const Shading& shading,
                       const Cutoff& cutoff, const NodeColors& colors, const Band& band, RenderCounts* counts,
                       const TraceOptions& options) {
  const bool means = shading.mode == ShadeMode::kColor && tree.many_materials();
  size_t stride = 0;
  Status status = check_band(camera, tree.level(), band, &stride);
  // That colours are missing is said before anything else of a band, an empty one too.
  if (status != Status::kBadArgument && means && !cutoff.cuts_nothing() &&
      colors.nodes() != tree.node_count()) {
    status = Status::kBadArgument;
  }
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  status = check_width(camera, tree.level(), options.width);
  if (status != Status::kOk) {
    return status;
  }

  // A cut node is shaded as a hit of a material of its own, the only one of this palette.
  Rgb8 mean;
  Shading shading_of_mean = shading;
  shading_of_mean.palette = Span<const Rgb8>(&mean, 1);
  const uint8_t material = tree.uniform_material();
  mean = material < shading.palette.size ? shading.palette[material] : shading.default_color;
  const Rgb8 background = shade(Hit{}, Ray{}, camera, shading);
  PathCache cache;
  return draw_rows(camera, tree.bounds(), band, stride, background, counts,
                   [&](const Ray& ray, Hit* hit, Rgb8* color) {
                     CutHit found;
                     const Status traced = trace_cut(tree, ray, cutoff, options, &found, &cache);
                     if (found.cut && means) {
                       // A damaged tree may lead to a node that is not there.
                       mean = found.node < colors.nodes() ? colors.color(found.node) : shading.default_color;
                     }
                     *hit = found.hit;
                     *color = shade(found.hit, ray, camera, found.cut ? shading_of_mean : shading);
                     return traced;
                   });
}

}  // namespace thimble
