#include "scene/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "output/units.h"
#include "readers/source.h"
#include "scene/scene_source.h"
#include "scene/workers.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

Real3 unit(const Real3& a) {
  return scaled(a, 1 / std::sqrt(dot(a, a)));
}

// Of integers of 30 bits, components within -1 .. 1.
Real3 to_reals(const Vec3i& vector) {
  return scaled(real_of(vector), 1.0 / kMaxViewComponent);
}

// Where rays may start, on each axis.
struct Reach {
  explicit Reach(int level)
      : low(static_cast<double>(kMinOriginWorlds) * (1 << level)),
        high(static_cast<double>(kMaxOriginWorlds) * (1 << level)) {}
  bool holds(const Real3& point) const {
    return std::all_of(point.begin(), point.end(), [&](double at) { return at >= low && at <= high; });
  }

  double low;
  double high;
};

template <class... Pieces>
void fail_view_if(bool is_wrong, FramingFault fault, const Pieces&... pieces) {
  if (is_wrong) {
    throw FramingError(fault, pieces...);
  }
}

Vec3Q8 reachable_q8(const Real3& eye, const Reach& reach, bool is_given) {
  fail_view_if(!reach.holds(eye), is_given ? FramingFault::kEyeOutside : FramingFault::kTargetTooFar,
               is_given ? "the eye is at " : "the eye for this target would be at ", text_of(eye),
               ", outside the accepted ", shortest(reach.low), " to ", shortest(reach.high),
               " (-4 to 5 world sizes)");
  return to_q8(eye);
}

// The nearest point that can be written.
Vec3Q8 saturated_q8(const Real3& point) {
  Vec3Q8 result;
  for (int axis = 0; axis < 3; ++axis) {
    const double raw = std::round(point[static_cast<std::size_t>(axis)] * Q8::kOne);
    result[axis] = Q8::from_raw(static_cast<std::int32_t>(
        std::clamp(raw, static_cast<double>(INT32_MIN), static_cast<double>(INT32_MAX))));
  }
  return result;
}

Q14 span_q14(double voxels) {
  fail_view_if(!(voxels * Q14::kOne <= INT32_MAX), FramingFault::kSpan, "a picture ", shortest(voxels),
               " voxels wide is beyond the limit of 131,071");
  return Q14::from_raw(static_cast<std::int32_t>(std::max(1L, std::lround(voxels * Q14::kOne))));
}

double voxels_of(Q14 length) {
  return static_cast<double>(length.raw) / Q14::kOne;
}

Real3 middle_of(const VoxelBox& bounds) {
  return scaled(plus(real_of(bounds.low), real_of(bounds.high)), 0.5);
}

constexpr const char* kUpIsParallel = "what is up is parallel to the direction of view";

// What is looked at, and which way.
struct Sight {
  Real3 target;
  Vec3i forward;  // as the core is given them, so that both mean the same axes
  Vec3i up;
  PictureAxes axes;  // of length 1
};

Sight sight_of(const ViewWishes& wishes, const Reach& reach, const VoxelBox& bounds) {
  Sight sight;
  sight.target = wishes.target.value_or(middle_of(bounds));
  if (wishes.eye) {
    reachable_q8(*wishes.eye, reach, true);
  }
  const Real3 direction = wishes.eye ? minus(sight.target, *wishes.eye) : wishes.forward;
  fail_view_if(largest(direction) == 0, FramingFault::kNoDirection,
               "the eye and the target are the same point");
  fail_view_if(wishes.up && largest(*wishes.up) == 0, FramingFault::kUp,
               "what is up, 0,0,0, has no direction");
  sight.forward = to_integers(direction, kMaxViewComponent);
  sight.up = wishes.up ? to_integers(*wishes.up, kMaxViewComponent) : default_up(sight.forward);
  const Real3 forward = to_reals(sight.forward);
  const Real3 up = to_reals(sight.up);
  fail_view_if(largest(cross(forward, up)) == 0, FramingFault::kUp, kUpIsParallel);
  sight.axes.forward = unit(forward);
  sight.axes.right = unit(cross(sight.axes.forward, up));
  sight.axes.up = cross(sight.axes.right, sight.axes.forward);
  return sight;
}

// How a picture opens: the tangent of half its vertical angle, and its width by its height.
struct Lens {
  explicit Lens(const ViewWishes& wishes)
      : aspect(static_cast<double>(wishes.width_px) / wishes.height_px),
        tan_y(std::tan(wishes.fov_degrees * 3.14159265358979323846 / 360)) {}

