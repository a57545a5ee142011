// Files of the project that the program reads while it runs.
#pragma once

#include <string>

namespace slipbench {

// Where a file of the project is, given from its root ("scenes/papillarray/hexapod.yaml"): below share/slipbench of the prefix
// that the program runs from, else, for a program in its build folder, in the source tree. Throws InputError when it is in neither.
std::string project_file(const std::string& path);

}  // namespace slipbench
