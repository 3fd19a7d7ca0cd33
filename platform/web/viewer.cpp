// A scene to look around in: what the page calls from frame to frame. Everything is exported; nothing is
// suspended.
//
// While the camera moves frames are fast and without light: by the brick map, or of every few pixels where
// there is none. At rest the page asks for rows of the picture with all of the light, then for rows with four
// samples a pixel.
#include "apps/demo_view.h"
#include "apps/place.h"
#include "apps/scene_light.h"
#include "apps/shown_scene.h"
#include "thimble/base/memory.h"
#include "web/layout.h"

extern "C" uint8_t __heap_base;  // the linker's: the end of constants and variables

namespace thimble::web {
namespace {

constexpr size_t kPageBytes = 65536;
constexpr int32_t kMostAcross = 2;  // samples of a pixel, each way
constexpr size_t kPixelBytes = 3;

struct Viewer {
  apps::ShownScene shown;
  apps::SceneLight light;
  SceneCamera at;
  Camera camera;
  Camera fine;  // kMostAcross times as many pixels each way
  Shading shading;
  int32_t width_px;
  int32_t height_px;
  Bytes picture;  // rows without gaps
  Bytes rows;     // of the fine camera, for one row of the picture
};
// Constant: what has a constructor is constructed anew by each call of an export.
constinit Viewer viewer{};
int32_t picked[10];

uint8_t* at(uintptr_t address) {
  return reinterpret_cast<uint8_t*>(address);
}

// Bytes behind the heap's base, the memory grown to hold them; null where the browser has none.
uint8_t* reserve(uintptr_t* next, size_t bytes) {
  const uintptr_t from = (*next + 7) / 8 * 8;
  *next = from + bytes;
  const size_t pages = (*next + kPageBytes - 1) / kPageBytes;
  const size_t before = __builtin_wasm_memory_size(0);
  if (pages > before && __builtin_wasm_memory_grow(0, pages - before) == SIZE_MAX) {
    return nullptr;
  }
  return at(from);
}

Status draw(const Camera& camera, const Band& band, bool lit) {
  if (lit && viewer.light.effects() != Effect::kNone) {
    return apps::draw_lit(viewer.shown.scene, camera, viewer.shading, viewer.light, band);
  }
  return apps::draw_scene(viewer.shown, camera, viewer.shading, band);
}

}  // namespace
}  // namespace thimble::web

