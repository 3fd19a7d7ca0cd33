#include "commands/options.h"

#include <algorithm>
#include <cmath>

#include "commands/arguments.h"
#include "output/progress.h"
#include "output/units.h"
#include "scene/board_fit.h"

namespace thimble::tools {
namespace {

// "X,Y,Z" as three finite numbers.
std::optional<Real3> parse_triple(std::string_view text) {
  Real3 result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = text.find(',');
    const auto number = parse_real(text.substr(0, comma));
    if (!number || (comma == std::string_view::npos) != (i == 2)) {
      return std::nullopt;
    }
    result[i] = *number;
    text.remove_prefix(i == 2 ? text.size() : comma + 1);
  }
  return result;
}

void add_triple(CLI::App& app, const std::string& name, std::optional<Real3>* value, bool* given,
                const std::string& help) {
  add_text_option(
      app, name, "X,Y,Z",
      [value, given](const std::string& text) {
        *value = parse_triple(text);
        *given = true;
        return *value ? "" : "is not three numbers X,Y,Z";
      },
      help);
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

double largest(const Real3& v) {
  return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
}

// A real vector as integers of 30 bits in the same direction.
Vec3i to_integers(const Real3& vector) {
  const double scale = largest(vector);
  Vec3i result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = static_cast<std::int32_t>(
        std::lround(vector[static_cast<std::size_t>(axis)] / scale * kMaxViewComponent));
  }
  return result;
}

// The other way, components within -1 .. 1.
Real3 to_reals(const Vec3i& vector) {
  return scaled({static_cast<double>(vector.x), static_cast<double>(vector.y), static_cast<double>(vector.z)},
                1.0 / kMaxViewComponent);
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

std::array<Real3, 8> corners_of(const VoxelBox& box) {
  std::array<Real3, 8> corners{};
  for (unsigned corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[corner][static_cast<std::size_t>(axis)] =
          ((corner >> axis) & 1U) != 0 ? box.high[axis] : box.low[axis];
    }
  }
  return corners;
}

// From which side a scene is seen when nobody says: from the front, left and above.
constexpr Real3 kDefaultForward{0.5, 0.9, -0.45};
// Part of the picture that a framed scene fills.
constexpr double kFill = 0.94;

}  // namespace

void SceneOptions::add_scene(CLI::App& app, bool required) {
  Option scene =
      add_argument(app, "scene", "SCENE", &arguments.scene,
                   "a file (.vox .ply .obj .off .xyz .csv .scene .oct, a Gadget-1 snapshot, .gz of any) or a "
                   "generator: points:N, cluster:N, spheres, water or demo, each with ,seed=S,depth=L");
  if (required) {
    scene.required();
  }
  add_whole_option(
      app, "--depth", "L", kMinLevel, kMaxLevel,
      [this](std::int64_t level) { arguments.depth = static_cast<int>(level); },
      "the world is 2^L voxels a side, L from 1 to 12 (default: the least that holds a .vox, .scene or "
      "--as-voxels file, that of a baked scene, 9 for other files, 10 for points and cluster, 6 for the "
      "others)");
  add_flag(app, "--as-voxels", &arguments.as_voxels,
           "point files: coordinates are voxel indices; nothing is scaled, turned or moved");
  add_flag(app, "--z-up", &arguments.z_up, "meshes: z is up in the file (default: y is)");
}

void SceneOptions::add_report(CLI::App& app) {
  add_flag(app, "--quiet", &quiet, "no progress bar and no summary on standard error");
  add_path_option(app, "--stats", "FILE.json", &stats_path, "write counts, bytes and times as JSON");
}

void SceneOptions::add_to(CLI::App& app) {
  add_scene(app);
  add_bytes(app, "--memory", &memory_bytes,
            "the budget, such as 65536, 64K or 2M: one block of memory for all that lies between reader and "
            "display (default: as much as it takes)");
  add_board(app, &board,
            "keep to a board's RAM less its stack, as with --memory (the smaller of both counts); a baked "
            "scene lies in its flash and takes no RAM");
  add_flag(app, "--coarsen", &coarsen,
           "when the budget is short, merge blocks of voxels instead of failing; this only adds solid");
  add_choice_option(
      app, "--structure", {"dense", "pool", "compact"},
      [this](std::size_t index) { structure = static_cast<StructureKind>(index); },
      "what is built and traced: one bit a voxel, an octree that can be edited, or a compact one")
      .default_str("compact");
  add_report(app);
}

