#include "commands/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "output/progress.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

// "X,Y,Z" as three finite numbers.
std::optional<Real3> parse_triple(const std::string& text) {
  Real3 result{};
  const char* at = text.data();
  const char* end = at + text.size();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto [next, error] = std::from_chars(at, end, result[i]);
    if (error != std::errc{} || !std::isfinite(result[i])) {
      return std::nullopt;
    }
    at = next;
    if (i < 2 && (at == end || *at++ != ',')) {
      return std::nullopt;
    }
  }
  return at == end ? std::optional<Real3>(result) : std::nullopt;
}

void add_triple(CLI::App& app, const std::string& name, std::optional<Real3>* value,
                const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [name, value](const std::string& text) {
           *value = parse_triple(text);
           if (!*value) {
             throw CLI::ValidationError(name, "\"" + text + "\" is not X,Y,Z");
           }
         },
         help)
      ->type_name("X,Y,Z");
}

Real3 minus(const Real3& a, const Real3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Real3& a, const Real3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real3 scaled(const Real3& a, double factor) {
  return {a[0] * factor, a[1] * factor, a[2] * factor};
}
Real3 plus(const Real3& a, const Real3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Real3 unit(const Real3& a) {
  return scaled(a, 1 / std::sqrt(dot(a, a)));
}

// A real vector as integers of 30 bits in the same direction.
Vec3i to_integers(const Real3& vector) {
  const double largest = std::max({std::abs(vector[0]), std::abs(vector[1]), std::abs(vector[2])});
  Vec3i result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = static_cast<std::int32_t>(
        std::lround(vector[static_cast<std::size_t>(axis)] / largest * kMaxViewComponent));
  }
  return result;
}

std::string text_of(const Real3& v) {
  return shortest(v[0]) + "," + shortest(v[1]) + "," + shortest(v[2]);
}

Vec3Q8 to_q8(const Real3& point, int level, const char* what) {
  Vec3Q8 result;
  const double side = static_cast<double>(1 << level);
  for (int axis = 0; axis < 3; ++axis) {
    const double value = point[static_cast<std::size_t>(axis)];
    if (!(value >= kMinOriginWorlds * side && value <= kMaxOriginWorlds * side)) {
      throw InputError(std::string(what) + " " + text_of(point) + " is outside the accepted " +
                       shortest(kMinOriginWorlds * side) + " to " + shortest(kMaxOriginWorlds * side) +
                       " (-4 to 5 world sizes)");
    }
    result[axis] = Q8::from_raw(static_cast<std::int32_t>(std::lround(value * Q8::kOne)));
  }
  return result;
}

// The picture's axes for a direction of view, in doubles: only for framing, rays are made by the core.
struct Axes {
  Real3 right;
  Real3 up;
  Real3 forward;
};

Axes axes_of(const Real3& forward, const Real3& up) {
  Axes axes;
  axes.forward = unit(forward);
  axes.right = unit(cross(axes.forward, up));
  axes.up = cross(axes.right, axes.forward);
  return axes;
}

Real3 default_up_for(const Real3& forward) {
  return forward[0] == 0 && forward[1] == 0 ? Real3{0, 1, 0} : Real3{0, 0, 1};
}

std::array<Real3, 8> corners_of(const VoxelBox& box) {
  std::array<Real3, 8> corners{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[corner][static_cast<std::size_t>(axis)] =
          ((corner >> axis) & 1U) != 0 ? box.max[axis] : box.min[axis];
    }
  }
  return corners;
}

// From which side a scene is seen when nobody says: from the front, left and above.
constexpr Real3 kDefaultForward{0.5, 0.9, -0.45};
// Part of the picture that a framed scene fills.
constexpr double kFill = 0.94;

}  // namespace

