#include "commands/limited_picture.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <new>

#include "commands/render_command.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kMostErrorBytes = 400;
constexpr int kWaitSeconds = 19;  // for a disk, and for processors that others use

// Numbers of the signals that clean_up_on_signals() catches: this process has nothing to clean up.
void die_by_signals() {
  for (const int number : {SIGHUP, SIGINT, SIGQUIT, SIGABRT, SIGBUS, SIGALRM, SIGTERM, SIGXCPU}) {
    std::signal(number, SIG_DFL);
  }
}

void limit_this_process(const PictureLimits& limits) {
  const auto most = [](auto what, std::uint64_t amount) {
    const rlimit both{amount, amount};
    ::setrlimit(what, &both);
  };
#ifndef __SANITIZE_ADDRESS__  // its shadow memory takes terabytes of addresses
  most(RLIMIT_AS, limits.memory_bytes);
#endif
  most(RLIMIT_CPU, static_cast<std::uint64_t>(limits.seconds));
  most(RLIMIT_CORE, 0);
  most(RLIMIT_FSIZE, 0);
  ::alarm(static_cast<unsigned>(limits.seconds + kWaitSeconds));
}

}  // namespace

struct LimitedPicture::Shared {
  bool is_done;
  std::uint64_t voxels;
  std::size_t scene_bytes;
  std::array<char, kMostErrorBytes> error;

  std::uint8_t* pixels() { return reinterpret_cast<std::uint8_t*>(this + 1); }
  void fail(std::string_view sentence) {
    if (!is_done) {
      sentence.copy(error.data(), error.size() - 1);
      is_done = true;
    }
  }
  void draw(const std::string& path, std::int32_t side_px, const PictureLimits& limits) {
    try {
      RenderCommand command;
      command.scene.arguments.scene = path;
      command.scene.quiet = true;
      // What is too fine for a small picture is merged. The rest is the program's, the file's and the picture's.
      command.scene.memory_bytes = limits.memory_bytes / 3;
      command.scene.coarsen = true;
      command.view.side = NamedView::kBest;
      command.view.fov_degrees = kPictureFov;
      command.view.width_px = command.view.height_px = side_px;
      if (limits.coarse) {
        int& depth = command.scene.arguments.mesh_depth;
        depth = std::min(depth, static_cast<int>(std::bit_width(static_cast<unsigned>(side_px - 1))));
      }
      const auto source = command.scene.open();
      const LookPicture look = draw_look(command, *source);
      voxels = look.stats.voxels;
      std::uint8_t* const behind = std::copy(look.image.pixels.begin(), look.image.pixels.end(), pixels());
      is_done = true;  // also where the scene takes too much
      if (limits.scene_bytes != 0) {
        const std::vector<std::uint8_t> scene = page_scene(command, *source, look.camera, limits.scene_bytes);
        if (scene.size() <= limits.scene_bytes) {
          std::copy(scene.begin(), scene.end(), behind);
          scene_bytes = scene.size();
        }
      }
    } catch (const std::bad_alloc&) {
      fail("takes more memory than a small picture may");
    } catch (const std::exception& wrong) {
      fail(wrong.what());
    }
  }
};

LimitedPicture::LimitedPicture(const std::string& path, std::int32_t side_px, const PictureLimits& limits)
    : side_px_(side_px),
      limits_(limits),
      picture_bytes_(3 * static_cast<std::size_t>(side_px) * static_cast<std::size_t>(side_px)),
      bytes_(sizeof(Shared) + picture_bytes_ + limits.scene_bytes) {
  void* const memory = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  const int parent = ::getpid();
  process_ = memory == MAP_FAILED ? -1 : ::fork();
  if (process_ < 0) {
    const std::string why = std::strerror(errno);
    if (memory != MAP_FAILED) {
      ::munmap(memory, bytes_);
    }
    throw OutputError("no process can be started to draw " + path + ": " + why);
  }
  shared_ = static_cast<Shared*>(memory);  // zeros, which are an empty one
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    die_by_signals();
    limit_this_process(limits);
    if (::getppid() == parent) {
      shared_->draw(path, side_px, limits);
    }
    ::_exit(0);
  }
}

LimitedPicture::~LimitedPicture() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  ::munmap(shared_, bytes_);
}

bool LimitedPicture::take(SmallPicture* picture, bool waits) {
  int status = 0;
  if (process_ <= 0 || ::waitpid(process_, &status, waits ? 0 : WNOHANG) != process_) {
    return false;
  }
  process_ = -1;
  if (!shared_->is_done) {
    const int number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    const bool took_long = number == SIGXCPU || number == SIGKILL || number == SIGALRM;
    shared_->fail(took_long ? concat("takes longer than the ", limits_.seconds, " s that a small picture may")
                            : "ended the process that read it");
  }
  picture->error = shared_->error.data();
  picture->voxels = shared_->voxels;
  if (picture->error.empty()) {
    const std::uint8_t* const first = shared_->pixels();
    const std::uint8_t* const behind = first + picture_bytes_;
    picture->image = {side_px_, side_px_, PixelFormat::kRgb888, {first, behind}};
    picture->scene.assign(behind, behind + shared_->scene_bytes);
  }
  return true;
}

}  // namespace thimble::tools