std::optional<std::uint64_t> SceneOptions::budget_bytes() const {
  if (board == nullptr) {
    return memory_bytes;
  }
  return std::min(free_ram_bytes(*board), memory_bytes.value_or(UINT64_MAX));
}

void add_bytes(CLI::App& app, const std::string& name, std::optional<std::uint64_t>* bytes,
               const std::string& help) {
  add_text_option(
      app, name, "BYTES",
      [bytes](const std::string& text) {
        *bytes = parse_bytes(text);
        return *bytes ? "" : "is not a number of bytes such as 65536, 64K or 2M";
      },
      help);
}

void add_board(CLI::App& app, const platform::BoardFacts** board, const std::string& help) {
  std::string names;
  for (const platform::BoardFacts& each : platform::boards()) {
    names += (names.empty() ? "" : ", ") + std::string(each.name);
  }
  add_text_option(
      app, "--board", "NAME",
      [board, names](const std::string& text) {
        *board = platform::find_board(text.c_str());
        return *board != nullptr ? std::string() : "is not a board; there are " + names;
      },
      help + "; " + names);
}

std::unique_ptr<SceneSource> SceneOptions::open() const {
  ProgressBar bar("reading", quiet);
  return open_scene(arguments, [&](double done) { bar.update(done); });
}

BuiltScene SceneOptions::build(const SceneSource& source, std::uint64_t band_bytes,
                               std::uint64_t least_band_bytes, std::uint64_t render_state_bytes) const {
  ProgressBar bar("building", quiet);
  BuildOptions options;
  options.structure = structure;
  options.memory_bytes = budget_bytes();
  if (board != nullptr) {
    if (!memory_bytes || *memory_bytes > free_ram_bytes(*board)) {
      options.budget_name = std::string(board->name) + "'s RAM less its stack";
    }
    options.baked_in_flash = true;
    const BakedScene* baked = source.baked();
    if (baked != nullptr && structure == StructureKind::kCompact &&
        baked->bytes().size > scene_flash_bytes(*board)) {
      throw InputError("takes " + grouped(baked->bytes().size) + " bytes, " + board->name + " has " +
                       grouped(scene_flash_bytes(*board)) + " bytes of flash for a scene");
    }
  }
  options.coarsen = coarsen;
  options.band_bytes = band_bytes;
  options.least_band_bytes = least_band_bytes;
  options.threads = build_threads;
  options.render_state_bytes = render_state_bytes;
  return BuiltScene(source, options, [&](double done) { bar.update(done); });
}

void EngineOptions::add_to(CLI::App& app) {
  static const std::vector<std::string> kNames{"auto", "wide", "ray64", "ray32"};
  add_choice_option(
      app, "--engine", kNames, [this](std::size_t index) { name = kNames[index]; },
      "wide: object order, with vectors and threads, for --structure compact where there is room; ray64, "
      "ray32: ray by ray with products of that width; the answers are the same, but ray32 refuses rays that "
      "need more; auto: wide where it can be, but not with --board, else ray64")
      .default_str("auto");
  add_whole_option(
      app, "--threads", "N", 1, wide::kMaxThreads,
      [this](std::int64_t number) { threads = static_cast<int>(number); },
      "threads that build, and that draw with the wide engine or with effects")
      .default_str("1");
}

void EngineOptions::add_ray_engines_to(CLI::App& app) {
  static const std::vector<std::string> kNames{"auto", "ray64", "ray32"};
  add_choice_option(
      app, "--engine", kNames, [this](std::size_t index) { name = kNames[index]; },
      "the width of the arithmetic; the answers are the same, but ray32 refuses rays that need more")
      .default_str("auto");
}

bool EngineOptions::prepare(BuiltScene* built, std::int32_t width_px, std::int32_t height_px) const {
  if (name != "auto" && name != "wide") {
    return false;
  }
  const bool ready = built->prepare_wide(width_px, height_px, threads);
  if (!ready && name == "wide") {
    throw InputError(built->structure() == StructureKind::kCompact
                         ? "no room for --engine wide within --memory"
                         : "--engine wide draws --structure compact only");
  }
  return ready;
}

void EngineOptions::add_board_engines_to(CLI::App& app) {
  static const std::vector<std::string> kNames{"auto", "wide", "ray64"};
  add_choice_option(
      app, "--engine", kNames, [this](std::size_t index) { name = kNames[index]; },
      "what draws demo's frames without light; the pictures are the same. wide: object order, with vectors "
      "and "
      "threads, in memory of this machine's own, and the first frame by the core too, for the stack, and "
      "compared; ray64: the core, as on the board (by bricks where the scene has a brick map); auto: wide "
      "where it can be, else ray64. Frames with light, those thinned or refined to hold a rate, and other "
      "applications are always the core's")
      .default_str("auto");
  add_whole_option(
      app, "--threads", "N", 1, wide::kMaxThreads,
      [this](std::int64_t number) { threads = static_cast<int>(number); },
      "threads that draw with the wide engine")
      .default_str("1");
}

