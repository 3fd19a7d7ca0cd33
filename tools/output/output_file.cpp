#include "output/output_file.h"

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "output/held_signals.h"

namespace thimble::tools {
namespace {

std::string name_of_open(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

// A copy of a descriptor that the program was started with: those that it opened itself end with it, and are nobody
// else's to name. -1 and errno where there is none that can be written to.
int copy_of_given(int descriptor) {
  const int flags = ::fcntl(descriptor, F_GETFD);
  const int mode = ::fcntl(descriptor, F_GETFL);
  if (flags < 0 || (flags & FD_CLOEXEC) != 0 || (mode & O_ACCMODE) == O_RDONLY) {
    errno = EBADF;
    return -1;
  }
  return ::fcntl(descriptor, F_DUPFD_CLOEXEC, 3);
}

// Nothing can take the name of what is mounted there.
bool is_mounted(const std::string& path) {
  struct statx info {};
  return ::statx(AT_FDCWD, path.c_str(), 0, STATX_TYPE, &info) == 0 &&
         (info.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

}  // namespace

void check_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw OutputError(std::string("standard output: cannot be written: ") + std::strerror(errno));
  }
}

OutputFile::OutputFile(const std::string& path, Empty empty) : path_(path) {
  const FilePlace place(path);
  target_ = place.target;
  if (place.descriptor == 1) {
    file_ = stdout;
    return;
  }
  if (place.error != 0 && place.error != ENOENT) {
    fail(place.error);
  }
  const bool exists = place.error == 0;
  const bool is_filled = exists && empty == Empty::kIsFilled && place.info.st_size == 0;
  if (exists && S_ISDIR(place.info.st_mode)) {
    fail(EISDIR);
  }
  int descriptor = -1;
  if (place.descriptor >= 0) {
    descriptor = copy_of_given(place.descriptor);
  } else if (place.is_descriptor) {
    descriptor = ::open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);  // behind what its owner wrote
  } else if (exists && (is_filled || !S_ISREG(place.info.st_mode))) {
    descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  } else if (exists && ::access(path.c_str(), W_OK) != 0) {
    fail(errno);
  } else if (is_mounted(target_)) {
    fail(EBUSY);
  } else {
    descriptor = open_unfinished();
    // The result gets the mode that any new file would, or that of the file it replaces.
    const mode_t mask = ::umask(0);
    ::umask(mask);
    if (::fchmod(descriptor, exists ? place.info.st_mode & 07777U : 0666U & ~mask) != 0) {
      // Not all file systems have modes.
    }
  }
  file_ = descriptor < 0 ? nullptr : ::fdopen(descriptor, "wb");
  if (file_ == nullptr) {
    const int error = errno;
    delete_unfinished();
    fail(error);
  }
}

// Beside the target, and short, so that any name that the target has will do. It is free but for a chance of 2^-64.
std::string OutputFile::hidden_name() const {
  std::array<unsigned char, 8> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    fail(errno);
  }
  std::string name = target_.substr(0, target_.rfind('/') + 1) + ".thimble-";
  for (const unsigned byte : random) {
    name += {"0123456789abcdef"[byte >> 4], "0123456789abcdef"[byte & 15]};
  }
  return name;
}

// A file beside the target, so that the renaming is one step. Where the system can, it has no name until it is
// finished, so that nothing is left of it even when the program is killed.
int OutputFile::open_unfinished() {
  const std::string folder = target_.substr(0, target_.rfind('/') + 1);
  const int nameless = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (nameless >= 0 && ::access(name_of_open(nameless).c_str(), F_OK) == 0) {
    is_nameless_ = true;
    return nameless;
  }
  if (nameless >= 0) {
    ::close(nameless);  // without /proc it could never get a name
  }
  const HeldSignals held;
  temporary_ = hidden_name();
  const int descriptor = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    const int error = errno;
    temporary_.clear();
    fail(error);
  }
  remember_unfinished(temporary_);
  return descriptor;
}

