// Rays a second on a surface: a mesh as voxels, filling 1920 x 1080, and the rays that go on from what is
// seen.
//
//   thimble_surface_table dragon.ply.gz                  depth 11, some minutes
//   thimble_surface_table dragon.ply.gz --depth 9 --csv F
//
// Three kinds: primary rays in tiles of 4 x 4 pixels; from every second hit a shadow ray to one light; from
// every fourth hit four rays anywhere in the half space above the face (ambient occlusion). Origins are 1/256
// voxel and directions integers, so that all are given the same rays. The core and NanoVDB trace ray by ray,
// Embree in packets of 16; the wide renderer draws primary rays' picture. All by turns on one thread,
// processor time. `wrong`: rays whose answer (what is entered first, or whether anything is) is not the
// core's.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <random>

#include "benchmarks/peers/contest.h"
#include "output/output_file.h"
#include "readers/file_bytes.h"
#include "readers/oct.h"
#include "readers/read_any.h"
#include "scene/built_scene.h"
#include "scene/framing.h"
#include "scene/host_memory.h"
#include "scene/scene_source.h"
#include "scene/wide_renderer.h"
#include "scene/world_fit.h"
#include "wide/rays/ray_map.h"

namespace thimble::benchmarks {
namespace {

constexpr std::int32_t kWidthPx = 1920;
constexpr std::int32_t kHeightPx = 1080;
constexpr int kTurns = 3;

Ray to_core(const FloatRay& from) {
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(from.origin[axis] * 256));
    ray.direction[axis] = static_cast<std::int32_t>(from.direction[axis]);
  }
  return ray;
}

FloatRay to_floats(const Ray& from) {
  FloatRay ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = static_cast<float>(from.origin[axis].raw) / 256;
    ray.direction[axis] = static_cast<float>(from.direction[axis]);
  }
  return ray;
}

// The mesh's triangles where its voxels are.
std::vector<float> corners_of(const std::string& path, int level) {
  const tools::Source source = tools::read_any(path, tools::share(tools::load_file(path)));
  const auto& mesh = std::get<tools::TriangleMesh>(source);
  const auto turned = [](const std::array<double, 3>& p) { return std::array{p[0], -p[2], p[1]}; };
  tools::Bounds bounds;
  for (const auto& position : mesh.positions) {
    bounds.add(turned(position));
  }
  const tools::WorldFit fit(bounds, level);
  std::vector<float> corners;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      for (const std::int32_t unit : fit.units(turned(mesh.positions[vertex]))) {
        corners.push_back(static_cast<float>(unit) / 256);
      }
    }
  }
  return corners;
}

struct Kind {
  std::string name;
  bool any;
  std::vector<FloatRay> rays;
  std::vector<float> expected;  // t of the core's answer; with `any`, 0 or infinity
};

std::vector<Kind> make_rays(const tools::BuiltScene& built, const Camera& camera) {
  std::vector<Kind> kinds(3);
  kinds[0] = {"primary", false, {}, {}};
  kinds[1] = {"shadow", true, {}, {}};
  kinds[2] = {"occlusion", true, {}, {}};
  constexpr float kLight[3] = {-20000, -30000, 40000};
  std::mt19937_64 random(1);
  std::size_t hits = 0;
  for (std::int32_t tile = 0; tile < kWidthPx / 4 * (kHeightPx / 4); ++tile) {
    for (int i = 0; i < 16; ++i) {
      const Ray ray = camera.ray(tile % (kWidthPx / 4) * 4 + i % 4, tile / (kWidthPx / 4) * 4 + i / 4);
      const FloatRay primary = to_floats(ray);
      kinds[0].rays.push_back(primary);
      Hit hit;
      if (built.closest_hit(ray, &hit, {}) != Status::kOk || hit.kind != HitKind::kHit || hit.axis < 0) {
        continue;
      }
      // The hit, on the face and within the voxel.
      const float t = static_cast<float>(hit.t_numerator) / static_cast<float>(hit.t_denominator);
      FloatRay next;
      for (int axis = 0; axis < 3; ++axis) {
        const auto low = static_cast<float>(hit.voxel[axis]);
        const float at = std::floor((primary.origin[axis] + t * primary.direction[axis]) * 256) / 256;
        next.origin[axis] = axis == hit.axis ? low + (ray.direction[axis] < 0 ? 1.0F : 0.0F)
                                             : std::clamp(at, low, low + 255.0F / 256);
      }
      const float outward = ray.direction[hit.axis] < 0 ? 1.0F : -1.0F;
      ++hits;
      if (hits % 2 == 0 && outward * kLight[hit.axis] > 0) {
        std::copy(std::begin(kLight), std::end(kLight), std::begin(next.direction));
        kinds[1].rays.push_back(next);
      }
      for (int more = 0; hits % 4 == 0 && more < 4; ++more) {
        float square = 0;
        do {
          square = 0;
          for (float& component : next.direction) {
            component = static_cast<float>(static_cast<std::int64_t>(random() % 65535) - 32767);
            square += component * component;
          }
        } while (square > 32767.0F * 32767.0F || next.direction[hit.axis] == 0);
        next.direction[hit.axis] = outward * std::abs(next.direction[hit.axis]);
        kinds[2].rays.push_back(next);
      }
    }
  }
  return kinds;
}

