// From a tree of YAML values to a checked Scene.
#pragma once

#include <cstdint>

#include "sim/scene/catalogues.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// Reads the tree of a scene without its key `sweep`. Throws InputError at the first thing that is wrong. `trace` may be null.
// Throws InputError naming the root's line where a default name (the motion 'stage', say) is not in its catalogue.
Scene read_scene(const YamlNode& root, const Catalogues& catalogues, Trace* trace);

// The scene's `seed`, 0 where it has none. Throws InputError when it is no unsigned number of 64 bits.
std::uint64_t read_seed(const YamlNode& root);

}  // namespace slipbench
