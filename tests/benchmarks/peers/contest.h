/// One scene drawn by this renderer and by all peers, frame by frame by turns, so that the load of the
/// machine falls on all of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/measure.h"
#include "benchmarks/peers/peer.h"
#include "instruments/timed_frames.h"
#include "scene/built_scene.h"
#include "scene/wide_renderer.h"

namespace thimble::benchmarks {

/// What one of them did. Times are as instruments/timed_frames.h says.
struct Entrant {
  std::string name;
  double ms = 0;       ///< a frame with cold caches: 64 MiB were written just before
  double warm_ms = 0;  ///< a frame that comes after its own; 0 where that was not measured: beyond 20 ms
  double build_seconds = 0;
  std::uint64_t bytes = 0;         ///< of what it keeps between frames
  std::uint64_t differing_px = 0;  ///< pixels that show another voxel than the core's ray, in one frame
  /// A peer counts when fewer than one pixel in a thousand differs.
  bool counts(std::uint64_t pixels) const { return differing_px * 1000 < pixels; }
};

struct Result {
  std::string scene;
  std::uint64_t points = 0;
  std::uint64_t voxels = 0;
  bool orthographic = false;
  std::uint64_t hits = 0;
  std::vector<Entrant> entrants;      ///< this renderer first, then the core ray by ray, then the peers
  std::vector<std::string> left_out;  ///< peers that do not fit

  const Entrant* find(const std::string& name) const;
  /// The fastest of the peers that count, the core's own rays among them; null when there is none.
  const Entrant* best_peer() const;
};

class Contest {
 public:
  static constexpr std::int32_t kWidthPx = tools::kTimedWidthPx;
  static constexpr std::int32_t kHeightPx = tools::kTimedHeightPx;
  static constexpr std::uint64_t kPixels = std::uint64_t{kWidthPx} * kHeightPx;

  /// `kind` is points or cluster, in a world of 2^depth a side. Peers are left out where their structures and the
  /// voxels that they are made from would take more than `most_bytes`.
  Contest(const std::string& kind, std::uint64_t points, int depth, std::uint64_t most_bytes);

  /// `frames` frames each that count, by turns.
  Result run(bool orthographic, int frames);

 private:
  double draw_wide(const Camera& camera, std::uint64_t* hits);
  double draw_core(const Camera& camera);

  std::string kind_;
  std::uint64_t points_;
  std::unique_ptr<tools::BuiltScene> built_;
  std::unique_ptr<tools::WideRenderer> renderer_;
  std::vector<Voxel> voxels_;  // in the tree's order; empty where no peer fits
  std::vector<std::string> left_out_;
  struct Rival {
    std::unique_ptr<Peer> peer;
    double build_seconds = 0;
  };
  std::vector<Rival> rivals_;
  std::vector<std::uint8_t> pixels_;
};

/// A scene of the command's, and of a file its depth behind an @.
std::unique_ptr<tools::SceneSource> open_at(const std::string& scene_at_depth);
/// Without its folder.
inline std::string short_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}
/// Every voxel of the tree, in its order.
std::vector<Voxel> voxels_of(const tools::BuiltScene& built);
/// All of a picture in greys.
Band gray_band(std::vector<std::uint8_t>* pixels, std::int32_t rows);
inline const char* projection(bool orthographic) {
  return orthographic ? "orthographic" : "perspective";
}
/// The whole file or, after an error, none; nothing where `path` is empty.
void write_text(const std::string& path, const std::string& text);

/// The machine in words: processor, caches, memory, system, compiler, instruction set in use.
std::vector<std::pair<std::string, std::string>> machine();

}  // namespace thimble::benchmarks
