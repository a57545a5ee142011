// Reads the keys for bodies that move by forces.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/scene.h"
#include "sim/scene/yaml_tree.h"

namespace slipbench {

// Reads the keys for bodies that move by forces, and refuses them if there are none. `scene`: read
// except for these keys, detector, controller and expectations. Records into the trace of `reader`.
// Throws InputError at the node that does not fit.
void read_dynamics(const EntryReader& reader, const YamlNode& root, const Catalogues& catalogues, Scene& scene);

// Returns the value of `key` in the scene; null if it is missing or withdrawn.
const YamlNode* find_kept(const YamlNode& root, std::string_view key);

// Returns the path of an entry of the map `list`. The entry names a `what` by an identifier and
// selects by `selector` one of `entries`. Throws InputError if it does not; `allowed`: the content
// of the entry, for messages.
std::string named_part(const YamlNode& node, const std::string& list, const std::string& what, const std::string& allowed,
                       const std::string& selector, const std::vector<Entry>& entries);

}  // namespace slipbench
