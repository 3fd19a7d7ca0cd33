/// Where a picture is taken from: what is wished of a view, and the camera that shows the scene so.
///
/// Geometry in doubles, for framing alone: the core gets integers and makes every ray from them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "readers/input_error.h"
#include "readers/real3.h"
#include "scene/scene_shape.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

class SceneSource;

/// From which side a scene is seen when nobody says: from the front, left and above.
inline constexpr Real3 kDefaultForward{0.5, 0.9, -0.45};
/// The part of the picture that a framed scene fills then.
inline constexpr double kDefaultFill = 0.94;

/// What a scene that is framed as a person would fills, of the picture's tighter side.
inline constexpr double kPictureFill = 0.9;
/// The vertical angle of such a picture.
inline constexpr double kPictureFov = 35;

/// Sides to see a scene from. Front looks along +y, left along +x, top down with the front below.
enum class NamedView : std::uint8_t {
  kPaper,  ///< kDefaultForward, with the corners of a box within kDefaultFill: what instruments look from
  kBest,   ///< of a few three-quarter views the one that shows most (`best_angles`)
  kIso,  ///< of the four corners, as high as isometric drawings stand, the one that shows most (`best_angles`)
  kFront,
  kBack,
  kLeft,
  kRight,
  kTop,
};

/// Where a camera stands around a scene, in degrees.
struct ViewAngles {
  double turn = 0;  ///< 0 in front (towards -y), 90 on the right (+x)
  double tilt = 0;  ///< above the horizon, -90 .. 90
};

/// Why a view cannot be.
enum class FramingFault : std::uint8_t {
  kEyeOutside,        ///< of where rays may start
  kTargetTooFar,      ///< so that the eye for it would be outside
  kNoDirection,       ///< the eye is the target
  kUp,                ///< no direction, or the view's
  kSpan,              ///< beyond the limit
  kCoarseDirections,  ///< `direction_bits` are too few for the picture
  kFineDirections,    ///< all that there may be are too few
  kFineOrigins,       ///< pixels lie closer than origins of parallel rays can
  kCornersOutside,    ///< rays of a parallel picture's corners would start outside
  kOwnCamera,         ///< that of the scene cannot draw this size
};

/// A view that cannot be. `what()` says why, in a sentence without options: the command names those that help.
class FramingError : public InputError {
 public:
  template <class... Pieces>
  explicit FramingError(FramingFault why, const Pieces&... pieces) : InputError(pieces...), fault(why) {}
  FramingFault fault;
};

/// Points and lengths in voxels. What is not given frames the scene.
struct ViewWishes {
  std::int32_t width_px = 800;  ///< 1 .. kMaxPicturePx
  std::int32_t height_px = 600;
  /// Whether somebody chose the size; a board's display decides it otherwise.
  bool sized = false;
  /// Whether somebody said where the camera is or how it looks; a scene's own camera goes first otherwise.
  bool placed = false;
  bool orthographic = false;
  std::optional<Real3> eye;         ///< else as far back as it takes to see the whole scene
  std::optional<Real3> target;      ///< else the middle of the scene
  std::optional<Real3> up;          ///< else `default_up` of the direction of view
  Real3 forward = kDefaultForward;  ///< the direction of view where there is no eye; any length above 0
  /// Instead of `forward`, for `frame_shape`: the side, and the angles to turn from there.
  NamedView side = NamedView::kPaper;
  ViewAngles onward;
  double fov_degrees = 60;     ///< vertical, 1 .. 120; perspective
  std::optional<double> span;  ///< width of the picture; orthographic, else the whole scene
  double fill = kDefaultFill;  ///< of the picture, 0 .. 1, where the scene is framed
  int direction_bits = 0;      ///< kMinDirectionBits .. kMaxDirectionBits; 0: as many as are needed
};

inline Real3 real_of(const Vec3i& v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

inline Real3 real_of(const Vec3Q8& point) {
  return {static_cast<double>(point.x.raw) / Q8::kOne, static_cast<double>(point.y.raw) / Q8::kOne,
          static_cast<double>(point.z.raw) / Q8::kOne};
}
/// "1,2.5,-3".
std::string text_of(const Real3& v);

/// A camera's axes in the picture, at right angles and of any length.
struct PictureAxes {
  PictureAxes() = default;
  explicit PictureAxes(const SceneCamera& camera);
  Real3 right{};
  Real3 up{};
  Real3 forward{};
};

/// A view as it came out.
struct Framing {
  Camera camera;
  SceneCamera kept;  ///< the same without the picture's size, as a baked scene keeps it
  std::string note;  ///< a sentence where not all could be shown that was to be; else empty
};

/// The camera for what lies in `bounds` (empty: the whole world) of a world of 2^level. A function of its
/// arguments alone. Throws FramingError where rays cannot start or go as wished.
Framing frame_box(const ViewWishes& wishes, int level, const VoxelBox& bounds);

/// As a person would frame it: from `wishes.side`, turned and tilted on by `wishes.onward`, what is occupied in
/// the middle of the picture, filling kPictureFill of its tighter side. With an eye, a target or kPaper: as
/// `frame_box`, in that direction. A function of its arguments alone. Throws FramingError as above.
Framing frame_shape(const ViewWishes& wishes, const SceneShape& shape);

/// The camera that the scene brings along, unless `wishes.placed` or it has none; then the one above.
Framing frame_scene(const ViewWishes& wishes, const SceneSource& source, const SceneShape& shape);

/// As the last, but where nobody says where the camera is the eye may go all round the upright through its target, at its
/// distance, with everything occupied in the picture: as the demonstration of a board turns (apps/demo_view.h).
Framing frame_round(const ViewWishes& wishes, const SceneSource& source, const SceneShape& shape);

/// Pictures all around, `count` of them: the view above turned by a whole turn, clockwise, in equal steps, about
/// the upright through the middle of the scene, from as far away as the widest of them wants.
std::vector<Framing> frame_turns(const ViewWishes& wishes, const SceneShape& shape, int count);

/// Shading in that mode, by depth between the planes that bound the scene.
Shading scene_shading(ShadeMode mode, Span<const Rgb8> palette, const Camera& camera, const VoxelBox& bounds);

/// The same view in a picture `across` times as wide and high. Throws InputError beyond the largest size.
ViewWishes finer(const ViewWishes& wishes, int across);

/// Of a fixed set of three-quarter views from above (from the front and the back, the left and the right, at
/// two heights) the one that shows the most distinct faces and colours: each is drawn at 96 x 72 pixels, and
/// what is counted is the different planes of faces (axis, side and coordinate, with the material) among the
/// hits. People model with the front in front, so a view from behind must show half again as much as the best
/// from there, and where all is of one material none does; ties go to the earlier one. kIso chooses among four corners.
/// Integers decide, so it is the same on every machine. 55,296 rays; without a compact tree, the first view.
ViewAngles best_angles(const SceneShape& shape, NamedView side = NamedView::kBest);

}  // namespace thimble::tools
