// The releases of MuJoCo for which the pads know the layout of models and data.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/mujoco/releases/members.h"

namespace slipbench {

// Returns the versions in layouts.h, oldest first: "3.3.7".
[[nodiscard]] std::vector<std::string> known_releases();

// Returns the layout of a release: that of layouts.h, otherwise that of a library which the
// command of how_to_add() has written to `folder`, the folder of the plugin. Empty if there is
// neither, or if the library was compiled for another version of slipbench.
[[nodiscard]] std::optional<SlipbenchLayout> find_layout(const std::string& version, const std::string& folder);

// Returns a sentence for a release without a layout: the known releases, and the command that
// compiles the layout of this one. `mujoco_file`: path of the release's libmujoco, beside or above
// which its headers are searched; if they are not found, the command has a placeholder.
[[nodiscard]] std::string how_to_add(const std::string& version, const std::string& folder, const std::string& mujoco_file);

}  // namespace slipbench
