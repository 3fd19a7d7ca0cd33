#include "benchmarks/peers/contest.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>
#include <thread>

#include "output/output_file.h"
#include "readers/oct.h"
#include "scene/scene_source.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::benchmarks {
namespace {

// Who takes longer draws a single frame, and who takes less draws some more, with warm caches.
constexpr double kSlowSeconds = 0.2;
constexpr double kFastSeconds = 0.02;
constexpr int kWarmFrames = 4;

Voxel voxel_at(std::int32_t x, std::int32_t y, std::int32_t z) {
  return {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(z)};
}

}  // namespace

std::unique_ptr<tools::SceneSource> open_at(const std::string& scene_at_depth) {
  const std::size_t at = scene_at_depth.rfind('@');
  tools::SceneArguments arguments;
  arguments.scene = scene_at_depth.substr(0, at);
  if (at != std::string::npos) {
    arguments.depth = std::stoi(scene_at_depth.substr(at + 1));
  }
  return tools::open_scene(arguments);
}

std::vector<Voxel> voxels_of(const tools::BuiltScene& built) {
  std::vector<Voxel> voxels;
  tools::walk_blocks(built.compact(), [&](const Vec3i& at, int level, std::uint8_t) {
    const std::int32_t side = std::int32_t{1} << level;
    for (std::int32_t i = 0; i < side * side * side; ++i) {
      voxels.push_back(voxel_at(at.x + i % side, at.y + i / side % side, at.z + i / side / side));
    }
  });
  return voxels;
}

Band gray_band(std::vector<std::uint8_t>* pixels, std::int32_t rows) {
  return {Bytes(pixels->data(), pixels->size()), PixelFormat::kGray8, 0, 0, rows};
}

void write_text(const std::string& path, const std::string& text) {
  if (!path.empty()) {
    tools::OutputFile file(path);
    file.write(text);
    file.commit();
  }
}

const Entrant* Result::find(const std::string& name) const {
  for (const Entrant& entrant : entrants) {
    if (entrant.name == name) {
      return &entrant;
    }
  }
  return nullptr;
}

const Entrant* Result::best_peer() const {
  const Entrant* best = nullptr;
  for (std::size_t i = 1; i < entrants.size(); ++i) {
    if (entrants[i].counts(Contest::kPixels) && (best == nullptr || entrants[i].ms < best->ms)) {
      best = &entrants[i];
    }
  }
  return best;
}

