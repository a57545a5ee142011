// Files that are safe to open: opening a pipe or a device may block for ever. And system calls that do all of their work.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace slipbench {

// Throws InputError "PATH: is a pipe, no file" (a socket, a device, a folder). Says nothing where nothing stands: opening it says
// why.
void check_regular_file(const std::string& path);

// The same, and refuses a file of more than `most` bytes before anything of it is read.
void check_regular_file(const std::string& path, std::uintmax_t most);

// These go on where a signal ends them early, or where they have done a part. True where all is done; else errno says why not.

// `at`: bytes from the file's beginning.
bool write_whole(int descriptor, std::string_view bytes, std::uint64_t at);

// `notes`: also what the system notes of it beside its length, as a folder's names.
bool sync_file(int descriptor, bool notes = false);

// Writes a file and syncs it; where that fails after it was opened, it is removed. `flags` of open(): what may stand there.
bool write_synced_file(const char* path, int flags, std::string_view bytes);

}  // namespace slipbench
