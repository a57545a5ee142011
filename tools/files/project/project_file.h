// Finds files of the project that the program reads at run time.
#pragma once

#include <string>

namespace slipbench {

// Path of a project file given relative to the project's root ("scenes/papillarray/hexapod.yaml"):
// below share/slipbench of the program's install prefix, else, for a program in its build folder,
// in the source tree. Throws InputError if it is in neither.
std::string project_file(const std::string& path);

}  // namespace slipbench
