// What truly happened in a recorded trial, as a detector is judged by it.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "sim/core/pad_state.h"
#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::eval {

// By which rule a sensor's pad slips in a sample.
enum class TruthRule {
  strict,       // labels/state: a unit slips when all of it slips
  micro,        // labels/state_micro: as soon as a part of it does
  paper,        // labels/state_paper: as the sensor's paper has it
  latched,      // micro, and what has slipped stays so until the whole pad loses contact, though it may have come to rest
  masked,       // micro, and what sticks again after a slip, before contact is lost, is neither right nor wrong
  has_slipped,  // of a PapillArray alone: a pillar whose tip was fast (SlipRule) stays so until it loses contact
};

// "strict", ... The parser throws InputError with the nearest name.
std::vector<std::string> label_rule_names();
TruthRule parse_label_rule(const std::string& name);
std::string label_rule_name(TruthRule rule);

// The pad's state in each sample of a sensor, [T]. `turning`: the motion turns the pad, which has_slipped asks. Throws InputError for
// has_slipped of another sensor, and for labels that are no states or not one a sample.
std::vector<PadState> label_states(const SensorRecord& sensor, TruthRule rule, bool turning);

// When slip first begins at or after `from` [s]: resolved inside the step where the labels have events, else the first sample that slips; NaN:
// never. Of the rule strict it is a first unit as a whole; of the others, and of a pad of a single unit, a first part of a unit: a camera
// sees a tip move as soon as a part of it lets go. `states`: label_states() by that rule.
double first_slip(const SensorRecord& sensor, TruthRule rule, const std::vector<PadState>& states, double from);

struct Truth {
  std::vector<double> time;           // [T] s, samples of the sensor
  std::vector<PadState> state;        // [T]
  std::vector<bool> masked;           // [T] no frame to be judged by, though alarms in it count; empty: none is
  std::vector<float> stuck_fraction;  // [T], NaN while nothing touches
  double period = 0.0;                // s, from one sample to the next

  double first_slip = std::numeric_limits<double>::quiet_NaN();  // s, the one to be judged by: in a grasp the first of the lift
  // Closing fingers may make a grasp's sensor slip; from then until the lift no alarm counts, and none from a drop on.
  double any_slip = std::numeric_limits<double>::quiet_NaN();     // s, the first at all
  double judged_from = -std::numeric_limits<double>::infinity();  // s, the lift's beginning
  double judged_until = std::numeric_limits<double>::infinity();  // s, the drop

  // Whether an alarm at that time counts (dataset/README.md, How the detector did).
  [[nodiscard]] bool counts(double t) const { return (!(t >= any_slip) || t >= judged_from) && !(t >= judged_until); }
};

// That of one sensor of a trial. `scene`: recorded_scene(); null: the trial is no simulation's, and all of it counts. Throws InputError as
// label_states(), and for a guided grasp without a controller, which says when it is lifted.
Truth truth_of(const Scene* scene, const TrialRecord& record, const SensorRecord& sensor, TruthRule rule);

}  // namespace slipbench::eval
