// JSON whose keys stay in the order in which they were put in.
#pragma once

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace slipbench {

using Json = nlohmann::ordered_json;

// JSON has neither NaN nor infinity: null stands for them, and for what is not there.
inline Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }
template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace slipbench
