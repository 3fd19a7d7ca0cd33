#include "support/lit_cases.h"

#include "support/lit_world.h"

namespace thimble::tests {
namespace {

using testing::lamp;
using testing::sun;
using testing::surface;

std::uint8_t any_byte(std::mt19937_64& random) {
  return static_cast<std::uint8_t>(pick(random, 0, 255));
}
Rgb8 any_color(std::mt19937_64& random) {
  return {any_byte(random), any_byte(random), any_byte(random)};
}

void make_surfaces(std::mt19937_64& random, LitCase* lit) {
  for (std::int64_t i = pick(random, 0, 9) == 0 ? 0 : pick(random, 1, 200); i > 0; --i) {
    Surface one = surface(static_cast<SurfaceKind>(pick(random, 0, 4)), any_color(random));
    one.roughness = pick(random, 0, 1) == 0 ? std::uint8_t{0} : any_byte(random);
    one.mirror = pick(random, 0, 1) == 0 ? std::uint8_t{255} : any_byte(random);
    one.index_q12 = pick(random, 0, 3) == 0
                        ? kMinIndexQ12
                        : static_cast<std::uint16_t>(pick(random, kMinIndexQ12, kMaxIndexQ12));
    one.density_q8 = static_cast<std::uint16_t>(pick(random, 0, 300));
    one.emission_q8 = static_cast<std::uint16_t>(pick(random, 0, 1000));
    lit->surfaces.push_back(one);
  }
}

void make_lights(std::mt19937_64& random, int level, LitCase* lit) {
  const std::int64_t world = std::int64_t{256} << level;
  for (std::int64_t i = pick(random, 0, pick(random, 0, 20) == 0 ? 100 : 4); i > 0; --i) {
    const bool is_point = pick(random, 0, 1) == 0;
    Vec3i place = is_point ? random_voxel(random, -world, 2 * world) : random_voxel(random, -16384, 16384);
    if (pick(random, 0, 3) == 0) {
      place[pick_int(random, 0, 2)] = is_point ? 256 : 0;
    }
    if (!is_point && place == Vec3i{}) {
      place.z = 1;
    }
    Light light = is_point ? lamp(place) : sun(place);
    for (PackedU16& channel : light.color_q8) {
      channel = static_cast<std::uint16_t>(pick(random, 0, 600));
    }
    light.reach = static_cast<std::uint16_t>(pick(random, 0, 200));
    lit->lights.push_back(light);
  }
}

void make_water(std::mt19937_64& random, int level, LitCase* lit) {
  const std::int64_t side = std::int64_t{1} << level;
  const Vec3i corner = random_voxel(random, 0, side - 1);
  const auto width = pick_int(random, 1, std::min<std::int64_t>(side - corner.x, 40));
  const auto depth = pick_int(random, 1, std::min<std::int64_t>(side - corner.y, 40));
  const auto height = pick_int(random, 0, (side - corner.z) * 256);
  lit->scene.has_water = true;
  lit->scene.water = still_water(corner, width, depth, height);
  if (pick(random, 0, 1) == 0) {
    lit->heights.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(depth));
    std::int32_t lowest = INT32_MAX;
    std::int32_t highest = 0;
    for (std::int32_t& one : lit->heights) {
      one = height * 256 + pick_int(random, 0, 65536);
      lowest = std::min(lowest, (one + 128) >> 8);
      highest = std::max(highest, (one + 128) >> 8);
    }
    lit->scene.water.lowest_q8 = lowest;
    lit->scene.water.highest_q8 = highest;
    lit->scene.water.heights_q16 = lit->heights.data();
  }
}

}  // namespace

LitCase random_light(std::mt19937_64& random, int level) {
  LitCase lit;
  make_surfaces(random, &lit);
  make_lights(random, level, &lit);
  make_water(random, level, &lit);
  LitScene& scene = lit.scene;
  for (std::uint16_t& channel : scene.ambient_q8) {
    channel = static_cast<std::uint16_t>(pick(random, 0, 300));
  }
  scene.sky = {any_color(random), any_color(random), any_color(random)};
  scene.fog = {any_color(random), static_cast<std::uint32_t>(pick(random, 0, 3000))};
  constexpr std::uint8_t kRays[] = {0, 4, 4, 8, 16, 32};
  scene.occlusion = {kRays[pick(random, 0, 5)], any_byte(random),
                     static_cast<std::uint16_t>(pick(random, 0, pick(random, 0, 3) == 0 ? 65535 : 30))};
  scene.bounces = static_cast<std::uint8_t>(pick(random, 0, 5));
  // All of them, one, or any.
  const std::int64_t kind = pick(random, 0, 5);
  lit.effects = kind == 0   ? Effect::kAll
                : kind == 1 ? EffectSet{1} << pick(random, 0, Effect::kCount - 1)
                            : static_cast<EffectSet>(pick(random, 0, Effect::kAll));
  lit.options.dither = pick(random, 0, 1) == 0;
  scene.surfaces = {lit.surfaces.data(), lit.surfaces.size()};
  scene.lights = {lit.lights.data(), lit.lights.size()};
  return lit;
}

WideScene cabinet(std::mt19937_64& random) {
  const int level = pick_int(random, 3, 7);
  const std::int32_t side = std::int32_t{1} << level;
  WideScene scene = make_scene(level, [&](Octree* octree) {
    for (std::int64_t i = pick(random, 5, 40); i > 0; --i) {
      const Vec3i at = random_voxel(random, 0, side - 1);
      const Vec3i size = random_voxel(random, 1, std::max(1, side / 3));
      const Vec3i end{std::min(side, at.x + size.x), std::min(side, at.y + size.y),
                      std::min(side, at.z + size.z)};
      (void)octree->insert_box({at, end}, static_cast<std::uint8_t>(pick(random, 0, 12)));
    }
    for (std::int64_t i = pick(random, 0, 200); i > 0; --i) {
      (void)octree->insert(random_voxel(random, 0, side - 1), static_cast<std::uint8_t>(pick(random, 0, 12)));
    }
    if (pick(random, 0, 9) == 0) {
      (void)octree->coarsen_to(octree->nodes_used() / 2);
    }
  });
  scene.what = "cabinet";
  return scene;
}

LitDrawn draw_lit_core(const WideScene& scene, const FrameCase& frame, const LitCase& lit) {
  LitDrawn drawn{std::vector<std::uint8_t>(band_size(frame), 0xA5), {}};
  Band band = frame.band;
  band.pixels = Bytes(drawn.pixels.data(), drawn.pixels.size());
  CHECK(render_lit_band(lit.effects, scene.tree, frame.camera, frame.shading, lit.scene, band, &drawn.counts,
                        lit.options) == Status::kOk);
  return drawn;
}

LitDrawn draw_lit_streams(const WideScene& scene, const wide::RayMap& map, const FrameCase& frame,
                          const LitCase& lit, std::size_t workspace_bytes, int threads) {
  const HeapBytes pixels(band_size(frame));
  std::memset(pixels.span().data, 0xA5, pixels.span().size);
  const HeapBytes workspace(workspace_bytes);
  Band band = frame.band;
  band.pixels = pixels.span();
  LitDrawn drawn;
  CHECK(map.tree().level() == scene.tree.level());
  CHECK(wide::render_lit(lit.effects, map, frame.camera, frame.shading, lit.scene, band, workspace.span(),
                         threads_of(threads), &drawn.counts, lit.options) == Status::kOk);
  drawn.pixels.assign(band.pixels.data, band.pixels.data + band.pixels.size);
  return drawn;
}

}  // namespace thimble::tests
