// Values inside a sweep, by their path.
#pragma once

#include <string>
#include <vector>

#include "sim/scene/yaml_tree.h"

namespace slipbench {

// "sweep.PATH" split into the keys and numbers that lead to what it names in the scene file `root`. A value that an entry of the sweep has is named by the
// entry and what follows: "sweep.motion.0.site.1" of an axis of maps, "sweep.motion.compression.median" of a draw. Anything else is an entry of its own:
// "sweep.motion.speed". Throws InputError for an empty part.
std::vector<std::string> swept_parts(const YamlNode& root, const std::string& path);

}  // namespace slipbench
