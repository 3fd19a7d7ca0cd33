// Times the GPU renderer, and checks its pictures against CRCs that the core made, perhaps on another machine.
//
//   bench_device expect SCENE... >expected.txt          by the core: every CRC that is checked
//   bench_device check expected.txt SCENE... [--quick]  by the GPU: a table in Markdown; exit 1 for a wrong picture
//
// SCENE: a file of `thimble bake`. Cameras are integers, so they are the same on every machine.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "gpu/renderer.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"
#include "thimble/picture/render.h"

namespace thimble::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Size {
  std::int32_t width;
  std::int32_t height;
};
constexpr Size kSizes[] = {{800, 600}, {1920, 1080}, {3840, 2160}};
constexpr int kCameras = 240;  // of a path, a degree each
constexpr int kInFlight = 3;
// What a pixel shows: a ShadeMode, or its light.
const char* const kPictures[] = {"depth", "normal", "color", "mono", "lit"};
constexpr int kLit = 4;

struct Scene {
  std::string name;
  std::vector<std::uint8_t> bytes;
  CompactTree tree;
  std::vector<Rgb8> palette;
  int shade = static_cast<int>(ShadeMode::kDepth);  // of the frames that are timed, beside lit ones
};

[[noreturn]] void fail(const std::string& sentence) {
  std::fprintf(stderr, "bench_device: %s\n", sentence.c_str());
  std::exit(2);
}

Scene load(const std::string& name) {
  Scene scene;
  scene.name = name;
  std::ifstream file(name, std::ios::binary);
  scene.bytes.assign(std::istreambuf_iterator<char>(file), {});
  BakedScene baked;
  if (BakedScene::open({scene.bytes.data(), scene.bytes.size()}, &baked) != Status::kOk) {
    fail(name + " is no baked scene");
  }
  scene.name = name.substr(name.find_last_of('/') + 1);
  scene.tree = baked.tree();
  scene.palette.assign(baked.palette().data, baked.palette().data + baked.palette().size);
  if (scene.name.rfind("points:", 0) != 0) {
    scene.shade = static_cast<int>(scene.tree.many_materials() ? ShadeMode::kColor : ShadeMode::kNormal);
  }
  return scene;
}

// Camera `degree` of the path around what is solid.
Camera camera_of(const Scene& scene, Size size, int degree, bool parallel) {
  constexpr std::int64_t kCosine = 1073578288;  // of one degree, by 2^30
  constexpr std::int64_t kSine = 18739380;
  const VoxelBox& box = scene.tree.bounds();
  std::int64_t x = -558000;  // a direction of length 2^20
  std::int64_t y = -779000;
  const std::int64_t z = 421000;
  for (int i = 0; i < degree; ++i) {
    const std::int64_t turned = (x * kCosine - y * kSine) >> 30;
    y = (x * kSine + y * kCosine) >> 30;
    x = turned;
  }
  std::int64_t diagonal_squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t side = box.high[axis] - box.low[axis];
    diagonal_squared += side * side;
  }
  std::int64_t diagonal = 0;
  while (diagonal * diagonal < diagonal_squared) {
    ++diagonal;
  }
  const std::int64_t direction[3] = {x, y, z};
  Vec3Q8 eye;
  Vec3i forward;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t middle = 128 * (std::int64_t{box.low[axis]} + box.high[axis]);
    const std::int64_t away = (direction[axis] * diagonal * 256 * 29 / 20) >> 20;
    eye[axis] = Q8::from_raw(static_cast<std::int32_t>(middle + away));
    forward[axis] = static_cast<std::int32_t>(-away);
  }
  Camera camera;
  Status status = Status::kOk;
  if (parallel) {
    OrthographicView view{
        eye, forward, {}, Q14::from_raw(static_cast<std::int32_t>(diagonal << 14)), size.width, size.height};
    status = camera.set(view, scene.tree.level());
  } else {
    PerspectiveView view{eye, forward, {}, Q16::saturate(35), size.width, size.height};
    status = camera.set(view, scene.tree.level());
  }
  if (status != Status::kOk) {
    fail(scene.name + ": the camera is refused");
  }
  return camera;
}

