// What stands beside the program, in the build as in a prefix, or beside the library that holds this code, where another program has loaded it
// (Python's module); among it libraries that are loaded when they are needed, because they take long to load or long to build.
#pragma once

#include <string>

namespace slipbench {

// Where `path`, relative to the folder of the program or of that library, leads.
std::string own_path(const std::string& path);

// The address of `symbol` in the library at own_path(path), which stays loaded. Throws InputError with the loader's reason and `remedy`,
// "allowed: ...". The handlers of SIGINT, SIGTERM and SIGHUP do not change, even if the library sets its own.
void* own_symbol(const std::string& path, const std::string& symbol, const std::string& remedy);

}  // namespace slipbench
