// Finds files of the project that the program reads at run time.
#pragma once

#include <string>

namespace slipbench {

// Path of a project file given relative to the project's root ("scenes/papillarray/hexapod.yaml"):
// below share/slipbench of the program's install prefix, else, for a program in its build folder,
// in the source tree. Throws InputError if it is in neither.
std::string project_file(const std::string& path);

// Path of a scene that a user names: `name` itself if such a file exists or if it is absolute, else
// the shipped scene of this name, with or without the folder scenes ("papillarray/stage.yaml"),
// else `name`.
std::string scene_path(const std::string& name);

}  // namespace slipbench
