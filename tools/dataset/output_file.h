// What may be written to, and files that appear whole.
#pragma once

#include <string>

namespace slipbench {

// Whether there is a file at `path` that begins with the signature of HDF5, as every dataset does.
bool begins_as_hdf5(const std::string& path);

// Throws InputError when a file cannot be put at `path`: no file name, a folder, a special file, a symbolic link (which would be
// replaced, not followed), a read-only file, a missing folder.
void check_target(const std::string& path);

// The same for a file made from the dataset `input`, written by write_text_file. Refuses besides what would destroy a dataset:
// the input itself and whatever begins as HDF5 does.
void check_text_target(const std::string& path, const std::string& input);

// Writes `text` to PATH.partial, syncs it and renames it. Throws InputError when that is not possible; then nothing is left behind.
void write_text_file(const std::string& path, const std::string& text);

}  // namespace slipbench
