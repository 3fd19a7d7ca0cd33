// A voxel model drawn as triangles by small3dlib, beside this core's frame by the brick map: 320 x 240 pixels, the same
// cameras, by turns, and how many pixels show another face than the exact picture.
//
//   thimble_small3d_table [--scenes A;B] [--frames N]
//
// Built with -DTHIMBLE_SMALL3DLIB=DIR, a folder with small3dlib.h, which is not ours and not here; without it its
// columns say `not run`. Frames are the demonstration's (apps/demo_view.h). As many as eight are judged.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "apps/demo_view.h"
#include "apps/shown_scene.h"
#include "benchmarks/measure.h"
#include "benchmarks/small3d/voxel_faces.h"
#include "scene/baking.h"
#include "scene/scene_source.h"
#include "thimble/picture/render.h"
#ifdef THIMBLE_HAVE_SMALL3DLIB
#include "benchmarks/small3d/small3d_drawing.h"
#endif

namespace thimble::benchmarks {
namespace {

constexpr std::int32_t kWidthPx = 320;
constexpr std::int32_t kHeightPx = 240;
constexpr std::size_t kPixels = std::size_t{kWidthPx} * kHeightPx;

// A scene as a board has it.
class Scene {
 public:
  explicit Scene(const std::string& name) {
    tools::SceneArguments arguments;
    arguments.scene = name;
    source_ = tools::open_scene(arguments);
    tools::BakingOptions options;
    options.effects.automatic = false;
    options.brick_map = true;
    if (source_->camera() != nullptr) {
      options.camera = [&](const CompactTree&) { return *source_->camera(); };
    }
    baked_ = tools::bake_scene(*source_, options);
    if (BrickMap::open(baked_.scene.section(SectionKind::kBrickMap), &map_) != Status::kOk) {
      throw std::runtime_error(name + " has no brick map: it is too large for one");
    }
    orbit_ = apps::orbit_of(baked_.scene);
    shading_ = apps::demo_shading(baked_.scene.palette());
  }

  const tools::SceneSource& source() const { return *source_; }
  std::size_t bytes() const { return baked_.bytes.size(); }
  const Shading& shading() const { return shading_; }
  Camera camera(int frame) const {
    Camera camera;
    if (apps::view_at(orbit_, baked_.scene.tree(), apps::kGoldenStep * static_cast<std::uint32_t>(frame), {},
                      kWidthPx, kHeightPx, &camera) != Status::kOk) {
      throw std::runtime_error("no camera goes round this scene");
    }
    return camera;
  }
  // A frame by the map; its camera is set up first.
  void draw(int frame, std::vector<std::uint16_t>* pixels) const {
    if (render_band(baked_.scene.tree(), map_, camera(frame), shading_, band(pixels)) != Status::kOk) {
      throw std::runtime_error("the core draws no such frame");
    }
  }
  // Pixels of it that ray by ray are others.
  std::size_t differing(int frame) const {
    std::vector<std::uint16_t> fast(kPixels);
    std::vector<std::uint16_t> slow(kPixels);
    draw(frame, &fast);
    if (render_band(baked_.scene.tree(), camera(frame), shading_, band(&slow)) != Status::kOk) {
      throw std::runtime_error("the core draws no such frame");
    }
    std::size_t different = 0;
    for (std::size_t i = 0; i < kPixels; ++i) {
      different += fast[i] == slow[i] ? 0U : 1U;
    }
    return different;
  }
  // The rectangle in each pixel of the exact picture.
  std::vector<std::uint32_t> rects(int frame, const VoxelFaces& faces) const {
    const Camera from = camera(frame);
    std::vector<std::uint32_t> numbers;
    for (std::int32_t y = 0; y < kHeightPx; ++y) {
      for (std::int32_t x = 0; x < kWidthPx; ++x) {
        const Ray ray = from.ray(x, y);
        Hit hit;
        if (closest_hit(baked_.scene.tree(), ray, &hit) != Status::kOk) {
          throw std::runtime_error("the core traces no such ray");
        }
        numbers.push_back(faces.rect_of(ray, hit));
      }
    }
    return numbers;
  }

 private:
  static Band band(std::vector<std::uint16_t>* pixels) {
    return {Bytes(reinterpret_cast<std::uint8_t*>(pixels->data()), 2 * kPixels), PixelFormat::kRgb565, 0, 0,
            kHeightPx};
  }

