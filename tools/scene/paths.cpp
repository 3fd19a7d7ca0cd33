#include "scene/paths.h"

#include <filesystem>
#include <system_error>

namespace thimble::tools {

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
