// The user's own browser.
#pragma once

#include <optional>
#include <string>

namespace slipbench {

// Opens the file at `path` in the user's browser (README.md says in which) and does not wait for its end. Returns which program has opened it,
// or nothing where there is no screen or no such program.
std::optional<std::string> open_in_browser(const std::string& path);

}  // namespace slipbench
