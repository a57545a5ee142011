// Checks the files that an MJCF file names and the sizes that it declares, before MuJoCo opens and
// allocates them.
#pragma once

#include <string>

namespace slipbench {

// Throws InputError if the file, or one that it includes or names (meshes, textures, height
// fields), is not a regular file, is larger than 100 MB or is outside of the allowed folders
// (named_files.h) by any rule for names that MuJoCo may use, and if a declaration needs excessive
// memory: a height field or a texture of more than 10^8 cells, a `count` of more than 10^6 (nested
// ones multiplied), `memory` of more than 4 GB, an `nuser` of more than 10^6, an `nkey` of more
// than 10^4, or textures, height fields and `memory` of more than 4 GB in all; and if a number is NaN. Missing files and text that is not XML are left for MuJoCo to refuse.
void check_mjcf(const std::string& path);

// Has MuJoCo parse and compile the file and ignores the result: for a process that a crash may end
// (check_readable.h).
void try_mjcf(const std::string& path);

// Returns a message of MuJoCo about the file with the likely places, "FILE:LINE", instead of its
// line 0: MuJoCo counts no lines in included files.
std::string placed_message(const std::string& path, std::string message);

// Escapes `text` for use between double quotes.
[[nodiscard]] std::string escaped(const std::string& text);

// Returns <config key="..." value="..."/>: an attribute of a plugin's instance.
[[nodiscard]] std::string config_element(const std::string& key, const std::string& value);

// Version of the loaded library, e.g. "4.0.1".
std::string mujoco_library_version();

// True if the loaded library matches the headers with which this program was built. MuJoCo keeps no
// binary compatibility between versions: after a mismatch structs would be read at wrong offsets.
bool mujoco_header_matches_library();

}  // namespace slipbench