void SceneOptions::add_to(CLI::App& app) {
  app.add_option(
         "scene", arguments.scene,
         "a file (.vox .ply .obj .off .xyz .csv, Gadget-1 snapshot, .gz of any) or a generator: points:N, "
         "cluster:N, spheres, water, each with ,seed=S,depth=L")
      ->required()
      ->type_name("SCENE");
  app.add_option("--depth", arguments.depth,
                 "world of 2^L voxels a side, 1 to 12 (default: the least that holds a .vox or --as-voxels "
                 "file, 9 for "
                 "other files, 10 for points and cluster, 6 for spheres and water)")
      ->type_name("L")
      ->check(CLI::Range(kMinLevel, kMaxLevel));
  app.add_flag("--as-voxels", arguments.as_voxels,
               "point files: coordinates are voxel indices, not scaled or moved");
  app.add_flag("--z-up", arguments.z_up, "meshes: z is up in the file (default: y is)");
  app.add_option_function<std::string>(
         "--memory",
         [this](const std::string& text) {
           memory_bytes = parse_bytes(text);
           if (!memory_bytes) {
             throw CLI::ValidationError("--memory",
                                        "\"" + text + "\" is no number of bytes such as 65536, 64K or 2M");
           }
         },
         "one arena of BYTES for all that lies between reader and display (64K, 2M)")
      ->type_name("BYTES");
  app.add_flag("--coarsen", coarsen, "when --memory is short, merge blocks instead of failing");
  app.add_option("--structure", structure, "what is built and traced: dense, pool or compact")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, StructureKind>{{"dense", StructureKind::kDense},
                                                                       {"pool", StructureKind::kPool},
                                                                       {"compact", StructureKind::kCompact}},
                                  CLI::ignore_case))
      ->default_str("compact");
  app.add_flag("--quiet", quiet, "no progress bar and no summary");
  app.add_option("--stats", stats_path, "write counts, bytes and times as JSON")->type_name("FILE.json");
}

std::unique_ptr<SceneSource> SceneOptions::open() const {
  ProgressBar bar("reading", quiet);
  return open_scene(arguments, [&](double done) { bar.update(done); });
}

BuiltScene SceneOptions::build(const SceneSource& source, std::uint64_t band_bytes) const {
  ProgressBar bar("building", quiet);
  BuildOptions options;
  options.structure = structure;
  options.memory_bytes = memory_bytes;
  options.coarsen = coarsen;
  options.band_bytes = band_bytes;
  return BuiltScene(source, options, [&](double done) { bar.update(done); });
}

void EngineOptions::add_to(CLI::App& app) {
  app.add_option("--engine", name,
                 "auto, ray64 or ray32: the width of the arithmetic; the picture is the same")
      ->check(CLI::IsMember({"auto", "ray64", "ray32"}))
      ->default_str("auto");
}

TraceOptions EngineOptions::trace_options() const {
  TraceOptions options;
  options.width = name == "ray32" ? Width::k32 : Width::k64;
  return options;
}

void add_direction_bits(CLI::App& app, int* bits) {
  app.add_option("--direction-bits", *bits,
                 "bits of a ray's direction, 8 to 20 (default: as many as are needed)")
      ->type_name("N")
      ->check(CLI::Range(kMinDirectionBits, kMaxDirectionBits));
}

void ViewOptions::add_to(CLI::App& app) {
  app.add_option_function<std::string>(
         "--size",
         [this](const std::string& text) {
           const std::size_t x = text.find('x');
           int width = 0;
           int height = 0;
           const char* end = text.data() + text.size();
           const bool sound = x != std::string::npos &&
                              std::from_chars(text.data(), text.data() + x, width).ptr == text.data() + x &&
                              std::from_chars(text.data() + x + 1, end, height).ptr == end && width >= 1 &&
                              height >= 1 && width <= kMaxPicturePx && height <= kMaxPicturePx;
           if (!sound) {
             throw CLI::ValidationError("--size", "\"" + text + "\" is not WxH with sides of 1 to " +
                                                      std::to_string(kMaxPicturePx) + " pixels");
           }
           width_px = width;
           height_px = height;
         },
         "the picture's size in pixels")
      ->type_name("WxH")
      ->default_str("800x600");
  app.add_option("--projection", orthographic, "perspective or orthographic")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, bool>{{"perspective", false}, {"orthographic", true}}, CLI::ignore_case))
      ->default_str("perspective")
      ->type_name("NAME");
  add_triple(app, "--eye", &eye, "where the camera is, in voxels (default: where it sees the whole scene)");
  add_triple(app, "--target", &target, "what it looks at (default: the middle of the scene)");
  add_triple(app, "--up", &up, "what is up in the picture (default: 0,0,1; 0,1,0 when looking along z)");
  app.add_option("--fov", fov_degrees, "perspective: vertical field of view, 1 to 120 degrees")
      ->type_name("DEG")
      ->check(CLI::Range(1.0, 120.0))
      ->default_str("60");
  app.add_option("--span", span, "orthographic: width of the picture in voxels (default: the whole scene)")
      ->type_name("V")
      ->check(CLI::PositiveNumber);
  add_direction_bits(app, &direction_bits);
}