  double aspect;
  double tan_y;
};

// What it takes to see all corners.
struct Room {
  double distance = 0;    // of the eye from the target, in perspective
  double half_width = 0;  // of a parallel picture
  double before = 0;      // the farthest corner on the eye's side of the target
};

Room room_for(const VoxelBox& box, const Sight& sight, const Lens& lens, double fill) {
  Room room;
  for (const Vec3i& corner : box_corners(box)) {
    const Real3 offset = minus(real_of(corner), sight.target);
    const double x = std::abs(dot(offset, sight.axes.right));
    const double y = std::abs(dot(offset, sight.axes.up));
    const double z = dot(offset, sight.axes.forward);
    room.distance =
        std::max({room.distance, x / (lens.tan_y * lens.aspect * fill) - z, y / (lens.tan_y * fill) - z});
    room.half_width = std::max({room.half_width, x, y * lens.aspect});
    room.before = std::max(room.before, -z);
  }
  return room;
}

// The eye at `wanted` from the target, or, where a narrow view would want to stand farther back than rays may
// start, as far as they may.
Real3 eye_at(const Sight& sight, double wanted, const Reach& reach) {
  const Real3& forward = sight.axes.forward;
  double distance = wanted;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double limit = forward[axis] > 0 ? reach.low : reach.high;
    const double back = (sight.target[axis] - limit) / forward[axis];
    if (forward[axis] != 0 && back >= 0 && back < distance) {
      distance = back;
    }
  }
  Real3 eye = minus(sight.target, scaled(forward, distance));
  if (reach.holds(sight.target) && distance < wanted) {
    for (double& coordinate : eye) {  // what rounding may have added
      coordinate = std::clamp(coordinate, reach.low, reach.high);
    }
  }
  return eye;
}

// Whether a picture shows all points: in perspective, or of that half width.
bool shows_all(std::span<const Vec3i> points, const Real3& eye, const PictureAxes& axes, const Lens& lens,
               std::optional<double> half_width = {}) {
  return std::none_of(points.begin(), points.end(), [&](const Vec3i& point) {
    const Real3 offset = minus(real_of(point), eye);
    const double depth = dot(offset, axes.forward);
    const double reach_y = half_width ? *half_width / lens.aspect : depth * lens.tan_y;
    return depth <= 0 || std::abs(dot(offset, axes.up)) > reach_y ||
           std::abs(dot(offset, axes.right)) > reach_y * lens.aspect;
  });
}

void check(Status status, FramingFault fault, const std::string& why) {
  fail_view_if(status == Status::kBadArgument, FramingFault::kUp, kUpIsParallel);
  fail_view_if(status != Status::kOk, fault, "the camera: ", status_text(status), ": ", why);
}

Status set_camera(const ViewWishes& wishes, int level, Framing* framing) {
  return set_camera(framing->kept, wishes.width_px, wishes.height_px, level, &framing->camera);
}

void set_perspective_camera(const ViewWishes& wishes, int level, Framing* framing) {
  const Status status = set_camera(wishes, level, framing);
  const bool is_coarse = status == Status::kTooFine && wishes.direction_bits != 0;
  check(status, is_coarse ? FramingFault::kCoarseDirections : FramingFault::kFineDirections,
        is_coarse ? concat("directions of ", wishes.direction_bits, " bits are too coarse for this picture")
                  : "directions of 20 bits cannot be kept within 1/8 pixel");
}

// How far, in pixels, rays lie from where they were wished: the core's bound starts from the eye and the span
// as it got them, and what rounding them moved is added.
double moved_px(const ViewWishes& wishes, const Framing& framing, const Sight& sight) {
  const double pixel = voxels_of(framing.kept.span) / wishes.width_px;
  double moved = framing.camera.error_bound_px_q16() / 65536.0;
  if (wishes.eye) {
    const Real3 rounding = minus(*wishes.eye, real_of(framing.kept.eye));
    moved += std::hypot(dot(rounding, sight.axes.right), dot(rounding, sight.axes.up)) / pixel;
  }
  if (wishes.span) {
    moved += std::abs(*wishes.span / wishes.width_px / pixel - 1) *
             std::hypot(wishes.width_px, wishes.height_px) / 2;
  }
  return moved;
}

