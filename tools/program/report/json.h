// The JSON type of the page's data: keys stay in the order in which they were put in.
#pragma once

#include <nlohmann/json.hpp>

namespace slipbench::report {

using Json = nlohmann::ordered_json;

}  // namespace slipbench::report
