// The memories that ship with the program.
#pragma once

#include <string>

namespace slipbench::hd {

// The one that a scene gets when it names none.
inline constexpr const char* default_memories = "cl_gst_hd";

// Folder of the shipped classifier `name`, found from the place of the running program (share/slipbench/memories/hd beside its bin).
// Throws InputError when there is no such folder: where it was looked for.
std::string shipped_memories(const std::string& name);

// Folder of the classifier `name` on a command line: that folder where there is one, else the shipped one where it is
// default_memories, else `name` as it is.
std::string memories_folder(const std::string& name);

}  // namespace slipbench::hd
