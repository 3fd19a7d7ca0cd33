#include "output/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace thimble::tools {
namespace {

// Names of temporary files in use, for the signal handler: plain arrays, because a handler may not allocate.
constexpr std::size_t kSlots = 8;
constexpr std::size_t kNameBytes = 4096;
struct Slot {
  std::atomic<bool> used{false};
  std::atomic<bool> named{false};
  std::array<char, kNameBytes> name{};
};
std::array<Slot, kSlots>& slots() {
  static std::array<Slot, kSlots> all;
  return all;
}

void remember(const std::string& name) {
  for (Slot& slot : slots()) {
    bool expected = false;
    if (name.size() < kNameBytes && slot.used.compare_exchange_strong(expected, true)) {
      std::memcpy(slot.name.data(), name.c_str(), name.size() + 1);
      slot.named = true;
      return;
    }
  }
}

// Short, so that any name that the target has will do.
constexpr const char* kTemporary = ".thimble-XXXXXX";

std::string name_of_open(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

// Where a chain of links leads, whether or not something stands at its end: the links stay.
std::string followed(const std::string& path) {
  std::filesystem::path at = path;
  for (int links = 0; links < 64; ++links) {
    std::error_code is_no_link;
    const std::filesystem::path next = std::filesystem::read_symlink(at, is_no_link);
    if (is_no_link) {
      break;
    }
    at = at.parent_path() / next;  // `next` alone where it begins at the root
  }
  return at.string();
}

void forget(const std::string& name) {
  for (Slot& slot : slots()) {
    if (slot.named && name == slot.name.data()) {
      slot.named = false;
      slot.used = false;
      return;
    }
  }
}

}  // namespace

void discard_unfinished_output() {
  for (Slot& slot : slots()) {
    if (slot.named) {
      ::unlink(slot.name.data());
    }
  }
}

void check_standard_output() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    throw OutputError(std::string("standard output: cannot be written: ") + std::strerror(errno));
  }
}

void check_distinct(std::span<const std::string> paths, std::span<const std::string> inputs) {
  const auto same = [](const std::string& a, const std::string& b) {
    if (a == b) {
      return true;
    }
    if (a == "-" || b == "-") {
      return false;
    }
    std::error_code ignored;
    const auto first_path = std::filesystem::weakly_canonical(a, ignored);
    const auto second_path = std::filesystem::weakly_canonical(b, ignored);
    if (!first_path.empty() && first_path == second_path) {
      return true;
    }
    struct stat first {};
    struct stat second {};
    return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && S_ISREG(first.st_mode) &&
           first.st_dev == second.st_dev && first.st_ino == second.st_ino;
  };
  for (std::size_t i = 0; i < paths.size(); ++i) {
    // A device such as /dev/null takes anything any number of times.
    struct stat info {};
    const bool device = ::stat(paths[i].c_str(), &info) == 0 && S_ISCHR(info.st_mode);
    if (paths[i].empty() || (device && paths[i] != "-")) {
      continue;
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (same(paths[i], paths[j])) {
        throw OutputError((paths[i] == "-" ? "standard output" : paths[i]) + ": two outputs cannot share it");
      }
    }
    for (const std::string& input : inputs) {
      if (paths[i] != "-" && same(paths[i], input)) {
        throw OutputError(paths[i] + ": is an input and would be overwritten");
      }
    }
  }
}

OutputFile::OutputFile(const std::string& path) : path_(path), target_(path) {
  if (path == "-") {
    file_ = stdout;
    return;
  }
  struct stat info {};
  const bool exists = ::stat(path.c_str(), &info) == 0;
  if (!exists && errno != ENOENT) {
    fail(errno);
  }
  if (exists && S_ISDIR(info.st_mode)) {
    fail(EISDIR);
  }
  if (exists && !S_ISREG(info.st_mode)) {
    file_ = std::fopen(path.c_str(), "wb");
  } else if (exists && ::access(path.c_str(), W_OK) != 0) {
    fail(errno);
  } else {
    target_ = followed(path);
    const int descriptor = open_unfinished();
    // The result gets the mode that any new file would, or that of the file it replaces.
    const mode_t mask = ::umask(0);
    ::umask(mask);
    if (::fchmod(descriptor, exists ? info.st_mode & 07777U : 0666U & ~mask) != 0) {
      // Not all file systems have modes.
    }
    file_ = ::fdopen(descriptor, "wb");
  }
  if (file_ == nullptr) {
    fail(errno);
  }
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
  temporary_ = folder + kTemporary;
  const int descriptor = ::mkstemp(temporary_.data());
  if (descriptor < 0) {
    temporary_.clear();
    fail(errno);
  }
  remember(temporary_);
  return descriptor;
}

// Gives what was written a name of its own, which `commit` changes into the target's: a link cannot replace
// what stands there.
void OutputFile::name_unfinished() {
  const std::string open_file = name_of_open(::fileno(file_));
  for (int attempt = 0; attempt < 100; ++attempt) {
    // mkstemp chooses a free name; its file makes way at once. Whoever takes the name in between sends us on.
    std::string name = target_.substr(0, target_.rfind('/') + 1) + kTemporary;
    const int taken = ::mkstemp(name.data());
    if (taken < 0) {
      fail(errno);
    }
    ::close(taken);
    remember(name);
    temporary_ = name;
    ::unlink(name.c_str());
    if (::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      is_nameless_ = false;
      return;
    }
    const int error = errno;
    forget(name);
    temporary_.clear();
    if (error != EEXIST) {
      fail(error);
    }
  }
  fail(EEXIST);
}

OutputFile::~OutputFile() {
  if (file_ != nullptr && file_ != stdout) {
    std::fclose(file_);
  }
  if (!temporary_.empty()) {
    ::unlink(temporary_.c_str());
    forget(temporary_);
  }
}

void OutputFile::fail(int error) {
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

void OutputFile::flush() {
  if (std::fflush(file_) != 0) {
    fail(errno);
  }
}

void OutputFile::commit() {
  flush();
  if (file_ == stdout) {
    return;
  }
  if (is_nameless_) {
    name_unfinished();
  }
  std::FILE* file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0) {
    fail(errno);
  }
  if (temporary_.empty()) {
    return;
  }
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) {
    fail(errno);
  }
  forget(temporary_);
  temporary_.clear();
}

}  // namespace thimble::tools
