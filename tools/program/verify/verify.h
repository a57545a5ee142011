// Whether a dataset is what it says: digests, order, times, values, events, Coulomb's law, one surface under each element.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

struct Verified {
  // One object a dataset: {"file", "files", "schema", "complete", "trials", "holds", "checks", "failures"} as Verification::json()
  // has them, {"file", "error"} where it cannot be read, {"file", "part_of"} for a further file of a dataset that was named too.
  Json datasets = Json::array();
  // Where several of them are shards of a sweep: {"shards", "trials", "duplicates", "holds", "failures": [text]}: whether they are of one sweep,
  // whole, and hold no trial twice with different digests; else null.
  Json sweep = nullptr;
  bool holds = true;
  bool readable = true;
};

// `paths`: datasets by their first files; further files of them may stand among them. Throws
// nothing for a file that cannot be read: the others are verified all the same.
Verified verify_datasets(const std::vector<std::string>& paths);

}  // namespace slipbench

// What was checked of a dataset, and what does not hold.

namespace slipbench::verify {

enum class Check : std::size_t { digests, order, times, values, events, cone, contact };

// Where something does not hold.
struct Where {
  std::optional<std::size_t> trial = {};
  std::string array = {};                  // inside the trial: "labels/pad/margin"
  std::optional<std::size_t> sample = {};  // row of the array
};

class Verification {
 public:
  // Of each check so many failures are listed, the others counted.
  static constexpr std::size_t listed = 5;

  // `count` more of what the check looks at: trials for digests and order, values or samples of units for the others.
  void count(Check check, std::size_t count) { of(check).checked += count; }
  // What was left out, and why. Said once.
  void leave_out(Check check, const std::string& why);
  void fail(Check check, const Where& where, const std::string& what);

  [[nodiscard]] bool holds() const;
  // What another one has found, by its json(): of trials after those of this one.
  void add(const Json& later);

  // {"holds", "checks": [{"check", "checked", "of", "failed", "left_out": [...]}], "failures": [{"check", "trial", "array", "sample", "what"}]}
  [[nodiscard]] Json json() const;

 private:
  struct Entry {
    std::size_t checked = 0, failed = 0;
    std::vector<std::string> left_out;
    Json failures = Json::array();
  };
  Entry& of(Check check) { return entries_[static_cast<std::size_t>(check)]; }

  std::array<Entry, 7> entries_;
};

// Times rise strictly, those of a sensor at its rate to 1e-6 of a sample.
void check_times(const TrialRecord& record, Verification& verification);

// Finite, but for what README.md of tools/base/dataset allows NaN: where nothing touches, or what
// slips has no direction.
void check_values(const TrialRecord& record, Verification& verification);

// Events in order, onset times the first events, unit_state what the events leave behind, the pad's states what the units' are.
void check_events(const SensorRecord& sensor, std::size_t trial, Verification& verification);

// Coulomb's law in the labels, as far as README.md says that it holds for a unit.
// Which parts of the law the labels of one sensor keep.
struct ConeLaw {
  bool partial_margin = true;              // margin holds of units of which a part slips
  bool partial_stick = true;               // stick holds of them
  bool margin = true;                      // stick and partial: margin >= 0
  bool stick = true;                       // stick and partial: f_t <= mu_static f_n
  bool margin_value = true;                // touching: margin = 1 - f_t/(mu_static f_n)
  bool slip_most = true;                   // slip: f_t <= mu_kinetic f_n
  bool slip_least = true;                  // slip: f_t >= mu_kinetic f_n
  std::vector<std::string> left_out = {};  // which parts do not hold, and why
};

// Of the sensor `index` of a trial's scene.
ConeLaw cone_law(const Scene& scene, std::size_t index);

void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification);

}  // namespace slipbench::verify
