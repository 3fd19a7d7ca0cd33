// Shows a model that turns, in a window: view FILE. With view FILE FRAMES OUT.ppm it draws so many frames without one and
// keeps the last.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "thimble/files.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"
#include "wide/raster/renderer.h"

// Last, since it has macros of common names.
#include <X11/Xlib.h>
#undef Status

using namespace thimble;

namespace {
constexpr std::int32_t kWidth = 640, kHeight = 480;

// A camera `turn` radians around the middle of what is solid, which fills the picture.
Camera camera_at(const CompactTree& tree, double turn) {
  const VoxelBox& box = tree.bounds();
  const double x = (box.low.x + box.high.x) / 2.0, y = (box.low.y + box.high.y) / 2.0;
  const double z = (box.low.z + box.high.z) / 2.0;
  const double far = 1.1 * std::hypot(box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z);
  const auto q8 = [](double value) {
    return Q8::from_raw(static_cast<std::int32_t>(std::lround(256 * value)));
  };
  PerspectiveView view;
  view.eye = {q8(x + far * std::sin(turn)), q8(y - far * std::cos(turn)), q8(z + far / 2)};
  view.forward = look_at(view.eye, {q8(x), q8(y), q8(z)});
  view.fov_degrees = Q16::saturate(40);
  view.width_px = kWidth;
  view.height_px = kHeight;
  Camera camera;
  (void)camera.set(view, tree.level());
  return camera;
}
}  // namespace

int main(int count, char** words) {
  std::string error = "usage: view FILE [FRAMES OUT.ppm]";
  const auto scene = count < 2 ? nullptr : files::Scene::open(words[1], {}, &error);
  if (scene == nullptr) {
    std::fprintf(stderr, "view: %s\n", error.c_str());
    return 1;
  }
  const CompactTree& tree = scene->tree();
  wide::Threads threads(static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::uint8_t> list_bytes(wide::VoxelLists::bytes(tree));
  std::vector<std::uint8_t> work(wide::workspace_bytes(kWidth, kHeight, threads.count()) + 64);
  Arena arena(Bytes(list_bytes.data(), list_bytes.size()));
  wide::VoxelLists lists;
  if (wide::VoxelLists::make(tree, &arena, &lists) != Status::kOk) return 1;
  Arena workspace(Bytes(work.data(), work.size()));
  const Bytes drawn_in = workspace.take(work.size() - 64, 64);
  wide::Options options;
  options.threads = &threads;
  std::vector<std::uint8_t> rgb(3 * kWidth * kHeight), shown(4 * kWidth * kHeight);
  const auto draw = [&](double turn) {
    Shading shading;
    shading.mode = ShadeMode::kColor;
    shading.palette = scene->palette();
    const Band band{Bytes(rgb.data(), rgb.size()), PixelFormat::kRgb888, 0, 0, kHeight};
    const Camera camera = camera_at(tree, turn);
    if (wide::render(lists, camera, shading, band, drawn_in, nullptr, options) != Status::kOk) {
      (void)render_band(tree, camera, shading, band);  // cameras beyond what floats resolve are the core's
    }
  };
  if (count > 3) {
    for (int frame = 0; frame < std::atoi(words[2]); ++frame) draw(0.7 + 0.01 * frame);
    std::FILE* file = std::fopen(words[3], "wb");
    if (file == nullptr) return 1;
    std::fprintf(file, "P6\n%d %d\n255\n", kWidth, kHeight);
    std::fwrite(rgb.data(), 1, rgb.size(), file);
    return std::fclose(file);
  }
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return 1;
  const Window window =
      XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, kWidth, kHeight, 0, 0, 0);
  XSelectInput(display, window, KeyPressMask | ExposureMask);
  XMapWindow(display, window);
  XImage* image = XCreateImage(display, DefaultVisual(display, 0), 24, ZPixmap, 0,
                               reinterpret_cast<char*>(shown.data()), kWidth, kHeight, 32, 0);
  for (double turn = 0.7;; turn += 0.01) {  // until a key is pressed
    draw(turn);
    for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
      for (std::size_t c = 0; c < 3; ++c) shown[4 * i + c] = rgb[3 * i + 2 - c];
    }
    XPutImage(display, window, DefaultGC(display, 0), image, 0, 0, 0, 0, kWidth, kHeight);
    XSync(display, False);
    for (XEvent event; XPending(display) != 0;) {
      XNextEvent(display, &event);
      if (event.type == KeyPress) return 0;
    }
  }
}
