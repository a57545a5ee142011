// Files that are safe to open: opening a pipe or a device may block for ever.
#pragma once

#include <cstdint>
#include <string>

namespace slipbench {

// Throws InputError "PATH: is a pipe, no file" (a socket, a device, a folder). Says nothing where nothing stands: opening it says
// why.
void check_regular_file(const std::string& path);

// The same, and refuses a file of more than `most` bytes before anything of it is read.
void check_regular_file(const std::string& path, std::uintmax_t most);

}  // namespace slipbench