TraceOptions EngineOptions::trace_options() const {
  TraceOptions options;
  options.width = name == "ray32" ? Width::k32 : Width::k64;
  return options;
}

void add_quality(CLI::App& app, Quality* quality) {
  add_text_option(
      app, "--samples", "N",
      [quality](const std::string& text) {
        quality->across = 0;
        const auto number = parse_whole(text, 1, kMaxSamplesAcross * kMaxSamplesAcross);
        for (int across = 1; number && across <= kMaxSamplesAcross; ++across) {
          quality->across = *number == across * across ? across : quality->across;
        }
        return quality->across != 0 ? "" : "is not 1, 4, 9, 16, 25, 36, 49 or 64";
      },
      "samples a pixel, on a regular grid in it, averaged: 1, 4, 9, 16, 25, 36, 49 or 64")
      .default_str("1");
  add_text_option(
      app, "--cutoff", "PX",
      [quality](const std::string& text) -> std::string {
        const auto pixels = parse_real(text);
        if (!pixels || *pixels < 0 || *pixels > kMostCutoffPx) {
          return "is not a number from 0 to " + std::to_string(kMostCutoffPx);
        }
        quality->cutoff = Q16::from_raw(static_cast<std::int32_t>(std::lround(*pixels * Q16::kOne)));
        return {};
      },
      "stop at blocks of the tree that cover less than PX pixels, in their mean colour; 0 to 64, compact "
      "structure only")
      .default_str("0");
  add_whole_option(
      app, "--max-depth", "D", kMinLevel, kMaxLevel,
      [quality](std::int64_t depth) { quality->max_depth = static_cast<int>(depth); },
      "stop at blocks D levels down in the tree, in their mean colour: the scene as with a depth of D; "
      "compact structure only");
}

void add_direction_bits(CLI::App& app, int* bits) {
  add_whole_option(
      app, "--direction-bits", "N", kMinDirectionBits, kMaxDirectionBits,
      [bits](std::int64_t number) { *bits = static_cast<int>(number); },
      "bits of a ray's direction, 8 to 20 (default: as many as are needed)");
}

void ViewOptions::add_to(CLI::App& app, bool with_direction_bits) {
  add_text_option(
      app, "--size", "WxH",
      [this](const std::string& text) -> std::string {
        const std::size_t x = text.find('x');
        const auto width = parse_whole(text.substr(0, x), 1, kMaxPicturePx);
        const auto height =
            x == std::string::npos ? std::nullopt : parse_whole(text.substr(x + 1), 1, kMaxPicturePx);
        if (!width || !height) {
          return "is not WxH with sides of 1 to " + std::to_string(kMaxPicturePx) + " pixels";
        }
        width_px = static_cast<std::int32_t>(*width);
        height_px = static_cast<std::int32_t>(*height);
        size_given = true;
        return {};
      },
      "the picture's size in pixels (default: " + std::to_string(width_px) + "x" + std::to_string(height_px) +
          (has_option(app, "--board") ? ", or the display of --board)" : ")"));
  add_choice_option(
      app, "--projection", {"perspective", "orthographic"},
      [this](std::size_t index) {
        orthographic = index == 1;
        placed = true;
      },
      "how rays leave the camera")
      .default_str("perspective");
  add_triple(app, "--eye", &eye, &placed,
             "where the camera is, in voxels (default: where it sees the whole scene)");
  add_triple(app, "--target", &target, &placed,
             "what it looks at, in voxels (default: the middle of the scene)");
  add_triple(app, "--up", &up, &placed,
             "what is up in the picture (default: 0,0,1, or 0,1,0 when looking along z)");
  add_text_option(
      app, "--fov", "DEG",
      [this](const std::string& text) {
        const auto degrees = parse_real(text);
        fov_degrees = degrees.value_or(0);
        placed = true;
        return fov_degrees >= 1 && fov_degrees <= 120 ? "" : "is not a number from 1 to 120";
      },
      "perspective: vertical field of view in degrees, 1 to 120")
      .default_str("60");
  add_text_option(
      app, "--span", "V",
      [this](const std::string& text) {
        span = parse_real(text);
        placed = true;
        return span && *span > 0 ? "" : "is not a number above 0";
      },
      "orthographic: width of the picture in voxels (default: the whole scene)");
  if (with_direction_bits) {
    add_direction_bits(app, &direction_bits);
  }
}

