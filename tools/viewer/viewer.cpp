#include "viewer/viewer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "host/canvas.h"
#include "output/output_file.h"
#include "output/units.h"
#include "scene/host_memory.h"
#include "scene/moving_pool.h"
#include "viewer/camera_state.h"
#include "viewer/fast_frames.h"
#include "viewer/open_scene.h"
#include "viewer/saving.h"

namespace thimble::tools::viewer {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kRestSeconds = 0.12;   // after the last motion, before the picture refines
constexpr double kWindowSeconds = 0.3;  // that a scene may take to be read before there is a window
constexpr double kBlurSeconds = 0.2;    // coarse pictures that are replaced sooner are not shown
constexpr double kMessageSeconds = 8;
constexpr double kFastestFrameSeconds = 1.0 / 62;
constexpr double kGoodbyeSeconds = 0.04;  // that threads get to notice that it is over
constexpr double kFilmSeconds = 0.1;      // a frame of an animation
constexpr double kWaterSeconds = 1.0 / 30;
constexpr int kIdleMs = 50;
constexpr int kBusyMs = 8;

double now() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

void sleep_ms(int time) {
  std::this_thread::sleep_for(std::chrono::milliseconds(time));
}

// A picture that is to be saved once it is finished.
struct Saving {
  std::unique_ptr<Refinement> refinement;
  SceneArguments scene;
};

class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options)
      : options_(options), camera_(options.view), watch_(options.scene.scene) {}

  void run() {
    open();
    while (!ended_) {
      take_events();
      if (ended_) {
        break;
      }
      look_for_scene();
      if (scene_ == nullptr) {
        show();
        continue;
      }
      play();
      look_around();
      refine();
      finish_savings();
      std::erase_if(leaving_, [](const auto& each) { return each->has_ended(); });
      if (!message_.empty() && now() >= message_until_) {
        needs_showing_ = true;
      }
      if (needs_showing_) {
        show();
      }
    }
    end();
  }

 private:
  void open() {
    const double start = now();
    read(options_.scene);
    while (!reading_->has_ended() && now() < start + kWindowSeconds) {
      sleep_ms(2);
    }
    look_for_scene();  // what cannot be read at all needs no window
    host::ScreenOptions screen;
    screen.title = "thimble: " + name();
    screen.width_px = options_.view.width_px;
    screen.height_px = options_.view.height_px;
    screen.scale = 1;
    try {
      screen_ = host::open_screen(options_.display, screen);
    } catch (const host::ScreenError& error) {
      throw OutputError(error.what());
    }
    if (screen_->width_px() <= 0) {
      const std::string why = screen_->fault();
      throw OutputError("there is neither a display nor a terminal to look around in" +
                        (why.empty() ? "" : " (" + why + ")") + "; thimble render " +
                        quoted_for_shell(options_.scene.scene) + " -o picture.png draws a picture");
    }
    is_terminal_ = std::string(screen_->name()) == "terminal";
    controls_.emplace(!is_terminal_);
  }

  void adopt(std::shared_ptr<const OpenScene> scene, const ViewWishes& view) {
    // All that may throw comes first.
    auto look = std::make_shared<const FinishedLook>(scene, options_.look);
    const FinishedPicture trial(look, view);
    auto frames = std::make_unique<FastFrames>(scene, trial.is_plain(), options_.threads);
    stop_refining();
    if (frames_ != nullptr) {
      frames->keep_pace(*frames_);
    }
    pool_.reset();
    leave(&next_frame_);
    scene_ = std::move(scene);
    look_ = std::move(look);
    frames_ = std::move(frames);
    camera_.change_scene(*scene_);
    changed_ = true;
  }

  // The scene that was read, if one was. Before there is a screen, what is wrong with it is the command's error.
  void look_for_scene() {
    if (reading_ != nullptr && reading_->has_ended()) {
      const bool is_first = scene_ == nullptr;
      const bool is_other = wanted_.scene != options_.scene.scene;
      const std::string name = printable(wanted_.scene);
      try {
        std::shared_ptr<const OpenScene> scene = reading_->take();
        const ViewWishes view = is_other ? unplaced(options_.view) : options_.view;
        adopt(std::move(scene), view);
        options_.view = view;
        options_.scene = wanted_;
        if (is_other) {
          camera_ = CameraState(view);
          screen_->set_title("thimble: " + name);
        }
        watch_.watch(scene_->source->files());
        if (is_first || is_other) {
          plays_ = scene_->source->frames() > 1 && !options_.scene.frame;
        }
        if (!is_first) {
          tell(name + (is_other ? "" : " has changed and was read again"));
        }
      } catch (const std::exception& error) {
        if (is_first) {
          throw;
        }
        const std::string sentence = name + (is_other ? "" : " has changed and") +
                                     " cannot be read: " + error.what() + "; the old picture stays";
        tell(sentence);
        if (!is_terminal_) {
          std::fprintf(stderr, "thimble: %s\n", printable(sentence).c_str());
        }
      }
      reading_.reset();
    }
    if (screen_ != nullptr && reading_ == nullptr && watch_.has_changed(now())) {
      read(options_.scene);
    }
  }

  // Whatever was being read is no longer wanted.
  void read(const SceneArguments& scene) {
    leave(&reading_);
    wanted_ = scene;
    reading_ = std::make_unique<SceneReading>(scene, options_.threads);
  }

  void play_or_stop() {
    const bool has_frames = scene_->source->frames() > 1;
    const WaterSurface* const water = picture_->water();
    if (!has_frames && water == nullptr) {
      tell("nothing here plays: it has neither frames nor water");
      return;
    }
    plays_ = !plays_;
    next_frame_at_ = now();
    if (!has_frames) {
      // What is drawn to the end, and saved, is the scene's own water.
      pool_.reset();
      if (plays_) {
        pool_memory_ = HostMemory(MovingPool::bytes(*water));
        pool_ = std::make_unique<MovingPool>(scene_->tree(), *water, pool_memory_.bytes());
      }
    }
    changed_ = true;
  }

  // The next frame of an animation is read while the one before is shown.
  void play() {
    if (!plays_ || picture_ == nullptr || reading_ != nullptr) {
      return;
    }
    const double time = now();
    if (pool_ != nullptr) {
      if (time >= next_frame_at_) {
        next_frame_at_ = std::max(next_frame_at_ + kWaterSeconds, time);
        pool_->step();
        changed_ = true;
      }
      return;
    }
    const auto read_next = [this] {
      SceneArguments next = options_.scene;
      next.frame = (next.frame.value_or(0) + 1) % scene_->source->frames();
      next_frame_ = std::make_unique<SceneReading>(next, options_.threads, scene_);
    };
    if (next_frame_ == nullptr) {
      read_next();
      return;
    }
    if (!next_frame_->has_ended() || time < next_frame_at_) {
      return;
    }
    next_frame_at_ = std::max(next_frame_at_ + kFilmSeconds, time);
    try {
      std::shared_ptr<const OpenScene> scene = next_frame_->take();
      next_frame_.reset();
      camera_.hold(picture_->framing(), *scene_);
      const std::shared_ptr<const FinishedLook> before = look_;
      adopt(std::move(scene), options_.view);
      look_->keep_exposure(*before);
      options_.scene.frame = (options_.scene.frame.value_or(0) + 1) % scene_->source->frames();
      read_next();
    } catch (const std::exception& error) {
      next_frame_.reset();
      plays_ = false;
      tell(name() + " stops: " + error.what());
    }
  }

  void take_events() {
    int timeout = wait_ms();
    while (!ended_) {
      const auto event = screen_->next_event(timeout);
      if (!event) {
        return;
      }
      timeout = 0;
      if (event->kind == host::EventKind::kDrop) {
        SceneArguments dropped;  // seen from its best side, its frames from the first
        dropped.scene = event->path;
        read(dropped);
        tell("reading " + printable(dropped.scene));
        continue;
      }
      if (event->kind == host::EventKind::kResize) {
        changed_ = true;
      }
      act(controls_->take(*event, now(), screen_->height_px()));
    }
  }

  void act(Action action) {
    const auto pointer = [this] {
      return controls_->has_pointer() ? std::array{controls_->pointer_x_px(), controls_->pointer_y_px()}
                                      : std::array{picture_->width_px() / 2, picture_->height_px() / 2};
    };
    if (action == Action::kNone) {
      return;
    }
    if (action == Action::kEnd) {
      ended_ = true;
      return;
    }
    if (action == Action::kHelp) {
      shows_keys_ = !shows_keys_;
      needs_showing_ = true;
      return;
    }
    if (picture_ == nullptr) {
      return;
    }
    switch (action) {
      case Action::kSave:
        save();
        return;
      case Action::kPlay:
        play_or_stop();
        return;
      case Action::kPick:
      case Action::kLookThere: {
        const auto [x, y] = pointer();
        const auto picked = pick(*scene_, picture_->camera(), x, y);
        if (!picked) {
          tell("there is nothing under the pointer");
        } else if (action == Action::kPick) {
          const std::string text = picked_text(*scene_, picture_->camera(), *picked, x, y);
          tell(text);
          print(text);
        } else {
          camera_.look_at(picked->point, picture_->framing(), *scene_);
          changed_ = true;
        }
        return;
      }
      default:
        camera_.choose(action, picture_->framing(), *scene_);
        changed_ = true;
    }
  }

  void look_around() {
    const Motion motion = controls_->take_motion(now());
    if (picture_ != nullptr && motion.any()) {
      camera_.apply(motion, picture_->framing(), *scene_);
      changed_ = true;
    }
    if (changed_) {
      draw_frame(motion.any());
    }
  }

  // Of a picture that measures its exposure, as `thimble render` does: the one that is shown may have that of a frame before.
  void begin_refinement() {
    refinement_ = std::make_unique<Refinement>(std::make_shared<FinishedPicture>(look_, picture_->wishes()),
                                               options_.threads);
    refining_since_ = now();
  }

  void refine() {
    if (picture_ == nullptr || is_refined_) {
      return;
    }
    if (refinement_ == nullptr) {
      if (!plays_ && now() >= changed_at_ + kRestSeconds) {
        begin_refinement();
      }
      return;
    }
    std::vector<std::uint8_t> rgb;
    if (refinement_->take(&rgb)) {
      const bool is_blurred = refinement_->step() > std::max(2, frames_->step());
      if (!is_blurred || now() > refining_since_ + kBlurSeconds) {
        rgb_ = std::move(rgb);
        needs_showing_ = true;
      }
    }
    if (!refinement_->has_ended()) {
      return;
    }
    if (refinement_->is_finished()) {
      is_refined_ = true;
      needs_showing_ = true;
      if (saves_this_) {
        write(refinement_->picture(), options_.scene, rgb_);
        saves_this_ = false;
      }
    } else if (const std::string fault = refinement_->fault(); !fault.empty()) {
      is_refined_ = true;
      saves_this_ = false;
      tell(fault);
    }
  }

  void draw_frame(bool moves) {
    changed_ = false;
    const std::int32_t most = kMaxPicturePx / look_->across();
    const std::int32_t width = std::clamp(screen_->width_px(), 1, most);
    const std::int32_t height = std::clamp(screen_->height_px(), 1, most);
    const double began = now();
    std::shared_ptr<FinishedPicture> picture;
    const ViewWishes wishes = camera_.wishes(width, height);
    try {
      picture = std::make_shared<FinishedPicture>(look_, wishes);
    } catch (const InputError& error) {
      tell(error.what());  // a camera that cannot be: the picture before it stays
      camera_fault_ = message_;
      return;
    }
    if (!camera_fault_.empty() && message_ == camera_fault_) {
      message_.clear();
      message_until_ = 0;
    }
    camera_fault_.clear();
    stop_refining();
    if (pool_ != nullptr) {
      picture->show_water(pool_->surface());
    }
    if (!draw_lit(picture.get(), moves)) {
      frames_->draw(*picture, &rgb_);
    }
    picture_ = std::move(picture);
    changed_at_ = now();
    show();
    const double took = now() - began;  // with the screen's part
    frame_seconds_ = frame_seconds_ == 0 ? took : 0.8 * frame_seconds_ + 0.2 * took;
    frame_began_ = began;
  }

  // With its light: what a GPU draws, and the frame of an animation that plays, where that is there before the next one.
  bool draw_lit(FinishedPicture* picture, bool moves) {
    const bool is_film = plays_ && scene_->source->frames() > 1;
    const double left = is_film ? next_frame_at_ - now() : FastFrames::kFrameSeconds;
    if (left <= 0 || ((moves || !is_film) && look_->gpu().empty())) {
      return false;
    }
    picture->keep_exposure();
    return frames_->draw_lit(*picture, &rgb_, left, now);
  }

  void show() {
    needs_showing_ = false;
    std::string overlay = state_text();
    if (shows_keys_) {
      overlay += "\n\n" + keys_text();
    }
    if (now() < message_until_) {
      overlay += "\n" + message_;
    } else {
      message_.clear();
    }
    // Text in a window is up to twelve pixels wide a letter.
    const std::int32_t columns = is_terminal_ ? screen_->width_px() - 3 : (screen_->width_px() - 32) / 12;
    screen_->set_overlay(host::folded(overlay, static_cast<std::size_t>(std::max(columns, 16))));
    if (picture_ == nullptr) {
      const std::int32_t width = std::clamp(screen_->width_px(), 1, kMaxPicturePx);
      const std::int32_t height = std::clamp(screen_->height_px(), 1, kMaxPicturePx);
      rgb_.assign(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 24);
      screen_->show({rgb_.data(), width, height});
      return;
    }
    screen_->show({rgb_.data(), picture_->width_px(), picture_->height_px()});
  }

  void save() {
    if (is_refined_ && refinement_ != nullptr && refinement_->is_finished()) {
      write(refinement_->picture(), options_.scene, rgb_);
      return;
    }
    if (is_refined_) {
      tell("the picture cannot be finished: " + refinement_->fault());
      return;
    }
    if (refinement_ == nullptr) {
      begin_refinement();
    }
    saves_this_ = true;
    tell("the picture is saved as soon as it is finished");
  }

  void write(const FinishedPicture& picture, const SceneArguments& scene,
             const std::vector<std::uint8_t>& rgb) {
    try {
      const std::string file = save_picture(scene.scene, picture.width_px(), picture.height_px(), rgb);
      const std::string command = render_command(scene, picture.wishes(), picture.look().words(), file);
      print(command);
      tell("saved " + file + "; the same picture by\n" + command);
    } catch (const OutputError& error) {
      tell(error.what());
    }
  }

  void finish_savings() {
    std::erase_if(savings_, [this](const Saving& saving) {
      Refinement& refinement = *saving.refinement;
      std::vector<std::uint8_t> rgb;
      const bool has_ended = refinement.has_ended();
      if (has_ended && refinement.take(&rgb) && refinement.is_finished()) {
        write(refinement.picture(), saving.scene, rgb);
      }
      return has_ended;
    });
  }

  // Threads notice soon that their work is no longer wanted; nobody waits for that.
  template <class Task>
  void leave(std::unique_ptr<Task>* task) {
    if (*task != nullptr) {
      (*task)->cancel();
      leaving_.push_back(std::move(*task));
    }
  }

  // A refinement that is to be saved continues; others end when their threads notice.
  void stop_refining() {
    is_refined_ = false;
    if (refinement_ == nullptr) {
      return;
    }
    if (saves_this_) {
      savings_.push_back({std::move(refinement_), options_.scene});
      saves_this_ = false;
      return;
    }
    leave(&refinement_);
  }

  void tell(const std::string& text) {
    message_ = text;
    message_until_ = now() + kMessageSeconds;
    needs_showing_ = true;
  }

  void print(const std::string& line) {
    if (is_terminal_) {
      lines_.push_back(line);
      return;
    }
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
  }

  void end() {
    const std::string fault = screen_->fault();
    screen_.reset();
    for (const std::string& line : lines_) {
      std::printf("%s\n", line.c_str());
    }
    lines_.clear();
    is_terminal_ = false;
    stop_refining();
    for (Saving& saving : savings_) {
      const FinishedPicture& picture = saving.refinement->picture();
      std::fprintf(stderr, "thimble: the picture was not finished and is not saved; this makes it:\n");
      print(render_command(saving.scene, picture.wishes(), picture.look().words(),
                           free_picture_name(saving.scene.scene)));
      leave(&saving.refinement);
    }
    std::fflush(stdout);
    leave(&reading_);
    leave(&next_frame_);
    const auto has_ended = [](const auto& each) { return each->has_ended(); };
    const double until = now() + kGoodbyeSeconds;
    while (!std::all_of(leaving_.begin(), leaving_.end(), has_ended)) {
      if (now() > until) {
        if (!fault.empty()) {
          std::fprintf(stderr, "thimble: %s\n", fault.c_str());
        }
        // In the middle of a row; nobody needs it.
        std::_Exit(std::ferror(stdout) != 0 || !fault.empty() ? 1 : 0);
      }
      sleep_ms(2);
    }
    if (!fault.empty()) {
      throw OutputError(fault);
    }
  }

  std::string state_text() const {
    if (picture_ == nullptr) {
      return "reading " + name() + ": " +
             std::to_string(reading_ == nullptr ? 100 : static_cast<int>(100 * reading_->progress())) + "%";
    }
    const double rate = frame_seconds_ > 0 ? 1 / frame_seconds_ : 0;
    const std::string text = fixed(rate, 0) + " frames/s " + frames_->engine();
    if (is_refined_ && picture_->at_edges()) {
      return text + " | finished, samples where edges are";
    }
    if (is_refined_) {
      const auto across = static_cast<std::uint64_t>(picture_->across());
      return text + " | finished, " + counted(across * across, "sample") + " a pixel";
    }
    if (refinement_ != nullptr && refinement_->step() <= 1 && refinement_->percent() > 0) {
      return text + (refinement_->step() == 0 ? " | last pass " : " | first pass ") +
             std::to_string(refinement_->percent()) + "%";
    }
    return text + " 1:" + std::to_string(frames_->step());
  }

  int wait_ms() const {
    if (scene_ == nullptr) {
      return kIdleMs;
    }
    const double time = now();
    if (plays_ && !changed_ && !controls_->is_flying(time)) {
      const double left = next_frame_at_ - time;
      return left > 0 ? std::min(static_cast<int>(1000 * left), kBusyMs) : 1;
    }
    if (changed_ || controls_->is_flying(time)) {
      const double left = frame_began_ + kFastestFrameSeconds - time;
      return left > 0 ? static_cast<int>(1000 * left) : 0;
    }
    return is_refined_ && savings_.empty() && leaving_.empty() ? kIdleMs : kBusyMs;
  }

  std::string name() const { return printable(options_.scene.scene); }

  ViewerOptions options_;
  CameraState camera_;
  FileWatch watch_;
  SceneArguments wanted_;  // that `reading_` reads
  std::unique_ptr<SceneReading> reading_;
  std::unique_ptr<host::Screen> screen_;
  std::optional<Controls> controls_;
  bool is_terminal_ = false;

  std::shared_ptr<const OpenScene> scene_;
  std::shared_ptr<const FinishedLook> look_;
  std::unique_ptr<FastFrames> frames_;
  std::shared_ptr<const FinishedPicture> picture_;
  std::unique_ptr<Refinement> refinement_;
  std::vector<std::unique_ptr<BackgroundTask>> leaving_;  // cancelled, their threads still at it
  std::vector<Saving> savings_;
  std::vector<std::uint8_t> rgb_;

  bool plays_ = false;
  double next_frame_at_ = 0;
  std::unique_ptr<SceneReading> next_frame_;  // of an animation, the one after `options_.scene.frame`
  HostMemory pool_memory_;
  std::unique_ptr<MovingPool> pool_;

  bool ended_ = false;
  bool changed_ = true;  // the view
  bool shows_keys_ = false;
  bool needs_showing_ = false;
  bool is_refined_ = false;
  bool saves_this_ = false;
  double changed_at_ = 0;
  double refining_since_ = 0;
  double frame_began_ = 0;
  double frame_seconds_ = 0;
  std::string message_;
  double message_until_ = 0;
  std::string camera_fault_;        // why there is no picture of the camera as it is
  std::vector<std::string> lines_;  // for standard output, once the terminal is free again
};

}  // namespace

