#include "support/wide_cases.h"

#include <doctest/doctest.h>

#include <cmath>
#include <map>

#include "support/random_up.h"

namespace thimble::tests {
namespace {

// Fills the octree with something; says what.
std::string fill_randomly(std::mt19937_64& random, int level, Octree* octree) {
  std::string what;
  const std::int32_t side = std::int32_t{1} << level;
  const auto materials = pick(random, 0, 3) == 0 ? 200 : 1;
  const auto material = [&] { return static_cast<std::uint8_t>(pick(random, 1, materials)); };
  const auto anywhere = [&](std::int32_t low, std::int32_t high) {
    return Vec3i{pick_int(random, low, high), pick_int(random, low, high), pick_int(random, low, high)};
  };
  const std::int64_t kind = pick(random, 0, 9);
  switch (kind) {
    case 0:
      what = "empty";
      break;
    case 1:
      what = "full";
      REQUIRE(octree->insert_block({0, 0, 0}, level, material()) == Status::kOk);
      break;
    case 2:
      what = "one voxel";
      REQUIRE(octree->insert(anywhere(0, side - 1), material()) == Status::kOk);
      break;
    case 3:
    case 4:
      what = "blocks";
      for (std::int64_t i = pick(random, 1, 60); i > 0; --i) {
        const int block = pick_int(random, 0, std::max(0, level - 1));
        const Vec3i at = anywhere(0, (side >> block) - 1);
        (void)octree->insert_block({at.x << block, at.y << block, at.z << block}, block, material());
      }
      break;
    case 5: {
      what = "crowd";  // dense, around a point
      const Vec3i middle = anywhere(0, side - 1);
      const auto radius = pick_int(random, 1, 12);
      for (std::int64_t i = pick(random, 100, 4000); i > 0; --i) {
        const Vec3i step = anywhere(-radius, radius);
        (void)octree->insert(
            {std::clamp(middle.x + step.x, 0, side - 1), std::clamp(middle.y + step.y, 0, side - 1),
             std::clamp(middle.z + step.z, 0, side - 1)},
            material());
      }
      break;
    }
    case 6: {
      what = "floor";
      const std::int32_t height = pick_int(random, 0, side - 1);
      const std::int32_t most = std::min(side, 60);
      for (std::int32_t y = 0; y < most; ++y) {
        for (std::int32_t x = 0; x < most; ++x) {
          (void)octree->insert({x, y, height}, material());
        }
      }
      break;
    }
    default:
      what = "points";
      for (std::int64_t i = pick(random, 1, pick(random, 0, 9) == 0 ? 20000 : 2000); i > 0; --i) {
        (void)octree->insert(anywhere(0, side - 1), material());
      }
      break;
  }
  if (pick(random, 0, 9) == 0 && octree->nodes_used() > 8) {
    what += ", merged";
    (void)octree->coarsen_to(octree->nodes_used() / 2);
  }
  return what;
}

// Picks a point in 1/256 voxel: anywhere from so many world sizes to so many, or on a plane, an edge or a
// corner of voxels.
Vec3Q8 random_point(std::mt19937_64& random, int level, std::int64_t low_worlds, std::int64_t high_worlds) {
  Vec3Q8 point;
  const std::int64_t world = std::int64_t{256} << level;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t raw = pick(random, low_worlds * world, high_worlds * world);
    if (pick(random, 0, 2) == 0) {
      raw = raw / 256 * 256;
    }
    point[axis] = Q8::from_raw(static_cast<std::int32_t>(raw));
  }
  return point;
}

// Sets up some camera; false where the core refuses what was drawn.
bool random_camera(std::mt19937_64& random, const WideScene& scene, Camera* camera) {
  const int level = scene.level;
  const auto width = pick_int(random, 1, 90);
  const auto height = pick_int(random, 1, 40);
  const bool inside = pick(random, 0, 2) == 0;
  const Vec3Q8 eye = inside ? random_point(random, level, 0, 1) : random_point(random, level, -4, 5);
  // At something solid, or anywhere.
  Vec3Q8 target = random_point(random, level, 0, 1);
  if (!scene.tree.empty() && pick(random, 0, 1) == 0) {
    const VoxelBox& bounds = scene.tree.bounds();
    for (int axis = 0; axis < 3; ++axis) {
      target[axis] = Q8::from_raw(
          pick_int(random, std::int64_t{256} * bounds.low[axis], std::int64_t{256} * bounds.high[axis]));
    }
  }
  Vec3i forward = look_at(eye, target);
  switch (pick(random, 0, 5)) {
    case 0: {  // along an axis
      const int axis = pick_int(random, 0, 2);
      const std::int32_t sign = pick(random, 0, 1) == 0 ? -1 : 1;
      forward = {};
      forward[axis] = sign;
      break;
    }
    case 1:  // in a plane
      forward[pick_int(random, 0, 2)] = 0;
      break;
    default:
      break;
  }
  const int bits = pick(random, 0, 3) == 0 ? pick_int(random, 8, 20) : 0;
  if (pick(random, 0, 2) == 0) {
    OrthographicView view{eye, forward, random_up(random), {}};
    const double most = std::ldexp(1.0, level) * 2;
    const double least = most / 4000;
    const double span = least * std::pow(most / least, static_cast<double>(pick(random, 0, 1000)) / 1000);
    view.span = Q14::from_raw(std::max(1, static_cast<std::int32_t>(span * Q14::kOne)));
    view.width_px = width;
    view.height_px = height;
    view.direction_bits = bits;
    return camera->set(view, level) == Status::kOk;
  }
  PerspectiveView view{eye, forward, random_up(random)};
  view.fov_degrees =
      Q16::from_raw(static_cast<std::int32_t>(pick(random, 0, 3) == 0   ? 65536
                                              : pick(random, 0, 3) == 0 ? 120 * 65536
                                                                        : pick(random, 65536, 120 * 65536)));
  view.width_px = width;
  view.height_px = height;
  view.direction_bits = bits;
  return camera->set(view, level) == Status::kOk;
}

}  // namespace

