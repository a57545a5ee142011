// One trial of a dataset with a detector's answers; `eval` and `detect` share it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/json.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"

namespace slipbench::eval {

struct RecordedTrial {
  TrialRecord record;                 // its sensors are in `sensors`
  std::vector<SensorRecord> sensors;  // in the scene's order
  std::size_t read = 0;               // index of the sensor that the detector reads
  Replayed replayed;
  std::optional<Scene> scene;  // empty: an imported recording

  [[nodiscard]] const SensorRecord& sensor() const { return sensors[read]; }
  // Truth by the rule. Throws InputError as eval::truth_of().
  [[nodiscard]] Truth truth(LabelRule rule) const;
};

// Reads a trial and runs the detector on it. `sensor`: name in the scene; empty: the only one.
// Throws InputError for a trial with its outcome alone, for an unknown sensor, and as replay()
// does. `interpolate`: as in replay(). The notice of an imported trial also says how many of its
// samples `import --rate` interpolated.
RecordedTrial recorded_trial(const DatasetReader& reader, std::size_t trial, const DetectorScene& detector,
                             const std::string& sensor, const Catalogues& catalogues, bool interpolate = false);

// Collects Replayed::notice of the trials into one line.
class Notices {
 public:
  // `notice`: of the next trial; empty: none.
  void add(const std::string& notice);
  // The first notice, with the number of trials that have another one. Empty: none.
  [[nodiscard]] std::string text() const;

 private:
  std::string first_;
  std::size_t others_ = 0;
};

// Parameters by name, for results.
Json parameters_json(const Parameters& parameters);

}  // namespace slipbench::eval
