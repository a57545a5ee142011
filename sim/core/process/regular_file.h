// Files that are safe to open (opening a pipe or a device may block for ever), and system calls
// that complete all of their work.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace slipbench {

// Throws InputError "PATH: is a pipe, no file" (a socket, a device, a folder). Does not report a
// missing file: opening it does.
void check_regular_file(const std::string& path);

// The same; also refuses a file of more than `most` bytes before it is read.
void check_regular_file(const std::string& path, std::uintmax_t most);

// These functions retry if a signal interrupts them, or if only a part is done. They return true if
// all is done; else errno has the reason.

// `at`: offset in bytes from the file's beginning.
bool write_whole(int descriptor, std::string_view bytes, std::uint64_t at);

// `notes`: also sync metadata besides the length, such as a folder's names.
bool sync_file(int descriptor, bool notes = false);

// Writes a file and syncs it. If that fails after opening, the file is removed. `flags`: further
// flags of open(), which say whether the file may exist.
bool write_synced_file(const char* path, int flags, std::string_view bytes);

}  // namespace slipbench
