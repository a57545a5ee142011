#include "tools/dataset/record/trial_outcome.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tools/dataset/record/json.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

double number_or_nan(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

// Indexed by Detection.
constexpr std::array<std::string_view, 5> detection_words{"quiet", "false_alarm", "early", "seen", "missed"};

Detection detection_of(const std::string& word) {
  const auto found = std::ranges::find(detection_words, word);
  if (found == detection_words.end()) {
    reject("the outcome has the detection '{}'; allowed: {}", word, fmt::join(detection_words, ", "));
  }
  return static_cast<Detection>(found - detection_words.begin());
}

template <class Grasp, class Visit>
void for_each_grasp_number(Grasp&& grasp, Visit&& visit) {
  visit("drop_time_s", grasp.drop_time);
  visit("lift_height_m", grasp.lift_height);
  visit("slip_translation_m", grasp.slip_translation);
  visit("slip_rotation_rad", grasp.slip_rotation);
  visit("max_grip_force_N", grasp.max_grip_force);
  visit("final_grip_force_N", grasp.final_grip_force);
  visit("ideal_grip_force_N", grasp.ideal_grip_force);
  visit("reaction_time_s", grasp.reaction_time);
}

// All values null in JSON.
constexpr GraspOutcome no_grasp{.max_grip_force = std::numeric_limits<double>::quiet_NaN(),
                                .final_grip_force = std::numeric_limits<double>::quiet_NaN()};

}  // namespace

std::string_view detection_word(Detection detection) { return detection_words.at(static_cast<std::size_t>(detection)); }

void settle_detection(TrialOutcome& outcome, bool slips) {
  if (!std::isnan(outcome.false_alarm_time)) {
    outcome.detection = slips ? Detection::early : Detection::false_alarm;
  } else {
    outcome.detection = !slips ? Detection::quiet : std::isnan(outcome.detection_time) ? Detection::missed : Detection::seen;
  }
  if (outcome.detection != Detection::early) return;
  outcome.detection_delay = std::numeric_limits<double>::quiet_NaN();
  if (outcome.grasp) outcome.grasp->reaction_time = std::numeric_limits<double>::quiet_NaN();
}

std::string outcome_json(const TrialOutcome& outcome) {
  Json json;
  json["dropped"] = outcome.grasp ? Json(outcome.grasp->dropped) : Json(nullptr);
  json["lifted"] = outcome.grasp && outcome.grasp->lifted ? Json(*outcome.grasp->lifted) : Json(nullptr);
  for_each_grasp_number(outcome.grasp.value_or(no_grasp), [&json](const char* key, double value) { json[key] = or_null(value); });
  if (outcome.grasp && outcome.grasp->turn) {
    const TurnOutcome& turn = *outcome.grasp->turn;
    json["tilt_rad"] = turn.tilt;
    json["least_tilt_rad"] = turn.least_tilt;
    json["standing"] = turn.standing;
  }
  if (outcome.hold) {
    json["held"] = outcome.hold->held;
    json["hold_from_s"] = outcome.hold->from;
    json["moved_m"] = outcome.hold->moved;
  }
  json["touch_time_s"] = or_null(outcome.touch_time);
  json["first_micro_slip_time_s"] = or_null(outcome.first_micro_slip_time);
  json["first_slip_time_s"] = or_null(outcome.first_slip_time);
  json["gross_slip_time_s"] = or_null(outcome.gross_slip_time);
  json["max_slip_distance_m"] = or_null(outcome.max_slip_distance);
  json["false_alarm_time_s"] = or_null(outcome.false_alarm_time);
  json["detection_time_s"] = or_null(outcome.detection_time);
  json["detection_delay_s"] = or_null(outcome.detection_delay);
  if (outcome.detection) {
    json["judged_slip_time_s"] = or_null(outcome.judged_slip_time);
    json["detection"] = detection_word(*outcome.detection);
  }
  if (!outcome.saturated.empty()) json["saturated_samples"] = outcome.saturated;
  return json.dump();
}

TrialOutcome parse_outcome(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    TrialOutcome outcome;
    outcome.touch_time = number_or_nan(json.at("touch_time_s"));
    outcome.first_micro_slip_time = number_or_nan(json.at("first_micro_slip_time_s"));
    outcome.first_slip_time = number_or_nan(json.at("first_slip_time_s"));
    outcome.gross_slip_time = number_or_nan(json.at("gross_slip_time_s"));
    outcome.max_slip_distance = number_or_nan(json.at("max_slip_distance_m"));
    outcome.false_alarm_time = number_or_nan(json.value("false_alarm_time_s", Json(nullptr)));
    outcome.detection_time = number_or_nan(json.value("detection_time_s", Json(nullptr)));
    outcome.detection_delay = number_or_nan(json.value("detection_delay_s", Json(nullptr)));
    if (json.contains("detection")) {
      outcome.judged_slip_time = number_or_nan(json.at("judged_slip_time_s"));
      outcome.detection = detection_of(json.at("detection").get<std::string>());
    }
    if (const Json dropped = json.value("dropped", Json(nullptr)); !dropped.is_null()) {
      outcome.grasp = no_grasp;
      outcome.grasp->dropped = dropped.get<bool>();
      if (const Json lifted = json.value("lifted", Json(nullptr)); !lifted.is_null()) outcome.grasp->lifted = lifted.get<bool>();
      for_each_grasp_number(*outcome.grasp, [&json](const std::string& key, double& value) {
        // Datasets of versions up to 0.2.0 lack the lift height of a box.
        value = number_or_nan(key == "lift_height_m" ? json.value(key, Json(nullptr)) : json.at(key));
      });
      if (json.contains("standing")) {
        outcome.grasp->turn = {.tilt = json.at("tilt_rad").get<double>(),
                               .least_tilt = json.at("least_tilt_rad").get<double>(),
                               .standing = json.at("standing").get<bool>()};
      }
    }
    if (json.contains("held")) {
      outcome.hold = {.held = json.at("held").get<bool>(),
                      .from = json.at("hold_from_s").get<double>(),
                      .moved = json.at("moved_m").get<double>()};
    }
    if (json.contains("saturated_samples")) json.at("saturated_samples").get_to(outcome.saturated);
    return outcome;
  } catch (const nlohmann::json::exception& error) {
    reject("the outcome is not the JSON object of a trial: {}", error.what());
  }
}

}  // namespace slipbench
