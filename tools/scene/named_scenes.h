/// The scenes that come with Thimble, found by their names: `thimble render castle`.
///
/// They lie beside the program: in share/thimble/scenes where it is installed (the folder may be moved or
/// unpacked anywhere); in a folder that one builds in, behind a link to tools/gallery/scenes.
#pragma once

#include <string>
#include <vector>

namespace thimble::tools {

/// The names of the scenes that are there, sorted; empty where none can be found.
std::vector<std::string> scene_names();

/// The path of the scene of that name. `scene` itself where a file of that name is in the current folder, and
/// where it cannot be a name: those have neither '/' nor '.'.
/// Throws InputError, which lists the names, for one that is neither a file nor known.
std::string scene_path(const std::string& scene);

/// Where `name` (scenes, images) lies beside the program: installed, or behind a link that the build makes. Empty: nowhere.
std::string folder_beside_program(const std::string& name);

// Names of files, as text.

/// The last part of a path, without its folder.
std::string file_name(const std::string& path);
/// What the file `path` means by `name`: relative to its own folder, unless it begins at the root.
std::string path_beside(const std::string& path, const std::string& name);
/// One spelling of a path, links followed as far as it exists; the path itself where that fails.
std::string canonical_path(const std::string& path);

/// Whether `parse_generator` (generators.h) takes it, or says what is wrong with it.
bool is_generator(const std::string& word);

}  // namespace thimble::tools
