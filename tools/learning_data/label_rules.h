// The rules by which a sample of a pad is labelled slip, for export, training and evaluation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/api/pad_state.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench {

enum class LabelRule : std::uint8_t { strict, micro, paper, latched, masked, tightened, moved, slides, has_slipped, recorded };

// Label of a sample that sticks after a slip, until contact is lost. Such a sample is still under the
// shear that caused the slip.
enum class AfterSlip : std::uint8_t {
  stick,
  slip,             // a slip lasts until contact is lost
  masked,           // the sample is neither used for training nor judged
  masked_on_stage,  // masked on a stage, stick in a grasp, where the grip has tightened since
};

// Uses of labels, each of which takes some of the rules.
enum class LabelUse : std::uint8_t {
  pillars,     // single pillars of a PapillArray: its logs and the training of gst_hd
  training,    // of networks
  evaluation,  // `eval`
};

// A rule: how it labels the samples of a sensor, and which uses take it.
struct LabelRuleInfo {
  const char* name;  // in commands, files and Python
  LabelRule value;
  const char* meaning;  // for help texts and the cards of exports
  // The states from which the rule derives its labels: an array of the dataset, or if null a
  // computation. `turning`: true if the motion turns the pad.
  std::vector<std::uint8_t> LabelRecord::*stored = nullptr;
  std::vector<PadState> (*computed)(const SensorRecord& sensor, bool turning) = nullptr;
  AfterSlip after_slip = AfterSlip::stick;
  // A slip that moves the object by less than least_slip_distance (tools/statistics/slip_score.h) is
  // stick. The samples of a larger slip are masked until the object has moved that far. On a stage all
  // slips of one contact are one slip.
  bool least_distance = false;
  bool whole_unit = false;  // slip begins when a first unit slips as a whole, else when a first part of one slips
  // A pillar slips while ..., for a rule that decides for each pillar (PillarLabels::slipping); null: it
  // does not. "{speed}" stands for the label speed.
  const char* pillar_meaning = nullptr;
  const char* sensor = nullptr;    // type of the only sensor that has it, not for networks; null: any sensor
  LabelRule evaluated_by = value;  // rule by which `eval` judges detectors that were trained with this one
};

// All rules in the order of LabelRule.
std::span<const LabelRuleInfo> label_rules();
const LabelRuleInfo& about_rule(LabelRule rule);

// Array of a sensor's labels that contains the states of the rule, such as "state_micro"; empty if
// the rule changes or computes states.
std::string array_of(const LabelRuleInfo& rule);
// Rules of simulated trials for which array_of() is not empty.
std::vector<LabelRuleInfo> stored_rules();

std::string label_rule_name(LabelRule rule);
// `use`: empty for the rules of any use.
std::vector<std::string> label_rule_names(std::optional<LabelUse> use = {});
// Throws InputError for an unknown name, with the nearest one, and for a rule that `use` does not take.
LabelRule parse_label_rule(const std::string& name, std::optional<LabelUse> use = {});
// "strict, micro, ...": the rules of simulated trials of any sensor that a use takes, for errors.
std::string rules_of_truth(LabelUse use);
// Lines "  strict       a unit counts as slipping when all of it slips" of the rules for a use, for help texts.
std::string label_rules_text(LabelUse use);

// The pad's state in each sample of a sensor, [T], from which the rule derives its labels, before
// AfterSlip and least_distance; unknown_state where the labels of a recording say so. Throws InputError
// for labels that the sensor does not have, with those that `use` takes, and for labels that are invalid
// or not one per sample.
std::vector<PadState> states_by(const SensorRecord& sensor, LabelRule rule, bool turning, LabelUse use);

}  // namespace slipbench
