// How a scene's trials are split for learning.
#pragma once

#include <optional>
#include <string>

#include "sim/scene/scene.h"
#include "tools/base/dataset/header.h"

namespace slipbench {

// The scene's `split`; empty where it has none.
std::optional<SplitRule> split_rule(const Scene& scene);

// What the trial has in common with those that must be in the same part: its material, or what else the scene's `split` says. An
// object is what the pads touch, its material and shape, wherever it stands. Throws SceneValueError where the scene splits by
// speed and its motion has none.
std::string split_group(const Scene& scene);

}  // namespace slipbench
