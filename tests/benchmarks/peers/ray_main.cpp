// Rays in vectors against the core ray by ray: shadows, occlusion and what is seen, by every instruction set.
//
//   thimble_ray_table dragon.ply.gz@10 monu10.vox points:1000000@10
//   thimble_ray_table --peers dragon.ply.gz@11      beside Embree and NanoVDB, from nearer by
//
// A scene is a file or a generator, @ and a depth. Its rays are those of its picture of 1280 x 800, framed as
// `thimble render` frames it; from every second hit a shadow ray to one light; from every fourth hit four rays
// anywhere in the half space above the face (occlusion), once without an end and once within a reach of 8 voxels.
// All by turns on one thread, processor time, the least of so many turns. `wrong`: rays whose answer is not the
// core's (in kind, voxel, axis, t and material where the ray wants the voxel; a peer's in t, to 1e-4, or in
// whether anything is hit). NanoVDB traces ray by ray, Embree in packets of 16: boxes, and a mesh's own triangles.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <random>

#include "benchmarks/peers/contest.h"
#include "output/output_file.h"
#include "readers/read_any.h"
#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/host_memory.h"
#include "scene/scene_source.h"
#include "scene/world_fit.h"
#include "thimble/trace/secondary_ray.h"
#include "wide/raster/kernels.h"
#include "wide/rays/ray_map.h"

namespace thimble::benchmarks {
namespace {

constexpr std::int32_t kWidthPx = 1280;
constexpr std::int32_t kHeightPx = 800;
constexpr double kReach = 8;  // voxels

struct Kind {
  std::string name;
  bool any = true;
  std::vector<Ray> rays;
  std::vector<RayPoint> before;  // empty: none
};

// What a way of tracing said.
struct Answers {
  std::vector<std::uint8_t> any;
  std::vector<Hit> hits;

  explicit Answers(const Kind& kind)
      : any(kind.any ? kind.rays.size() : 0), hits(kind.any ? 0 : kind.rays.size()) {}
};

void add_occlusion(std::mt19937_64& random, const Ray& ray, const Hit& hit, Kind* free, Kind* within) {
  for (int more = 0; more < 4; ++more) {
    Ray next;
    next.origin = start_on_face(ray, hit);
    double square = 0;
    do {
      square = 0;
      for (int axis = 0; axis < 3; ++axis) {
        next.direction[axis] = static_cast<std::int32_t>(static_cast<std::int64_t>(random() % 65535) - 32767);
        square += static_cast<double>(next.direction[axis]) * next.direction[axis];
      }
    } while (square > 32767.0 * 32767.0 || next.direction[hit.axis] == 0);
    if ((ray.direction[hit.axis] < 0) != (next.direction[hit.axis] > 0)) {
      next.direction[hit.axis] = -next.direction[hit.axis];
    }
    free->rays.push_back(next);
    within->rays.push_back(next);
    within->before.push_back(
        {static_cast<std::int32_t>(kReach * 65536), static_cast<std::int32_t>(std::sqrt(square) * 65536)});
  }
}

std::vector<Kind> make_rays(const tools::BuiltScene& built, const Camera& camera) {
  std::vector<Kind> kinds{{"primary", false, {}, {}},
                          {"shadow", true, {}, {}},
                          {"occlusion", true, {}, {}},
                          {"reach 8", true, {}, {}}};
  constexpr Vec3i kLight{-20000, -30000, 40000};
  std::mt19937_64 random(1);
  std::size_t hits = 0;
  for (std::int32_t tile = 0; tile < kWidthPx / 4 * (kHeightPx / 4); ++tile) {
    for (int i = 0; i < 16; ++i) {
      const Ray ray = camera.ray(tile % (kWidthPx / 4) * 4 + i % 4, tile / (kWidthPx / 4) * 4 + i / 4);
      kinds[0].rays.push_back(ray);
      Hit hit;
      if (built.closest_hit(ray, &hit, {}) != Status::kOk || hit.kind != HitKind::kHit || hit.axis < 0) {
        continue;
      }
      ++hits;
      if (hits % 2 == 0 && leaves_face(kLight, hit.axis, looks_to_smaller(ray, hit))) {
        kinds[1].rays.push_back({start_on_face(ray, hit), kLight});
      }
      if (hits % 4 == 0) {
        add_occlusion(random, ray, hit, &kinds[2], &kinds[3]);
      }
    }
  }
  return kinds;
}

void trace_by_core(const CompactTree& tree, const Kind& kind, Answers* to) {
  for (std::size_t i = 0; i < kind.rays.size(); ++i) {
    HitKind met = HitKind::kMiss;
    if (!kind.any) {
      to->hits[i] = Hit{};
      (void)closest_hit(tree, kind.rays[i], &to->hits[i]);
    } else if (kind.before.empty()) {
      (void)any_hit(tree, kind.rays[i], &met);
      to->any[i] = met == HitKind::kHit;
    } else {
      (void)any_hit_before(tree, kind.rays[i], kind.before[i], &met);
      to->any[i] = met == HitKind::kHit;
    }
  }
}

void trace_by_map(const wide::RayMap& map, const Kind& kind, Answers* to) {
  const Span<const Ray> rays{kind.rays.data(), kind.rays.size()};
  if (!kind.any) {
    (void)wide::first_hit(map, rays, {to->hits.data(), to->hits.size()});
  } else if (kind.before.empty()) {
    (void)wide::any_hit(map, rays, {to->any.data(), to->any.size()});
  } else {
    (void)wide::any_hit_before(map, rays, {kind.before.data(), kind.before.size()},
                               {to->any.data(), to->any.size()});
  }
}

bool same(const Hit& a, const Hit& b) {
  return a.kind == b.kind &&
         (a.kind != HitKind::kHit ||
          (a.voxel == b.voxel && a.axis == b.axis && a.t_numerator == b.t_numerator &&
           a.t_denominator == b.t_denominator && a.material == b.material && a.block_level == b.block_level));
}

std::size_t count_wrong(const Answers& expected, const Answers& found) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < expected.any.size(); ++i) {
    wrong += expected.any[i] != found.any[i] ? 1U : 0U;
  }
  for (std::size_t i = 0; i < expected.hits.size(); ++i) {
    wrong += same(expected.hits[i], found.hits[i]) ? 0U : 1U;
  }
  return wrong;
}

