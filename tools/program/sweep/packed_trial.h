// What a trial consists of, for its way from the process that has simulated it (tools/base/workers/child_process.h).
#pragma once

#include <tuple>

#include "tools/base/record/encoder.h"
#include "tools/base/workers/child_process.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

template <MaybeConst<EncodedArray> Value>
auto fields_of(Value& array) {
  return std::tie(array.path, array.unit, array.codes, array.type, array.shape, array.chunk_rows, array.chunks);
}

template <MaybeConst<EncodedAttribute::Doubles> Value>
auto fields_of(Value& doubles) {
  return std::tie(doubles.shape, doubles.values);
}

template <MaybeConst<EncodedAttribute> Value>
auto fields_of(Value& attribute) {
  return std::tie(attribute.path, attribute.name, attribute.value);
}

template <MaybeConst<EncodedTrial> Value>
auto fields_of(Value& trial) {
  return std::tie(trial.trial, trial.material, trial.arrays, trial.attributes, trial.digest);
}

template <MaybeConst<TrialOutcome> Value>
auto fields_of(Value& outcome) {
  return std::tie(outcome.touch_time, outcome.first_micro_slip_time, outcome.first_slip_time, outcome.gross_slip_time,
                  outcome.max_slip_distance, outcome.false_alarm_time, outcome.detection_time, outcome.detection_delay,
                  outcome.judged_slip_time, outcome.detection, outcome.grasp, outcome.hold, outcome.saturated);
}

template <MaybeConst<SensorSummary> Value>
auto fields_of(Value& sensor) {
  return std::tie(sensor.name, sensor.units, sensor.state_count, sensor.state_micro_count);
}

template <MaybeConst<DetectorSummary> Value>
auto fields_of(Value& detector) {
  return std::tie(detector.type, detector.sensor, detector.confusion);
}

template <MaybeConst<TrialSummary> Value>
auto fields_of(Value& summary) {
  return std::tie(summary.trial, summary.params, summary.outcome, summary.sensors, summary.detector, summary.controller,
                  summary.resumed);
}

}  // namespace slipbench
