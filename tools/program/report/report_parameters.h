// The values that were drawn for each trial, as axes of the overview.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/json.h"

namespace slipbench::report {

// Turns one drawn value into {"value": number in SI, "unit": SI symbol} or {"text": ...}. Text such as "4 mm/s" becomes a number.
// An infinite number, which JSON does not have, is {"value": null, "unit"}. A bare number takes the unit of the scene key that ends `path` ("motion.speed": m/s), "" where the key is not known.
Json plain_value(const std::string& path, const Json& drawn);

// The axes of the sweep: every path of any trial, in the order of first appearance, as
// {"path", "unit", "numeric": every trial that has it has a number, "varied": not the same in all trials}.
// `trials`: each {path: plain_value}.
Json axes(const std::vector<Json>& trials);

}  // namespace slipbench::report