Contest::Contest(const std::string& kind, std::uint64_t points, int depth, std::uint64_t most_bytes)
    : kind_(kind), points_(points), pixels_(kPixels) {
  tools::SceneArguments arguments;
  arguments.scene = kind + ":" + std::to_string(points);
  arguments.depth = depth;
  const auto source = tools::open_scene(arguments);
  built_ = std::make_unique<tools::BuiltScene>(*source, tools::BuildOptions{});
  renderer_ = tools::WideRenderer::make(built_->compact(), &built_->arena(), kWidthPx, kHeightPx, 1);
  const std::uint64_t voxels = built_->voxels();
  // What they keep a voxel, about, while they build; and what a grid of bits takes in any case.
  struct Maker {
    const char* name;
    std::unique_ptr<Peer> (*make)(const std::vector<Voxel>&);
    std::uint64_t bytes;
  };
  for (const Maker& maker :
       {Maker{"raster in floats", make_raster, voxels * sizeof(Voxel)},
        Maker{"exact loop", make_loop, voxels * sizeof(Voxel)}, Maker{"Embree", make_embree, voxels * 200},
        Maker{"textbook's octree", make_textbook, voxels * 400},
        Maker{"NanoVDB", make_nanovdb, std::min<std::uint64_t>(voxels * 3000, 5'000'000'000)}}) {
    if (maker.bytes + voxels * sizeof(Voxel) > most_bytes) {
      left_out_.emplace_back(maker.name);
      continue;
    }
    if (voxels_.empty()) {
      voxels_ = voxels_of(*built_);
    }
    Rival rival;
    rival.build_seconds = seconds_of([&] { rival.peer = maker.make(voxels_); });
    if (rival.peer != nullptr) {
      rivals_.push_back(std::move(rival));
    }
  }
}

double Contest::draw_wide(const Camera& camera, std::uint64_t* hits) {
  return seconds_of([&] {
    RenderCounts counts;
    wide::Counts work;
    const Shading shading = tools::timed_shading(camera, built_->bounds());
    const Band band = gray_band(&pixels_, kHeightPx);
    if ((renderer_ == nullptr || renderer_->render(camera, shading, band, &counts, &work) != Status::kOk) &&
        built_->render_band(camera, shading, band, &counts, {}) != Status::kOk) {
      throw std::runtime_error("the core does not take the rays of this view");
    }
    *hits = counts.hits;
  });
}

double Contest::draw_core(const Camera& camera) {
  return seconds_of([&] {
    RenderCounts counts;
    if (built_->render_band(camera, tools::timed_shading(camera, built_->bounds()),
                            gray_band(&pixels_, kHeightPx), &counts, {}) != Status::kOk) {
      throw std::runtime_error("the core does not take the rays of this view");
    }
  });
}

namespace {

// Drives out of the caches what a frame left there, so that none finds more of its own than the next: all draw
// into the same picture.
void chill_caches() {
  static std::vector<std::uint64_t> memory(std::size_t{8} << 20);  // 64 MiB
  for (std::size_t i = 0; i < memory.size(); i += 8) {
    memory[i] += i;
  }
}

// Of an entrant, in seconds.
struct Times {
  std::vector<double> cold;
  std::vector<double> warm;
  bool is_slow = false;

  // Draws frame `frame` when it is his turn.
  template <class Draw>
  void add(int frame, const Draw& draw) {
    if (is_slow) {
      return;
    }
    chill_caches();
    const double first = draw(frame);
    is_slow = first > kSlowSeconds;
    if (is_slow || frame > 0) {
      cold.push_back(first);
    }
    for (int again = 1; first < kFastSeconds && again <= kWarmFrames; ++again) {
      warm.push_back(draw(frame + again));
    }
  }
  double cold_ms() const { return 1e3 * median(cold); }
  double warm_ms() const { return warm.empty() ? 0 : 1e3 * median(warm); }
};

}  // namespace

Result Contest::run(bool orthographic, int frames) {
  Result result;
  result.scene = kind_;
  result.points = points_;
  result.voxels = built_->voxels();
  result.left_out = left_out_;
  result.orthographic = orthographic;
  std::vector<Times> times(2 + rivals_.size());
  std::vector<std::uint64_t> differing(rivals_.size(), 0);
  std::vector<Voxel> wanted(kPixels);
  std::vector<Voxel> shown(kPixels);
  std::vector<std::uint8_t> core_pixels;
  std::uint64_t wide_differing = 0;
  for (int frame = 0; frame <= frames; ++frame) {  // the first does not count
    const auto camera_at = [&](int number) {
      return tools::timed_camera(built_->level(), orthographic, number);
    };
    times[0].add(frame, [&](int number) { return draw_wide(camera_at(number), &result.hits); });
    times[1].add(frame, [&](int number) { return draw_core(camera_at(number)); });
    for (std::size_t i = 0; i < rivals_.size(); ++i) {
      times[2 + i].add(frame, [&](int number) {
        return seconds_of([&] {
          const Camera camera = camera_at(number);
          const Shading shading = tools::timed_shading(camera, built_->bounds());
          rivals_[i].peer->draw(View(camera, shading.near_q8, shading.far_q8), pixels_.data(), nullptr);
        });
      });
    }
  }
  // One frame more is judged, not timed: by the voxels, and this renderer's and the core's by their pixels.
  const Camera camera = tools::timed_camera(built_->level(), orthographic, 0);
  for (std::int32_t y = 0; y < kHeightPx; ++y) {
    for (std::int32_t x = 0; x < kWidthPx; ++x) {
      Hit hit;
      if (built_->closest_hit(camera.ray(x, y), &hit, {}) != Status::kOk) {
        throw std::runtime_error("the core does not take the rays of this view");
      }
      wanted[static_cast<std::size_t>(y) * kWidthPx + static_cast<std::size_t>(x)] =
          hit.kind == HitKind::kHit ? voxel_at(hit.voxel.x, hit.voxel.y, hit.voxel.z) : kNoVoxel;
    }
  }
  draw_core(camera);
  core_pixels = pixels_;
  draw_wide(camera, &result.hits);
  for (std::size_t i = 0; i < kPixels; ++i) {
    wide_differing += core_pixels[i] != pixels_[i] ? 1U : 0U;
  }
  const Shading shading = tools::timed_shading(camera, built_->bounds());
  for (std::size_t i = 0; i < rivals_.size(); ++i) {
    rivals_[i].peer->draw(View(camera, shading.near_q8, shading.far_q8), pixels_.data(), shown.data());
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
      differing[i] += shown[pixel] == wanted[pixel] ? 0U : 1U;
    }
  }
  const std::uint64_t list_bytes = renderer_ == nullptr ? 0 : wide::VoxelLists::bytes(built_->compact());
  result.entrants.push_back({"Thimble", times[0].cold_ms(), times[0].warm_ms(), built_->build_seconds(),
                             built_->tree_bytes() + list_bytes, wide_differing});
  result.entrants.push_back({"Thimble, ray by ray", times[1].cold_ms(), times[1].warm_ms(),
                             built_->build_seconds(), built_->tree_bytes(), 0});
  for (std::size_t i = 0; i < rivals_.size(); ++i) {
    result.entrants.push_back({rivals_[i].peer->name(), times[2 + i].cold_ms(), times[2 + i].warm_ms(),
                               rivals_[i].build_seconds, rivals_[i].peer->bytes(), differing[i]});
  }
  return result;
}

std::vector<std::pair<std::string, std::string>> machine() {
  std::vector<std::pair<std::string, std::string>> words;
  std::ifstream processors("/proc/cpuinfo");
  for (std::string line; std::getline(processors, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 || line.rfind("cache size", 0) == 0) {
      words.emplace_back(line.substr(0, line.find('\t')), line.substr(colon + 2));
    }
    if (line.empty()) {
      break;  // the others are alike
    }
  }
  words.emplace_back("processors", std::to_string(std::thread::hardware_concurrency()));
  words.emplace_back("memory_bytes", std::to_string(static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                                                    static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE))));
  utsname system{};
  if (uname(&system) == 0) {
    words.emplace_back("system", std::string(system.sysname) + " " + system.release + " " + system.machine);
  }
  words.emplace_back("compiler", __VERSION__);
  words.emplace_back("instruction_set", wide::instruction_set());
  return words;
}

}  // namespace thimble::benchmarks