extern "C" {

// Room for a scene of so many bytes and a picture of that size; null where there is none. Once in a module's
// life.
[[clang::export_name("room")]] uint8_t* thimble_room(uint32_t scene_bytes, int32_t width_px,
                                                     int32_t height_px) {
  using namespace thimble;
  using namespace thimble::web;
  uintptr_t next = reinterpret_cast<uintptr_t>(&__heap_base);
  const size_t row = kPixelBytes * static_cast<size_t>(width_px);
  const size_t rows = row * static_cast<size_t>(kMostAcross * kMostAcross);
  uint8_t* const scene = reserve(&next, scene_bytes);
  uint8_t* const picture = reserve(&next, row * static_cast<size_t>(height_px));
  uint8_t* const fine = reserve(&next, rows);
  if (scene == nullptr || picture == nullptr || fine == nullptr) {
    return nullptr;
  }
  layout.scene = {scene, scene_bytes};
  viewer.picture = {picture, row * static_cast<size_t>(height_px)};
  viewer.rows = {fine, rows};
  viewer.width_px = width_px;
  viewer.height_px = height_px;
  return scene;
}

// Opens the scene that was put there: 0, or an English phrase that says what is wrong.
[[clang::export_name("open")]] const char* thimble_open() {
  using namespace thimble;
  using namespace thimble::web;
  if (const char* wrong = apps::open_scene(&viewer.shown)) {
    return wrong;
  }
  if (const char* wrong = apps::open_light(viewer.shown.scene, &viewer.light)) {
    return wrong;
  }
  Arena none;
  if (!viewer.shown.scene.section(SectionKind::kBrickMap).empty()) {
    apps::open_map(&viewer.shown, &none);
  }
  viewer.shading = apps::demo_shading(viewer.shown.scene.palette());
  viewer.at = apps::orbit_of(viewer.shown.scene).camera;
  if (!viewer.shown.scene.has_camera()) {
    return "the scene has no camera";
  }
  return nullptr;
}

[[clang::export_name("level")]] int thimble_level() {
  return thimble::web::viewer.shown.scene.tree().level();
}
[[clang::export_name("is_lit")]] bool thimble_is_lit() {
  return thimble::web::viewer.light.effects() != thimble::Effect::kNone;
}
[[clang::export_name("has_map")]] bool thimble_has_map() {
  return thimble::web::viewer.shown.has_map;
}
[[clang::export_name("picture")]] const uint8_t* thimble_picture() {
  return thimble::web::viewer.picture.data;
}
// The scene's own camera: component `axis` of its eye (`of_target` false) or target, in 1/256 voxel.
[[clang::export_name("own_camera")]] int32_t thimble_own_camera(bool of_target, int axis) {
  const thimble::SceneCamera& own = thimble::web::viewer.shown.scene.camera();
  const thimble::Vec3Q8& point = of_target ? own.target : own.eye;
  return axis == 0 ? point.x.raw : axis == 1 ? point.y.raw : point.z.raw;
}

// The box of what is solid: component `axis` of its low or its high corner, in voxels.
[[clang::export_name("bounds")]] int32_t thimble_bounds(bool high, int axis) {
  const thimble::VoxelBox& box = thimble::web::viewer.shown.scene.tree().bounds();
  return (high ? box.high : box.low)[axis];
}
// The vertical angle of view, in 1/65536 degree; 0 for a parallel view, whose width in 1/16384 voxel is `span`.
[[clang::export_name("fov")]] int32_t thimble_fov() {
  const thimble::SceneCamera& own = thimble::web::viewer.shown.scene.camera();
  return own.is_perspective ? own.fov_degrees.raw : 0;
}
[[clang::export_name("span")]] int32_t thimble_span() {
  return thimble::web::viewer.shown.scene.camera().span.raw;
}

// What the ray of a pixel of the picture hits: the point in 1/256 voxel and the voxel, three numbers each; the
// face as in Shading::face_light, -1 where the eye is in it; material, colour (red at bit 16), SurfaceKind.
// Null for nothing.
[[clang::export_name("pick")]] const int32_t* thimble_pick(int32_t x_px, int32_t y_px) {
  using namespace thimble;
  using namespace thimble::web;
  const Camera& camera = viewer.camera;
  if (x_px < 0 || y_px < 0 || x_px >= camera.width_px() || y_px >= camera.height_px()) {
    return nullptr;
  }
  const Ray ray = camera.ray(x_px, y_px);
  Hit hit;
  if (closest_hit(viewer.shown.scene.tree(), ray, &hit) != Status::kOk || hit.kind != HitKind::kHit) {
    return nullptr;
  }
  for (int axis = 0; axis < 3; ++axis) {
    // The product is below 2^51 (camera.h, ray.h).
    const int64_t along = int64_t{ray.direction[axis]} * hit.t_numerator * Q8::kOne / hit.t_denominator;
    picked[axis] = ray.origin[axis].raw + static_cast<int32_t>(along);
    picked[3 + axis] = hit.voxel[axis];
  }
  const Face face = face_of(hit, ray.direction);
  const Span<const Rgb8> palette = viewer.shown.scene.palette();
  const Rgb8 color = hit.material < palette.size ? palette[hit.material] : Rgb8{255, 255, 255};
  const Span<const Surface>& surfaces = viewer.light.baked.scene.surfaces;
  const SurfaceKind kind = hit.material < surfaces.size ? surfaces[hit.material].kind : SurfaceKind::kDiffuse;
  picked[6] = hit.axis < 0 ? -1 : 2 * face.axis + (face.negative ? 0 : 1);
  picked[7] = hit.material;
  picked[8] = color.r << 16 | color.g << 8 | color.b;
  picked[9] = static_cast<int32_t>(kind);
  return picked;
}

// Looks from there to there, in 1/256 voxel; the width of a parallel view is `zoom` / 256 of the scene's own.
// False, and the camera as it was, where there is no such camera. `own`: the scene's, to the last bit.
[[clang::export_name("look")]] bool thimble_look(int32_t ex, int32_t ey, int32_t ez, int32_t tx, int32_t ty,
                                                 int32_t tz, int32_t zoom, bool own) {
  using namespace thimble;
  using namespace thimble::web;
  SceneCamera at = viewer.at;
  if (!own) {
    at.eye = {Q8::from_raw(ex), Q8::from_raw(ey), Q8::from_raw(ez)};
    at.target = {Q8::from_raw(tx), Q8::from_raw(ty), Q8::from_raw(tz)};
    at.forward = {};
    at.up = {};
    at.span = Q14::from_raw(static_cast<int32_t>(int64_t{at.span.raw} * zoom >> 8));
  }
  const int level = viewer.shown.scene.tree().level();
  Camera camera;
  if (set_camera(at, viewer.width_px, viewer.height_px, level, &camera) != Status::kOk) {
    return false;
  }
  viewer.camera = camera;
  // Where the fine one cannot be had the samples are those of the coarse one.
  return set_camera(at, kMostAcross * viewer.width_px, kMostAcross * viewer.height_px, level, &viewer.fine) ==
             Status::kOk ||
         (viewer.fine = Camera{}, true);
}

// Draws `rows` rows of every `step`-th pixel of every `step`-th row, stretched; rows are multiples of `step`.
[[clang::export_name("draw")]] bool thimble_draw(int32_t first, int32_t rows, int32_t step, bool lit) {
  using namespace thimble;
  using namespace thimble::web;
  const size_t stride = kPixelBytes * static_cast<size_t>(viewer.width_px);
  uint8_t* const to = viewer.picture.data + stride * static_cast<size_t>(first);
  if (step == 1) {
    const Band band{{to, stride * static_cast<size_t>(rows)}, PixelFormat::kRgb888, 0, first, rows};
    return draw(viewer.camera, band, lit) == Status::kOk;
  }
  const Camera thin = viewer.camera.thinned(step);
  const size_t thin_stride = kPixelBytes * static_cast<size_t>(thin.width_px());
  for (int32_t y = first; y < first + rows && y < viewer.height_px; y += step) {
    const Band band{viewer.rows.subspan(0, thin_stride), PixelFormat::kRgb888, 0, y / step, 1};
    if (draw(thin, band, lit) != Status::kOk) {
      return false;
    }
    for (int32_t line = y; line < y + step && line < viewer.height_px; ++line) {
      uint8_t* const row = viewer.picture.data + stride * static_cast<size_t>(line);
      for (int32_t x = 0; x < viewer.width_px; ++x) {
        for (size_t i = 0; i < kPixelBytes; ++i) {
          row[kPixelBytes * static_cast<size_t>(x) + i] =
              band.pixels.data[kPixelBytes * static_cast<size_t>(x / step) + i];
        }
      }
    }
  }
  return true;
}

// Draws a row with all of the light and four samples a pixel, averaged.
[[clang::export_name("draw_fine")]] bool thimble_draw_fine(int32_t y) {
  using namespace thimble;
  using namespace thimble::web;
  const size_t width = static_cast<size_t>(viewer.width_px);
  const size_t fine_stride = kPixelBytes * width * kMostAcross;
  if (viewer.fine.width_px() != kMostAcross * viewer.width_px) {
    return thimble_draw(y, 1, 1, true);
  }
  const Band band{viewer.rows.subspan(0, fine_stride * kMostAcross), PixelFormat::kRgb888, 0, y * kMostAcross,
                  kMostAcross};
  if (draw(viewer.fine, band, true) != Status::kOk) {
    return false;
  }
  uint8_t* const row = viewer.picture.data + kPixelBytes * width * static_cast<size_t>(y);
  for (size_t x = 0; x < width; ++x) {
    for (size_t i = 0; i < kPixelBytes; ++i) {
      const uint8_t* const from = band.pixels.data + 2 * kPixelBytes * x + i;
      const uint32_t sum =
          2U + from[0] + from[kPixelBytes] + from[fine_stride] + from[fine_stride + kPixelBytes];
      row[kPixelBytes * x + i] = static_cast<uint8_t>(sum >> 2);
    }
  }
  return true;
}
}
