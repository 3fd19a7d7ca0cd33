#include "viewer/file_watch.h"

#include <sys/stat.h>

#include <utility>

namespace thimble::tools::viewer {

FileWatch::FileWatch(std::string path) : path_(std::move(path)), known_(look()), last_(known_) {}

FileWatch::Mark FileWatch::look() const {
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0) {
    return {};
  }
  return {true, status.st_ino, status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

bool FileWatch::has_changed(double seconds) {
  if (looked_at_ >= 0 && seconds < looked_at_ + kLookSeconds) {
    return false;
  }
  looked_at_ = seconds;
  const Mark now = look();
  const bool rests = now == last_;
  last_ = now;
  if (!now.exists || !rests || now == known_) {
    return false;  // one that is gone may come back: editors write a new file beside the old one
  }
  known_ = now;
  return true;
}

}  // namespace thimble::tools::viewer
