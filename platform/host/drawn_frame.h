/// A frame that was drawn in the core's place, whole and beside the board's memory, and handed out in the
/// bands that the application asks for.
///
/// Nothing is carried over from frame to frame: with another camera, shading or format, and when the rows do
/// not follow one another downwards, it is drawn anew.
///
/// A frame that is requested from deeper on the stack than any before, the first one among them, is drawn by
/// the core too, so that the application's stack is what it is when the core draws everything; of what is
/// flushed the two are compared.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/simulation.h"
#include "thimble/base/memory.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::host {

class DrawnFrame {
 public:
  /// Without a painter there is never a frame. `flash`: the only bytes that a tree and a palette may lie in,
  /// since they cannot change.
  DrawnFrame(FramePainter* painter, ConstBytes flash) : painter_(painter), flash_(flash) {}

  // On the application's thread and stack:
  /// Whether this band, the next to be handed out, is the first of a frame: then `draw` comes first.
  /// `stack` grows down.
  bool begins_with(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   std::uintptr_t stack);
  /// Copies the band's rows; false, and nothing is copied, where the core is to draw them.
  bool hand_out(const Band& band);
  /// Whether a band that the core drew beside this differs. Asked once for each.
  bool contradicts(const Band& band);

  // On the other one:
  void draw();

 private:
  bool holds(const Band& band) const;

  FramePainter* painter_;
  ConstBytes flash_;
  bool may_draw_ = false;  ///< the next band
  // What is drawn.
  CompactTree tree_;
  Camera camera_;
  Shading shading_;
  PixelFormat format_ = PixelFormat::kGray8;
  std::array<std::uint8_t, sizeof(Camera)> camera_bytes_{};  ///< with its padding
  std::array<std::uint8_t, sizeof(Shading)> shading_bytes_{};
  std::vector<std::uint8_t> pixels_;
  bool is_drawn_ = false;
  std::int32_t next_row_ = -1;  ///< below those that were requested; -1: there is no frame
  bool is_left_ = false;        ///< to the core too
  std::uintptr_t deepest_ = UINTPTR_MAX;
  // The rows that were left last.
  std::int32_t left_row_ = 0;
  std::int32_t left_rows_ = 0;
};

}  // namespace thimble::host