// Gives what was written a name of its own, which `place` changes into the target's: a link cannot replace what stands
// there.
void OutputFile::name_unfinished(int descriptor) {
  const HeldSignals held;
  temporary_ = hidden_name();
  if (::linkat(AT_FDCWD, name_of_open(descriptor).c_str(), AT_FDCWD, temporary_.c_str(), AT_SYMLINK_FOLLOW) !=
      0) {
    const int error = errno;
    temporary_.clear();
    fail(error);
  }
  remember_unfinished(temporary_);
  is_nameless_ = false;
}

void OutputFile::delete_unfinished() {
  if (!temporary_.empty()) {
    const HeldSignals held;
    ::unlink(temporary_.c_str());
    forget_unfinished(temporary_);
    temporary_.clear();
  }
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) {
    std::fclose(file_);
  }
  delete_unfinished();
}

void OutputFile::fail(int error) const {
  throw OutputError((path_ == "-" ? std::string("standard output") : path_) +
                    ": cannot be written: " + std::strerror(error));
}

void OutputFile::write(std::string_view text) {
  if (!text.empty() && std::fwrite(text.data(), 1, text.size(), file_) != text.size()) {
    fail(errno);
  }
}

void OutputFile::write(std::span<const unsigned char> bytes) {
  write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void OutputFile::finish() {
  if (std::fflush(file_) != 0) {
    fail(errno);
  }
  if (file_ == stdout) {
    return;
  }
  if (is_nameless_) {
    name_unfinished(::fileno(file_));
  }
  std::FILE* file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) {
    fail(errno);
  }
}

void OutputFile::keep_old() {
  struct stat info {};
  if (temporary_.empty() || (::lstat(target_.c_str(), &info) != 0 && errno == ENOENT)) {
    return;
  }
  if (S_ISDIR(info.st_mode)) {
    fail(EISDIR);
  }
  const std::string name = hidden_name();
  // A second name for it, or where the file system has none it goes aside.
  if (::link(target_.c_str(), name.c_str()) != 0 && ::rename(target_.c_str(), name.c_str()) != 0) {
    fail(errno);
  }
  kept_ = name;
}

void OutputFile::place() {
  if (temporary_.empty()) {
    return;
  }
  const HeldSignals held;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    fail(errno);
  }
  is_placed_ = true;
  forget_unfinished(temporary_);
  temporary_.clear();
}

void OutputFile::undo() {
  if (!kept_.empty()) {
    ::rename(kept_.c_str(), target_.c_str());  // does nothing where both names are of one file
    settle();
  } else if (is_placed_) {
    ::unlink(target_.c_str());
  }
  is_placed_ = false;
}

void OutputFile::settle() {
  if (!kept_.empty()) {
    ::unlink(kept_.c_str());
    kept_.clear();
  }
}

void OutputFile::commit() {
  finish();
  place();
}

OutputSet::OutputSet(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
                     const std::vector<std::string>& sequence)
    : claim_(paths, inputs, sequence) {
  for (const std::string& path : paths) {
    files_.push_back(path.empty() ? nullptr : std::make_unique<OutputFile>(path));
    has_standard_output_ = has_standard_output_ || (!path.empty() && files_.back()->is_standard_output());
  }
}

void OutputSet::write(std::size_t index, std::string_view text) const {
  if (files_[index] != nullptr) {
    files_[index]->write(text);
  }
}

void OutputSet::commit() {
  std::vector<OutputFile*> files;
  for (const auto& file : files_) {
    if (file != nullptr) {
      file->finish();
      if (file->wants_name()) {
        files.push_back(file.get());
      }
    }
  }
  const HeldSignals held;
  try {
    for (OutputFile* file : files) {
      if (files.size() > 1) {
        file->keep_old();
      }
      file->place();
    }
  } catch (const OutputError&) {
    for (OutputFile* file : files) {
      file->undo();
    }
    throw;
  }
  for (OutputFile* file : files) {
    file->settle();
  }
}

void OutputSet::print(std::string_view text) const {
  if (!has_standard_output_) {
    OutputFile output("-");
    output.write(text);
    output.commit();
  }
}

}  // namespace thimble::tools
