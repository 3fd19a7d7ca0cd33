/// @file file_watch.h
/// Notices that one of a few files has changed, by looking at them now and then.
#ifndef THIMBLE_TOOLS_VIEWER_FILE_WATCH_H
#define THIMBLE_TOOLS_VIEWER_FILE_WATCH_H

#include <cstdint>
#include <string>
#include <vector>

namespace thimble::tools::viewer {

class FileWatch {
 public:
  /// Between two looks, in seconds.
  static constexpr double kLookSeconds = 0.25;

  /// What is there now counts as known. A path that names no file, such as a generator, never changes.
  explicit FileWatch(std::string path);

  /// Watches these from now on. What is there now counts as known, but for those that were watched before.
  void watch(const std::vector<std::string>& paths);
  /// Whether a file is another than the one known, and all were the same at the last two looks, so that whoever
  /// writes them has paused; they are then known. `seconds`: of any steady clock.
  bool has_changed(double seconds);

 private:
  struct Mark {
    bool exists = false;
    std::uint64_t inode = 0;
    std::int64_t bytes = 0;
    std::int64_t seconds = 0;
    std::int64_t nanoseconds = 0;
    friend bool operator==(const Mark&, const Mark&) = default;
  };
  struct Watched {
    std::string path;
    Mark known;
    Mark last;
  };
  static Mark look(const std::string& path);

  std::vector<Watched> files_;
  double looked_at_ = -1;
};

}  // namespace thimble::tools::viewer

#endif
