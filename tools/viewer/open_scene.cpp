#include "viewer/open_scene.h"

#include <exception>

namespace thimble::tools::viewer {
namespace {

struct Cancelled {};

}  // namespace

SceneReading::SceneReading(const SceneArguments& arguments, int threads)
    : thread_([this, arguments, threads] { run(arguments, threads); }) {}

SceneReading::~SceneReading() {
  cancel();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void SceneReading::run(const SceneArguments& arguments, int threads) {
  const auto progress = [this](double from) {
    return [this, from](double done) {
      progress_.store(from + done / 2);
      if (cancelled_.load()) {
        throw Cancelled();
      }
    };
  };
  try {
    auto scene = std::make_shared<OpenScene>();
    scene->source = tools::open_scene(arguments, progress(0));
    BuildOptions options;
    options.threads = threads;
    options.band_bytes = 1;  // rows are drawn straight into the picture
    scene->built = std::make_unique<BuiltScene>(*scene->source, options, progress(0.5));
    scene_ = std::move(scene);
  } catch (const Cancelled&) {
    // Nobody waits for it.
  } catch (...) {
    error_ = std::current_exception();
  }
  done_.store(true);
}

std::shared_ptr<const OpenScene> SceneReading::take() {
  thread_.join();
  if (error_ != nullptr) {
    std::rethrow_exception(error_);
  }
  return std::move(scene_);
}

}  // namespace thimble::tools::viewer
