// A scene to look around in: what the page calls from frame to frame. Everything is exported; nothing is
// suspended.
//
// While the camera moves frames are fast: voxels by the brick map, or of every few pixels where there is none. At
// rest the page asks for rows of the picture that `thimble render` draws of the scene (scene/look_picture.h), with
// one sample a pixel, then with all. bake.wasm says how the scene looks from a camera (look_block.h). Where the page has
// a GPU, the GPU draws that picture.
#include "apps/shown_scene.h"
#include "gpu/frame_words.h"
#include "scene/backdrop.h"
#include "scene/magnify.h"
#include "scene/moving_pool.h"
#include "thimble/base/memory.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "web/layout.h"
#include "web/look_block.h"

extern "C" uint8_t __heap_base;  // the linker's: the end of constants and variables

namespace thimble::tools {
namespace {

constexpr size_t kPageBytes = 65536;
constexpr int32_t kMostAcross = 2;  // samples of a pixel, each way
constexpr size_t kPixelBytes = 3;
constexpr Rgb8 kBehind{1, 0, 2};  // no surface's colour but by chance

// What a GPU is to draw, which the page reads: samples, and what makes the picture of them (platform/gpu/kernel/finish.inc).
struct GpuFrame {
  gpu::Parameters parameters;
  struct {
    int32_t width_px;
    int32_t height_px;
    int32_t across;
    int32_t step;
    int32_t samples_width;
    int32_t last_row;
    uint8_t top[4];
    uint8_t bottom[4];
    ToneTable tone;
  } finish;
  uint32_t takes_pairs;
};

struct Viewer {
  apps::ShownScene shown;
  BakedLighting baked;  // of the scene; names what is picked
  SceneCamera own;
  Camera camera;
  Camera fine;  // kMostAcross times as many pixels each way
  LookBlock look;
  Bytes lighting_bytes;
  BakedLighting lighting;  // of the look
  ToneTable tone;
  bool has_one_sample;  // a pixel at rest, by its exposure
  MovingPool pool;
  Bytes pool_bytes;  // of the pool
  bool rains;
  bool has_looked_for_map;
  WebCamera seen;
  int32_t width_px;
  int32_t height_px;
  uintptr_t next;  // the end of what is used
  Bytes picture;   // rows without gaps
  Bytes small;     // of every few pixels
  Bytes samples;   // of a row of the picture
  Bytes shares;    // of light behind them
  GpuFrame gpu;
};
// Constant: what has a constructor is constructed anew by each call of an export.
constinit Viewer viewer{};
int32_t picked[10];

uint8_t* at(uintptr_t address) {
  return reinterpret_cast<uint8_t*>(address);
}

// Bytes behind all others, the memory grown to hold them; none where the browser has none.
Bytes reserve(size_t bytes) {
  const uintptr_t from = (viewer.next + 7) / 8 * 8;
  const size_t pages = (from + bytes + kPageBytes - 1) / kPageBytes;
  const size_t before = __builtin_wasm_memory_size(0);
  if (pages > before && __builtin_wasm_memory_grow(0, pages - before) == SIZE_MAX) {
    return {};
  }
  viewer.next = from + bytes;
  return {at(from), bytes};
}

// The brick map by which frames are fast, where none was baked in; who draws at rest alone needs none.
void make_map() {
  apps::ShownScene& shown = viewer.shown;
  viewer.has_looked_for_map = true;
  const Bytes room = reserve(most_brick_map_bytes(shown.scene.tree()));
  size_t written = 0;
  shown.has_map = BrickMap::make(shown.scene.tree(), room, &shown.map, &written) == Status::kOk;
  viewer.next -= room.size - (shown.has_map ? written : 0);
}

Bytes row_of_picture(int32_t y) {
  const size_t stride = kPixelBytes * static_cast<size_t>(viewer.width_px);
  return viewer.picture.subspan(stride * static_cast<size_t>(y), stride);
}

Shading shading_of(const Camera& camera, Span<const Rgb8> palette) {
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = palette;
  const DepthRange range = depth_range(camera, viewer.shown.scene.tree().bounds());
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  return shading;
}

// Rows first .. first + rows - 1 of `camera`, as bake.wasm's quick look says.
Status draw_quick(const Camera& camera, int32_t first, int32_t rows, Bytes pixels) {
  const LookBlock& look = viewer.look;
  const Band band{pixels, PixelFormat::kRgb888, 0, first, rows};
  Shading shading = shading_of(camera, {look.quick_palette, look.colors});
  shading.mode = look.quick_mode;
  for (int face = 0; face < 6; ++face) {
    shading.face_light[face] = look.quick_light[face];
  }
  const bool shows_behind = look.has_backdrop && !look.is_stars;
  if (shows_behind) {
    shading.background = kBehind;
  }
  const bool is_lit = look.quick_effects != Effect::kNone;
  Status status = Status::kOk;
  if (is_lit) {
    shading.palette = {look.palette, look.colors};
    LitScene scene = viewer.lighting.scene;
    if (viewer.rains) {
      scene.water = viewer.pool.surface();
    }
    status = render_lit_band(look.quick_effects, viewer.shown.scene.tree(), camera, shading, scene, band);
  } else {
    status = apps::draw_scene(viewer.shown, camera, shading, band);
  }
  uint8_t* pixel = pixels.data;
  for (int32_t y = first; (is_lit || shows_behind) && y < first + rows; ++y) {
    const Rgb8 behind = backdrop_color(look.background, y, camera.height_px());
    for (int32_t x = 0; x < camera.width_px(); ++x, pixel += kPixelBytes) {
      if (shows_behind && pixel[0] == kBehind.r && pixel[1] == kBehind.g && pixel[2] == kBehind.b) {
        store_pixel(pixel, 0, y, PixelFormat::kRgb888, behind);
      } else if (is_lit) {
        store_pixel(pixel, 0, y, PixelFormat::kRgb888,
                    {look.quick_tone[pixel[0]], look.quick_tone[pixel[1]], look.quick_tone[pixel[2]]});
      }
    }
  }
  return status;
}

// The whole picture from every `step`-th pixel, those between mixed; `step` above 1.
bool draw_thin(const Camera& thin, int32_t step) {
  const size_t row = kPixelBytes * static_cast<size_t>(thin.width_px());
  if (viewer.small.empty()) {
    viewer.small = reserve(viewer.picture.size / 2);
  }
  for (int32_t y = 0; y < thin.height_px(); ++y) {
    const Bytes to = viewer.small.subspan(row * static_cast<size_t>(y), row);
    if (to.empty() || draw_quick(thin, y, 1, to) != Status::kOk) {
      return false;
    }
  }
  // The samples of a row are as many bytes as the work.
  magnify_rows(viewer.small.data, step, viewer.width_px, viewer.height_px, 0, thin.height_px(),
               reinterpret_cast<uint16_t*>(viewer.samples.data), viewer.picture.data);
  return true;
}

// At rest.
Shading rest_shading(const Camera& camera) {
  Shading shading = shading_of(camera, {viewer.look.palette, viewer.look.colors});
  for (uint16_t& light : shading.face_light) {
    light = static_cast<uint16_t>(2U * light / 3);
  }
  return shading;
}

// Light and what is behind it for `rows` rows of a camera's rays, into `samples` and `shares`. `counts` may be null.
Status trace_samples(const Camera& camera, int32_t first, int32_t rows, LitCounts* counts) {
  const LookBlock& look = viewer.look;
  const CompactTree& tree = viewer.shown.scene.tree();
  const Shading shading = rest_shading(camera);
  const size_t count = static_cast<size_t>(camera.width_px()) * static_cast<size_t>(rows);
  const Band band{viewer.samples.subspan(0, kPixelBytes * count), PixelFormat::kRgb888, 0, first, rows};
  const Status status =
      render_lit_band(look.effects, tree, camera, shading, viewer.lighting.scene, band, counts);
  uint8_t* share = viewer.shares.data;
  for (int32_t y = first; y < first + rows; ++y) {
    RowRays rays(camera, 0, y);
    for (int32_t x = 0; x < camera.width_px(); ++x, rays.next(), ++share) {
      if (!look.has_backdrop || !light_behind(tree, look.ground, rays.ray(), share)) {
        *share = kNothingBehind;
      }
    }
  }
  return status;
}

// Pixel x of a row from `across` x `across` samples of `camera`, whose rows these are: the mean.
Rgb8 finished(const Camera& camera, int32_t x, int32_t across, Rgb8 behind) {
  uint32_t sums[3] = {};
  for (int32_t j = 0; j < across; ++j) {
    for (int32_t i = 0; i < across; ++i) {
      const size_t sample = static_cast<size_t>(j * camera.width_px() + x * across + i);
      const uint8_t* const color = viewer.samples.data + kPixelBytes * sample;
      const uint8_t share = viewer.shares.data[sample];
      const Rgb8 shown =
          share == kNothingBehind ? viewer.tone({color[0], color[1], color[2]}) : shaded(behind, share);
      sums[0] += shown.r;
      sums[1] += shown.g;
      sums[2] += shown.b;
    }
  }
  const auto count = static_cast<uint32_t>(across * across);
  const auto mean = [count](uint32_t sum) { return static_cast<uint8_t>((sum + count / 2) / count); };
  return {mean(sums[0]), mean(sums[1]), mean(sums[2])};
}

int32_t samples_across(bool has_one_sample) {
  const bool has_fine = viewer.fine.width_px() == kMostAcross * viewer.width_px;
  return viewer.look.across == kMostAcross && has_fine && !has_one_sample ? kMostAcross : 1;
}

// Row `y` of the picture that `camera` has, of `across` samples each way, to where it belongs.
Status draw_lit(const Camera& camera, int32_t y, int32_t across, Bytes to) {
  const Status status = trace_samples(camera, y * across, across, nullptr);
  const Rgb8 behind = backdrop_color(viewer.look.background, y, camera.height_px() / across);
  for (int32_t x = 0; x < camera.width_px() / across; ++x) {
    store_pixel(to.data, x, y, PixelFormat::kRgb888, finished(camera, x, across, behind));
  }
  return status;
}

// False, and the view as it was, where there is no such camera.
bool look_from(const SceneCamera& at) {
  const int level = viewer.shown.scene.tree().level();
  Camera camera;
  if (set_camera(at, viewer.width_px, viewer.height_px, level, &camera) != Status::kOk) {
    return false;
  }
  viewer.camera = camera;
  // Where the fine one cannot be had the samples are those of the coarse one.
  if (set_camera(at, kMostAcross * viewer.width_px, kMostAcross * viewer.height_px, level, &viewer.fine) !=
      Status::kOk) {
    viewer.fine = Camera{};
  }
  return true;
}

// Stretches a row of every `step`-th pixel to `step` rows of the picture, from row `y` on.
void stretch(Bytes thin, int32_t y, int32_t step) {
  for (int32_t line = y; line < y + step && line < viewer.height_px; ++line) {
    const Bytes row = row_of_picture(line);
    for (size_t x = 0; x < static_cast<size_t>(viewer.width_px); ++x) {
      for (size_t i = 0; i < kPixelBytes; ++i) {
        row.data[kPixelBytes * x + i] = thin.data[kPixelBytes * (x / static_cast<size_t>(step)) + i];
      }
    }
  }
}

}  // namespace

extern "C" {

// Room for a scene of so many bytes and a picture of that size; null where there is none. What was there is gone.
[[clang::export_name("room")]] uint8_t* thimble_room(uint32_t scene_bytes, int32_t width_px,
                                                     int32_t height_px) {
  viewer = {};
  viewer.next = reinterpret_cast<uintptr_t>(&__heap_base);
  viewer.width_px = width_px;
  viewer.height_px = height_px;
  const size_t width = static_cast<size_t>(width_px);
  constexpr size_t kSamples = static_cast<size_t>(kMostAcross * kMostAcross);
  const Bytes scene = reserve(scene_bytes);
  viewer.picture = reserve(kPixelBytes * width * static_cast<size_t>(height_px));
  viewer.samples = reserve(kPixelBytes * kSamples * width);
  viewer.shares = reserve(kSamples * width);
  web::layout.scene = scene;
  const bool has_room =
      !scene.empty() && !viewer.picture.empty() && !viewer.samples.empty() && !viewer.shares.empty();
  return has_room ? scene.data : nullptr;
}

// Opens the scene that was put there: 0, or an English phrase that says what is wrong.
[[clang::export_name("open")]] const char* thimble_open() {
  const BakedScene& scene = viewer.shown.scene;
  if (const char* wrong = apps::open_scene(&viewer.shown)) {
    return wrong;
  }
  const ConstBytes lighting = scene.section(SectionKind::kLighting);
  if (!lighting.empty() &&
      BakedLighting::open(lighting, scene.tree().level(), &viewer.baked) != Status::kOk) {
    return "the scene's lighting is damaged";
  }
  Arena none;
  if (!scene.section(SectionKind::kBrickMap).empty()) {
    apps::open_map(&viewer.shown, &none);
  }
  viewer.has_looked_for_map = viewer.shown.has_map;
  if (!scene.has_camera()) {
    return "the scene has no camera";
  }
  viewer.own = scene.camera();
  return nullptr;
}

[[clang::export_name("level")]] int thimble_level() {
  return viewer.shown.scene.tree().level();
}
[[clang::export_name("has_map")]] bool thimble_has_map() {
  return viewer.shown.has_map;
}
[[clang::export_name("picture")]] const uint8_t* thimble_picture() {
  return viewer.picture.data;
}
// The scene's own camera: component `axis` of its eye (`of_target` false) or target, in 1/256 voxel.
[[clang::export_name("own_camera")]] int32_t thimble_own_camera(bool of_target, int axis) {
  const SceneCamera& own = viewer.shown.scene.camera();
  const Vec3Q8& point = of_target ? own.target : own.eye;
  return axis == 0 ? point.x.raw : axis == 1 ? point.y.raw : point.z.raw;
}

// The vertical angle of view, in 1/65536 degree, or the width of a parallel view in 1/16384 voxel.
[[clang::export_name("lens")]] int32_t thimble_lens() {
  const SceneCamera& own = viewer.own;
  return own.is_perspective ? own.fov_degrees.raw : own.span.raw;
}
[[clang::export_name("is_parallel")]] bool thimble_is_parallel() {
  return !viewer.own.is_perspective;
}

// What the ray of a pixel of the picture hits: the point in 1/256 voxel and the voxel, three numbers each; the
// face as in Shading::face_light, -1 where the eye is in it; material, colour (red at bit 16), SurfaceKind.
// Null for nothing.
[[clang::export_name("pick")]] const int32_t* thimble_pick(int32_t x_px, int32_t y_px) {
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
  const Span<const Surface>& surfaces = viewer.baked.scene.surfaces;
  const SurfaceKind kind = hit.material < surfaces.size ? surfaces[hit.material].kind : SurfaceKind::kDiffuse;
  picked[6] = hit.axis < 0 ? -1 : 2 * face.axis + (face.negative ? 0 : 1);
  picked[7] = hit.material;
  picked[8] = color.r << 16 | color.g << 8 | color.b;
  picked[9] = static_cast<int32_t>(kind);
  return picked;
}

// Where the camera of `see` is written.
[[clang::export_name("camera")]] WebCamera* thimble_camera() {
  return &viewer.seen;
}
// Looks from that camera. False, and the view as it was, where there is no such camera.
[[clang::export_name("see")]] bool thimble_see() {
  return look_from(viewer.seen.of(viewer.own));
}

// Room for a LookBlock and what belongs to it, of so many bytes; null where there is none.
[[clang::export_name("look_room")]] uint8_t* thimble_look_room(uint32_t bytes) {
  if (bytes > viewer.lighting_bytes.size) {
    viewer.lighting_bytes = reserve(bytes);
  }
  return viewer.lighting_bytes.data;
}
// Looks so from now on, and from the block's own camera, unless the view has moved on. False where the block is none.
[[clang::export_name("take_look")]] bool thimble_take_look(bool moved_on) {
  viewer.look = *reinterpret_cast<const LookBlock*>(viewer.lighting_bytes.data);
  viewer.lighting = {};
  const ConstBytes section = viewer.lighting_bytes.subspan(sizeof(LookBlock), viewer.look.lighting_bytes);
  if (!moved_on && !look_from(viewer.look.camera)) {
    return false;
  }
  return section.empty() ||
         BakedLighting::open(section, viewer.shown.scene.tree().level(), &viewer.lighting) == Status::kOk;
}

// The next frame of rain on the water, or, where none falls, the scene's own water again. False where there is no water,
// or no memory for it.
[[clang::export_name("rain")]] bool thimble_rain(bool falls) {
  const WaterSurface& rest = viewer.lighting.scene.water;
  if ((viewer.look.effects & Effect::kWater) == 0 || !falls) {
    viewer.rains = false;
    return !falls;
  }
  if (!viewer.rains) {
    if (viewer.pool_bytes.empty()) {
      viewer.pool_bytes = reserve(MovingPool::bytes(rest));
    }
    viewer.pool = MovingPool(viewer.shown.scene.tree(), rest, viewer.pool_bytes);
    viewer.rains = !viewer.pool_bytes.empty();
  }
  viewer.pool.step();
  return viewer.rains;
}
[[clang::export_name("has_water")]] bool thimble_has_water() {
  return (viewer.look.effects & Effect::kWater) != 0;
}

// The exposure of the picture at rest, and kOneSample where that is so (measure_look), from rows first .. first + rows
// - 1 of a thinned one; 0 while there are more rows.
[[clang::export_name("expose")]] uint32_t thimble_expose(int32_t first, int32_t rows) {
  static GrayCounts counts;
  static LitCounts traced;
  const Camera& all = samples_across(false) == 1 ? viewer.camera : viewer.fine;
  const int32_t longest = all.width_px() > all.height_px() ? all.width_px() : all.height_px();
  const Camera coarse = all.thinned((longest + kExposurePx - 1) / kExposurePx);
  if (first == 0) {
    counts = {};
    traced = {};
  }
  for (int32_t y = first; y < first + rows && y < coarse.height_px(); ++y) {
    if (trace_samples(coarse, y, 1, &traced) != Status::kOk) {
      return 256;  // drawing will say so
    }
    for (size_t x = 0; x < static_cast<size_t>(coarse.width_px()); ++x) {
      const uint8_t* const color = viewer.samples.data + kPixelBytes * x;
      if (viewer.shares.data[x] == kNothingBehind) {
        ++counts.of[gray_of({color[0], color[1], color[2]})];
      }
    }
  }
  if (first + rows < coarse.height_px()) {
    return 0;
  }
  uint64_t rays = 0;
  for (const uint64_t of_kind : traced.rays) {
    rays += of_kind;
  }
  const auto pixels = [](const Camera& camera) {
    return static_cast<uint64_t>(camera.width_px()) * static_cast<uint64_t>(camera.height_px());
  };
  const bool allows_four = rays * 4 * pixels(viewer.camera) / pixels(coarse) <= kMostLookRays;
  const uint32_t exposure = is_dark_but_for_glow(viewer.lighting.scene) ? kOwnColorsQ8 : exposure_q8(counts);
  return exposure | (allows_four ? 0 : kOneSample);
}
// What is drawn at rest is drawn with it from then on.
[[clang::export_name("set_exposure")]] void thimble_set_exposure(uint32_t exposure_q8) {
  viewer.tone = tone_table(exposure_q8 & ~kOneSample);
  viewer.has_one_sample = (exposure_q8 & kOneSample) != 0;
}

// Draws rows of every `step`-th pixel of every `step`-th row, stretched; `first` is a multiple of `step`. `lit`: as
// at rest, with one sample. Else all rows, with mixtures in between.
[[clang::export_name("draw")]] bool thimble_draw(int32_t first, int32_t rows, int32_t step, bool lit) {
  if (!lit && !viewer.has_looked_for_map) {
    make_map();
  }
  if (step == 1 && !lit) {
    const size_t stride = kPixelBytes * static_cast<size_t>(viewer.width_px);
    const Bytes to =
        viewer.picture.subspan(stride * static_cast<size_t>(first), stride * static_cast<size_t>(rows));
    return draw_quick(viewer.camera, first, rows, to) == Status::kOk;
  }
  const Camera thin = viewer.camera.thinned(step);
  if (!lit) {
    return draw_thin(thin, step);
  }
  const Bytes row = viewer.samples.subspan(0, kPixelBytes * static_cast<size_t>(thin.width_px()));
  for (int32_t y = first; y < first + rows && y < viewer.height_px; y += step) {
    if (draw_lit(thin, y / step, 1, row) != Status::kOk) {
      return false;
    }
    stretch(row, y, step);
  }
  return true;
}

// Draws a row as at rest, with all samples.
[[clang::export_name("draw_fine")]] bool thimble_draw_fine(int32_t y) {
  const int32_t across = samples_across(viewer.has_one_sample);
  return draw_lit(across == 1 ? viewer.camera : viewer.fine, y, across, row_of_picture(y)) == Status::kOk;
}

#ifdef THIMBLE_WEB_GPU
// What a GPU's kernels (platform/gpu) draw: the tree,
[[clang::export_name("tree")]] const uint8_t* thimble_tree() {
  return viewer.shown.scene.tree().bytes();
}
[[clang::export_name("tree_bytes")]] size_t thimble_tree_bytes() {
  return viewer.shown.scene.tree().size_bytes();
}
// and the picture at rest with all samples, or, `step` above 0, of every `step`-th pixel with one, stretched: a GpuFrame.
// Null where they do not draw it.
[[clang::export_name("gpu_frame")]] const GpuFrame* thimble_gpu_frame(int32_t step) {
  const LookBlock& look = viewer.look;
  if (look.is_stars || (look.effects & ~gpu::kEffectsInKernels) != 0) {
    return nullptr;
  }
  GpuFrame& frame = viewer.gpu;
  const int32_t across = step == 0 ? samples_across(viewer.has_one_sample) : 1;
  const int32_t pixels = step == 0 ? 1 : step;
  const Camera camera = across == 1 ? viewer.camera.thinned(pixels) : viewer.fine;
  const Shading shading = rest_shading(camera);
  const Ground& ground = look.ground;
  const gpu::Backdrop behind{ground.is_there, ground.z, ground.reach, ground.toward_sun, kAround};
  const gpu::LitFrame lit{look.effects, camera, shading, viewer.lighting.scene,
                          look.has_backdrop ? &behind : nullptr};
  frame.parameters = {};
  gpu::set_tree(viewer.shown.scene.tree(), &frame.parameters);
  gpu::set_frame(camera, shading, &frame.parameters);
  gpu::set_light(lit, &frame.parameters);
  frame.takes_pairs = gpu::needs_pairs(camera.level(), gpu::largest_direction(lit)) ? 1 : 0;
  const int32_t rows = camera.height_px() / across;
  auto& finish = frame.finish;
  finish.width_px = viewer.width_px;
  finish.height_px = viewer.height_px;
  finish.across = across;
  finish.step = pixels;
  finish.samples_width = camera.width_px();
  finish.last_row = rows > 1 ? rows - 1 : 1;
  store_pixel(finish.top, 0, 0, PixelFormat::kRgb888, backdrop_color(look.background, 0, 2));
  store_pixel(finish.bottom, 0, 0, PixelFormat::kRgb888, backdrop_color(look.background, 1, 2));
  finish.tone = viewer.tone;
  return &frame;
}
#endif
}

}  // namespace thimble::tools