void ViewOptions::use_display(const platform::BoardFacts* board) {
  if (board != nullptr && !size_given) {
    width_px = board->width_px;
    height_px = board->height_px;
  }
}

ViewOptions ViewOptions::finer(int across) const {
  ViewOptions fine = *this;
  if (width_px > kMaxPicturePx / across || height_px > kMaxPicturePx / across) {
    throw InputError(std::to_string(across * across) + " samples a pixel want a picture of at most " +
                     std::to_string(kMaxPicturePx / across) + " pixels a side");
  }
  fine.width_px *= across;
  fine.height_px *= across;
  return fine;
}

Camera ViewOptions::camera(const SceneSource& source, int level, const VoxelBox& bounds, std::string* note,
                           SceneCamera* chosen) const {
  if (placed || source.camera() == nullptr) {
    return camera(level, bounds, note, chosen);
  }
  SceneCamera own = *source.camera();
  if (direction_bits != 0) {
    own.direction_bits = static_cast<std::uint8_t>(direction_bits);
  }
  Camera result;
  const Status status = set_camera(own, width_px, height_px, level, &result);
  if (status != Status::kOk) {
    throw InputError(std::string("the scene's own camera does not suit a picture of ") +
                     std::to_string(width_px) + "x" + std::to_string(height_px) + ": " + status_text(status) +
                     "; another --size, or a camera of your own (--eye, --target, --span), helps");
  }
  if (chosen != nullptr) {
    *chosen = own;
  }
  return result;
}