const wide::VoxelLists& WideScene::lists() const {
  if (list_bytes_ == nullptr) {
    list_bytes_ = std::make_unique<HeapBytes>(wide::VoxelLists::bytes(tree, kind));
    Arena arena(list_bytes_->span());
    REQUIRE(wide::VoxelLists::make(tree, &arena, &lists_, kind) == Status::kOk);
  }
  return lists_;
}

WideScene make_scene(int level, const std::function<void(Octree*)>& fill, std::size_t pool_bytes,
                     wide::ListKind kind) {
  WideScene scene;
  scene.level = level;
  const HeapBytes pool(pool_bytes);
  Octree octree;
  REQUIRE(Octree::make(level, pool.span(), &octree) == Status::kOk);
  fill(&octree);
  scene.bytes = std::make_unique<HeapBytes>(compact_of(octree));
  scene.tree = open_or_throw(*scene.bytes);
  scene.kind = kind;
  return scene;
}

WideScene scene_of(ConstBytes tree, const std::string& what) {
  WideScene scene;
  scene.what = what;
  scene.bytes = std::make_unique<HeapBytes>(tree.size);
  std::copy(tree.begin(), tree.end(), scene.bytes->span().data);
  scene.tree = open_or_throw(*scene.bytes);
  scene.level = scene.tree.level();
  return scene;
}

Vec3i random_voxel(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  return {pick_int(random, low, high), pick_int(random, low, high), pick_int(random, low, high)};
}

WideScene random_scene(std::mt19937_64& random) {
  const int level = pick_int(random, 1, 12);
  std::string what;
  // Lists of boxes alone are made where a budget holds no others.
  const wide::ListKind kind = pick(random, 0, 2) == 0 ? wide::ListKind::kBoxes : wide::ListKind::kFastest;
  WideScene scene = make_scene(
      level, [&](Octree* octree) { what = fill_randomly(random, level, octree); }, std::size_t{4} << 20,
      kind);
  scene.what = what;
  return scene;
}

void set_depth_range(const WideScene& scene, FrameCase* frame) {
  const DepthRange range = depth_range(frame->camera, scene.tree.bounds());
  frame->shading.near_q8 = range.near_q8;
  frame->shading.far_q8 = range.far_q8;
}

