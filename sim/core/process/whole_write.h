// System calls about a file that go on where a signal ends them early, or where they have done a part. True where all is done; else errno says why
// not.
#pragma once

#include <cstdint>
#include <string_view>

namespace slipbench {

// `at`: bytes from the file's beginning.
bool write_whole(int descriptor, std::string_view bytes, std::uint64_t at);

// `notes`: also what the system notes of it beside its length, as a folder's names.
bool sync_file(int descriptor, bool notes = false);

// Writes a file and syncs it; where that fails after it was opened, it is removed. `flags` of open(): what may stand there.
bool write_synced_file(const char* path, int flags, std::string_view bytes);

}  // namespace slipbench
