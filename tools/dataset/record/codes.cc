#include "tools/dataset/record/codes.h"

#include <string>

#include <fmt/format.h>

#include "sim/api/pad_state_names.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {
namespace {

// {"first":0,"second":1, ...} without the braces.
template <class Choices>
std::string members_of(const Choices& choices) {
  std::string text;
  for (const auto& choice : choices)
    text += fmt::format(R"({}"{}":{})", text.empty() ? "" : ",", choice.name, static_cast<int>(choice.value));
  return text;
}

}  // namespace

std::string_view codes_of(std::string_view array) {
  static const std::string of_units = "{" + members_of(unit_states) + "}";
  static const std::string of_events = "{" + members_of(event_kinds) + "}";
  static const std::string of_pads = "{" + members_of(pad_states) + "}";
  if (array == "unit_state") return of_units;
  if (array == "events/kind") return of_events;
  if (array == "state" || array == "state_micro" || array == "state_paper" || array == "detector_class") return of_pads;
  return {};
}

std::string_view codes_with_unknown() {
  static const std::string codes =
      fmt::format(R"({{{},"{}":{}}})", members_of(pad_states), unknown_state_name, static_cast<int>(unknown_state));
  return codes;
}

std::string_view shown_unit(std::string_view array, std::string_view unit) {
  if (!codes_of(array).empty()) return "code";
  if (array == "events/unit") return "index";
  if (array == "command" || array == "measured_position") return "counts";
  return unit;
}

}  // namespace slipbench
