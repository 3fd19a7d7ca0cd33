/// @file named_scenes.h
/// The scenes that come with Thimble, found by their names: `thimble render castle`.
///
/// They lie beside the program: in share/thimble/scenes where it is installed (the folder may be moved or
/// unpacked anywhere); in a folder that one builds in, behind a link to tools/gallery/scenes.
#ifndef THIMBLE_TOOLS_SCENE_NAMED_SCENES_H
#define THIMBLE_TOOLS_SCENE_NAMED_SCENES_H

#include <string>
#include <vector>

namespace thimble::tools {

/// The names of the scenes that are there, sorted; empty where none can be found.
std::vector<std::string> scene_names();

/// The path of the scene of that name. `scene` itself where a file of that name is in the current folder, and
/// where it cannot be a name: those have neither '/' nor '.'.
/// Throws InputError, which lists the names, for one that is neither a file nor known.
std::string scene_path(const std::string& scene);

}  // namespace thimble::tools

#endif
