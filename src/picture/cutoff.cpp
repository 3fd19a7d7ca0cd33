#include "thimble/picture/cutoff.h"

#include "../base/bits.h"
#include "../base/wide_arithmetic.h"
#include "../trace/crossings.h"
#include "../trace/descent.h"
#include "../trace/path_cache.h"
#include "ray_range.h"

namespace thimble {
namespace {

// What a cut-off means for one ray.
struct RayCut {
  int32_t reach_q8;
  int level;
  int axis;  // of the largest direction component

  RayCut(const Cutoff& cutoff, const MirroredRay& ray) : level(cutoff.level()) {
    axis = ray.direction.y > ray.direction.x ? 1 : 0;
    axis = ray.direction.z > ray.direction[axis] ? 2 : axis;
    reach_q8 = cutoff.reach_q8(ray.direction[axis]);
  }
};

// The loop of trace.cpp, with one question more at each node: whether to stop there.
template <class Int, class Unsigned>
[[gnu::noinline]] CutHit walk_cut(const CompactTree& tree, const MirroredRay& ray, const RayCut& cut,
                                  uint32_t max_visits, DirectionPath<Unsigned>* cache) {
  CutHit result;
  Hit& hit = result.hit;
  const Crossings<Int> crossings(ray);
  Int num;
  Int den;
  if (tree.empty() || !crossings.enter_box(&num, &den)) {
    return result;
  }
  const CompactNodes nodes{tree};
  const int world_level = tree.level();
  const int32_t side = int32_t{1} << world_level;
  using Path = NodePath<Unsigned>;
  const Path& path = cache->path(ray, world_level);
  Step<Path> stack[kMaxLevel + 1];
  int32_t lows[kMaxLevel + 1];
  uint32_t pending = 0;
  typename Path::State state = path.start(ray, world_level);
  uint32_t index = 0;
  int level = world_level;
  int32_t low = 0;  // the node's lower plane on the cut-off's axis, in voxels
  bool inside = ray.within(side);

  for (uint32_t visits = 0;;) {
    if (level <= cut.level || ray.distance(cut.axis, low) >> level >= cut.reach_q8) {
      hit.kind = HitKind::kHit;
      hit.visits = visits;
      result.cut = true;
      result.node = index;
      report(ray, side, crossings, corner_of(stack, level, world_level), level, &hit);
      return result;
    }
    if (visits == max_visits) {
      hit.kind = HitKind::kStepLimit;
      hit.visits = visits;
      return result;
    }
    ++visits;
    NodeRef node;
    if (!nodes.load(index, &node)) {
      hit.visits = visits;
      return result;
    }
    const bool solid = node.mask == 0;
    uint32_t rest = path.octants(state) & node.mask;
    if (rest != 0) {
      rest = mirrored_octants(rest, ray.flip);
      if (inside) {
        rest &= octants_from(ray.origin_octant(level));
      }
    }
    if (solid || (level == 1 && rest != 0)) {
      hit.kind = HitKind::kHit;
      hit.visits = visits;
      if (!solid) {
        const unsigned octant = bits::lowest_bit(rest);
        hit.material = nodes.voxel_material(index, node.mask, octant ^ ray.flip);
        stack[level].octant = static_cast<uint8_t>(octant);
        level = 0;
      } else {
        hit.material = nodes.block_material(index);
        if (!nodes.merged(index)) {
          descend_to_voxel(path, ray, state, level, inside, stack);
          level = 0;
        }
      }
      report(ray, side, crossings, corner_of(stack, level, world_level), level, &hit);
      return result;
    }

    if (rest == 0) {
      if (pending == 0) {
        hit.visits = visits;
        return result;
      }
      level = static_cast<int>(bits::lowest_bit(pending));
      inside = false;
      state = stack[level].state;
      node = stack[level].node;
      rest = stack[level].rest;
      low = lows[level];
    } else {
      nodes.find_children(index, &node);
      stack[level].state = state;
      stack[level].node = node;
      lows[level] = low;
    }
    const unsigned octant = bits::lowest_bit(rest);
    rest &= rest - 1;
    stack[level].octant = static_cast<uint8_t>(octant);
    stack[level].rest = static_cast<uint8_t>(rest);
    pending = (pending & ~(uint32_t{1} << level)) | static_cast<uint32_t>(rest != 0) << level;
    inside = inside && octant == ray.origin_octant(level);
    index = nodes.child(node, octant ^ ray.flip);
    state = path.child(state, octant);
    --level;
    low |= static_cast<int32_t>((octant >> cut.axis & 1U) << level);
  }
}

Status trace_cut(const CompactTree& tree, const Ray& ray, const Cutoff& cutoff, const TraceOptions& options,
                 CutHit* hit, PathCache* cache) {
  const Status status = check_ray(ray, tree.level());
  if (status != Status::kOk) {
    return status;
  }
  // Chips with 32-bit registers take the narrow path whenever they may.
  bool narrow = options.width == Width::k32;
  if (narrow || (sizeof(void*) <= 4 && options.width == Width::kAuto)) {
    const bool accepted = accepts_32(ray, tree.level());
    if (narrow && !accepted) {
      return Status::kOutOfRange;
    }
    narrow = accepted;
  }
  const MirroredRay mirrored(ray, int32_t{1} << tree.level(), tree.bounds());
  const RayCut cut(cutoff, mirrored);
  *hit = narrow
             ? walk_cut<int32_t, uint32_t>(tree, mirrored, cut, options.max_visits, cache->of(uint32_t{0}))
             : walk_cut<int64_t, uint64_t>(tree, mirrored, cut, options.max_visits, cache->of(uint64_t{0}));
  return Status::kOk;
}

// Pixels of a row that are tested together.
constexpr int32_t kRunPx = 32;

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
  const uint64_t part = uint64_t{square_root_rounded(squares)} * static_cast<uint32_t>(pixels.raw);
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
  const uint64_t reach = ((static_cast<uint64_t>(static_cast<uint32_t>(largest)) * factor_) >> shift_) + 1;
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
  const int32_t width = camera.width_px();
  const bool means = shading.mode == ShadeMode::kColor && tree.many_materials();
  if (width == 0 || camera.level() != tree.level() || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row ||
      (means && !cutoff.cuts_nothing() && colors.nodes() != tree.node_count())) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  const size_t stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  if (line_bytes > band.pixels.size ||
      static_cast<size_t>(band.rows) - 1 > (band.pixels.size - line_bytes) / stride) {
    return Status::kOutOfMemory;
  }
  for (unsigned corner = 0; options.width == Width::k32 && corner < 4; ++corner) {
    const Ray ray =
        camera.ray((corner & 1U) != 0 ? width - 1 : 0, (corner & 2U) != 0 ? camera.height_px() - 1 : 0);
    if (!accepts_32(ray, tree.level())) {
      return Status::kBadArgument;
    }
  }

