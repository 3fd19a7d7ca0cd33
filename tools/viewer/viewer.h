/// A scene to look around in: the loop between a screen, the camera and what draws.
///
/// While the camera moves, frames are drawn by the clock (fast_frames.h); once it rests, the finished picture
/// comes out of them on other threads (finished_picture.h), and ends as what `thimble render` makes. Everything
/// else, screen included, happens on the thread that calls.
#pragma once

#include <string>

#include "host/screen.h"
#include "scene/framing.h"
#include "scene/scene_arguments.h"
#include "viewer/finished_picture.h"

namespace thimble::tools::viewer {

struct ViewerOptions {
  SceneArguments scene;
  ViewWishes view;  ///< the first view; its size is the window's at first
  LookWishes look;
  int threads = 1;
  host::ScreenKind display = host::ScreenKind::kAuto;
};

/// Opens a screen and stays until the user ends it. What `s` saved is printed on standard output, a command a
/// line. Ends the process itself where its threads are still in the middle of something slow. Throws
/// InputError for a scene that cannot be read at first, OutputError where there is no screen.
void run_viewer(const ViewerOptions& options);

/// Without a screen: turns once around the scene in so many frames, then finishes the picture. One line of
/// CSV for standard output, under the columns of `kBenchColumns`: of the last frame its engine and that it has
/// every `step`-th pixel; the median and the slowest of the frames' times; until each pixel had all of the
/// light, and until the picture was finished; from the file to the first frame. Throws InputError.
std::string bench_viewer(const ViewerOptions& options, int frames);
inline constexpr const char* kBenchColumns =
    "scene,voxels,size_px,threads,engine,step,frames_a_second,frame_ms,slowest_frame_ms,lit_ms,finished_ms,"
    "first_ms";

}  // namespace thimble::tools::viewer
