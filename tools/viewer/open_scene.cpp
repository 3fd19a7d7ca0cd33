#include "viewer/open_scene.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <utility>

#include "scene/framing.h"

namespace thimble::tools::viewer {
namespace {

struct Cancelled {};

const char* kind_name(SurfaceKind kind) {
  constexpr std::array kNames{"", " metal", " glass", " that glows",
                              " cloud"};  // in the order of `SurfaceKind`
  return kNames[static_cast<std::size_t>(kind)];
}

const char* face_name(const Face& face) {
  constexpr std::array kNegative{"left face (-x)", "front face (-y)", "bottom face (-z)"};
  constexpr std::array kPositive{"right face (+x)", "back face (+y)", "top face (+z)"};
  return (face.negative ? kNegative : kPositive)[static_cast<std::size_t>(face.axis)];
}

}  // namespace

std::optional<Picked> pick(const OpenScene& scene, const Camera& camera, std::int32_t x_px,
                           std::int32_t y_px) {
  if (x_px < 0 || y_px < 0 || x_px >= camera.width_px() || y_px >= camera.height_px()) {
    return std::nullopt;
  }
  const Ray ray = camera.ray(x_px, y_px);
  Picked picked;
  if (closest_hit(scene.tree(), ray, &picked.hit) != Status::kOk || picked.hit.kind != HitKind::kHit) {
    return std::nullopt;
  }
  const double t = static_cast<double>(picked.hit.t_numerator) / picked.hit.t_denominator;
  picked.point = plus(real_of(ray.origin), scaled(real_of(ray.direction), t));
  return picked;
}

std::string picked_text(const OpenScene& scene, const Camera& camera, const Picked& picked, std::int32_t x_px,
                        std::int32_t y_px) {
  const Hit& hit = picked.hit;
  std::string text = "voxel " + std::to_string(hit.voxel.x) + "," + std::to_string(hit.voxel.y) + "," +
                     std::to_string(hit.voxel.z);
  text += hit.axis < 0 ? ": the eye is in it"
                       : std::string(": its ") + face_name(face_of(hit, camera.ray(x_px, y_px).direction));
  const Material& material = scene.source->palette()[hit.material];
  std::array<char, 16> color{};
  std::snprintf(color.data(), color.size(), "#%02x%02x%02x", material.color.r, material.color.g,
                material.color.b);
  return text + ", material " + std::to_string(hit.material) + ", " + color.data() + kind_name(material.kind);
}

SceneReading::SceneReading(const SceneArguments& arguments, int threads,
                           std::shared_ptr<const OpenScene> before)
    : thread_([this, arguments, threads, before = std::move(before)] {
        run(arguments, threads, before.get());
      }) {}

SceneReading::~SceneReading() {
  cancel();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void SceneReading::run(const SceneArguments& arguments, int threads, const OpenScene* before) {
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
    scene->shape = before != nullptr && before->shape.owner != nullptr
                       ? before->shape
                       : shape_of(*scene->source, *scene->built);
    scene_ = std::move(scene);
  } catch (const Cancelled&) {
    // Nobody waits for it.
  } catch (...) {
    error_ = std::current_exception();
  }
  ended_.store(true);
}

std::shared_ptr<const OpenScene> SceneReading::take() {
  thread_.join();
  if (error_ != nullptr) {
    std::rethrow_exception(error_);
  }
  return std::move(scene_);
}

FileWatch::FileWatch(std::string path) {
  watch({std::move(path)});
}

FileWatch::Mark FileWatch::look(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    return {};
  }
  return {std::uint64_t{status.st_ino}, static_cast<std::uint64_t>(status.st_size),
          static_cast<std::uint64_t>(status.st_mtim.tv_sec),
          static_cast<std::uint64_t>(status.st_mtim.tv_nsec)};
}

void FileWatch::watch(const std::vector<std::string>& paths) {
  std::vector<Watched> files;
  for (const std::string& path : paths) {
    const auto known =
        std::find_if(files_.begin(), files_.end(), [&](const Watched& each) { return each.path == path; });
    const Mark now = known == files_.end() ? look(path) : Mark{};
    files.push_back(known == files_.end() ? Watched{path, now, now} : *known);
  }
  files_ = std::move(files);
}

bool FileWatch::has_changed(double seconds) {
  if (looked_at_ >= 0 && seconds < looked_at_ + kLookSeconds) {
    return false;
  }
  looked_at_ = seconds;
  bool rest = true;
  bool changed = false;
  for (Watched& file : files_) {
    const Mark now = look(file.path);
    // One that is gone may come back: editors write a new file beside the old one.
    rest = rest && now == file.last && (now != Mark{} || file.known == Mark{});
    changed = changed || now != file.known;
    file.last = now;
  }
  if (!rest || !changed) {
    return false;
  }
  for (Watched& file : files_) {
    file.known = file.last;
  }
  return true;
}

}  // namespace thimble::tools::viewer
