#include "support/frames.h"

#include <doctest/doctest.h>

#include <iterator>
#include <utility>

#include "golden/scenes.h"
#include "support/chip_worlds.h"
#include "support/gpu_kernels.h"
#include "support/hard_frames.h"
#include "support/lit_cases.h"
#include "support/random_up.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"

namespace thimble::tests {
namespace {

using Random = std::mt19937_64;

bool takes_all(Subject& /*subject*/, const FrameCase& /*frame*/) {
  return true;
}
bool is_narrow(Subject& subject, const FrameCase& frame) {
  for (std::int32_t y = 0; y < frame.camera.height_px(); ++y) {
    for (std::int32_t x = 0; x < frame.camera.width_px(); ++x) {
      if (!accepts_32(frame.camera.ray(x, y), subject.tree().level())) {
        return false;
      }
    }
  }
  return true;
}
bool has_map(Subject& subject, const FrameCase& /*frame*/) {
  return subject.map().level() != 0;
}
bool is_fast(Subject& subject, const FrameCase& frame) {
  return has_map(subject, frame) && draws_fast(subject.map(), frame.camera);
}
bool is_fast_32(Subject& subject, const FrameCase& frame) {
  return is_fast(subject, frame) && subject.tree().level() <= kMaxBrickMapLevel;
}
bool is_whole(Subject& /*subject*/, const FrameCase& frame) {
  return frame.band.first_row == 0 && frame.band.rows == frame.camera.height_px() &&
         frame.band.stride_bytes == 0;
}

Status draw_64(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
               const Band& band, RenderCounts* counts) {
  return render_band(subject.tree(), frame.camera, frame.shading, band, counts, {UINT32_MAX, Width::k64});
}
Status draw_32(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
               const Band& band, RenderCounts* counts) {
  return render_band_32(subject.tree(), frame.camera, frame.shading, band, counts);
}
Status draw_uncut(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
                  const Band& band, RenderCounts* counts) {
  return render_band_cut(subject.tree(), frame.camera, frame.shading, Cutoff(), NodeColors(), band, counts);
}
Status draw_shared(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
                   const Band& band, RenderCounts* counts) {
  return render_band(*subject.shared(), frame.camera, frame.shading, band, counts);
}
Status draw_bricks(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
                   const Band& band, RenderCounts* counts) {
  return render_band(subject.tree(), subject.map(), frame.camera, frame.shading, band, counts);
}
Status draw_bricks_32(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
                      const Band& band, RenderCounts* counts) {
  return render_band_32(subject.tree(), subject.map(), frame.camera, frame.shading, band, counts);
}
Status draw_anytime(const Engine& /*engine*/, Subject& subject, const FrameCase& frame, Random& /*random*/,
                    const Band& band, RenderCounts* counts) {
  const std::int32_t height = frame.camera.height_px();
  const HeapBytes memory(anytime_bytes(frame.camera.width_px(), height, band.format));
  AnytimeFrame drawn;
  REQUIRE(AnytimeFrame::make(subject.tree(), frame.camera, frame.shading, band.format, memory.span(),
                             &drawn) == Status::kOk);
  for (int turn = 0; turn < 100000 && !drawn.done(); ++turn) {
    REQUIRE(drawn.refine(subject.tree(), 100000) == Status::kOk);
  }
  const Band all = drawn.band(0, height);
  std::copy(all.pixels.begin(), all.pixels.end(), band.pixels.begin());
  counts->hits = drawn.counts().hits;
  return drawn.done() ? Status::kOk : Status::kDamaged;
}
Status draw_wide_band(const Engine& engine, Subject& subject, const FrameCase& frame, Random& random,
                      const Band& band, RenderCounts* counts) {
  wide::use_instruction_set(engine.number);
  return render_wide(subject.scene(), frame, band, random_options(random), counts);
}
Status draw_by_kernels(const Engine& engine, Subject& subject, const FrameCase& frame, Random& /*random*/,
                       const Band& band, RenderCounts* counts) {
  std::uint64_t outside = 0;
  const auto drawn = draw_by_kernel(subject.words(), frame.camera, frame.shading, band,
                                    engine.number != 0 ? Pairs::kAlways : Pairs::kAsNeeded, &outside);
  CHECK(outside == 0);
  std::copy(drawn.begin(), drawn.end(), band.pixels.begin());
  counts->hits = UINT64_MAX;
  return Status::kOk;
}

// Voxels of one material, near one another in part; no eight that make a block.
WideScene make_strewn(Random& random) {
  const int level = pick_int(random, 2, 10);
  const std::int64_t side = std::int64_t{1} << level;
  return make_scene(
      level,
      [&](Octree* octree) {
        for (std::int64_t n = pick(random, 1, std::int64_t{1} << pick(random, 1, 16)); n > 0; --n) {
          const Vec3i at = random_voxel(
              random, 0, pick(random, 0, 2) == 0 ? side - 1 : std::min<std::int64_t>(side - 1, 40));
          if ((at.x & at.y & at.z & 1) == 0) {
            REQUIRE(octree->insert(at, 1) == Status::kOk);
          }
        }
      },
      std::size_t{24} << 20);
}
// A dense cloud in a large world, whose list has short entries unless it is coarsened; often where cubes of entries meet.
WideScene make_stars(Random& random) {
  const int level = pick_int(random, 11, 12);
  const std::int32_t side = std::int32_t{1} << level;
  const std::int32_t cloud = pick_int(random, 48, 128);
  Vec3i corner;
  for (int axis = 0; axis < 3; ++axis) {
    corner[axis] = pick_int(random, 0, 1) == 0 ? 1024 - cloud / 2 : pick_int(random, 0, side - cloud);
  }
  const double share = 0.01 * pick_int(random, 1, 6);
  return make_scene(
      level,
      [&](Octree* octree) {
        for (double n = share * cloud * cloud * cloud; n > 0; --n) {
          const Vec3i at = random_voxel(random, 0, cloud - 1);
          if ((at.x & at.y & at.z & 1) == 0) {  // no block
            REQUIRE(octree->insert({corner.x + at.x, corner.y + at.y, corner.z + at.z}, 1) == Status::kOk);
          }
        }
        if (pick(random, 0, 3) == 0) {
          (void)octree->coarsen_to(octree->nodes_used() / 2);  // blocks, which no short entry holds
        }
      },
      std::size_t{24} << 20);
}
WideScene make_chip(Random& random) {
  return scene_of(make_chip_tree(random, kChipWorlds[pick_int(random, 0, 6)], pick_int(random, 3, 6)).view(),
                  "");
}
WideScene make_deep(Random& random) {
  return scene_of(make_chip_tree(random, kChipWorlds[pick_int(random, 0, 6)], pick_int(random, 9, 10)).view(),
                  "");
}

bool set_chip(Random& random, const WideScene& scene, Camera* camera) {
  *camera = hard_chip_camera(random, scene.level);
  return true;
}
bool set_deep(Random& random, const WideScene& scene, Camera* camera) {
  *camera = hard_deep_camera(random, scene.tree);
  return true;
}
// Of several hundred pixels, so that little of a picture may be written.
bool set_large(Random& random, const WideScene& scene, Camera* camera) {
  const std::int32_t world = 256 << scene.level;
  PerspectiveView view;
  Vec3Q8 target;
  for (int axis = 0; axis < 3; ++axis) {
    const int out = pick_int(random, 0, 2) == 0 ? 0 : world;
    view.eye[axis] = Q8::from_raw(pick_int(random, -out, world + out));
    target[axis] = Q8::from_raw(
        pick_int(random, 256 * scene.tree.bounds().low[axis], 256 * scene.tree.bounds().high[axis]));
  }
  view.forward = look_at(view.eye, target);
  view.fov_degrees = Q16::saturate(pick_int(random, 20, 110));
  view.width_px = pick_int(random, 33, 400);
  view.height_px = pick_int(random, 20, 260);
  return camera->set(view, scene.level) == Status::kOk;
}
// Voxels of a twentieth of a pixel to two pixels, seen from any side or along an axis.
bool set_fine(Random& random, const WideScene& scene, Camera* camera) {
  Vec3Q8 target;
  Vec3i away;
  const int along = pick_int(random, 0, 5);
  for (int axis = 0; axis < 3; ++axis) {
    target[axis] = Q8::from_raw(
        pick_int(random, 256 * scene.tree.bounds().low[axis], 256 * scene.tree.bounds().high[axis]));
    away[axis] = along > 2 || along == axis ? pick_int(random, -100, 100) : 0;
  }
  const double length = std::sqrt(double{1} * away.x * away.x + away.y * away.y + away.z * away.z);
  if (length == 0) {
    return false;
  }
  const double voxel_px = 0.05 * std::pow(40.0, 0.001 * pick_int(random, 0, 1000));
  const auto eye_at = [&](double distance) {
    Vec3Q8 eye;
    for (int axis = 0; axis < 3; ++axis) {
      eye[axis] =
          Q8::from_raw(target[axis].raw + static_cast<std::int32_t>(256 * distance * away[axis] / length));
    }
    return eye;
  };
  if (pick_int(random, 0, 1) == 0) {
    OrthographicView view;
    view.eye = eye_at(300);
    view.forward = look_at(view.eye, target);
    view.up = random_up(random);
    view.width_px = pick_int(random, 20, 120);
    view.height_px = pick_int(random, 20, 90);
    view.span = Q14::from_raw(static_cast<std::int32_t>(view.width_px / voxel_px * Q14::kOne));
    return camera->set(view, scene.level) == Status::kOk;
  }
  PerspectiveView view;
  const int degrees = pick_int(random, 5, 90);
  view.width_px = pick_int(random, 20, 120);
  view.height_px = pick_int(random, 20, 90);
  view.eye = eye_at(view.height_px / 2 / std::tan(degrees * 3.14159 / 360) / voxel_px);
  view.forward = look_at(view.eye, target);
  view.up = random_up(random);
  view.fov_degrees = Q16::saturate(degrees);
  return camera->set(view, scene.level) == Status::kOk;
}
// Few pixels of wide pictures, along axes and diagonals.
bool set_diagonal(Random& random, const WideScene& scene, Camera* camera) {
  PerspectiveView view;
  for (int axis = 0; axis < 3; ++axis) {
    view.eye[axis] = Q8::from_raw(pick_int(random, -600, (256 << scene.level) + 600));
    view.forward[axis] = pick_int(random, -1, 1);
  }
  view.up = random_up(random);
  view.fov_degrees = Q16::saturate(pick_int(random, 60, 120));
  view.width_px = pick_int(random, 16, 70);
  view.height_px = pick_int(random, 8, 40);
  view.direction_bits = pick_int(random, 0, 1) == 0 ? 0 : pick_int(random, kMinDirectionBits, 12);
  return camera->set(view, scene.level) == Status::kOk;
}

// Distances and directions of 31 bits together, more or less: parallel pictures about the plane where distances take one
// more bit, so that the longest rays may be those of one corner alone; and pinholes of every kind.
bool set_border(Random& random, const WideScene& scene, Camera* camera) {
  const int side = 256 << scene.level;
  const bool is_parallel = pick_int(random, 0, 2) != 0;
  Vec3Q8 eye;
  for (int axis = 0; axis < 3; ++axis) {
    eye[axis] =
        Q8::from_raw(pick_int(random, 0, is_parallel ? side : 7 * side) - (axis == 0 ? 7 * side / 2 : 0));
  }
  const Vec3i forward = random_voxel(random, -1000, 1000);
  const Vec3i up = random_voxel(random, -1000, 1000);
  const int bits = std::clamp(pick_int(random, 19, 22) - scene.level, kMinDirectionBits, kMaxDirectionBits);
  const Q14 span = Q14::from_raw(20 << std::max(scene.level, 2) << 12);
  return (is_parallel ? camera->set(OrthographicView{eye, forward, up, span, 5, 4, bits}, scene.level)
                      : camera->set(PerspectiveView{eye, forward, up, Q16::saturate(120), 5, 4, bits},
                                    scene.level)) == Status::kOk;
}

// The frame's band in bands of `rows`.
Status draw_in_bands(const Engine& engine, Subject& subject, const FrameCase& frame, Random& random,
                     std::int32_t rows, Bytes pixels, RenderCounts* counts) {
  const PixelFormat format = frame.band.format;
  const std::size_t line = row_bytes(format, frame.camera.width_px());
  const std::size_t stride = frame.band.stride_bytes == 0 ? line : frame.band.stride_bytes;
  for (std::int32_t row = 0; row < frame.band.rows; row += rows) {
    FrameCase part = frame;
    part.band.first_row += row;
    part.band.rows = std::min(rows, frame.band.rows - row);
    part.band.pixels = pixels.subspan(stride * row_place(format, row), band_size(part));
    const Status status = engine.draw(engine, subject, frame, random, part.band, counts);
    if (status != Status::kOk) {
      return status;
    }
  }
  return Status::kOk;
}

}  // namespace

const BrickMap& Subject::map() {
  if (map_ == nullptr) {
    map_ = std::make_unique<OwnedMap>(tree(), std::min(most_brick_map_bytes(tree()), std::size_t{1} << 23));
  }
  return map_->map;
}
const SharedTree* Subject::shared() {
  if (shared_bytes_ == nullptr && tree().node_count() < 50000) {
    shared_bytes_ = std::make_unique<HeapBytes>(shared_of(tree()));
    REQUIRE(SharedTree::open(shared_bytes_->view(), &shared_) == Status::kOk);
  }
  return shared_bytes_ == nullptr ? nullptr : &shared_;
}
const gpu::SceneWords& Subject::words() {
  if (words_ == nullptr) {
    words_ = std::make_unique<gpu::SceneWords>(gpu::make_scene_words(tree()));
  }
  return *words_;
}

std::vector<Engine> brick_engines() {
  return {{"bricks", has_map, draw_bricks},
          {"bricks, fast", is_fast, draw_bricks},
          {"bricks, 32 bits", is_fast_32, draw_bricks_32}};
}
std::vector<Engine> core_engines() {
  std::vector<Engine> all{
      {"core, 64 bits", takes_all, draw_64},
      {"core, 32 bits", is_narrow, draw_32, false, Status::kBadArgument},
      {"cut-off of nothing", takes_all, draw_uncut},
      {"shared tree", [](Subject& subject, const FrameCase&) { return subject.shared() != nullptr; },
       draw_shared},
      {"any-time", is_whole, draw_anytime, false}};
  for (Engine& engine : brick_engines()) {
    all.push_back(std::move(engine));
  }
  return all;
}
std::vector<Engine> wide_engines() {
  std::vector<Engine> all;
  for (int set = 0; set < wide::instruction_set_count(); ++set) {
    wide::use_instruction_set(set);
    all.push_back({std::string("wide, ") + wide::instruction_set(), takes_all, draw_wide_band, false,
                   Status::kOk, set});
  }
  wide::use_instruction_set(-1);
  return all;
}
std::vector<Engine> kernel_engines() {
  const auto takes = [](Subject& /*subject*/, const FrameCase& frame) {
    return frame.band.stride_bytes == 0 && !has_pages(frame.band.format);
  };
  return {{"gpu kernels", takes, draw_by_kernels},
          {"gpu kernels, pairs of words", takes, draw_by_kernels, false, Status::kOk, 1}};
}

namespace worlds {
const WorldRow kCabinet{"cabinet", cabinet};
const WorldRow kSolid{"solid", [](std::mt19937_64& random) {
                        return solid_scene(random, pick_int(random, 2, pick_int(random, 0, 2) == 0 ? 12 : 8));
                      }};
const WorldRow kStrewn{"strewn", make_strewn};
const WorldRow kStars{"stars", make_stars};
const WorldRow kChip{"chip", make_chip};
const WorldRow kDeep{"deep", make_deep};
}  // namespace worlds
namespace cameras {
const CameraRow kHard{"hard", hard_camera};
const CameraRow kChip{"chip", set_chip};
const CameraRow kDeep{"deep", set_deep};
const CameraRow kLarge{"large", set_large};
const CameraRow kDiagonal{"diagonal", set_diagonal};
const CameraRow kFine{"fine", set_fine};
const CameraRow kBorder{"border", set_border};
}  // namespace cameras

void Tallies::add(const std::string& name, std::uint64_t pixels, bool is_right, std::uint64_t seed) {
  auto at = std::find_if(rows_.begin(), rows_.end(), [&](const Tally& row) { return row.name == name; });
  if (at == rows_.end()) {
    at = rows_.insert(rows_.end(), Tally{name});
  }
  ++at->frames;
  at->pixels += pixels;
  if (!is_right && at->wrong++ == 0) {
    at->first_wrong_seed = seed;
  }
}
std::uint64_t Tallies::pixels() const {
  std::uint64_t sum = 0;
  for (const Tally& row : rows_) {
    sum += row.pixels;
  }
  return sum;
}
std::uint64_t Tallies::pixels_of(const std::string& name) const {
  const auto at =
      std::find_if(rows_.begin(), rows_.end(), [&](const Tally& row) { return row.name == name; });
  return at == rows_.end() ? 0 : at->pixels;
}
std::uint64_t Tallies::wrong() const {
  std::uint64_t sum = 0;
  for (const Tally& row : rows_) {
    sum += row.wrong;
  }
  return sum;
}

bool make_frame(std::mt19937_64& random, const WideScene& scene, const CameraRow& camera, FrameCase* frame) {
  if (!random_frame(random, scene, frame)) {
    return false;
  }
  if (camera.set == nullptr) {
    return true;
  }
  if (!camera.set(random, scene, &frame->camera)) {
    return false;
  }
  set_depth_range(scene, frame);
  Shading& shading = frame->shading;
  const std::int64_t range = shading.far_q8 - std::int64_t{shading.near_q8};
  if (pick(random, 0, 3) == 0 && shading.near_q8 >= 0 && range > 7) {  // greys of some part of what is there
    const std::int64_t part = range >> pick(random, 0, 3);
    shading.near_q8 += pick_int(random, 0, range - part);
    shading.far_q8 = shading.near_q8 + static_cast<std::int32_t>(part);
  }
  const std::size_t gap = frame->band.stride_bytes == 0 || has_pages(frame->band.format)
                              ? 0
                              : static_cast<std::size_t>(pick(random, 0, 5));
  frame->band.stride_bytes = gap == 0 ? 0 : row_bytes(frame->band.format, frame->camera.width_px()) + gap;
  frame->band.first_row = 0;
  frame->band.rows = frame->camera.height_px();
  return true;
}

std::uint64_t draw_by_all(const std::vector<Engine>& engines, Subject& subject, const FrameCase& frame,
                          std::mt19937_64& random, std::uint64_t seed, Tallies* tallies) {
  std::uint64_t expected_hits = 0;
  const std::vector<std::uint8_t> expected = draw_core(subject.scene(), frame, &expected_hits);
  const auto area =
      static_cast<std::uint64_t>(frame.camera.width_px()) * static_cast<std::uint64_t>(frame.band.rows);
  const std::int32_t together = band_row_multiple(frame.band.format);
  for (const Engine& engine : engines) {
    const bool takes = engine.takes(subject, frame);
    if (!takes && (engine.otherwise == Status::kOk || frame.band.rows == 0)) {
      continue;
    }
    // Whole, or in bands of a few rows, as many as share bytes or more.
    const bool is_whole = !engine.splits || pick(random, 0, 1) == 0;
    const std::int32_t rows = is_whole ? std::max(frame.band.rows, 1) : together * pick_int(random, 1, 20);
    const HeapBytes pixels(expected.size());
    std::memset(pixels.span().data, 0xA5, expected.size());
    RenderCounts counts;
    const Status status = draw_in_bands(engine, subject, frame, random, rows, pixels.span(), &counts);
    const bool is_drawn = takes && status != Status::kTooFine;
    const bool is_same = std::equal(expected.begin(), expected.end(), pixels.view().begin());
    const bool is_untouched = counts.rays == 0 && counts.node_visits == 0 &&
                              std::all_of(pixels.view().begin(), pixels.view().end(),
                                          [](std::uint8_t byte) { return byte == 0xA5; });
    const bool is_right = is_drawn ? status == Status::kOk && is_same &&
                                         (counts.hits == expected_hits || counts.hits == UINT64_MAX)
                                   : is_untouched && (takes || status == engine.otherwise);
    tallies->add(takes ? engine.name : engine.name + ": refused", is_drawn ? area : 0, is_right, seed);
    CHECK_MESSAGE(is_right, engine.name, ", seed ", seed, ", rows ", rows, ": ", static_cast<int>(status));
  }
  return expected_hits;
}

Tallies check_frames(const Trial& trial) {
  const BestInstructionSet after;
  const bool few = takes_few() || std::getenv("THIMBLE_FEW") != nullptr;
  const std::uint64_t wanted = std::getenv("THIMBLE_LONG") != nullptr ? 100 * trial.pixels
                               : few                                  ? trial.few_pixels
                                                                      : trial.pixels;
  Tallies tallies;
  std::uint64_t pixels = 0;
  std::uint64_t hits = 0;
  const auto has_share = [&](const Tally& row) { return row.pixels == 0 || row.pixels >= wanted; };
  for (std::uint64_t seed = seed_or(trial.seed);
       pixels < wanted ||
       (pixels < 10 * wanted && !std::all_of(tallies.rows().begin(), tallies.rows().end(), has_share));
       ++seed) {
    std::mt19937_64 random(seed);
    const std::size_t turn = seed % (trial.worlds.size() * trial.cameras.size());
    const CameraRow& camera = trial.cameras[turn / trial.worlds.size()];
    Subject subject(trial.worlds[turn % trial.worlds.size()].make(random));
    for (int view = 0; view < trial.views; ++view) {
      FrameCase frame;
      if (!make_frame(random, subject.scene(), camera, &frame)) {
        continue;
      }
      hits += draw_by_all(trial.engines, subject, frame, random, seed, &tallies);
      pixels +=
          static_cast<std::uint64_t>(frame.camera.width_px()) * static_cast<std::uint64_t>(frame.band.rows);
    }
  }
  CHECK(tallies.wrong() == 0);
  CHECK(hits > pixels / 400);
  return tallies;
}

void check_golden_frames(const std::vector<Engine>& engines) {
  const BestInstructionSet after;
  std::vector<std::uint8_t> bytes(std::size_t{256} << 10);
  std::mt19937_64 random(1);
  Tallies tallies;
  std::uint64_t pixels = 0;
  for (int i = 0; i < golden::frame_count(); ++i) {
    const golden::Frame& shown = golden::frame(i);
    CAPTURE(shown.name);
    Arena arena(Bytes(bytes.data(), bytes.size()));
    golden::World world;
    FrameCase frame;
    REQUIRE(golden::build_scene(shown.scene, golden::Structure::kCompact, &arena, &world) == Status::kOk);
    REQUIRE(golden::set_up(shown, &frame.camera, &frame.shading) == Status::kOk);
    frame.band.format = shown.format;
    frame.band.rows = shown.height_px;
    Subject subject(scene_of({world.compact.bytes(), world.compact.size_bytes()}, shown.name));
    (void)draw_by_all(engines, subject, frame, random, static_cast<std::uint64_t>(i), &tallies);
    pixels += static_cast<std::uint64_t>(shown.width_px) * static_cast<std::uint64_t>(shown.height_px);
  }
  for (const Engine& engine : engines) {
    CHECK_MESSAGE(tallies.pixels_of(engine.name) > pixels / 4, engine.name);
  }
}

}  // namespace thimble::tests
