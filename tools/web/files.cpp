// What the readers ask of a system (readers/file_bytes.h, scene/named_scenes.h, scene/...), from what the page
// handed over.
#include "web/files.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "readers/file_bytes.h"
#include "scene/host_memory.h"
#include "scene/named_scenes.h"
#include "scene/point_tree.h"
#include "scene/workers.h"

namespace thimble::tools {
namespace {

std::map<std::string, std::span<const std::uint8_t>>& files() {
  static std::map<std::string, std::span<const std::uint8_t>> all;
  return all;
}

std::string own_file;  // the first that is loaded
std::string model;     // the last one beside it

// Those that are free again. Pages of a WebAssembly memory take none of the machine's until they are written, but they
// are never given back: the next frame of an animation is built where the one before was.
std::vector<Bytes> kept_memory;
std::vector<const std::uint8_t*> large_memory;  // free or not

}  // namespace

std::string model_at_fault() {
  return model.empty() ? "" : model + ": ";
}
void end_of_reading() {
  own_file.clear();
  model.clear();
}

void add_file(const std::string& name, std::span<const std::uint8_t> bytes) {
  files()[name] = bytes;
}

// ---- readers/file_bytes.h

std::string load_beside(const std::string& path, std::uint64_t limit_bytes, SharedBytes& file) {
  const auto found = files().find(file_name(path));
  if (found == files().end()) {
    return "is not here: drop it together with the file that names it";
  }
  if (found->second.empty()) {
    return "is empty";
  }
  if (found->second.size() > limit_bytes) {
    return "holds more than the limit of " + std::to_string(limit_bytes) + " bytes";
  }
  file = {found->second, nullptr};
  return {};
}

SharedBytes load_file(const std::string& path, std::uint64_t limit_bytes, const FirstLook& look) {
  const std::string name = file_name(path);
  if (own_file.empty()) {
    own_file = name;
  } else if (name != own_file) {
    model = name;
  }
  SharedBytes file;
  if (const std::string fault = load_beside(path, limit_bytes, file); !fault.empty()) {
    throw InputError(fault);
  }
  if (look) {
    look(file.bytes.first(std::min(file.bytes.size(), kFirstLookBytes)));
  }
  return file;
}

SharedBytes load_shared(const std::string& path, const FirstLook& look, bool /*is_beside*/) {
  return load_file(path, kFileLimitBytes, look);
}

// ---- scene/named_scenes.h

std::string file_name(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

// All files lie in one folder.
std::string path_beside(const std::string& /*path*/, const std::string& name) {
  return name;
}

std::string canonical_path(const std::string& path) {
  return file_name(path);
}

// ---- scene

std::vector<std::string> scene_names() {
  return {};
}

std::string scene_path(const std::string& scene) {
  return scene;
}

void each_task(std::size_t tasks, int /*threads*/,
               const std::function<void(std::size_t task, std::size_t worker)>& run) {
  for (std::size_t task = 0; task < tasks; ++task) {
    run(task, 0);
  }
}

// What fits a page is few points.
PointTree build_point_tree(const SceneSource& /*source*/, Bytes /*room*/, int /*threads*/,
                           const Progress& /*progress*/, std::uint64_t /*most_list_bytes*/) {
  return {};
}

HostMemory::HostMemory(std::size_t size) : size_(size) {
  if (size != 0) {
    data_ = static_cast<std::uint8_t*>(std::malloc(size));
    if (data_ == nullptr) {
      throw std::bad_alloc();
    }
  }
}

HostMemory HostMemory::largest() {
  HostMemory memory;
  if (!kept_memory.empty()) {
    memory.data_ = kept_memory.back().data;
    memory.size_ = kept_memory.back().size;
    kept_memory.pop_back();
    return memory;
  }
  for (std::size_t size = std::size_t{512} << 20; size >= std::size_t{1} << 20; size /= 2) {
    memory.data_ = static_cast<std::uint8_t*>(std::malloc(size));
    if (memory.data_ != nullptr) {
      memory.size_ = size;
      large_memory.push_back(memory.data_);
      return memory;
    }
  }
  throw std::bad_alloc();
}

void HostMemory::keep(std::size_t size) {
  HostMemory small(size);
  std::memcpy(small.data_, data_, size);
  std::swap(data_, small.data_);
  std::swap(size_, small.size_);
}

HostMemory::~HostMemory() {
  const bool is_large = std::count(large_memory.begin(), large_memory.end(), data_) != 0;
  is_large ? kept_memory.push_back({data_, size_}) : std::free(data_);
}

}  // namespace thimble::tools
