/// @file paths.h
/// Names of files, as text.
#ifndef THIMBLE_TOOLS_SCENE_PATHS_H
#define THIMBLE_TOOLS_SCENE_PATHS_H

#include <string>

namespace thimble::tools {

/// The last part of a path, without its folder.
std::string file_name(const std::string& path);
/// What the file `path` means by `name`: relative to its own folder, unless it begins at the root.
std::string path_beside(const std::string& path, const std::string& name);
/// One spelling of a path, links followed as far as it exists; the path itself where that fails.
std::string canonical_path(const std::string& path);

}  // namespace thimble::tools

#endif
