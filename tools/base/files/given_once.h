// Lists of files that a user names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace slipbench {

// Throws InputError where two of `paths` are one file, whose content would count twice. `what`: the word for a file, such as
// "dataset". Files that do not exist are left to their readers.
void check_given_once(const std::vector<std::string>& paths, std::string_view what);

}  // namespace slipbench