Camera ViewOptions::camera(int level, const VoxelBox& occupied, std::string* note,
                           SceneCamera* chosen) const {
  const std::int32_t side = std::int32_t{1} << level;
  const VoxelBox box = occupied.empty() ? VoxelBox{{0, 0, 0}, {side, side, side}} : occupied;
  const auto corners = corners_of(box);
  const Real3 center = scaled(plus(corners[0], corners[7]), 0.5);
  const Real3 looked_at = target.value_or(center);
  if (eye) {
    to_q8(*eye, level, "--eye");
  }
  const Real3 difference = eye ? minus(looked_at, *eye) : kDefaultForward;
  if (largest(difference) == 0) {
    throw InputError("--eye and --target are the same point");
  }
  if (up && largest(*up) == 0) {
    throw InputError("--up 0,0,0 has no direction");
  }
  // What the core will be given, so that both mean the same axes.
  const Vec3i forward_view = to_integers(difference);
  const Vec3i up_view = up ? to_integers(*up) : default_up(forward_view);
  const Real3 forward = to_reals(forward_view);
  const Real3 upward = to_reals(up_view);
  if (largest(cross(forward, upward)) == 0) {
    throw InputError("--up is parallel to the direction of view");
  }
  const Axes axes = axes_of(forward, upward);
  const double aspect = static_cast<double>(width_px) / height_px;
  const double tan_y = std::tan(fov_degrees * 3.14159265358979323846 / 360);

  // How far back the eye must be, and how wide a parallel picture, to see all corners.
  double distance = 0;
  double half_width = 0;
  double reach = 0;
  bool partial = false;
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
    const double wanted = distance;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double limit = axes.forward[axis] > 0 ? static_cast<double>(kMinOriginWorlds) * side
                                                  : static_cast<double>(kMaxOriginWorlds) * side;
      const double back = (looked_at[axis] - limit) / axes.forward[axis];
      if (axes.forward[axis] != 0 && back >= 0 && back < distance) {
        distance = back;
      }
    }
    eye_point = minus(looked_at, scaled(axes.forward, distance));
    const bool reachable = std::all_of(looked_at.begin(), looked_at.end(), [&](double coordinate) {
      return coordinate >= static_cast<double>(kMinOriginWorlds) * side &&
             coordinate <= static_cast<double>(kMaxOriginWorlds) * side;
    });
    if (reachable && distance < wanted) {
      for (double& coordinate : eye_point) {  // what rounding may have added
        coordinate = std::clamp(coordinate, static_cast<double>(kMinOriginWorlds) * side,
                                static_cast<double>(kMaxOriginWorlds) * side);
      }
    }
    // What the margin gives away may be enough to see it all even so.
    partial = !orthographic && std::any_of(corners.begin(), corners.end(), [&](const Real3& corner) {
      const Real3 offset = minus(corner, eye_point);
      const double reach_y = dot(offset, axes.forward) * tan_y;
      return std::abs(dot(offset, axes.up)) > reach_y || std::abs(dot(offset, axes.right)) > reach_y * aspect;
    });
  }

  const Vec3Q8 eye_q8 = to_q8(eye_point, level, eye ? "--eye" : "the eye for this --target,");
  SceneCamera kept;
  kept.is_perspective = !orthographic;
  kept.direction_bits = static_cast<std::uint8_t>(direction_bits);
  kept.eye = eye_q8;
  kept.target = saturated_q8(looked_at);
  kept.forward = forward_view;
  kept.up = up ? up_view : Vec3i{};
  kept.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(std::lround(fov_degrees * Q16::kOne)));
  Camera result;
  Status status = Status::kOk;
  std::string advice;
  if (orthographic) {
    OrthographicView view;
    view.eye = eye_q8;
    view.forward = forward_view;
    view.up = up_view;
    const double least = static_cast<double>(least_orthographic_span(width_px, level).raw) / Q14::kOne;
    const auto to_q14 = [](double voxels) {
      if (!(voxels * Q14::kOne <= INT32_MAX)) {
        throw InputError("a picture " + shortest(voxels) +
                         " voxels wide is beyond the limit of 131,071 (--span)");
      }
      return Q14::from_raw(static_cast<std::int32_t>(std::max(1L, std::lround(voxels * Q14::kOne))));
    };
    const double whole = 2 * half_width / kFill;
    constexpr double kMostSpan = 131071;
    partial = !span && whole > kMostSpan;
    view.span = to_q14(span.value_or(std::min(whole, kMostSpan)));
    view.width_px = width_px;
    view.height_px = height_px;
    view.direction_bits = direction_bits;
    status = result.set(view, level);
    if (status == Status::kTooFine && !span) {
      view.span = to_q14(least);  // a scene of a few voxels is shown smaller instead
      status = result.set(view, level);
    }
    // A long thin picture of the whole scene may be wider than rays may start: then it shows less.
    for (int tries = 0; status == Status::kOutOfRange && !span && tries < 64; ++tries) {
      view.span = to_q14(static_cast<double>(view.span.raw) / Q14::kOne * 0.8);
      status = result.set(view, level);
      partial = true;
    }
    kept.span = view.span;
    // The core's bound starts from the eye and the span as it got them; what rounding them moved is added
    // here.
    const double pixel = static_cast<double>(view.span.raw) / Q14::kOne / width_px;
    double moved_px = result.error_bound_px_q16() / 65536.0;
    if (eye) {
      const Real3 rounding = minus(
          *eye, {static_cast<double>(eye_q8.x.raw) / Q8::kOne, static_cast<double>(eye_q8.y.raw) / Q8::kOne,
                 static_cast<double>(eye_q8.z.raw) / Q8::kOne});
      moved_px += std::hypot(dot(rounding, axes.right), dot(rounding, axes.up)) / pixel;
    }
    if (span) {
      moved_px += std::abs(*span / width_px / pixel - 1) * std::hypot(width_px, height_px) / 2;
    }
    if (status == Status::kOk && direction_bits == 0 && moved_px > 0.125) {
      status = Status::kTooFine;
    }
    advice =
        status == Status::kTooFine
            ? "the pixels are too fine for origins in 1/256 voxel; a wider picture helps, about --span " +
                  shortest(std::ceil(2 * least * 100) / 100) + ""
            : "the picture's corners must lie within -4 to 5 world sizes; a smaller --span or another "
              "--eye helps";
  } else {
    PerspectiveView view;
    view.eye = eye_q8;
    view.forward = forward_view;
    view.up = up_view;
    view.fov_degrees = kept.fov_degrees;
    view.width_px = width_px;
    view.height_px = height_px;
    view.direction_bits = direction_bits;
    status = result.set(view, level);
    advice = status == Status::kTooFine && direction_bits != 0
                 ? "directions of " + std::to_string(direction_bits) +
                       " bits are too coarse for this picture; leave out --direction-bits"
                 : "directions of 20 bits cannot be kept within 1/8 pixel; a wider --fov or a smaller --size "
                   "helps";
  }
  if (status == Status::kBadArgument) {
    throw InputError("--up is parallel to the direction of view");
  }
  if (status != Status::kOk) {
    throw InputError(std::string("the camera: ") + status_text(status) + ": " + advice);
  }
  if (partial && note != nullptr) {
    *note = "the whole scene cannot be seen at once from within -4 to 5 world sizes; a part of it is shown";
  }
  if (chosen != nullptr) {
    *chosen = kept;
  }
  return result;
}

}  // namespace thimble::tools
