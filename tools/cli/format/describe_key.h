// Describes the keys of a scene for `slipbench describe`, from the JSON Schema that editors read.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/cli/terminal.h"
#include "tools/dataset/record/json.h"

namespace slipbench {

// The keys that a scene file may have, in alphabetical order.
std::vector<std::string> scene_key_names();

// Returns the page of a key: its purpose, keys and values, defaults and allowed values. `schema`:
// scene_schema().
std::string describe_key_text(const std::string& key, const Json& schema, const Style& style, std::size_t width);
// The same as an entry of `describe --json`, with the key's part of the schema.
Json describe_key_json(const std::string& key, const Json& schema);

}  // namespace slipbench
