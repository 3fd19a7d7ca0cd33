// A world that is dug and built while it is drawn, 640 x 360 with a sun and exact shadows: dig_and_place FILE FRAMES OUT.ppm.
// What the middle of the picture shows is dug away; every fourth frame a voxel is placed on it instead. The last frame is
// kept, and what a frame took is said.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "thimble/files.h"
#include "thimble/light/map_render.h"
#include "thimble/tree/edited_world.h"
#include "wide/threads.h"

using namespace thimble;

int main(int count, char** words) {
  std::string error = "usage: dig_and_place FILE FRAMES OUT.ppm";
  const auto scene = count < 4 ? nullptr : files::Scene::open(words[1], {}, &error);
  if (scene == nullptr) {
    std::fprintf(stderr, "dig_and_place: %s\n", error.c_str());
    return 1;
  }
  // The tree and its brick map, in bytes with room to grow.
  std::vector<std::uint64_t> bytes(std::size_t{16} << 20);
  const Bytes room(reinterpret_cast<std::uint8_t*>(bytes.data()), 8 * bytes.size());
  EditedWorld world;
  if (EditedWorld::make(scene->tree(), EditedWorld::room_in(scene->tree(), room.size), room, &world) !=
      Status::kOk) {
    std::fputs("dig_and_place: no room, or more than 1,024 voxels a side\n", stderr);
    return 1;
  }
  constexpr std::int32_t kWidth = 640, kHeight = 360, kBandRows = 8;
  constexpr EffectSet kSunlight = Effect::kDirectLight | Effect::kShadows;
  const Light sun;  // over the viewer's left shoulder
  LitScene light;
  light.lights = {&sun, 1};
  light.has_shadows = true;
  std::vector<std::uint8_t> proofs(SunBricks::bytes(world.map()));  // where no shadow falls
  SunBricks proven;
  if (SunBricks::make(world.map(), sun.place, Bytes(proofs.data(), proofs.size()), &proven) == Status::kOk) {
    (void)proven.prove();
  }
  const Camera camera = scene->camera(kWidth, kHeight, {"--view", "best"});
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = scene->palette();
  wide::Threads threads(static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::uint8_t> rgb(3 * kWidth * kHeight);
  const int frames = std::atoi(words[2]);
  int edits = 0;
  const auto start = std::chrono::steady_clock::now();
  for (int frame = 0; frame < frames; ++frame) {
    Hit hit;  // what stands in the middle of the picture
    const Ray ray = camera.ray(kWidth / 2, kHeight / 2);
    if (closest_hit(world.tree(), ray, &hit) == Status::kOk && hit.kind == HitKind::kHit && hit.axis >= 0) {
      Vec3i beside = hit.voxel;  // the empty place before the face that the ray enters
      beside[hit.axis] += ray.direction[hit.axis] > 0 ? -1 : 1;
      const Status status = frame % 4 == 3 ? world.set(beside, hit.material) : world.clear(hit.voxel);
      edits += status == Status::kOk ? 1 : 0;  // out of room, or of the world: nothing has changed
    }
    (void)proven.follow(world, 4096);
    world.forget_changes();
    threads.each(kHeight / kBandRows, [&](int band_number) {
      const std::int32_t row = band_number * kBandRows;
      const Band band{
          Bytes(&rgb[std::size_t{3} * kWidth * static_cast<std::size_t>(row)], 3 * kWidth * kBandRows),
          PixelFormat::kRgb888, 0, row, kBandRows};
      (void)render_lit_band<kSunlight>(world.tree(), world.map(), camera, shading, light, {&proven, 1}, band);
    });
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%d edits, %.1f ms a frame\n", edits, 1000 * seconds / frames);
  std::FILE* file = std::fopen(words[3], "wb");
  if (file == nullptr) return 1;
  std::fprintf(file, "P6\n%d %d\n255\n", kWidth, kHeight);
  std::fwrite(rgb.data(), 1, rgb.size(), file);
  return std::fclose(file);
}