  // A cut node is shaded as a hit of a material of its own, the only one of this palette.
  Rgb8 mean;
  Shading shading_of_mean = shading;
  shading_of_mean.palette = Span<const Rgb8>(&mean, 1);
  const uint8_t material = tree.uniform_material();
  mean = material < shading.palette.size ? shading.palette[material] : shading.default_color;
  const Rgb8 background = shade(Hit{}, Ray{}, camera, shading);
  PathCache cache;
  RenderCounts done;
  for (int32_t row = 0; row < band.rows; ++row) {
    const int32_t y = band.first_row + row;
    uint8_t* line = band.pixels.data + stride * static_cast<size_t>(row);
    for (size_t i = 0; i < line_bytes; ++i) {
      line[i] = 0;
    }
    for (int32_t run = 0; run < width; run += kRunPx) {
      const int32_t end = run + kRunPx < width ? run + kRunPx : width;
      const bool missed = all_miss({camera.ray(run, y), camera.ray(end - 1, y)}, tree.bounds());
      RowRays rays(camera, run, y);
      for (int32_t x = run; x < end; ++x, rays.next()) {
        if (missed) {
          store_pixel(line, x, y, band.format, background);
          continue;
        }
        const Ray ray = rays.ray();
        CutHit hit;
        if (trace_cut(tree, ray, cutoff, options, &hit, &cache) != Status::kOk) {
          return Status::kBadArgument;
        }
        if (hit.cut && means) {
          // A damaged tree may lead to a node that is not there.
          mean = hit.node < colors.nodes() ? colors.color(hit.node) : shading.default_color;
        }
        store_pixel(line, x, y, band.format,
                    shade(hit.hit, ray, camera, hit.cut ? shading_of_mean : shading));
        done.node_visits += hit.hit.visits;
        done.hits += hit.hit.kind == HitKind::kHit ? 1U : 0U;
        done.step_limited += hit.hit.kind == HitKind::kStepLimit ? 1U : 0U;
      }
    }
    done.rays += static_cast<uint32_t>(width);
  }
  if (counts != nullptr) {
    counts->rays += done.rays;
    counts->hits += done.hits;
    counts->node_visits += done.node_visits;
    counts->step_limited += done.step_limited;
  }
  return Status::kOk;
}

}  // namespace thimble
