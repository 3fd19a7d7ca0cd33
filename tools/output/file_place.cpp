#include "output/file_place.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <mutex>
#include <system_error>

#include "output/output_file.h"
#include "output/units.h"

namespace thimble::tools {
namespace {

// The number N of PROC/fd/N, as /dev/stdout and /dev/fd/N lead to, also of another process; else -1.
int descriptor_at(const std::filesystem::path& path, bool* is_ours) {
  const std::string name = path.filename().string();
  const int number = number_in<int>(name).value_or(-1);
  if (number < 0) {
    return -1;
  }
  std::error_code error;
  const std::string folder = std::filesystem::canonical(path.parent_path() / ".", error).string();
  const std::string ours = std::filesystem::canonical("/proc/self", error).string();
  if (error || !folder.starts_with("/proc/") || !folder.ends_with("/fd")) {
    return -1;
  }
  *is_ours = folder.starts_with(ours + "/");
  return number;
}

// Devices take anything any number of times.
bool is_device(const FilePlace& place) {
  return place.error == 0 && S_ISCHR(place.info.st_mode);
}

bool is_same_inode(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// By device and inode, and where nothing stands yet by folder and name.
bool is_one_file(const FilePlace& a, const FilePlace& b) {
  if (a.path == b.path || (a.descriptor >= 0 && a.descriptor == b.descriptor)) {
    return true;
  }
  if (a.error == 0 || b.error == 0) {
    return a.error == 0 && b.error == 0 && is_same_inode(a.info, b.info);
  }
  const std::filesystem::path first = a.target;
  const std::filesystem::path second = b.target;
  struct stat folder {};
  struct stat other {};
  return first.filename() == second.filename() && ::stat((first.parent_path() / ".").c_str(), &folder) == 0 &&
         ::stat((second.parent_path() / ".").c_str(), &other) == 0 && is_same_inode(folder, other);
}

// Whether writing to `output` spoils what `input` has. A socket may be both ends.
bool spoils(const FilePlace& output, const FilePlace& input) {
  return !is_device(output) && !(output.error == 0 && S_ISSOCK(output.info.st_mode)) &&
         is_one_file(output, input);
}

[[noreturn]] void refuse_input(const FilePlace& output) {
  throw OutputError((output.path == "-" ? "standard output" : output.path) +
                    ": is an input and would be overwritten");
}

// Of the whole process.
struct Claims {
  std::mutex mutex;
  std::vector<const FilePlace*> outputs;
  std::vector<std::string> inputs;
};

Claims& claims() {
  static Claims all;
  return all;
}

}  // namespace

FilePlace::FilePlace(const std::string& given) : path(given), target(given) {
  if (path == "-") {
    descriptor = 1;
    is_descriptor = true;
    error = ::fstat(1, &info) == 0 ? 0 : errno;
    return;
  }
  std::filesystem::path at = path;
  for (int links = 0; links < 64; ++links) {
    bool is_ours = false;
    const int number = descriptor_at(at, &is_ours);
    if (number >= 0) {
      is_descriptor = true;
      descriptor = is_ours ? number : -1;
      break;
    }
    std::error_code is_no_link;
    const std::filesystem::path next = std::filesystem::read_symlink(at, is_no_link);
    if (is_no_link) {
      target = at.string();
      break;
    }
    at = at.parent_path() / next;  // `next` alone where it begins at the root
  }
  error = ::stat(path.c_str(), &info) == 0 ? 0 : errno;
}

OutputClaim::OutputClaim(const std::vector<std::string>& paths, const std::vector<std::string>& inputs,
                         const std::vector<std::string>& sequence) {
  Claims& all = claims();
  const std::lock_guard lock(all.mutex);
  std::vector<std::string> read = all.inputs;
  read.insert(read.end(), inputs.begin(), inputs.end());
  std::erase(read, "");
  std::vector<FilePlace> read_places;
  read_places.reserve(read.size());
  for (const std::string& input : read) {
    read_places.emplace_back(input == "-" ? "./-" : input);
  }
  const auto claim = [&](const std::string& path, std::size_t others) {
    const FilePlace place(path);
    for (std::size_t i = 0; i < others; ++i) {
      const FilePlace& other = places_[i];
      const bool is_one_descriptor = place.descriptor >= 0 && place.descriptor == other.descriptor;
      if ((is_one_descriptor || !is_device(place)) && is_one_file(place, other)) {
        throw OutputError((path == "-" ? "standard output" : path) + ": two outputs cannot share it");
      }
    }
    for (const FilePlace& input : read_places) {
      if (spoils(place, input)) {
        refuse_input(place);
      }
    }
    places_.push_back(place);
  };
  for (const std::string& path : paths) {
    if (!path.empty()) {
      claim(path, places_.size());
    }
  }
  const std::size_t single = places_.size();
  for (const std::string& path : sequence) {
    claim(path, single);
  }
  for (const FilePlace& place : places_) {
    all.outputs.push_back(&place);
  }
}

OutputClaim::~OutputClaim() {
  Claims& all = claims();
  const std::lock_guard lock(all.mutex);
  for (const FilePlace& place : places_) {
    std::erase(all.outputs, &place);
  }
}

void claim_input(const std::string& path) {
  Claims& all = claims();
  const std::lock_guard lock(all.mutex);
  const FilePlace place(path == "-" ? "./-" : path);
  for (const FilePlace* output : all.outputs) {
    if (spoils(*output, place)) {
      refuse_input(*output);
    }
  }
  if (place.error == 0 && S_ISREG(place.info.st_mode) &&
      std::find(all.inputs.begin(), all.inputs.end(), path) == all.inputs.end()) {
    all.inputs.push_back(path);
  }
}

}  // namespace thimble::tools
