/// @file file_watch.h
/// Notices that a file has changed, by looking at it now and then.
#ifndef THIMBLE_TOOLS_VIEWER_FILE_WATCH_H
#define THIMBLE_TOOLS_VIEWER_FILE_WATCH_H

#include <cstdint>
#include <string>

namespace thimble::tools::viewer {

class FileWatch {
 public:
  /// Between two looks, in seconds.
  static constexpr double kLookSeconds = 0.25;

  /// What is there now counts as known. A path that names no file, such as a generator, never changes.
  explicit FileWatch(std::string path);

  /// Whether the file is another than the one known, and was the same at the last two looks, so that whoever
  /// writes it has paused; it is then known. `seconds`: of any steady clock.
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
  Mark look() const;

  std::string path_;
  Mark known_;
  Mark last_;
  double looked_at_ = -1;
};

}  // namespace thimble::tools::viewer

#endif
