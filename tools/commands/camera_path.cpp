#include "commands/render_command.h"

#include "readers/text.h"

namespace thimble::tools {
namespace {

constexpr std::uint64_t kMostPathBytes = std::uint64_t{64} << 20;
constexpr std::array<const char*, 10> kNames{"ex", "ey", "ez", "tx", "ty", "tz", "ux", "uy", "uz", "fov"};

// The camera that a line's cells are; of nine and more the fourth three are what is up, the last of seven and ten is fov.
PathCamera camera_of(const std::vector<std::string_view>& cells, std::uint64_t line, const ViewWishes& view,
                     bool has_fov) {
  std::array<double, 10> numbers{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t column = has_fov && i + 1 == cells.size() ? 9 : i;
    fail_at_line_if(parse_number(cells[i], numbers[column]) != NumberKind::kFinite, line, kNames[column], " ",
                    quoted(cells[i]), " is no finite number");
  }
  PathCamera camera{view, line};
  camera.view.placed = true;
  camera.view.eye = Real3{numbers[0], numbers[1], numbers[2]};
  camera.view.target = Real3{numbers[3], numbers[4], numbers[5]};
  if (cells.size() >= 9) {
    camera.view.up = Real3{numbers[6], numbers[7], numbers[8]};
  }
  if (has_fov) {
    camera.view.fov_degrees = numbers[9];
    fail_at_line_if(!(numbers[9] >= 1 && numbers[9] <= 120), line, "fov ", shortest(numbers[9]),
                    " is not from 1 to 120 degrees");
  }
  return camera;
}

// Between the second and the third of four keys, at `t` of 0 .. 1.
double on_spline(const std::array<double, 4>& keys, double t) {
  const double squared = t * t;
  const double cubed = squared * t;
  return (keys[0] * (2 * squared - t - cubed) + keys[1] * (2 - 5 * squared + 3 * cubed) +
          keys[2] * (t + 4 * squared - 3 * cubed) + keys[3] * (cubed - squared)) /
         2;
}

CameraPath cameras_of(std::string_view text, const ViewWishes& view) {
  CameraPath result;
  std::size_t columns = 0;  // of the first line
  LineReader lines(text.substr(mark_bytes(text)));
  for (std::string_view all; lines.next(all);) {
    if (all.find_first_not_of(" \t") == std::string_view::npos) {
      continue;
    }
    const std::uint64_t line = lines.line_number();
    const std::vector<std::string_view> cells = comma_columns(all);
    const bool is_first = columns == 0;
    if (is_first) {
      columns = cells.size();
      fail_at_line_if(columns < 6 || columns == 8 || columns > 10, line, columns,
                      " columns are none of a camera; ", kPathColumns);
      result.has_fov = columns == 7 || columns == 10;
    }
    fail_at_line_if(cells.size() != columns, line, cells.size(), " columns; the first line has ", columns);
    if (is_first && are_names(cells)) {
      std::vector<const char*> names(kNames.begin(), kNames.begin() + static_cast<std::ptrdiff_t>(columns));
      names.back() = result.has_fov ? kNames.back() : names.back();
      fail_at_line_if(misplaces(cells, names), line, "the columns are named in another order; ",
                      kPathColumns);
      continue;
    }
    const PathCamera camera = camera_of(cells, line, view, result.has_fov);
    fail_at_line_if(result.cameras.size() == kMostFilmFrames, line, "a film has at most ",
                    grouped(kMostFilmFrames), " frames");
    result.cameras.push_back(camera);
  }
  fail_if(result.cameras.empty(), "holds no camera");
  return result;
}

}  // namespace

const char* const kPathColumns =
    "ex,ey,ez,tx,ty,tz are where it stands and what it looks at, in voxels; ux,uy,uz for what is up, fov in "
    "degrees, or both may follow";

CameraPath read_camera_path(const std::string& path, const ViewWishes& view) {
  return about(printable(path), [&] { return cameras_of(load_file(path, kMostPathBytes).text(), view); });
}

CameraPath smoothed(const CameraPath& keys, int frames) {
  const std::vector<PathCamera>& cameras = keys.cameras;
  const std::size_t ways = cameras.size() - 1;
  const std::size_t all = ways * static_cast<std::size_t>(frames) + 1;
  fail_if(all > kMostFilmFrames, "with --seconds this is a film of more than ", grouped(kMostFilmFrames),
          " frames");
  CameraPath result;
  result.has_fov = keys.has_fov;
  result.cameras.reserve(all);
  for (std::size_t way = 0; way < ways; ++way) {
    const ViewWishes& from = cameras[way].view;
    const ViewWishes& to = cameras[way + 1].view;
    for (int frame = 0; frame < frames; ++frame) {
      // Before the first key and behind the last one the way goes straight on.
      const auto between = [&](const auto& value_of) {
        const double a = value_of(from);
        const double b = value_of(to);
        return on_spline({way == 0 ? 2 * a - b : value_of(cameras[way - 1].view), a, b,
                          way + 1 == ways ? 2 * b - a : value_of(cameras[way + 2].view)},
                         static_cast<double>(frame) / frames);
      };
      PathCamera camera = cameras[way];
      camera.is_between = frame != 0;
      for (std::optional<Real3> ViewWishes::*const point :
           {&ViewWishes::eye, &ViewWishes::target, &ViewWishes::up}) {
        for (std::size_t axis = 0; from.*point && axis < 3; ++axis) {
          (*(camera.view.*point))[axis] =
              between([&](const ViewWishes& view) { return (*(view.*point))[axis]; });
        }
      }
      camera.view.fov_degrees =
          std::clamp(between([](const ViewWishes& view) { return view.fov_degrees; }), 1.0, 120.0);
      result.cameras.push_back(camera);
    }
  }
  result.cameras.push_back(cameras.back());
  return result;
}

std::vector<Framing> frame_path(const std::string& path, const CameraPath& cameras, const SceneShape& shape) {
  std::vector<Framing> framings;
  for (const PathCamera& camera : cameras.cameras) {
    const std::string place = concat(printable(path), ": line ", camera.line,
                                     camera.is_between ? ": on the way from here to the next" : "");
    framings.push_back(about(place, [&] { return frame_shape(camera.view, shape); }));
  }
  return framings;
}

}  // namespace thimble::tools