void trace_core(const tools::BuiltScene& built, const Kind& kind, std::vector<float>* t) {
  constexpr float kNothing = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < kind.rays.size(); ++i) {
    const Ray ray = to_core(kind.rays[i]);
    if (kind.any) {
      HitKind met = HitKind::kMiss;
      (void)any_hit(built.compact(), ray, &met);
      (*t)[i] = met == HitKind::kHit ? 0 : kNothing;
    } else {
      Hit hit;
      (void)closest_hit(built.compact(), ray, &hit);
      (*t)[i] = hit.kind != HitKind::kHit
                    ? kNothing
                    : static_cast<float>(hit.t_numerator) / static_cast<float>(hit.t_denominator);
    }
  }
}

// The same by the map of masks, in vectors; from and to the core's form, as its caller has them.
struct MapRays {
  std::vector<Ray> rays;
  std::vector<std::uint8_t> any;
  std::vector<Hit> hits;

  explicit MapRays(const Kind& kind)
      : any(kind.any ? kind.rays.size() : 0), hits(kind.any ? 0 : kind.rays.size()) {
    for (const FloatRay& ray : kind.rays) {
      rays.push_back(to_core(ray));
    }
  }
  void trace(const wide::RayMap& map) {
    const Span<const Ray> all{rays.data(), rays.size()};
    if (hits.empty()) {
      (void)wide::any_hit(map, all, {any.data(), any.size()});
    } else {
      (void)wide::first_hit(map, all, {hits.data(), hits.size()});
    }
  }
  void copy_to(std::vector<float>* t) const {
    constexpr float kNothing = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (hits.empty()) {
        (*t)[i] = any[i] != 0 ? 0 : kNothing;
      } else {
        (*t)[i] = hits[i].kind != HitKind::kHit
                      ? kNothing
                      : static_cast<float>(hits[i].t_numerator) / static_cast<float>(hits[i].t_denominator);
      }
    }
  }
};

// Draws the picture of the primary rays, which must have so many hits.
void draw_wide(tools::WideRenderer* renderer, const VoxelBox& bounds, const Camera& camera, std::size_t hits,
               std::vector<std::uint8_t>* pixels) {
  RenderCounts counts;
  wide::Counts work;
  if (renderer->render(camera, tools::timed_shading(camera, bounds), gray_band(pixels, kHeightPx), &counts,
                       &work) != Status::kOk ||
      counts.hits != hits) {
    throw std::runtime_error("the wide renderer's picture is another");
  }
}

// Rays whose `t` is not what the core found.
std::size_t count_wrong(const Kind& kind, const std::vector<float>& t) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const float ours = kind.expected[i];
    const bool same = (t[i] < 1e30F) == (ours < 1e30F) &&
                      (kind.any || !(ours < 1e30F) || std::abs(t[i] - ours) <= 1e-4F * ours);
    wrong += same ? 0U : 1U;
  }
  return wrong;
}

