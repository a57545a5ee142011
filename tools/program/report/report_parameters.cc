#include "tools/program/report/report_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sim/core/quantity.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::report {
namespace {

// Scene keys that are no entry's parameter.
constexpr std::array<std::pair<std::string_view, Quantity>, 3> scene_keys = {{
    {"duration", Quantity::time},
    {"time_step", Quantity::time},
    {"label_speed", Quantity::speed},
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

// Whose parameters stand below the first part of a path: "motion" of "motion.speed".
const std::vector<Entry>& entries_below(std::string_view first) {
  static const Catalogues catalogues = program_catalogues();
  static const std::vector<Entry> none;
  static const std::array<std::pair<std::string_view, const std::vector<Entry>*>, 10> places{
      {{"motion", &catalogues.motions},
       {"sensors", &catalogues.sensors},
       {"surface", &catalogues.surfaces},
       {"effects", &catalogues.effects},
       {"detector", &catalogues.detectors},
       {"controller", &catalogues.controllers},
       {"box", &catalogues.grasp},
       {"grip", &catalogues.grasp},
       {"scatter", &catalogues.grasp},
       {"bodies", &catalogues.bodies}}};
  const auto found = std::ranges::find(places, first, &std::pair<std::string_view, const std::vector<Entry>*>::first);
  return found == places.end() ? none : *found->second;
}

// What the path's parameter is measured in, where all entries that have one of this name agree; the path does not say which entry
// it is.
Quantity quantity_of_path(const std::string& path) {
  const std::string_view key = key_of(path);
  // What a plugin's library declares is in no catalogue, whatever it is called.
  if (path.starts_with("detector.parameters.") || path.starts_with("controller.parameters.")) return Quantity::none;
  std::optional<Quantity> found;
  for (const Entry& entry : entries_below(std::string_view(path).substr(0, path.find('.')))) {
    for (const ParameterSpec& spec : entry.parameters) {
      if (spec.name != key) continue;
      if (found && *found != spec.quantity) return Quantity::none;
      found = spec.quantity;
    }
  }
  if (found) return *found;
  for (const auto& [known, quantity] : scene_keys) {
    if (known == key) return quantity;
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

// Text with a unit, or a bare number, as a number in SI with its symbol; empty: it is a name.
std::optional<std::pair<double, std::string>> number_with_unit(const std::string& path, const std::string& text) {
  try {
    const Quantity quantity = quantity_of(text);
    return std::pair{parse_quantity(text, quantity),
                     quantity == Quantity::none ? unit_of_path(path) : std::string(si_symbol(quantity))};
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
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
  std::vector<std::string> paths;
  for (const Json& trial : trials) {
    for (const auto& [path, value] : trial.items()) {
      if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
    }
  }
  Json list = Json::array();
  for (const std::string& path : paths) {
    Json axis{{"path", path}, {"unit", ""}, {"numeric", true}, {"varied", false}};
    for (const Json& trial : trials) {
      const Json value = trial.value(path, Json());
      if (value != trials.front().value(path, Json())) axis["varied"] = true;
      if (value.is_null()) continue;
      if (!value.contains("value")) axis["numeric"] = false;
      if (axis["unit"].get_ref<const std::string&>().empty()) axis["unit"] = value.value("unit", "");
    }
    list.push_back(std::move(axis));
  }
  return list;
}

}  // namespace slipbench::report