Camera ViewOptions::camera(int level, const VoxelBox& occupied) const {
  const std::int32_t side = std::int32_t{1} << level;
  const VoxelBox box = occupied.empty() ? VoxelBox{{0, 0, 0}, {side, side, side}} : occupied;
  const auto corners = corners_of(box);
  const Real3 center = scaled(plus(corners[0], corners[7]), 0.5);
  const Real3 looked_at = target.value_or(center);
  const Real3 forward = eye ? minus(looked_at, *eye) : kDefaultForward;
  if (dot(forward, forward) == 0) {
    throw InputError("--eye and --target are the same point");
  }
  const Real3 upward = up.value_or(default_up_for(forward));
  const Real3 sideways = cross(forward, upward);
  if (!(dot(sideways, sideways) > 0)) {
    throw InputError("--up is parallel to the direction of view");
  }
  const Axes axes = axes_of(forward, upward);
  const double aspect = static_cast<double>(width_px) / height_px;
  const double tan_y = std::tan(fov_degrees * 3.14159265358979323846 / 360);

  // How far back the eye must be, and how wide a parallel picture, to see all corners.
  double distance = 0;
  double half_width = 0;
  double reach = 0;
  for (const Real3& corner : corners) {
    const Real3 offset = minus(corner, looked_at);
    const double x = std::abs(dot(offset, axes.right));
    const double y = std::abs(dot(offset, axes.up));
    const double z = dot(offset, axes.forward);
    distance = std::max({distance, x / (tan_y * aspect * kFill) - z, y / (tan_y * kFill) - z});
    half_width = std::max({half_width, x, y * aspect});
    reach = std::max(reach, -z);
  }
  if (orthographic) {
    distance = reach + 1;
  }
  Real3 eye_point = eye.value_or(minus(looked_at, scaled(axes.forward, distance)));
  if (!eye) {
    // A narrow view would want to stand farther back than rays may start: it stays within the limits.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double limit = axes.forward[axis] > 0 ? static_cast<double>(kMinOriginWorlds) * side
                                                  : static_cast<double>(kMaxOriginWorlds) * side;
      const double back = (looked_at[axis] - limit) / axes.forward[axis];
      if (axes.forward[axis] != 0 && back >= 0 && back < distance) {
        distance = back;
      }
    }
    eye_point = minus(looked_at, scaled(axes.forward, distance));
  }

  Camera result;
  Status status = Status::kOk;
  std::string advice;
  if (orthographic) {
    OrthographicView view;
    view.eye = to_q8(eye_point, level, "--eye");
    view.forward = to_integers(forward);
    view.up = to_integers(upward);
    const double least = static_cast<double>(least_orthographic_span(width_px, level).raw) / Q14::kOne;
    const auto to_q14 = [](double voxels) {
      if (!(voxels * Q14::kOne <= INT32_MAX)) {
        throw InputError("--span " + shortest(voxels) + " is beyond 131,071 voxels");
      }
      return Q14::from_raw(static_cast<std::int32_t>(std::max(1L, std::lround(voxels * Q14::kOne))));
    };
    view.span = to_q14(span.value_or(2 * half_width / kFill));
    view.width_px = width_px;
    view.height_px = height_px;
    view.direction_bits = direction_bits;
    status = result.set(view, level);
    if (status == Status::kTooFine && !span) {
      view.span = to_q14(least);  // a scene of a few voxels is shown smaller instead
      status = result.set(view, level);
    }
    advice = status == Status::kTooFine
                 ? "the pixels are too fine for origins in 1/256 voxel; --span " +
                       shortest(std::ceil(least * 100) / 100) + " or more always works for this --size"
                 : "the picture's corners must lie within -4 to 5 world sizes; a smaller --span or another "
                   "--eye helps";
  } else {
    PerspectiveView view;
    view.eye = to_q8(eye_point, level, "--eye");
    view.forward = to_integers(forward);
    view.up = to_integers(upward);
    view.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(std::lround(fov_degrees * Q16::kOne)));
    view.width_px = width_px;
    view.height_px = height_px;
    view.direction_bits = direction_bits;
    status = result.set(view, level);
    advice = "directions of 20 bits cannot be kept within 1/8 pixel; a wider --fov or a smaller --size helps";
  }
  if (status == Status::kBadArgument) {
    throw InputError("--up is parallel to the direction of view");
  }
  if (status != Status::kOk) {
    throw InputError(std::string("the camera: ") + status_text(status) + ": " + advice);
  }
  return result;
}

}  // namespace thimble::tools
