// The user's own browser.
#pragma once

#include <optional>
#include <string>

namespace slipbench {

// Opens the file at `path` in the user's browser (README.md says in which) without waiting for its end. Returns the name of the program that opened it;
// empty: there is no screen, or no program that opens a page.
std::optional<std::string> open_in_browser(const std::string& path);

}  // namespace slipbench
