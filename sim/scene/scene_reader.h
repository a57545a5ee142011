// From a tree of YAML values to a checked Scene.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sim/scene/catalogues.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// A key at the root of a scene.
struct SceneKey {
  std::string_view name;
  std::string_view doc;  // one sentence: what it holds
};

// All root keys, in alphabetical order.
std::span<const SceneKey> scene_keys();

// Reads the tree of a scene without its key `sweep`. Throws InputError at the first error; at the
// root's line if a default name (such as the motion 'stage') is not in its catalogue. `trace` may
// be null.
Scene read_scene(const YamlNode& root, const Catalogues& catalogues, Trace* trace);

// Returns the scene's `seed`, 0 if it has none. Throws InputError if it is not an unsigned 64-bit
// integer.
std::uint64_t read_seed(const YamlNode& root);

}  // namespace slipbench
