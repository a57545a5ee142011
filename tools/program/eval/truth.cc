#include "tools/program/eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "sim/core/contact_frame.h"
#include "sim/core/error.h"
#include "sim/motion/motion.h"
#include "tools/program/samples/samples.h"

namespace slipbench::eval {
namespace {

constexpr std::array<std::pair<const char*, TruthRule>, 6> rules{{{"strict", TruthRule::strict},
                                                                  {"micro", TruthRule::micro},
                                                                  {"paper", TruthRule::paper},
                                                                  {"latched", TruthRule::latched},
                                                                  {"masked", TruthRule::masked},
                                                                  {"has_slipped", TruthRule::has_slipped}}};

std::vector<PadState> latched(std::vector<PadState> states) {
  PadState held = PadState::no_contact;
  for (PadState& state : states) {
    const bool slipped = held == PadState::incipient || held == PadState::gross;
    held = state == PadState::no_contact || !slipped ? state : std::max(state, held);
    state = held;
  }
  return states;
}

// Which samples stick after a slip of the same contact.
std::vector<bool> stuck_again(const std::vector<PadState>& states) {
  std::vector<bool> masked;
  bool slipped = false;
  for (const PadState state : states) {
    if (state == PadState::no_contact) slipped = false;
    if (state == PadState::incipient || state == PadState::gross) slipped = true;
    masked.push_back(slipped && state == PadState::non_slip);
  }
  return masked;
}

std::vector<PadState> has_slipped(const SensorRecord& sensor, bool turning) {
  const PapillarraySamples samples(sensor, SlipRule::has_slipped, default_label_speed);
  std::vector<PadState> states;
  for (std::size_t row = 0; row < samples.size(); ++row) states.push_back(samples.pad_state(row, turning));
  return states;
}

std::vector<PadState> checked_states(const SensorRecord& sensor, const std::vector<std::uint8_t>& codes) {
  if (codes.size() != sensor.time.size()) {
    throw InputError(fmt::format("labels/{}: {} states of {} samples; needed: the true state of each", sensor.name, codes.size(),
                                 sensor.time.size()));
  }
  std::vector<PadState> states;
  for (const std::uint8_t code : codes) {
    if (code > static_cast<std::uint8_t>(PadState::gross)) {
      throw InputError(fmt::format("labels/{}: state {}; allowed: 0 to 3", sensor.name, code));
    }
    states.push_back(static_cast<PadState>(code));
  }
  return states;
}

// When the arm of a grasp begins to rise [s]. A guided one does so as its controller says, to a sample of the sensor.
double lift_start(const Scene& scene, const TrialRecord& record) {
  const Parameters& motion = scene.motion.parameters;
  if (!scene.guided()) return lift_times(motion).start;
  if (!record.control) throw InputError("is a grasp with a guided arm and without a controller, which says when it is lifted");
  const std::vector<float>& arm = record.control->grip.arm;
  for (std::size_t row = 0; 2 * row + 1 < arm.size(); ++row) {
    if (arm[2 * row + 1] > 0.0F) return record.control->time[row] + motion.number("latency");
  }
  return std::numeric_limits<double>::infinity();
}

bool turns(const Scene* scene) {
  if (scene == nullptr) return false;
  const auto& values = scene->motion.parameters.values();
  const auto rotation = values.find("rotation");
  return rotation != values.end() && std::get<double>(rotation->second) != 0.0;
}

}  // namespace

std::vector<std::string> label_rule_names() {
  std::vector<std::string> names;
  for (const auto& [name, rule] : rules) names.emplace_back(name);
  return names;
}

TruthRule parse_label_rule(const std::string& name) {
  const auto found = std::ranges::find(rules, name, [](const auto& rule) { return std::string(rule.first); });
  if (found == rules.end()) throw InputError("unknown label rule " + quote(name) + allowed_names(name, label_rule_names()));
  return found->second;
}

std::string label_rule_name(TruthRule rule) {
  return std::ranges::find(rules, rule, [](const auto& one) { return one.second; })->first;
}

std::vector<PadState> label_states(const SensorRecord& sensor, TruthRule rule, bool turning) {
  switch (rule) {
    case TruthRule::strict: return checked_states(sensor, sensor.labels.state);
    case TruthRule::micro:
    case TruthRule::masked: return checked_states(sensor, sensor.labels.state_micro);
    case TruthRule::paper: return checked_states(sensor, sensor.labels.state_paper);
    case TruthRule::latched: return latched(checked_states(sensor, sensor.labels.state_micro));
    case TruthRule::has_slipped: break;
  }
  if (sensor.type != "papillarray") {
    throw InputError(fmt::format(
        "sensor {}: is a {}; the rule has_slipped is the PapillArray's, allowed: strict, micro, paper, latched, masked",
        sensor.name, sensor.type));
  }
  return has_slipped(sensor, turning);
}

double first_slip(const SensorRecord& sensor, TruthRule rule, const std::vector<PadState>& states, double from) {
  const LabelRecord& labels = sensor.labels;
  if (labels.event_time.empty()) {
    for (std::size_t row = 0; row < states.size(); ++row) {
      if (states[row] >= PadState::incipient && sensor.time[row] >= from) return sensor.time[row];
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  const bool parts = rule != TruthRule::strict || labels.units() == 1;
  double first = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < labels.event_time.size(); ++k) {
    const auto kind = static_cast<EventKind>(labels.event_kind[k]);
    const bool begins = kind == EventKind::slip || (parts && kind == EventKind::micro);
    if (begins && labels.event_time[k] >= from) first = std::fmin(first, labels.event_time[k]);
  }
  return first;
}

Truth truth_of(const Scene* scene, const TrialRecord& record, const SensorRecord& sensor, TruthRule rule) {
  Truth truth;
  truth.time = sensor.time;
  truth.state = label_states(sensor, rule, turns(scene));
  if (rule == TruthRule::masked) truth.masked = stuck_again(truth.state);
  truth.stuck_fraction = sensor.labels.stuck_fraction;
  truth.period = 1.0 / sensor.rate;
  truth.any_slip = first_slip(sensor, rule, truth.state, truth.judged_from);
  // A grasp that is no simulation's does not say when it was lifted: all of its samples count.
  if (record.outcome.grasp && scene != nullptr) {
    truth.judged_from = lift_start(*scene, record);
    if (record.outcome.grasp->dropped) truth.judged_until = record.outcome.grasp->drop_time;
  }
  truth.first_slip = first_slip(sensor, rule, truth.state, truth.judged_from);
  return truth;
}

}  // namespace slipbench::eval
