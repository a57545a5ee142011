// Files beside the program, in the build tree or in a prefix, or beside the library that holds this
// code if another program has loaded it (Python's module). Some are libraries that are loaded on
// demand, because they take long to load or long to build.
#pragma once

#include <string>

namespace slipbench {

// Resolves `path` relative to the folder of the program or of that library.
std::string own_path(const std::string& path);

// Returns the address of `symbol` in the library at own_path(path), which stays loaded. Throws
// InputError with the loader's reason and `remedy`, "allowed: ...". The handlers of SIGINT, SIGTERM
// and SIGHUP do not change, even if the library sets its own.
void* own_symbol(const std::string& path, const std::string& symbol, const std::string& remedy);

}  // namespace slipbench
