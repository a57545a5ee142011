// Checks lists of files that a user names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slipbench {

// Throws InputError if two of `paths` are the same file, whose content would count twice. `what`:
// word for a file, such as "dataset". Files that do not exist are ignored; their readers report
// them.
void check_given_once(const std::vector<std::string>& paths, std::string_view what);

}  // namespace slipbench
