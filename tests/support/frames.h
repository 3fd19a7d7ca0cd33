/// One harness for all that draws what `render_band` draws: an engine, a kind of world and a kind of camera are a row each,
/// and a test says which of them meet.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "gpu/scene_words.h"
#include "support/wide_cases.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tests {

/// A world and what engines draw it by; each is made when it is first asked for.
class Subject {
 public:
  explicit Subject(WideScene scene) : scene_(std::move(scene)) {}

  const WideScene& scene() const { return scene_; }
  const CompactTree& tree() const { return scene_.tree; }
  /// Of no level where the tree has none.
  const BrickMap& map();
  /// Null where it would take long.
  const SharedTree* shared();
  const gpu::SceneWords& words();

 private:
  WideScene scene_;
  std::unique_ptr<OwnedMap> map_;
  std::unique_ptr<HeapBytes> shared_bytes_;
  std::unique_ptr<gpu::SceneWords> words_;
  SharedTree shared_;
};

struct Engine {
  std::string name;
  bool (*takes)(Subject& subject, const FrameCase& frame);
  /// kTooFine leaves the frame to the core, untouched. Hits that are not counted are UINT64_MAX.
  Status (*draw)(const Engine& engine, Subject& subject, const FrameCase& frame, std::mt19937_64& random,
                 const Band& band, RenderCounts* counts);
  bool splits = true;              ///< draws bands of a few rows, too
  Status otherwise = Status::kOk;  ///< the status for what it does not take, where that is always the same
  int number = 0;                  ///< which of several alike
};

/// The core's: both widths, a cut-off that cuts nothing, shared trees, frames by bricks, any-time frames.
std::vector<Engine> core_engines();
/// Those by bricks alone: any camera's, those that are fast, those of 32 bits.
std::vector<Engine> brick_engines();
/// The wide renderer by each instruction set, by any order, list and number of threads.
std::vector<Engine> wide_engines();
/// The GPU's kernels, compiled for the host.
std::vector<Engine> kernel_engines();

struct WorldRow {
  const char* name;
  WideScene (*make)(std::mt19937_64& random);
};
struct CameraRow {
  const char* name;
  /// False where the core refuses what was drawn. Null: any camera, and a band of any rows and stride.
  bool (*set)(std::mt19937_64& random, const WideScene& scene, Camera* camera);
};

namespace worlds {
inline constexpr WorldRow kAny{"any", random_scene};
extern const WorldRow kCabinet, kSolid, kStrewn, kStars, kChip, kDeep;
}  // namespace worlds
namespace cameras {
inline constexpr CameraRow kAny{"any", nullptr};
extern const CameraRow kHard, kChip, kDeep, kLarge, kDiagonal, kFine, kBorder;
}  // namespace cameras

/// What an engine drew so far, and how much of it was not the core's.
struct Tally {
  std::string name;
  std::uint64_t frames = 0;
  std::uint64_t pixels = 0;
  std::uint64_t wrong = 0;
  std::uint64_t first_wrong_seed = 0;
};
class Tallies {
 public:
  void add(const std::string& name, std::uint64_t pixels, bool is_right, std::uint64_t seed);
  std::uint64_t pixels() const;
  std::uint64_t pixels_of(const std::string& name) const;
  std::uint64_t wrong() const;
  const std::vector<Tally>& rows() const { return rows_; }

 private:
  std::vector<Tally> rows_;
};

/// A frame of the camera's kind; false where the core refuses it.
bool make_frame(std::mt19937_64& random, const WideScene& scene, const CameraRow& camera, FrameCase* frame);
/// The frame by every engine that takes it, whole and in bands: bytes, gaps between rows and hits have to be the core's.
/// -> how many pixels it hit.
std::uint64_t draw_by_all(const std::vector<Engine>& engines, Subject& subject, const FrameCase& frame,
                          std::mt19937_64& random, std::uint64_t seed, Tallies* tallies);

struct Trial {
  std::vector<Engine> engines;
  std::vector<WorldRow> worlds;
  std::vector<CameraRow> cameras;
  std::uint64_t seed;    ///< of the first world; THIMBLE_SEED begins elsewhere
  std::uint64_t pixels;  ///< by each engine that draws at all
  std::uint64_t
      few_pixels;  ///< where a run takes few; THIMBLE_LONG takes a hundred times as many as `pixels`
  int views = 6;   ///< of each world
};
/// Draws until every engine had its share; holds that none is wrong, and that much was hit.
Tallies check_frames(const Trial& trial);
/// The same of the golden frames, of which each engine has to take most.
void check_golden_frames(const std::vector<Engine>& engines);

}  // namespace thimble::tests
