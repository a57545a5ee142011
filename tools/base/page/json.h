// JSON whose keys stay in the order in which they were put in.
#pragma once

#include <nlohmann/json.hpp>

namespace slipbench {

using Json = nlohmann::ordered_json;

}  // namespace slipbench
