// What an MJCF file names and declares, looked at before MuJoCo opens and allocates it.
#pragma once

#include <string>

namespace slipbench {

// Throws InputError where the file, or one that it includes or names (meshes, textures, fields of heights), is no regular file or
// larger than 100 MB, and where a declaration takes memory out of all measure: a field of heights or a texture of more than 10^8
// cells, a `count` of more than 10^6, nested ones multiplied, `memory` of more than 4 GB, an `nuser` of more than 10^6, an `nkey` of more than 10^4. What cannot be
// found or is not XML is MuJoCo's to refuse.
void check_mjcf(const std::string& path);

// Has MuJoCo parse and compile the file, whatever it says of it: for a process that a crash may end (check_readable.h).
void try_mjcf(const std::string& path);

// A message of MuJoCo about the file, with the places that it may mean, "FILE:LINE", instead of its line 0: of what is included it counts no lines.
std::string placed_message(const std::string& path, std::string message);

// `text` as it stands between double quotes.
[[nodiscard]] std::string escaped(const std::string& text);

// <config key="..." value="..."/>: an attribute of a plugin's instance.
[[nodiscard]] std::string config_element(const std::string& key, const std::string& value);

// Version of the library that was loaded, e.g. "4.0.1".
std::string mujoco_library_version();

// Whether the loaded library is the one whose headers this program was built with. MuJoCo keeps no binary compatibility between
// versions, so a mismatch means that structs are read at wrong offsets.
bool mujoco_header_matches_library();

}  // namespace slipbench
