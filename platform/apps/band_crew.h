/// The bands of one frame by several cores: each takes the next band that nobody has, draws it into memory of its own
/// and sends it. One band more than there are cores is on its way to the display, so nobody waits to draw: when a core
/// begins to send its band, what was sent before has arrived, and that memory is its next.
///
/// The pixels are those of one core, which draws bands in any order. Where the bytes are wanted in order (their
/// CRC), a band waits until those above it were sent.
#pragma once

#include <stdint.h>

#include "thimble/base/status.h"

namespace thimble::apps {

/// A frame that is being drawn. While it is, what changes is touched under the lock alone.
struct CrewFrame {
  /// Bands of memory: one for each core, and what is on its way.
  static constexpr uint8_t kMemories = 3;

  int32_t height_px = 0;
  int32_t band_rows = 0;
  bool in_order = false;
  int32_t next_row = 0;         ///< of the next band that nobody has
  int32_t sent_rows = 0;        ///< in order: all above were sent
  uint8_t sending = 0;          ///< the memory whose band was sent last
  uint8_t drawing[2] = {1, 2};  ///< the memory of each core
  Status status = Status::kOk;  ///< the first that was not kOk ends the frame

  /// Somebody else has sent a band from `memory` last.
  void begin_after(uint8_t memory) {
    sending = memory;
    drawing[0] = memory == 0 ? 1 : 0;
    drawing[1] = memory == 2 ? 1 : 2;
  }
  void begin() {
    next_row = 0;
    sent_rows = 0;
    status = Status::kOk;
  }
};

/// A core's share of the frame: bands until none is left. `draw(memory, row, rows)` draws one, at the same time as other
/// cores; `send(memory, row, rows)` begins to send it, and returns when what was sent before has arrived: one core at
/// a time. `Port` has `lock` and `unlock`. Every core calls this once a frame, with its own number.
template <class Port, class Draw, class Send>
void draw_share(CrewFrame* frame, int core, const Draw& draw, const Send& send) {
  Port::lock();
  while (frame->status == Status::kOk && frame->next_row < frame->height_px) {
    const int32_t row = frame->next_row;
    const int32_t left = frame->height_px - row;
    const int32_t rows = left < frame->band_rows ? left : frame->band_rows;
    frame->next_row = row + rows;
    const uint8_t memory = frame->drawing[core];
    Port::unlock();
    const Status status = draw(memory, row, rows);
    Port::lock();
    while (frame->in_order && frame->sent_rows != row && frame->status == Status::kOk) {
      Port::unlock();
      Port::lock();
    }
    if (status != Status::kOk) {
      frame->status = status;
    }
    if (frame->status == Status::kOk) {
      send(memory, row, rows);
      frame->drawing[core] = frame->sending;
      frame->sending = memory;
      frame->sent_rows = row + rows;
    }
  }
  Port::unlock();
}

}  // namespace thimble::apps
