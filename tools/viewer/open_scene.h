/// A scene as the viewer has it, what is under the pointer, and the thread that reads one while the screen stays alive.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "readers/real3.h"
#include "scene/built_scene.h"
#include "scene/scene_arguments.h"
#include "scene/scene_shape.h"
#include "scene/scene_source.h"

namespace thimble::tools::viewer {

/// A source and the compact tree of it. Read by any number of threads.
struct OpenScene {
  std::unique_ptr<SceneSource> source;
  std::unique_ptr<BuiltScene> built;
  SceneShape shape;  ///< of an animation that of all its frames

  int level() const { return built->level(); }
  const CompactTree& tree() const { return built->compact(); }
  double side() const { return static_cast<double>(1U << static_cast<unsigned>(level())); }
};

/// What is under the pointer.
struct Picked {
  Hit hit;
  Real3 point;  ///< where the ray meets it, in voxels
};

/// What the ray of a pixel hits; nothing for none, and for pixels beyond the picture.
std::optional<Picked> pick(const OpenScene& scene, const Camera& camera, std::int32_t x_px,
                           std::int32_t y_px);

/// "voxel 12,3,40: its top face (+z), material 7, #a0522d glass".
std::string picked_text(const OpenScene& scene, const Camera& camera, const Picked& picked, std::int32_t x_px,
                        std::int32_t y_px);

/// Work on a thread of its own.
class BackgroundTask {
 public:
  virtual ~BackgroundTask() = default;

  /// Makes it end soon, with nothing; takes no time.
  void cancel() { cancelled_.store(true); }
  /// Whether it is done, cancelled or failed.
  bool has_ended() const { return ended_.load(); }

 protected:
  std::atomic<bool> cancelled_{false};
  std::atomic<bool> ended_{false};
};

/// Reads and builds a scene.
class SceneReading final : public BackgroundTask {
 public:
  /// `before`: another frame of the same animation; null for any other scene.
  SceneReading(const SceneArguments& arguments, int threads,
               std::shared_ptr<const OpenScene> before = nullptr);
  /// Cancels, and waits until the thread has noticed.
  ~SceneReading() override;

  /// 0 .. 1 of reading and building.
  double progress() const { return progress_.load(); }
  /// Once it has ended: the scene; throws what reading or building threw.
  std::shared_ptr<const OpenScene> take();

 private:
  void run(const SceneArguments& arguments, int threads, const OpenScene* before);

  std::atomic<double> progress_{0};
  std::shared_ptr<const OpenScene> scene_;
  std::exception_ptr error_;
  std::thread thread_;
};

// Notices that one of a few files has changed, by looking at them now and then.

class FileWatch {
 public:
  /// Between two looks, in seconds.
  static constexpr double kLookSeconds = 0.25;

  /// What is there now counts as known. A path that names no file, such as a generator, never changes.
  explicit FileWatch(std::string path);

  /// Watches these from now on. What is there now counts as known, but for those that were watched before.
  void watch(const std::vector<std::string>& paths);
  /// Whether a file is another than the one known, and all were the same at the last two looks, so that whoever
  /// writes them has paused; they are then known. `seconds`: of any steady clock.
  bool has_changed(double seconds);

 private:
  using Mark = std::array<std::uint64_t, 4>;  // inode, bytes, seconds and nanoseconds; of no file all 0
  struct Watched {
    std::string path;
    Mark known{};
    Mark last{};
  };
  static Mark look(const std::string& path);

  std::vector<Watched> files_;
  double looked_at_ = -1;
};

}  // namespace thimble::tools::viewer