  std::unique_ptr<tools::SceneSource> source_;
  tools::Baked baked_;
  BrickMap map_;
  apps::Orbit orbit_;
  Shading shading_;
};

// What a row says of small3dlib.
struct Rival {
  double ms = 0;
  std::size_t wrong_mean = 0;
  std::size_t wrong_most = 0;
  std::size_t bytes = 0;
};

#ifdef THIMBLE_HAVE_SMALL3DLIB
constexpr bool kIsThere = true;

std::uint16_t rgb565(const Rgb8& color) {
  std::uint16_t stored = 0;
  store_pixel(reinterpret_cast<std::uint8_t*>(&stored), 0, 0, PixelFormat::kRgb565, color);
  return stored;
}

// The colours that the core gives faces, found beforehand.
std::vector<std::uint16_t> colors_of(const VoxelFaces& faces, const Shading& shading) {
  std::vector<std::uint16_t> colors;
  for (const FaceRect& rect : faces.rects()) {
    const Rgb8 albedo = shading.palette[rect.material];
    const unsigned light = shading.face_light[2 * rect.axis + (rect.up ? 1 : 0)];
    const auto lit = [light](std::uint8_t part) { return static_cast<std::uint8_t>(part * light >> 8); };
    colors.push_back(rgb565({lit(albedo.r), lit(albedo.g), lit(albedo.b)}));
  }
  return colors;
}

// Draws by turns with the core, whose milliseconds go to `ours`.
Rival measure(const Scene& scene, const VoxelFaces& faces, int frames, std::vector<double>* ours) {
  const std::vector<std::uint16_t> colors = colors_of(faces, scene.shading());
  const std::uint16_t background = rgb565(scene.shading().background);
  Small3dDrawing drawing(faces, colors);
  const Small3dTuning tuning = tune(&drawing, scene.camera(0), scene.rects(0, faces));
  std::vector<std::uint16_t> pixels(kPixels);
  std::vector<std::uint32_t> rects(kPixels);
  std::vector<double> theirs;
  Rival rival;
  rival.bytes = drawing.bytes();
  std::size_t wrong = 0;
  const int judged = frames < 8 ? frames : 8;
  for (int frame = 0; frame < frames; ++frame) {
    ours->push_back(seconds_of([&] { scene.draw(frame, &pixels); }));
    theirs.push_back(
        seconds_of([&] { drawing.draw(scene.camera(frame), tuning, background, pixels.data(), nullptr); }));
    if (frame < judged) {
      drawing.draw(scene.camera(frame), tuning, background, pixels.data(), rects.data());
      const std::size_t now = wrong_pixels(scene.rects(frame, faces), rects);
      wrong += now;
      rival.wrong_most = std::max(rival.wrong_most, now);
    }
  }
  rival.wrong_mean = wrong / static_cast<std::size_t>(judged);
  rival.ms = 1e3 * median(theirs);
  return rival;
}
#else
constexpr bool kIsThere = false;

Rival measure(const Scene& scene, const VoxelFaces& /*faces*/, int frames, std::vector<double>* ours) {
  std::vector<std::uint16_t> pixels(kPixels);
  for (int frame = 0; frame < frames; ++frame) {
    ours->push_back(seconds_of([&] { scene.draw(frame, &pixels); }));
  }
  return {};
}
#endif

int run(int count, char** words) {
  std::vector<std::string> scenes{"demo", "cluster:6000,depth=6", "castle"};
  int frames = 40;
  CLI::App app("small3dlib beside this core, 320 x 240 pixels");
  app.add_option("--scenes", scenes, "scenes")->delimiter(';');
  app.add_option("--frames", frames, "of each row")->check(CLI::Range(1, 10000));
  CLI11_PARSE(app, count, words);
  std::printf(
      "| scene | surface | rectangles | Thimble, ms | bytes | wrong pixels | small3dlib, ms | bytes | "
      "wrong pixels, mean (most) | small3dlib / Thimble |\n"
      "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const std::string& name : scenes) {
    const Scene scene(name);
    std::size_t differing = 0;
    for (int frame = 0; frame < frames && frame < 8; ++frame) {
      differing += scene.differing(frame);
    }
    for (const bool joined : {false, true}) {
      const VoxelFaces faces(scene.source(), joined);
      std::vector<double> ours;
      const Rival rival = measure(scene, faces, frames, &ours);
      const double ms = 1e3 * median(ours);
      std::printf("| %s | %s | %zu | %.2f | %zu | %zu |", name.c_str(), joined ? "joined faces" : "faces",
                  faces.rects().size(), ms, scene.bytes(), differing);
      if (kIsThere) {
        std::printf(" %.2f | %zu | %zu (%zu) | %.1f |\n", rival.ms, rival.bytes, rival.wrong_mean,
                    rival.wrong_most, rival.ms / ms);
      } else {
        std::printf(" not run | not run | not run | not run |\n");
      }
      std::fflush(stdout);
    }
  }
  if (!kIsThere) {
    std::fprintf(stderr,
                 "small3dlib was not run: SMALL3DLIB=DIR make bench-small3dlib, DIR with small3dlib.h\n");
  }
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_small3d_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