void run_viewer(const ViewerOptions& options) {
  Viewer(options).run();
}

std::string bench_viewer(const ViewerOptions& options, int frames) {
  const double opened = now();
  SceneReading reading(options.scene, options.threads);
  const std::shared_ptr<const OpenScene> scene = reading.take();
  const auto look = std::make_shared<const FinishedLook>(scene, options.look);
  CameraState camera(options.view);
  const std::int32_t width = options.view.width_px;
  const std::int32_t height = options.view.height_px;
  auto picture = std::make_shared<const FinishedPicture>(look, camera.wishes(width, height));
  FastFrames fast(scene, picture->is_plain(), options.threads);
  std::vector<std::uint8_t> rgb;
  double first = 0;
  std::vector<double> times;
  constexpr int kWarmUp = 20;  // in which it finds its pace
  for (int i = -kWarmUp; i < frames; ++i) {
    Motion motion;
    motion.turn_right = 2.0 / frames;  // of half a turn
    camera.apply(motion, picture->framing(), *scene);
    const double start = now();
    picture = std::make_shared<const FinishedPicture>(look, camera.wishes(width, height));
    fast.draw(*picture, &rgb);
    const double took = now() - start;
    first = first == 0 ? now() - opened : first;
    if (i >= 0) {
      times.push_back(took);
    }
  }
  std::sort(times.begin(), times.end());
  const double median = times[times.size() / 2];
  camera.choose(Action::kFirstView, picture->framing(), *scene);
  picture = std::make_shared<const FinishedPicture>(look, camera.wishes(width, height));
  const double start = now();
  Refinement refinement(picture, options.threads);
  double lit = 0;
  while (!refinement.has_ended()) {
    if (refinement.take(&rgb) && lit == 0 && refinement.step() <= 1 && refinement.percent() == 100) {
      lit = now() - start;
    }
    sleep_ms(1);
  }
  const double finished = now() - start;
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), "%llu,%dx%d,%d,%s,%d,%.1f,%.2f,%.2f,%.0f,%.0f,%.0f",
                static_cast<unsigned long long>(scene->built->voxels()), width, height, options.threads,
                fast.engine().c_str(), fast.step(), 1 / median, 1000 * median, 1000 * times.back(),
                1000 * lit, 1000 * finished, 1000 * first);
  const std::string& name = options.scene.scene;
  return (name.find_first_of(",\"") == std::string::npos ? name : in_quotes(name)) + "," + text.data();
}

}  // namespace thimble::tools::viewer
