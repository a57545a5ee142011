#include "tools/learning_data/label_rules.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/slip_path.h"
#include "tools/files/reject.h"
#include "tools/learning_data/samples.h"

namespace slipbench {
namespace {

// A pillar slips from the first sample in which its tip is fast until it loses contact.
std::vector<PadState> has_slipped(const SensorRecord& sensor, bool turning) {
  const PapillarraySamples samples(sensor, LabelRule::has_slipped, default_label_speed);
  std::vector<PadState> states;
  for (std::size_t row = 0; row < samples.size(); ++row) states.push_back(samples.pad_state(row, turning));
  return states;
}

std::vector<PadState> checked_states(const SensorRecord& sensor, const std::vector<std::uint8_t>& codes, LabelRule rule) {
  if (codes.size() != sensor.time.size()) {
    reject("labels/{}: {} by the labels {} for {}; expected one for each", sensor.name, counted(codes.size(), "state"),
           label_rule_name(rule), counted(sensor.time.size(), "sample"));
  }
  std::vector<PadState> states;
  states.reserve(codes.size());
  for (const std::uint8_t code : codes) {
    const auto state = static_cast<PadState>(code);
    const bool unlabelled = !sensor.labels.truth && state == unknown_state;
    if (state > PadState::gross && !unlabelled) reject("labels/{}: state {}; allowed: 0 to 3", sensor.name, code);
    states.push_back(state);
  }
  return states;
}

// The object slides if it moved over the pad at 1 mm/s or more in the latest 0.1 s, and is held at less than
// 0.5 mm/s. Nobody needs an alarm of a slower creep, and a camera that labels recordings does not see it.
std::vector<PadState> slides(const SensorRecord& sensor, bool) {
  constexpr double span = 0.1, least = 1e-3, most_of_hold = 0.5e-3;  // s, m/s, m/s
  const std::vector<double> path = slip_path(sensor.labels, sensor.time.size());
  if (path.empty()) reject("labels/{}: have no slip distance; expected those of `slipbench sweep`", sensor.name);
  std::vector<PadState> states = checked_states(sensor, sensor.labels.state_micro, LabelRule::slides);
  std::size_t first = 0;
  for (std::size_t row = 0; row < states.size(); ++row) {
    // At least one step, also of a sensor that is slower.
    while (first + 1 < row && sensor.time[row] - sensor.time[first] > span * (1.0 + 1e-6)) ++first;
    if (states[row] == PadState::no_contact) continue;
    const double speed = (path[row] - path[first]) / std::max(span, sensor.time[row] - sensor.time[first]);
    states[row] = speed >= least ? PadState::gross : speed < most_of_hold ? PadState::non_slip : unknown_state;
  }
  return states;
}

constexpr std::array rules{LabelRuleInfo{.name = "strict",
                                         .value = LabelRule::strict,
                                         .meaning = "a unit counts as slipping when all of it slips",
                                         .stored = &LabelRecord::state,
                                         .whole_unit = true,
                                         .pillar_meaning = "all of it slips"},
                           LabelRuleInfo{.name = "micro",
                                         .value = LabelRule::micro,
                                         .meaning = "a unit counts as slipping as soon as a part of it slips",
                                         .stored = &LabelRecord::state_micro,
                                         .pillar_meaning = "a part of it slips"},
                           LabelRuleInfo{.name = "paper",
                                         .value = LabelRule::paper,
                                         .meaning = "the rule of the sensor's publication",
                                         .stored = &LabelRecord::state_paper,
                                         .pillar_meaning = "its tip slides faster than {speed}"},
                           LabelRuleInfo{.name = "latched",
                                         .value = LabelRule::latched,
                                         .meaning = "micro, and slip lasts until contact is lost",
                                         .stored = &LabelRecord::state_micro,
                                         .after_slip = AfterSlip::slip},
                           LabelRuleInfo{.name = "masked",
                                         .value = LabelRule::masked,
                                         .meaning = "micro without the frames that stick again after a slip",
                                         .stored = &LabelRecord::state_micro,
                                         .after_slip = AfterSlip::masked},
                           LabelRuleInfo{.name = "tightened",
                                         .value = LabelRule::tightened,
                                         .meaning = "masked on a stage, micro in a grasp",
                                         .stored = &LabelRecord::state_micro,
                                         .after_slip = AfterSlip::masked_on_stage,
                                         .evaluated_by = LabelRule::masked},
                           LabelRuleInfo{.name = "moved",
                                         .value = LabelRule::moved,
                                         .meaning = "tightened, but only slips that move the object by 0.05 mm or more count",
                                         .stored = &LabelRecord::state_micro,
                                         .after_slip = AfterSlip::masked_on_stage,
                                         .least_distance = true,
                                         .evaluated_by = LabelRule::masked},
                           LabelRuleInfo{.name = "slides",
                                         .value = LabelRule::slides,
                                         .meaning = "the object moves over the pad at 1 mm/s or more; 0.5 to 1 mm/s is left out",
                                         .computed = &slides,
                                         .evaluated_by = LabelRule::masked},
                           LabelRuleInfo{.name = "has_slipped",
                                         .value = LabelRule::has_slipped,
                                         .meaning = "PapillArray: a pillar whose tip was fast slips until it loses contact",
                                         .computed = &has_slipped,
                                         .pillar_meaning = "its tip has been faster than {speed} since it touched",
                                         .sensor = "papillarray"},
                           LabelRuleInfo{.name = "recorded",
                                         .value = LabelRule::recorded,
                                         .meaning = "the labels of imported recordings",
                                         .stored = &LabelRecord::state_paper}};

bool takes(LabelUse use, const LabelRuleInfo& rule) {
  switch (use) {
    case LabelUse::pillars: return rule.pillar_meaning != nullptr;
    case LabelUse::training: return rule.sensor == nullptr;
    case LabelUse::evaluation: return rule.evaluated_by == rule.value;
  }
  return false;
}

std::vector<LabelRuleInfo> rules_for(std::optional<LabelUse> use) {
  std::vector<LabelRuleInfo> taken;
  std::ranges::copy_if(rules, std::back_inserter(taken), [use](const LabelRuleInfo& rule) { return !use || takes(*use, rule); });
  return taken;
}

}  // namespace

std::span<const LabelRuleInfo> label_rules() { return rules; }

const LabelRuleInfo& about_rule(LabelRule rule) { return rules.at(static_cast<std::size_t>(rule)); }

std::string array_of(const LabelRuleInfo& rule) {
  const LabelRecord labels;
  std::string array;
  if (rule.stored == nullptr || rule.after_slip != AfterSlip::stick) return array;
  for_each_label(labels, 0, [&](const char* name, const char*, const Extents&, const auto& column) {
    if (static_cast<const void*>(&column) == &(labels.*rule.stored)) array = name;
  });
  return array;
}

std::vector<LabelRuleInfo> stored_rules() {
  std::vector<LabelRuleInfo> stored;
  std::ranges::copy_if(rules, std::back_inserter(stored),
                       [](const LabelRuleInfo& rule) { return rule.value != LabelRule::recorded && !array_of(rule).empty(); });
  return stored;
}

std::string label_rule_name(LabelRule rule) { return about_rule(rule).name; }

std::vector<std::string> label_rule_names(std::optional<LabelUse> use) { return choice_names(rules_for(use)); }

LabelRule parse_label_rule(const std::string& name, std::optional<LabelUse> use) {
  if (const std::optional<LabelRule> rule = choice_value(rules_for(use), name)) return *rule;
  if (choice_value(rules_for({}), name)) {
    reject("the label rule {} is not for this use; allowed: {}", quote(name), fmt::join(label_rule_names(use), ", "));
  }
  reject("unknown label rule {}{}", quote(name), allowed_names(name, label_rule_names(use)));
}

std::string rules_of_truth(LabelUse use) {
  std::vector<std::string> names;
  for (const LabelRuleInfo& rule : rules_for(use)) {
    if (rule.value != LabelRule::recorded && rule.sensor == nullptr) names.emplace_back(rule.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string label_rules_text(LabelUse use) {
  std::string text;
  for (const LabelRuleInfo& rule : rules_for(use)) text += fmt::format("  {:<12} {}\n", rule.name, rule.meaning);
  return text;
}

std::vector<PadState> states_by(const SensorRecord& sensor, LabelRule rule, bool turning, LabelUse use) {
  const LabelRuleInfo& about = about_rule(rule);
  const LabelRecord& labels = sensor.labels;
  const bool recorded = rule == LabelRule::recorded;
  if (recorded == labels.truth) {
    reject("sensor {}: is {} and has no labels {}; allowed: --labels {}", sensor.name, labels.truth ? "simulated" : "recorded",
           about.name, labels.truth ? rules_of_truth(use) : "recorded");
  }
  if (recorded && labels.state_paper.empty()) {
    reject(
        "labels/{}: the recording has no labels; use `slipbench detect`, which needs none, or import it with the key state in the map",
        sensor.name);
  }
  if (about.sensor != nullptr && sensor.type != about.sensor) {
    reject("sensor {}: is a {}, but the rule {} needs a {}; allowed: --labels {}", sensor.name, sensor.type, about.name,
           about.sensor, rules_of_truth(use));
  }
  return about.stored != nullptr ? checked_states(sensor, labels.*about.stored, rule) : about.computed(sensor, turning);
}

}  // namespace slipbench