// `whole`: the span that shows all. True where that much cannot be shown.
bool set_orthographic_camera(const ViewWishes& wishes, int level, const Sight& sight, double whole,
                             Framing* framing) {
  constexpr double kMostSpan = 131071;
  const double least = voxels_of(least_orthographic_span(wishes.width_px, level));
  bool partial = !wishes.span && whole > kMostSpan;
  Q14& span = framing->kept.span;
  span = span_q14(wishes.span.value_or(std::min(whole, kMostSpan)));
  Status status = set_camera(wishes, level, framing);
  if (status == Status::kTooFine && !wishes.span) {
    span = span_q14(least);  // a scene of a few voxels is shown smaller instead
    status = set_camera(wishes, level, framing);
  }
  // A long thin picture of the whole scene may be wider than rays may start: then it shows less.
  for (int tries = 0; status == Status::kOutOfRange && !wishes.span && tries < 64; ++tries) {
    span = span_q14(voxels_of(span) * 0.8);
    status = set_camera(wishes, level, framing);
    partial = true;
  }
  if (status == Status::kOk && wishes.direction_bits == 0 && moved_px(wishes, *framing, sight) > 0.125) {
    status = Status::kTooFine;
  }
  const bool is_fine = status == Status::kTooFine;
  check(status, is_fine ? FramingFault::kFineOrigins : FramingFault::kCornersOutside,
        is_fine ? "the pixels are too fine for origins in 1/256 voxel; a wider picture helps, of about " +
                      shortest(std::ceil(2 * least * 100) / 100) + " voxels"
                : "the picture's corners must lie within -4 to 5 world sizes");
  return partial;
}

constexpr double kDegree = 3.14159265358979323846 / 180;
// By how much the demonstration's eye nods (apps/demo_view.h), in degrees.
constexpr double kRoundNod = 360.0 / 256;

// The way in, and what is up where that is upright.
void look_from(const ViewAngles& angles, ViewWishes* wishes) {
  const double turn = angles.turn * kDegree;
  const double tilt = std::clamp(angles.tilt, -90.0, 90.0) * kDegree;
  wishes->forward = {-std::sin(turn) * std::cos(tilt), std::cos(turn) * std::cos(tilt), -std::sin(tilt)};
  constexpr double kUpright = 89.9;
  if (!wishes->up && std::abs(angles.tilt) > kUpright) {
    const double side = angles.tilt > 0 ? 1 : -1;
    wishes->forward = {0, 0, -side};
    wishes->up = Real3{-side * std::sin(turn), side * std::cos(turn), 0};
  }
}

// Corners as a camera sees them, about a point near them all.
class SeenExtent {
 public:
  SeenExtent(const std::vector<Vec3i>& corners, const Real3& middle, const PictureAxes& axes) {
    for (const Vec3i& corner : corners) {
      const Real3 offset = minus(real_of(corner), middle);
      points_.push_back({dot(offset, axes.right), dot(offset, axes.up), dot(offset, axes.forward)});
    }
  }

  /// Where two planes through the eye that open by `slope` to either side of the view touch the corners:
  /// their crossing, as the coordinate along the axis and the depth.
  struct Crossing {
    double along;
    double depth;
  };
  Crossing crossing(std::size_t axis, double slope) const {
    double above = -HUGE_VAL;
    double below = -HUGE_VAL;
    for (const Real3& point : points_) {
      above = std::max(above, point[axis] - slope * point[2]);
      below = std::max(below, -point[axis] - slope * point[2]);
    }
    return {(above - below) / 2, -(above + below) / (2 * slope)};
  }
  /// Where along an axis an eye at that depth sees as much on one side as on the other.
  double balanced(std::size_t axis, double slope, double depth) const {
    double low = 0;
    double high = slope;
    for (int step = 0; step < 48; ++step) {
      const double middle = (low + high) / 2;
      (crossing(axis, middle).depth < depth ? low : high) = middle;
    }
    return crossing(axis, high).along;
  }
  Crossing extent(std::size_t axis) const {  // the middle, and half the length
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (const Real3& point : points_) {
      low = std::min(low, point[axis]);
      high = std::max(high, point[axis]);
    }
    return {(low + high) / 2, (high - low) / 2};
  }

 private:
  std::vector<Real3> points_;
};