// The mesh's triangles where its voxels are; none where the scene is no mesh with y up.
std::vector<float> corners_of(const std::string& path, int level) {
  std::vector<float> corners;
  const tools::Source source = tools::read_scene_file({path});
  const auto* const mesh = std::get_if<tools::TriangleMesh>(&source);
  if (mesh == nullptr || mesh->is_z_up) {
    return corners;
  }
  const auto turned = [](const std::array<double, 3>& p) { return std::array{p[0], -p[2], p[1]}; };
  tools::Bounds bounds;
  for (const auto& position : mesh->positions) {
    bounds.add(turned(position));
  }
  const tools::WorldFit fit(bounds, level);
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t vertex : triangle) {
      for (const std::int32_t unit : fit.units(turned(mesh->positions[vertex]))) {
        corners.push_back(static_cast<float>(unit) / 256);
      }
    }
  }
  return corners;
}

std::vector<std::unique_ptr<Peer>> make_peers(const std::string& path, const tools::BuiltScene& built) {
  const std::vector<Voxel> voxels = voxels_of(built);
  std::vector<std::unique_ptr<Peer>> peers;
  peers.push_back(make_embree(voxels));
  if (const std::vector<float> corners = corners_of(path, built.level()); !corners.empty()) {
    peers.push_back(make_embree_triangles(corners));
  }
  peers.push_back(make_nanovdb(voxels));
  std::erase(peers, nullptr);
  return peers;
}

std::vector<FloatRay> as_floats(const std::vector<Ray>& rays) {
  std::vector<FloatRay> floats(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      floats[i].origin[axis] = static_cast<float>(rays[i].origin[axis].raw) / 256;
      floats[i].direction[axis] = static_cast<float>(rays[i].direction[axis]);
    }
  }
  return floats;
}

std::size_t count_wrong(const Answers& expected, const std::vector<float>& t) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const bool met = t[i] < 1e30F;
    if (expected.hits.empty()) {
      wrong += met == (expected.any[i] != 0) ? 0U : 1U;
      continue;
    }
    const Hit& hit = expected.hits[i];
    const bool is_hit = hit.kind == HitKind::kHit;
    const float entered =
        is_hit ? static_cast<float>(hit.t_numerator) / static_cast<float>(hit.t_denominator) : 0;
    wrong += met == is_hit && (!met || std::abs(t[i] - entered) <= 1e-4F * entered) ? 0U : 1U;
  }
  return wrong;
}

struct SetBack {
  ~SetBack() { wide::use_instruction_set(-1); }
};

