/// The threads that draw. Keep them from frame to frame: a thread that has to be woken for each frame starts a tenth of
/// a millisecond late, and one that drew the frame before starts at once.
#pragma once

#include <functional>
#include <memory>

#include "wide/limits.h"

namespace thimble::wide {

/// Not to be copied; draws one frame at a time.
class Threads {
 public:
  /// `count` includes the calling thread and is limited to 1 .. kMaxThreads and to what the system gives. More threads
  /// than processors are made if asked for, but gain nothing.
  explicit Threads(int count);
  ~Threads();

  int count() const { return count_; }

  /// Calls run(0) .. run(tasks - 1), each once; the calling thread takes its part. Returns when all calls have
  /// returned. No task may wait for another one to begin.
  void each(int tasks, const std::function<void(int task)>& run);
  /// `thread` is less than count(), and no two calls at a time have the same.
  void each(int tasks, const std::function<void(int task, int thread)>& run);

 private:
  struct Pool;

  int count_;
  std::unique_ptr<Pool> pool_;
};

}  // namespace thimble::wide