// From the middle of `bounds` by that much along the axes.
Real3 placed(const VoxelBox& bounds, const PictureAxes& axes, double right, double up, double forward) {
  return plus(plus(middle_of(bounds), scaled(axes.right, right)),
              plus(scaled(axes.up, up), scaled(axes.forward, forward)));
}

constexpr double kIsometric = 35.264389682754654;  // the angle of a cube's diagonal and its faces

// Those of kBest and kIso are the corner in front on the left.
ViewAngles angles_of(NamedView view) {
  constexpr ViewAngles kSide{-45, kIsometric};
  constexpr std::array<ViewAngles, 8> kAngles{
      // in the order of `NamedView`
      {kSide, kSide, kSide, {0, 0}, {180, 0}, {-90, 0}, {90, 0}, {0, 90}}};
  return kAngles[static_cast<std::size_t>(view)];
}

// The side that is wished, in numbers.
ViewAngles angles_for(const ViewWishes& wishes, const SceneShape& shape) {
  const bool is_chosen = wishes.side == NamedView::kBest || wishes.side == NamedView::kIso;
  ViewAngles angles = is_chosen ? best_angles(shape, wishes.side) : angles_of(wishes.side);
  angles.turn += wishes.onward.turn;
  angles.tilt = std::clamp(angles.tilt + wishes.onward.tilt, -90.0, 90.0);
  return angles;
}

// Rounded to what a camera can say, so that nothing of it moves later.
double kept_q8(double value) {
  return std::round(value * Q8::kOne) / Q8::kOne;
}
Real3 kept_q8(const Real3& point) {
  return {kept_q8(point[0]), kept_q8(point[1]), kept_q8(point[2])};
}

// The eye and the span that show the corners so; the target keeps to the middle of the view.
ViewWishes fitted(const ViewWishes& wishes, const SceneShape& shape, const Sight& sight) {
  const Lens lens(wishes);
  const PictureAxes& axes = sight.axes;
  const SeenExtent seen(shape.corners, middle_of(shape.bounds), axes);
  ViewWishes placed_view = wishes;
  placed_view.up = wishes.up.value_or(to_reals(sight.up));
  if (wishes.orthographic) {
    const SeenExtent::Crossing x = seen.extent(0);
    const SeenExtent::Crossing y = seen.extent(1);
    const SeenExtent::Crossing z = seen.extent(2);
    const double half = std::max(x.depth, y.depth * lens.aspect);
    placed_view.eye = kept_q8(placed(shape.bounds, axes, x.along, y.along, z.along - z.depth - 1));
    placed_view.target = plus(*placed_view.eye, scaled(axes.forward, z.depth + 1 - z.along));
    placed_view.span = wishes.span.value_or(std::ceil(2 * half / kPictureFill * Q14::kOne) / Q14::kOne);
    return placed_view;
  }
  const double slope_y = lens.tan_y * kPictureFill;
  const double slope_x = slope_y * lens.aspect;
  const double depth = std::min(seen.crossing(0, slope_x).depth, seen.crossing(1, slope_y).depth);
  const double x = seen.balanced(0, slope_x, depth);
  const double y = seen.balanced(1, slope_y, depth);
  placed_view.eye = kept_q8(placed(shape.bounds, axes, x, y, depth));
  placed_view.target = plus(*placed_view.eye, scaled(axes.forward, std::max(1.0, -depth)));
  return placed_view;
}

// What is seen of a scene while one goes round it: of each height the farthest from the upright.
class RoundExtent {
 public:
  explicit RoundExtent(const SceneShape& shape) : axis_(middle_of(shape.bounds)) {
    // The upright from which the farthest corner is least far.
    const auto farthest = [&](const Real3& from) {
      double most = 0;
      for (const Vec3i& corner : shape.corners) {
        most = std::max(most, std::hypot(corner.x - from[0], corner.y - from[1]));
      }
      return most;
    };
    double least = farthest(axis_);
    for (double step = least / 2; step > 1.0 / 16;) {
      bool moved = false;
      for (const auto& [x, y] : {std::pair{step, 0.0}, {-step, 0.0}, {0.0, step}, {0.0, -step}}) {
        const Real3 tried = plus(axis_, {x, y, 0});
        if (const double most = farthest(tried); most < least) {
          least = most;
          axis_ = tried;
          moved = true;
        }
      }
      step = moved ? step : step / 2;
    }
    for (const Vec3i& corner : shape.corners) {
      double& most = farthest_[corner.z];
      most = std::max(most, std::hypot(corner.x - axis_[0], corner.y - axis_[1]));
    }
  }

