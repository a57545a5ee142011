#include "tools/program/train/delays.h"

#include <algorithm>
#include <cmath>

#include "tools/base/record/trial_record.h"

namespace slipbench {

void Delays::add(std::span<const double> time, std::span<const PadState> called, double onset) {
  ++sequences;
  const auto alarm =
      std::ranges::find_if(called, [](PadState state) { return state == PadState::incipient || state == PadState::gross; });
  TrialOutcome outcome;
  if (alarm != called.end()) {
    const double first = time[static_cast<std::size_t>(alarm - called.begin())];
    (first >= onset ? outcome.detection_time : outcome.false_alarm_time) = first;  // without an onset it is a false alarm
  }
  settle_detection(outcome, !std::isnan(onset));
  if (!std::isnan(onset)) ++slipping;
  switch (*outcome.detection) {
    case Detection::quiet: break;
    case Detection::false_alarm: ++false_alarms; break;
    case Detection::early: ++early; break;
    case Detection::seen: delay.push_back(outcome.detection_time - onset); break;
    case Detection::missed: ++missed; break;
  }
}

void Delays::add(const Delays& other) {
  delay.insert(delay.end(), other.delay.begin(), other.delay.end());
  early += other.early;
  missed += other.missed;
  false_alarms += other.false_alarms;
  slipping += other.slipping;
  sequences += other.sequences;
}

}  // namespace slipbench
