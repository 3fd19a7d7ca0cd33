/// The work of the demonstration's frames, counted: how often the core, compiled once more for this alone, comes to the
/// beginning of one of its blocks of code (-fsanitize-coverage=trace-pc), the same on every machine. From it and what a
/// board's core was measured to take for a block (boards/frame_costs.h) follows what a frame of a scene takes there.
#pragma once

#include <cstddef>
#include <cstdint>

/// Not in namespace thimble, which is another one in the core that counts.
namespace counted {

struct FrameWork {
  std::uint64_t blocks = 0;
  std::uint64_t hits = 0;
};

/// The median of the round's eight golden frames (apps/demo_view.h) without light by the brick map, in ink where `is_ink`: of
/// a baked scene with a map. False where there is no such scene or no such view.
bool count_frames(const std::uint8_t* scene, std::size_t bytes, std::int32_t width_px, std::int32_t height_px,
                  bool is_ink, FrameWork* work);

}  // namespace counted