void measure(const std::string& name, const tools::BuiltScene& built, const wide::RayMap& map,
             const std::vector<std::unique_ptr<Peer>>& peers, const Kind& kind, int turns) {
  if (kind.rays.empty()) {
    return;
  }
  const SetBack after;
  const int sets = wide::instruction_set_count();
  Answers expected(kind);
  Answers found(kind);
  double core = 1e30;
  std::vector<double> best(static_cast<std::size_t>(sets), 1e30);
  std::vector<std::size_t> wrong(static_cast<std::size_t>(sets), 0);
  // No peer has rays that end.
  const std::size_t peer_count = kind.before.empty() ? peers.size() : 0;
  const std::vector<FloatRay> floats = peer_count > 0 ? as_floats(kind.rays) : std::vector<FloatRay>();
  std::vector<float> t(floats.size());
  std::vector<double> peer_best(peer_count, 1e30);
  std::vector<std::size_t> peer_wrong(peer_count, 0);
  for (int turn = 0; turn < turns; ++turn) {
    core = std::min(core, seconds_of([&] { trace_by_core(built.compact(), kind, &expected); }));
    for (int set = 0; set < sets; ++set) {
      wide::use_instruction_set(set);
      double& least = best[static_cast<std::size_t>(set)];
      least = std::min(least, seconds_of([&] { trace_by_map(map, kind, &found); }));
      wrong[static_cast<std::size_t>(set)] += count_wrong(expected, found);
    }
    for (std::size_t peer = 0; peer < peer_count; ++peer) {
      const double seconds = seconds_of([&] { peers[peer]->trace(floats, kind.any, t.data()); });
      peer_best[peer] = std::min(peer_best[peer], seconds);
      peer_wrong[peer] = count_wrong(expected, t);
    }
  }
  const auto put = [&](const std::string& engine, double seconds, std::size_t mistakes) {
    const double rate = static_cast<double>(kind.rays.size()) / seconds / 1e6;
    std::printf("%-22s %-10s %-17s %9zu %9.2f %8.2f %7zu\n", name.c_str(), kind.name.c_str(), engine.c_str(),
                kind.rays.size(), rate, core / seconds, mistakes);
  };
  put("core", core, 0);
  for (int set = 0; set < sets; ++set) {
    wide::use_instruction_set(set);
    put(wide::instruction_set(), best[static_cast<std::size_t>(set)], wrong[static_cast<std::size_t>(set)]);
  }
  for (std::size_t peer = 0; peer < peer_count; ++peer) {
    put(peers[peer]->name(), peer_best[peer], peer_wrong[peer]);
  }
  std::fflush(stdout);
}

int run(int count, char** words) {
  std::vector<std::string> scenes;
  int turns = 3;
  bool has_peers = false;
  CLI::App app("Rays a second by the map and by the core");
  app.add_option("SCENE@DEPTH", scenes, "files or generators")->required();
  app.add_option("--turns", turns, "of each way of tracing")->check(CLI::Range(1, 100));
  app.add_flag("--peers", has_peers, "beside Embree and NanoVDB, in a nearer view");
  CLI11_PARSE(app, count, words);
  std::printf("%-22s %-10s %-17s %9s %9s %8s %7s\n", "scene", "rays", "engine", "number", "Mrays/s",
              "to core", "wrong");
  for (const std::string& scene : scenes) {
    const auto source = open_at(scene);
    const tools::BuiltScene built(*source, {});
    const std::size_t bytes = wide::RayMap::bytes(built.compact());
    const tools::HostMemory memory(bytes);
    Arena arena(memory.bytes());
    wide::RayMap map;
    Status status = Status::kOk;
    const double seconds = seconds_of([&] { status = wide::RayMap::make(built.compact(), &arena, &map); });
    if (status != Status::kOk) {
      throw std::runtime_error("no map");
    }
    const std::string name = short_name(scene);
    std::printf("%s: map of %.1f MB (tree %.1f) in %.3f s\n", name.c_str(),
                static_cast<double>(arena.used_bytes()) / 1e6, static_cast<double>(built.tree_bytes()) / 1e6,
                seconds);
    tools::ViewWishes view;
    view.width_px = kWidthPx;
    view.height_px = kHeightPx;
    std::vector<std::unique_ptr<Peer>> peers;
    if (has_peers) {
      // A surface fills the picture, as in the gallery.
      const double unit = (1 << built.level()) / 1024.0;
      view.eye = tools::Real3{300 * unit, -500 * unit, 560 * unit};
      view.target = tools::Real3{512 * unit, 512 * unit, 470 * unit};
      view.fov_degrees = 44;
      peers = make_peers(scene.substr(0, scene.rfind('@')), built);
    }
    const Camera camera = tools::frame_box(view, built.level(), built.bounds()).camera;
    for (const Kind& kind : make_rays(built, camera)) {
      measure(name, built, map, peers, kind, turns);
    }
  }
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_ray_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
