// JSON with keys in insertion order.
#pragma once

#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

namespace slipbench {

using Json = nlohmann::ordered_json;

// null for NaN, infinity and missing values, which JSON cannot represent.
inline Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }
template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

}  // namespace slipbench