  /// Looks down by about `tilt` at a point of the upright: the one that is seen from nearest, and from where.
  Real3 target(const Lens& lens, double tilt, double* distance) const {
    double low = farthest_.begin()->first;
    double high = farthest_.rbegin()->first;
    for (int step = 0; step < 24; ++step) {  // the distance is convex in the height
      const double third = (high - low) / 3;
      if (distance_from(lens, tilt, low + third) < distance_from(lens, tilt, high - third)) {
        high -= third;
      } else {
        low += third;
      }
    }
    const double height = kept_q8((low + high) / 2);
    *distance = distance_from(lens, tilt, height);
    return {kept_q8(axis_[0]), kept_q8(axis_[1]), height};
  }

 private:
  double distance_from(const Lens& lens, double tilt, double height) const {
    constexpr int kSides = 16;  // of half a round; the other half mirrors it
    const double slope_y = lens.tan_y * kPictureFill;
    double distance = 0;
    for (const double nod : {-kRoundNod, kRoundNod}) {
      const double cosine = std::cos((tilt + nod) * kDegree);
      const double sine = std::sin((tilt + nod) * kDegree);
      for (const auto& [z, reach] : farthest_) {
        for (int side = 0; side <= kSides; ++side) {
          const double away = reach * std::cos(180 * kDegree * side / kSides);
          const double across = reach * std::sin(180 * kDegree * side / kSides);
          const double depth = away * cosine - (z - height) * sine;
          const double up = away * sine + (z - height) * cosine;
          distance =
              std::max({distance, across / (slope_y * lens.aspect) - depth, std::abs(up) / slope_y - depth});
        }
      }
    }
    return distance;
  }

  Real3 axis_;
  std::map<std::int32_t, double> farthest_;
};

// Those from the front, then as many from behind.
constexpr std::array<ViewAngles, 8> kCandidates{
    {{-35, 25}, {35, 25}, {-35, 40}, {35, 40}, {-145, 25}, {145, 25}, {-145, 40}, {145, 40}}};
constexpr std::array<ViewAngles, 4> kCorners{
    {{-45, kIsometric}, {45, kIsometric}, {-135, kIsometric}, {135, kIsometric}}};
constexpr std::int32_t kWidth = 96;
constexpr std::int32_t kHeight = 72;

// How many planes of faces, each in its material, a camera sees.
std::size_t planes_seen(const CompactTree& tree, const Camera& camera) {
  std::vector<std::uint32_t> planes;
  for (std::int32_t y = 0; y < kHeight; ++y) {
    for (std::int32_t x = 0; x < kWidth; ++x) {
      const Ray ray = camera.ray(x, y);
      Hit hit;
      if (closest_hit(tree, ray, &hit) != Status::kOk || hit.kind != HitKind::kHit) {
        continue;
      }
      const Face face = face_of(hit, ray.direction);
      // 12 bits of coordinate, 8 of material, 3 of face.
      planes.push_back(static_cast<std::uint32_t>(hit.voxel[face.axis]) << 11 |
                       static_cast<std::uint32_t>(hit.material) << 3 |
                       static_cast<std::uint32_t>(2 * face.axis + (face.negative ? 0 : 1)));
    }
  }
  std::sort(planes.begin(), planes.end());
  return static_cast<std::size_t>(std::unique(planes.begin(), planes.end()) - planes.begin());
}

}  // namespace

std::string text_of(const Real3& v) {
  return shortest(v[0]) + "," + shortest(v[1]) + "," + shortest(v[2]);
}

PictureAxes::PictureAxes(const SceneCamera& camera) {
  const Vec3i ahead = camera.forward == Vec3i{} ? look_at(camera.eye, camera.target) : camera.forward;
  forward = real_of(ahead);
  right = cross(forward, real_of(camera.up == Vec3i{} ? default_up(ahead) : camera.up));
  up = cross(right, forward);
}

