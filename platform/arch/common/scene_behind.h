/// The scene that `thimble image` puts behind a program (platform/images).
#pragma once

#include "images/scene_mark.h"
#include "thimble/base/memory.h"

namespace thimble {

/// In the program's own file: the linker knows its numbers.
extern const platform::SceneMark kSceneMark;

/// The scene at `kSceneMark.place` if it is sound, else `built_in`, and a line on the UART that says why. Reads all of the
/// scene the first time that it is called.
ConstBytes scene_behind(ConstBytes built_in);

}  // namespace thimble
