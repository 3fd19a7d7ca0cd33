/// @file open_scene.h
/// A scene as the viewer has it, and the thread that reads one while the screen goes on.
#ifndef THIMBLE_TOOLS_VIEWER_OPEN_SCENE_H
#define THIMBLE_TOOLS_VIEWER_OPEN_SCENE_H

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "scene/built_scene.h"
#include "scene/scene_arguments.h"
#include "scene/scene_source.h"

namespace thimble::tools::viewer {

/// A source and the compact tree of it. Read by any number of threads.
struct OpenScene {
  std::unique_ptr<SceneSource> source;
  std::unique_ptr<BuiltScene> built;

  int level() const { return built->level(); }
  const CompactTree& tree() const { return built->compact(); }
  double side() const { return static_cast<double>(1U << static_cast<unsigned>(level())); }
};

/// Reads and builds on a thread of its own.
class SceneReading {
 public:
  SceneReading(const SceneArguments& arguments, int threads);
  /// Cancels, and waits until the thread has noticed.
  ~SceneReading();
  SceneReading(const SceneReading&) = delete;
  SceneReading& operator=(const SceneReading&) = delete;

  bool is_done() const { return done_.load(); }
  /// 0 .. 1 of reading and building.
  double progress() const { return progress_.load(); }
  /// Makes it end soon, with nothing.
  void cancel() { cancelled_.store(true); }
  /// Once it is done: the scene; throws what reading or building threw.
  std::shared_ptr<const OpenScene> take();

 private:
  void run(const SceneArguments& arguments, int threads);

  std::atomic<bool> cancelled_{false};
  std::atomic<bool> done_{false};
  std::atomic<double> progress_{0};
  std::shared_ptr<const OpenScene> scene_;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace thimble::tools::viewer

#endif