Framing frame_box(const ViewWishes& wishes, int level, const VoxelBox& bounds) {
  const std::int32_t side = std::int32_t{1} << level;
  const VoxelBox box = bounds.empty() ? VoxelBox{{0, 0, 0}, {side, side, side}} : bounds;
  const Reach reach(level);
  const Lens lens(wishes);
  const Sight sight = sight_of(wishes, reach, box);
  const Room room = room_for(box, sight, lens, wishes.fill);
  const Real3 eye =
      wishes.eye.value_or(eye_at(sight, wishes.orthographic ? room.before + 1 : room.distance, reach));

  Framing framing;
  SceneCamera& kept = framing.kept;
  kept.is_perspective = !wishes.orthographic;
  kept.direction_bits = static_cast<std::uint8_t>(wishes.direction_bits);
  kept.eye = reachable_q8(eye, reach, wishes.eye.has_value());
  kept.target = saturated_q8(sight.target);
  kept.forward = sight.forward;
  kept.up = wishes.up ? sight.up : Vec3i{};
  kept.fov_degrees = Q16::from_raw(to_fixed(wishes.fov_degrees, Q16::kOne));
  bool partial = false;
  if (wishes.orthographic) {
    partial = set_orthographic_camera(wishes, level, sight, 2 * room.half_width / wishes.fill, &framing);
  } else {
    set_perspective_camera(wishes, level, &framing);
    // What the margin gives away may be enough to see it all even from too near.
    partial = !wishes.eye && !shows_all(box_corners(box), eye, sight.axes, lens);
  }
  if (partial) {
    framing.note =
        "the whole scene cannot be seen at once from within -4 to 5 world sizes; a part of it is shown";
  }
  return framing;
}

Framing frame_scene(const ViewWishes& wishes, const SceneSource& source, const SceneShape& shape) {
  if (wishes.placed || source.camera() == nullptr) {
    return frame_shape(wishes, shape);
  }
  Framing framing;
  framing.kept = *source.camera();
  if (wishes.direction_bits != 0) {
    framing.kept.direction_bits = static_cast<std::uint8_t>(wishes.direction_bits);
  }
  const Status status =
      set_camera(framing.kept, wishes.width_px, wishes.height_px, shape.level, &framing.camera);
  fail_view_if(status != Status::kOk, FramingFault::kOwnCamera,
               "the scene's own camera does not suit a picture of ", wishes.width_px, "x", wishes.height_px,
               ": ", status_text(status));
  return framing;
}

Framing frame_shape(const ViewWishes& given, const SceneShape& shape) {
  ViewWishes wishes = given;
  if (wishes.side == NamedView::kPaper) {
    return frame_box(wishes, shape.level, shape.bounds);
  }
  wishes.fill = kPictureFill;
  if (!wishes.eye) {
    look_from(angles_for(wishes, shape), &wishes);
  }
  if (wishes.eye || wishes.target || shape.corners.empty()) {
    return frame_box(wishes, shape.level, shape.bounds);
  }
  const Reach reach(shape.level);
  const Sight sight = sight_of(wishes, reach, shape.bounds);
  const ViewWishes placed_view = fitted(wishes, shape, sight);
  if (reach.holds(*placed_view.eye) && reach.holds(*placed_view.target)) {
    try {
      return frame_box(placed_view, shape.level, shape.bounds);
    } catch (const FramingError&) {
      // Beyond what a camera can do; the next one makes do with less, or says why not.
    }
  }
  Framing framing = frame_box(wishes, shape.level, shape.bounds);
  const SceneCamera& kept = framing.kept;
  const auto half_width = kept.is_perspective ? std::nullopt : std::optional(voxels_of(kept.span) / 2);
  if (shows_all(shape.corners, real_of(kept.eye), sight.axes, Lens(wishes), half_width)) {
    framing.note.clear();  // what its box lacks holds nothing
  }
  return framing;
}

Framing frame_round(const ViewWishes& wishes, const SceneSource& source, const SceneShape& shape) {
  constexpr double kSteep = 80;
  const bool is_free = !wishes.eye && !wishes.target && !wishes.up && !wishes.orthographic &&
                       wishes.side != NamedView::kPaper && !shape.corners.empty();
  if ((!wishes.placed && source.camera() != nullptr) || !is_free) {
    return frame_scene(wishes, source, shape);
  }
  const ViewAngles angles = angles_for(wishes, shape);
  if (std::abs(angles.tilt) > kSteep) {
    return frame_scene(wishes, source, shape);
  }
  ViewWishes view = wishes;
  look_from(angles, &view);
  double distance = 0;
  view.target = RoundExtent(shape).target(Lens(view), angles.tilt, &distance);
  const Reach reach(shape.level);
  view.eye = kept_q8(eye_at(sight_of(view, reach, shape.bounds), distance, reach));
  try {
    return frame_box(view, shape.level, shape.bounds);
  } catch (const FramingError&) {
    return frame_scene(wishes, source, shape);  // beyond what a camera can do
  }
}

