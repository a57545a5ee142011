// One trial of a dataset with what a detector sees in it. `eval` and `detect` both run detectors by it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/record/json.h"
#include "tools/program/eval/metrics.h"
#include "tools/program/eval/replay.h"

namespace slipbench::eval {

struct RecordedTrial {
  TrialRecord record;                 // its sensors are in `sensors`
  std::vector<SensorRecord> sensors;  // in the scene's order
  std::size_t read = 0;               // number of the sensor that the detector reads
  Replayed replayed;
  std::optional<Scene> scene;  // empty: an imported recording

  [[nodiscard]] const SensorRecord& sensor() const { return sensors[read]; }
  // By the rule. Throws InputError as eval::truth_of().
  [[nodiscard]] Truth truth(TruthRule rule) const;
};

// Reads a trial and runs the detector on it. `sensor`: the name in the scene; empty: the only one. Throws InputError: a
// trial with its outcome alone, no such sensor, and what replay() refuses.
RecordedTrial recorded_trial(const DatasetReader& reader, std::size_t trial, const DetectorScene& detector,
                             const std::string& sensor, const Catalogues& catalogues);

// The parameters by name, for results.
Json parameters_json(const Parameters& parameters);

}  // namespace slipbench::eval