bool random_frame(std::mt19937_64& random, const WideScene& scene, FrameCase* frame) {
  if (!random_camera(random, scene, &frame->camera)) {
    return false;
  }
  Shading& shading = frame->shading;
  shading.mode = static_cast<ShadeMode>(pick(random, 0, 3));
  for (std::int64_t i = pick(random, 0, 255); i > 0; --i) {
    frame->palette.push_back({static_cast<std::uint8_t>(pick(random, 0, 255)),
                              static_cast<std::uint8_t>(pick(random, 0, 255)),
                              static_cast<std::uint8_t>(pick(random, 0, 255))});
  }
  shading.palette = Span<const Rgb8>(frame->palette.data(), frame->palette.size());
  if (pick(random, 0, 1) == 0) {
    shading.background = {static_cast<std::uint8_t>(pick(random, 0, 255)), 77, 200};
  }
  set_depth_range(scene, frame);
  if (pick(random, 0, 9) == 0) {
    shading.near_q8 = pick_int(random, INT32_MIN, INT32_MAX);
    shading.far_q8 = pick_int(random, INT32_MIN, INT32_MAX);
  }
  Band& band = frame->band;
  band.format = static_cast<PixelFormat>(pick(random, 0, kPixelFormats - 1));
  const std::int32_t height = frame->camera.height_px();
  band.first_row = pick(random, 0, 1) == 0 ? 0 : pick_int(random, 0, height - 1);
  band.first_row -= band.first_row % band_row_multiple(band.format);
  band.rows =
      pick(random, 0, 1) == 0 ? height - band.first_row : pick_int(random, 0, height - band.first_row);
  if (band.first_row + band.rows < height) {
    band.rows -= band.rows % band_row_multiple(band.format);
  }
  if (pick(random, 0, 2) == 0) {
    band.stride_bytes =
        row_bytes(band.format, frame->camera.width_px()) + static_cast<std::size_t>(pick(random, 0, 9));
  }
  return true;
}

std::size_t band_size(const FrameCase& frame) {
  const std::size_t line = row_bytes(frame.band.format, frame.camera.width_px());
  const std::size_t stride = frame.band.stride_bytes == 0 ? line : frame.band.stride_bytes;
  if (frame.band.rows == 0) {
    return 0;
  }
  return stride * (row_place(frame.band.format, whole_rows(frame.band.format, frame.band.rows)) - 1) + line;
}

wide::Threads* threads_of(int count) {
  static std::map<int, std::unique_ptr<wide::Threads>> kept;
  auto& threads = kept[count];
  if (threads == nullptr) {
    threads = std::make_unique<wide::Threads>(count);
  }
  return threads.get();
}
int thread_count(const wide::Options& options) {
  return options.threads == nullptr ? 1 : options.threads->count();
}

Status render_wide(const WideScene& scene, const FrameCase& frame, const Band& band,
                   const wide::Options& options, RenderCounts* counts) {
  const HeapBytes workspace(wide::workspace_bytes(frame.camera.width_px(), band.rows, thread_count(options)));
  std::memset(workspace.span().data, 0xA5,
              workspace.span().size);  // a frame reads nothing that it did not write
  return wide::render(scene.lists(), frame.camera, frame.shading, band, workspace.span(), counts, options);
}

std::optional<std::vector<std::uint8_t>> draw_wide(const WideScene& scene, const FrameCase& frame,
                                                   const wide::Options& options, std::uint64_t* hits) {
  std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
  Band band = frame.band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  RenderCounts counts;
  const Status status = render_wide(scene, frame, band, options, &counts);
  CHECK((status == Status::kOk || status == Status::kTooFine));
  *hits = counts.hits;
  return status == Status::kOk ? std::optional(pixels) : std::nullopt;
}

std::vector<std::uint8_t> draw_core(const WideScene& scene, const FrameCase& frame, std::uint64_t* hits) {
  std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
  Band band = frame.band;
  band.pixels = Bytes(pixels.data(), pixels.size());
  RenderCounts counts;
  CHECK(render_band(scene.tree, frame.camera, frame.shading, band, &counts) == Status::kOk);
  *hits = counts.hits;
  return pixels;
}

wide::Options options_of(int threads, wide::Order order) {
  wide::Options options;
  options.threads = threads_of(threads);
  options.order = order;
  return options;
}

wide::Options random_options(std::mt19937_64& random) {
  wide::Options options;
  constexpr int kThreads[] = {1, 1, 1, 2, 5};
  options.threads = threads_of(kThreads[pick(random, 0, 4)]);
  options.order = static_cast<wide::Order>(pick(random, 0, 2));
  return options;
}

void use_random_instruction_set(std::mt19937_64& random) {
  wide::use_instruction_set(pick_int(random, 0, wide::instruction_set_count() - 1));
}

}  // namespace thimble::tests