std::vector<Framing> frame_turns(const ViewWishes& given, const SceneShape& shape, int count) {
  ViewWishes wishes = given;
  const ViewAngles first = angles_for(wishes, shape);
  const Reach reach(shape.level);
  const VoxelBox box = shape.bounds.empty() ? VoxelBox{{0, 0, 0}, {1, 1, 1}} : shape.bounds;
  const Lens lens(wishes);
  std::vector<ViewWishes> views;
  double distance = shape.bounds.empty() ? 1 : 0;
  double half_width = 0;
  for (int i = 0; i < count; ++i) {
    ViewWishes view = wishes;
    look_from({first.turn + 360.0 * i / count, first.tilt}, &view);
    const Sight sight = sight_of(view, reach, box);
    const SeenExtent seen(shape.corners, sight.target, sight.axes);
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      const double slope = lens.tan_y * kPictureFill * (axis == 0 ? lens.aspect : 1);
      const SeenExtent::Crossing crossing = seen.crossing(axis, slope);
      distance = std::max(distance, std::abs(crossing.along) / slope - crossing.depth);
      const SeenExtent::Crossing extent = seen.extent(axis);
      half_width =
          std::max(half_width, (std::abs(extent.along) + extent.depth) * (axis == 0 ? 1 : lens.aspect));
    }
    distance = std::max(distance, wishes.orthographic ? seen.extent(2).depth + 1 : 0);
    views.push_back(view);
  }
  std::vector<Framing> framings;
  for (ViewWishes& view : views) {
    const Sight sight = sight_of(view, reach, box);
    view.eye = eye_at(sight, distance, reach);
    view.target = sight.target;
    view.up = view.up.value_or(to_reals(sight.up));
    if (wishes.orthographic) {
      view.span = wishes.span.value_or(2 * half_width / kPictureFill);
    }
    framings.push_back(frame_box(view, shape.level, shape.bounds));
  }
  return framings;
}

Shading scene_shading(ShadeMode mode, Span<const Rgb8> palette, const Camera& camera,
                      const VoxelBox& bounds) {
  Shading shading;
  shading.mode = mode;
  shading.palette = palette;
  const DepthRange range = depth_range(camera, bounds);
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  return shading;
}

ViewWishes finer(const ViewWishes& wishes, int across) {
  const std::int32_t most = kMaxPicturePx / across;
  fail_if(wishes.width_px > most || wishes.height_px > most, across * across,
          " samples a pixel want a picture of at most ", most, " pixels a side");
  ViewWishes fine = wishes;
  fine.width_px *= across;
  fine.height_px *= across;
  return fine;
}

ViewAngles best_angles(const SceneShape& shape, NamedView side) {
  const std::span<const ViewAngles> all =
      side == NamedView::kIso ? std::span<const ViewAngles>(kCorners) : kCandidates;
  if (shape.tree == nullptr || shape.corners.empty()) {
    return all[0];
  }
  std::array<std::optional<std::size_t>, kCandidates.size()> seen{};
  each_task(all.size(), shape.threads, [&](std::size_t i, std::size_t) {
    ViewWishes wishes;
    wishes.width_px = kWidth;
    wishes.height_px = kHeight;
    wishes.side = NamedView::kFront;
    wishes.onward = all[i];
    wishes.fov_degrees = kPictureFov;
    try {
      seen[i] = planes_seen(*shape.tree, frame_shape(wishes, shape).camera);
    } catch (const FramingError&) {
      // A side from which this world cannot be seen whole.
    }
  });
  std::size_t best = 0;
  std::size_t most = 0;
  std::size_t front = 0;  // the most of the views from there
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool from_behind = i >= all.size() / 2;
    // Without colours, more faces are no reason to show a back.
    if (!seen[i] || (from_behind && front != 0 && !shape.tree->many_materials())) {
      continue;
    }
    if (from_behind ? 2 * *seen[i] > 3 * front && *seen[i] > most : *seen[i] > most) {
      best = i;
      most = *seen[i];
    }
    front = from_behind ? front : most;
  }
  return all[best];
}

}  // namespace thimble::tools