int run(int count, char** words) {
  std::string path;
  std::string csv_path;
  int depth = 11;
  CLI::App app("Rays a second on a mesh's voxels");
  app.add_option("MESH", path, "a mesh with y up: .ply, .obj, .off, .gz of these")->required();
  app.add_option("--depth", depth, "of the world")->check(CLI::Range(6, 11));
  app.add_option("--csv", csv_path, "the table as CSV");
  CLI11_PARSE(app, count, words);

  tools::SceneArguments arguments;
  arguments.scene = path;
  arguments.depth = depth;
  const auto source = tools::open_scene(arguments);
  tools::BuiltScene built(*source, {});
  const auto renderer = tools::WideRenderer::make(&built, kWidthPx, kHeightPx, 1);
  if (renderer == nullptr) {
    throw std::runtime_error("no room for the wide renderer");
  }
  const tools::HostMemory map_memory(wide::RayMap::bytes(built.compact()));
  Arena map_arena(map_memory.bytes());
  wide::RayMap map;
  if (wide::RayMap::make(built.compact(), &map_arena, &map) != Status::kOk) {
    throw std::runtime_error("no room for the map of masks");
  }
  const std::vector<Voxel> voxels = voxels_of(built);
  // As the gallery's picture sees it, closer.
  const double unit = (1 << depth) / 1024.0;
  tools::ViewWishes view;
  view.width_px = kWidthPx;
  view.height_px = kHeightPx;
  view.eye = tools::Real3{300 * unit, -500 * unit, 560 * unit};
  view.target = tools::Real3{512 * unit, 512 * unit, 470 * unit};
  view.fov_degrees = 44;
  const Camera camera = tools::frame_box(view, built.level(), {}).camera;

  std::vector<std::unique_ptr<Peer>> peers;
  peers.push_back(make_embree(voxels));
  peers.push_back(make_embree_triangles(corners_of(path, depth)));
  peers.push_back(make_nanovdb(voxels));
  std::erase(peers, nullptr);
  std::printf("%zu voxels of %d a side\n%-10s %-24s %10s %10s %9s %10s\n", voxels.size(), 1 << depth, "rays",
              "engine", "number", "hits", "Mrays/s", "wrong");
  std::string csv = "kind,engine,rays,hits,mega_rays_a_second,wrong\n";

  for (Kind& kind : make_rays(built, camera)) {
    std::vector<float> t(kind.rays.size());
    kind.expected.resize(kind.rays.size());
    trace_core(built, kind, &kind.expected);
    const std::size_t engines = 3 + peers.size();
    MapRays ours(kind);
    std::vector<double> best(engines, 1e30);
    std::vector<std::size_t> wrong(engines, 0);
    std::size_t hits = 0;
    for (const float entered : kind.expected) {
      hits += entered < 1e30F ? 1U : 0U;
    }
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(kWidthPx) * kHeightPx);
    for (int turn = 0; turn < kTurns; ++turn) {
      for (std::size_t engine = 0; engine < engines; ++engine) {
        if (engine == 0 && kind.any) {
          continue;  // it draws pictures only
        }
        const double seconds = seconds_of([&] {
          if (engine == 0) {
            draw_wide(renderer.get(), built.bounds(), camera, hits, &pixels);
          } else if (engine == 1) {
            trace_core(built, kind, &t);
          } else if (engine == 2) {
            ours.trace(map);
          } else {
            peers[engine - 3]->trace(kind.rays, kind.any, t.data());
          }
        });
        best[engine] = std::min(best[engine], seconds);
        if (engine == 2) {
          ours.copy_to(&t);
        }
        if (engine >= 2 && turn == 0) {
          wrong[engine] = count_wrong(kind, t);
        }
      }
    }
    for (std::size_t engine = 0; engine < engines; ++engine) {
      if (best[engine] > 1e29) {
        continue;
      }
      const std::string name = engine == 0   ? "Thimble, wide"
                               : engine == 1 ? "Thimble, ray by ray"
                               : engine == 2 ? "Thimble, rays in vectors"
                                             : peers[engine - 3]->name();
      const double rate = static_cast<double>(kind.rays.size()) / best[engine] / 1e6;
      std::printf("%-10s %-24s %10zu %10zu %9.3f %10zu\n", kind.name.c_str(), name.c_str(), kind.rays.size(),
                  hits, rate, wrong[engine]);
      std::fflush(stdout);
      csv += kind.name + ",\"" + name + "\"," + std::to_string(kind.rays.size()) + "," +
             std::to_string(hits) + "," + std::to_string(rate) + "," + std::to_string(wrong[engine]) + "\n";
    }
  }
  write_text(csv_path, csv);
  return 0;
}

}  // namespace
}  // namespace thimble::benchmarks

int main(int count, char** words) {
  return thimble::benchmarks::run_program("thimble_surface_table",
                                          [&] { return thimble::benchmarks::run(count, words); });
}