Shading shading_of(const Scene& scene, int picture, const Camera& camera) {
  Shading shading{.mode = picture == kLit ? ShadeMode::kColor : static_cast<ShadeMode>(picture),
                  .palette = {scene.palette.data(), scene.palette.size()}};
  const DepthRange range = depth_range(camera, scene.tree.bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  return shading;
}

// Of lit pictures: a sun with its shadows, the sky, and four rays of occlusion a pixel.
constexpr EffectSet kLight =
    Effect::kDirectLight | Effect::kShadows | Effect::kSky | Effect::kAmbientOcclusion;
const LitScene& light() {
  static const Light sun;
  static const LitScene scene = [] {
    LitScene made;
    made.lights = {&sun, 1};
    made.has_shadows = true;
    made.has_sky = true;
    made.occlusion.rays = 4;
    return made;
  }();
  return scene;
}

// A picture whose CRC is checked.
struct Check {
  int picture;
  Size size;
  int degree;
  bool parallel;
};

std::vector<Check> checks_of(const Scene& scene) {
  std::vector<Check> checks;
  for (const Size size : kSizes) {
    checks.push_back({scene.shade, size, 0, false});
    checks.push_back({kLit, size, 0, false});
  }
  for (int picture = 0; picture <= kLit; ++picture) {
    checks.push_back({picture, kSizes[0], 77, false});
    checks.push_back({picture, kSizes[0], 161, true});
  }
  return checks;
}

std::string name_of(const Scene& scene, const Check& check) {
  return scene.name + " " + kPictures[check.picture] + " " + std::to_string(check.size.width) + "x" +
         std::to_string(check.size.height) + " " + std::to_string(check.degree) +
         (check.parallel ? " parallel" : " perspective");
}

std::string hex(std::uint32_t crc) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", crc);
  return text;
}

