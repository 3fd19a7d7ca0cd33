#include "scene/named_scenes.h"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>

#include "output/units.h"
#include "readers/input_error.h"

namespace thimble::tools {
namespace {

namespace fs = std::filesystem;

// Where both are there, the text comes first: it has the model, a camera and light.
constexpr std::array<std::string_view, 3> kEndings{".scene", ".vox", ".vox.gz"};

// Paths by name.
std::map<std::string, std::string> known_scenes() {
  std::map<std::string, std::string> known;
  const fs::path folder = folder_beside_program("scenes");
  std::error_code error;
  for (const std::string_view ending : kEndings) {
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
      const std::string file = entry->path().filename().string();
      if (file.size() > ending.size() && file.ends_with(ending)) {
        known.try_emplace(file.substr(0, file.size() - ending.size()), entry->path().string());
      }
    }
    if (error && !folder.empty()) {
      throw ShortageError("the folder of the scenes that come along cannot be opened: " + error.message());
    }
  }
  return known;
}

}  // namespace

std::string folder_beside_program(const std::string& name) {
  const fs::path installed = fs::path(THIMBLE_SCENES_FROM_PROGRAM).parent_path() / name;
  std::error_code error;
  // Beside the program, else beside the library that this is part of.
  Dl_info library{};
  const bool is_known = dladdr(&kEndings, &library) != 0 && library.dli_fname != nullptr;
  for (const fs::path& file :
       {fs::read_symlink("/proc/self/exe", error), fs::path(is_known ? library.dli_fname : "")}) {
    for (const fs::path& from_file : {installed, fs::path(name)}) {
      fs::path folder = (file.parent_path() / from_file).lexically_normal();
      if (!file.empty() && fs::is_directory(folder, error)) {
        return folder.string();
      }
    }
  }
  return {};
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& [name, path] : known_scenes()) {
    names.push_back(name);
  }
  return names;
}

std::string scene_path(const std::string& scene) {
  std::error_code error;
  const bool may_be_name = !scene.empty() && scene.find_first_of("/.") == std::string::npos;
  if (!may_be_name || fs::exists(fs::symlink_status(scene, error))) {
    return scene;
  }
  const auto known = known_scenes();
  if (const auto found = known.find(scene); found != known.end()) {
    return found->second;
  }
  const std::vector<std::string> names = scene_names();
  throw InputError(
      "no such file, and no scene of that name", suggestion(scene, names),
      names.empty() ? " (none is installed beside the program)" : "; there are " + joined(names, ", "));
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

std::string path_beside(const std::string& path, const std::string& name) {
  return (std::filesystem::path(path).parent_path() / name).string();
}

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const auto result = std::filesystem::weakly_canonical(path, error);
  return error ? path : result.string();
}

}  // namespace thimble::tools
