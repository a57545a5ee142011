// An exploration as the one JSON object of `slipbench cost --json` and of the written file, which the page is made of.
#pragma once

#include <nlohmann/json.hpp>

#include "tools/program/cost/explore.h"

namespace slipbench::cost {

// Numbers in SI; shares of 1. README.md lists the keys. `environment`: environment_json().
nlohmann::ordered_json cost_json(const Exploration& exploration, const nlohmann::ordered_json& environment);

}  // namespace slipbench::cost