// By the core, rows in as many parts as there are cores.
std::uint32_t crc_by_core(const Scene& scene, const Check& check) {
  const Camera camera = camera_of(scene, check.size, check.degree, check.parallel);
  const Shading shading = shading_of(scene, check.picture, camera);
  const std::size_t row = row_bytes(PixelFormat::kRgb888, check.size.width);
  std::vector<std::uint8_t> pixels(row * static_cast<std::size_t>(check.size.height));
  std::vector<std::thread> threads;
  const auto count = static_cast<std::int32_t>(std::max(1U, std::thread::hardware_concurrency()));
  for (std::int32_t number = 0; number < count; ++number) {
    threads.emplace_back([&, number] {
      for (std::int32_t y = number; y < check.size.height; y += count) {
        Band band{
            .pixels = {pixels.data() + row * static_cast<std::size_t>(y), row}, .first_row = y, .rows = 1};
        const Status status = check.picture == kLit
                                  ? render_lit_band(kLight, scene.tree, camera, shading, light(), band)
                                  : render_band(scene.tree, camera, shading, band);
        if (status != Status::kOk) {
          fail(scene.name + ": the core refuses the picture");
        }
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  return crc32({pixels.data(), pixels.size()});
}

std::uint32_t crc_of(const std::uint32_t* pixels, std::size_t count) {
  std::vector<std::uint8_t> bytes(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      bytes[3 * i + static_cast<std::size_t>(channel)] =
          static_cast<std::uint8_t>(pixels[i] >> (8 * channel));
    }
  }
  return crc32({bytes.data(), bytes.size()});
}

using Expected = std::map<std::string, std::string>;

Expected read_expected(const char* path) {
  Expected expected;
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    const std::size_t space = line.find_last_of(' ');
    expected[line.substr(0, space)] = line.substr(space + 1);
  }
  if (expected.empty()) {
    fail(std::string(path) + " has no CRCs");
  }
  return expected;
}

void begin(gpu::Renderer* renderer, int number, int picture, const Camera& camera, const Shading& shading,
           bool read_back) {
  if (picture == kLit) {
    renderer->begin(number, gpu::LitFrame{kLight, camera, shading, light()}, read_back);
  } else {
    renderer->begin(number, camera, shading, read_back);
  }
}

// Returns how many pictures were wrong.
int check_pictures(const Scene& scene, gpu::Renderer* renderer, const Expected& expected, int* checked) {
  int wrong = 0;
  for (const Check& check : checks_of(scene)) {
    const auto known = expected.find(name_of(scene, check));
    if (known == expected.end()) {
      fail("no CRC for " + name_of(scene, check));
    }
    const Camera camera = camera_of(scene, check.size, check.degree, check.parallel);
    begin(renderer, 0, check.picture, camera, shading_of(scene, check.picture, camera), true);
    const gpu::Frame frame = renderer->end(0);
    const auto pixels =
        static_cast<std::size_t>(check.size.width) * static_cast<std::size_t>(check.size.height);
    const std::string got = hex(crc_of(frame.pixels, pixels));
    ++*checked;
    if (got != known->second) {
      ++wrong;
      std::printf("WRONG: %s has %s, not %s\n", name_of(scene, check).c_str(), got.c_str(),
                  known->second.c_str());
    }
  }
  return wrong;
}

struct Times {
  double device_median = 0;  // seconds of the kernel, one frame at a time
  double wall = 0;           // seconds a frame, several under way, every picture read back
  double wall_kept = 0;      // the same, pictures staying on the device
  int frames = 0;
};

double wall_of(int picture, gpu::Renderer* renderer, int frames, bool read_back,
               const std::vector<Camera>& cameras, const Shading& shading) {
  const auto start = Clock::now();
  for (int i = 0; i < frames + kInFlight; ++i) {
    if (i >= kInFlight) {
      (void)renderer->end(i % kInFlight);
    }
    if (i < frames) {
      begin(renderer, i % kInFlight, picture, cameras[static_cast<std::size_t>(i % kCameras)], shading,
            read_back);
    }
  }
  return seconds_since(start) / frames;
}

Times time_frames(const Scene& scene, int picture, Size size, gpu::Renderer* renderer, double seconds,
                  int most_frames) {
  std::vector<Camera> cameras;
  for (int degree = 0; degree < std::min(kCameras, std::max(most_frames, 1)); ++degree) {
    cameras.push_back(camera_of(scene, size, degree, false));
  }
  while (cameras.size() < kCameras) {
    cameras.push_back(cameras[cameras.size() % static_cast<std::size_t>(most_frames)]);
  }
  const Shading shading = shading_of(scene, picture, cameras[0]);
  std::vector<double> device;
  Times times;
  const auto start = Clock::now();
  for (int i = 0; i < most_frames && (i < 8 || seconds_since(start) < seconds); ++i) {
    const auto before = Clock::now();
    begin(renderer, 0, picture, cameras[static_cast<std::size_t>(i % kCameras)], shading, false);
    const double kernel = renderer->end(0).seconds;
    device.push_back(kernel > 0 ? kernel : seconds_since(before));
  }
  std::sort(device.begin(), device.end());
  times.device_median = device[device.size() / 2];
  times.frames = std::min(most_frames, std::max(kInFlight, static_cast<int>(seconds / times.device_median)));
  times.wall = wall_of(picture, renderer, times.frames, true, cameras, shading);
  times.wall_kept = wall_of(picture, renderer, times.frames, false, cameras, shading);
  return times;
}

void print_row(const Scene& scene, int picture, const gpu::Renderer& renderer, Size size, const Times& times,
               const char* remark) {
  const double rays = 1e-6 * static_cast<double>(size.width) * static_cast<double>(size.height);
  std::printf("| %s %s | %dx%d | %.2f | %.4f | %.0f | %.0f | %.0f | %.0f | %s |\n", scene.name.c_str(),
              kPictures[picture], size.width, size.height, 1e-6 * static_cast<double>(renderer.scene_bytes()),
              1000 * times.device_median, 1 / times.device_median, rays / times.device_median,
              1 / times.wall_kept, 1 / times.wall, remark);
  std::fflush(stdout);
}

int check_scenes(const char* expected_path, const std::vector<std::string>& names, bool quick) {
  const Expected expected = read_expected(expected_path);
  const auto start = Clock::now();
  const double seconds = quick ? 0 : 0.4;
  const int most_frames = quick ? 2 : 2000;
  int wrong = 0;
  for (const std::string& name : names) {
    const Scene scene = load(name);
    gpu::Options options;
    options.frames = kInFlight;
    gpu::Renderer renderer(scene.tree, {scene.palette.data(), scene.palette.size()}, options);
    if (&name == names.data()) {  // there is a device
      std::fprintf(stderr, "device: %s%s\n", renderer.device().name.c_str(),
                   renderer.device().is_software ? " (software)" : "");
      std::printf(
          "| scene | picture | tree MB | kernel ms | frames/s, kernel alone | M rays/s | frames/s, queued | "
          "frames/s, read back | pictures right |\n|---|---|---:|---:|---:|---:|---:|---:|---|\n");
    }
    int checked = 0;
    const int wrong_here = check_pictures(scene, &renderer, expected, &checked);
    wrong += wrong_here;
    char remark[40];
    std::snprintf(remark, sizeof remark, "%d of %d", checked - wrong_here, checked);
    for (const int picture : {scene.shade, kLit}) {
      for (const Size size : kSizes) {
        print_row(scene, picture, renderer, size,
                  time_frames(scene, picture, size, &renderer, seconds, most_frames), remark);
      }
    }
    std::fprintf(stderr, "%s: %.1f s\n", name.c_str(), seconds_since(start));
  }
  std::printf("\n%s; pictures wrong: %d\n", gpu::devices().front().name.c_str(), wrong);
  return wrong == 0 ? 0 : 1;
}

int expect_scenes(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const Scene scene = load(name);
    for (const Check& check : checks_of(scene)) {
      std::printf("%s %s\n", name_of(scene, check).c_str(), hex(crc_by_core(scene, check)).c_str());
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace thimble::bench

int main(int count, char** arguments) {
  using namespace thimble::bench;
  std::vector<std::string> names;
  bool quick = false;
  const bool checks = count > 1 && std::strcmp(arguments[1], "check") == 0;
  for (int i = checks ? 3 : 2; i < count; ++i) {
    if (std::strcmp(arguments[i], "--quick") == 0) {
      quick = true;
    } else {
      names.emplace_back(arguments[i]);
    }
  }
  if (names.empty() || (!checks && std::strcmp(arguments[1], "expect") != 0)) {
    fail("bench_device expect SCENE... or bench_device check EXPECTED SCENE... [--quick]");
  }
  try {
    return checks ? check_scenes(arguments[2], names, quick) : expect_scenes(names);
  } catch (const thimble::gpu::DeviceError& error) {
    fail(error.what());
  }
}
