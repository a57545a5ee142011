#include "tools/report/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sim/core/quantity.h"

namespace slipbench::report {

namespace {

constexpr std::array quantities = {Quantity::length,
                                   Quantity::time,
                                   Quantity::speed,
                                   Quantity::acceleration,
                                   Quantity::angle,
                                   Quantity::angular_speed,
                                   Quantity::angular_acceleration,
                                   Quantity::frequency,
                                   Quantity::force,
                                   Quantity::mass,
                                   Quantity::stiffness,
                                   Quantity::damping};

// The quantities of the scene keys that sweeps draw.
constexpr std::array<std::pair<std::string_view, Quantity>, 21> known_keys = {{
    {"speed", Quantity::speed},
    {"approach_speed", Quantity::speed},
    {"label_speed", Quantity::speed},
    {"compression", Quantity::length},
    {"gap", Quantity::length},
    {"edge_drop", Quantity::length},
    {"corner_drop", Quantity::length},
    {"pivot", Quantity::length},
    {"direction", Quantity::angle},
    {"tilt", Quantity::angle},
    {"rotation", Quantity::angular_speed},
    {"acceleration", Quantity::acceleration},
    {"angular_acceleration", Quantity::angular_acceleration},
    {"start", Quantity::time},
    {"stop", Quantity::time},
    {"reverse", Quantity::time},
    {"retract", Quantity::time},
    {"duration", Quantity::time},
    {"time_step", Quantity::time},
    {"rate", Quantity::frequency},
    {"mass", Quantity::mass},
}};

// The last part of a dotted path that is a name, not an index: "tilt" of "motion.tilt.0".
std::string_view key_of(std::string_view path) {
  while (true) {
    const std::size_t dot = path.rfind('.');
    const std::string_view last = dot == std::string_view::npos ? path : path.substr(dot + 1);
    const bool index = !last.empty() && last.find_first_not_of("0123456789") == std::string_view::npos;
    if (!index || dot == std::string_view::npos) return last;
    path = path.substr(0, dot);
  }
}

Quantity quantity_of_path(const std::string& path) {
  for (const auto& [key, quantity] : known_keys) {
    if (key == key_of(path)) return quantity;
  }
  return Quantity::none;
}

std::string unit_of_path(const std::string& path) { return std::string(si_symbol(quantity_of_path(path))); }

// A list such as a pivot, entry by entry: "(4 mm, 1 mm)".
std::string list_text(const std::string& path, const Json& list) {
  std::string text;
  for (const Json& entry : list) {
    if (!text.empty()) text += ", ";
    if (entry.is_number()) {
      text += format_quantity(entry.get<double>(), quantity_of_path(path));
    } else {
      text += entry.is_string() ? entry.get<std::string>() : entry.dump();
    }
  }
  return "(" + text + ")";
}

// Text with a unit, or a bare number, as a number in SI with its symbol.
std::optional<std::pair<double, std::string>> number_with_unit(const std::string& path, const std::string& text) {
  try {
    return std::pair{parse_quantity(text, Quantity::none), unit_of_path(path)};
  } catch (const std::invalid_argument&) {
    // Not a bare number: one of the quantities below has its unit, or it is a name.
  }
  for (const Quantity quantity : quantities) {
    try {
      return std::pair{parse_quantity(text, quantity), std::string(si_symbol(quantity))};
    } catch (const std::invalid_argument&) {
      continue;
    }
  }
  return std::nullopt;
}

}  // namespace

Json plain_value(const std::string& path, const Json& drawn) {
  if (drawn.is_number()) return {{"value", drawn.get<double>()}, {"unit", unit_of_path(path)}};
  if (drawn.is_array()) return {{"text", list_text(path, drawn)}};
  if (!drawn.is_string()) return {{"text", drawn.dump()}};
  const auto text = drawn.get<std::string>();
  if (const auto number = number_with_unit(path, text)) {
    return {{"value", std::isfinite(number->first) ? Json(number->first) : Json(nullptr)}, {"unit", number->second}};
  }
  return {{"text", text}};
}

Json axes(const std::vector<Json>& trials) {
  Json list = Json::array();
  std::vector<std::string> paths;
  for (const auto& trial : trials) {
    for (const auto& [path, value] : trial.items()) {
      if (std::find(paths.begin(), paths.end(), path) == paths.end()) paths.push_back(path);
    }
  }
  for (const std::string& path : paths) {
    bool numeric = true;
    bool varied = false;
    std::string unit;
    for (const auto& trial : trials) {
      varied = varied || !trial.contains(path) || !trials.front().contains(path) || trial.at(path) != trials.front().at(path);
      if (!trial.contains(path)) continue;
      numeric = numeric && trial.at(path).contains("value");
      if (unit.empty()) unit = trial.at(path).value("unit", "");
    }
    list.push_back({{"path", path}, {"unit", unit}, {"numeric", numeric}, {"varied", varied}});
  }
  return list;
}

}  // namespace slipbench::report
