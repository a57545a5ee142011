// Checks of a trial and their failures.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::verify {

enum class Check : std::size_t { digests, order, times, values, events, cone, contact };

// Location of a failure.
struct Where {
  std::optional<std::size_t> trial = {};
  std::string array = {};                  // path in the trial: "labels/pad/margin"
  std::optional<std::size_t> sample = {};  // row of the array
};

class Verification {
 public:
  // Number of failures listed per check; the others are counted.
  static constexpr std::size_t listed = 5;

  // Adds to the number of checked items: trials for digests and order, values or samples of units
  // for the others.
  void count(Check check, std::size_t count) { entry_of(check).checked += count; }
  // Records an omitted part with the reason, once.
  void leave_out(Check check, const std::string& why);
  void fail(Check check, const Where& where, const std::string& what);

  [[nodiscard]] bool holds() const;
  // Adds the json() of another object, for later trials.
  void add(const Json& later);

  // {"holds", "checks": [{"check", "checked", "of", "failed", "left_out": [...]}], "failures":
  // [{"check", "trial", "array", "sample", "what"}]}
  [[nodiscard]] Json json() const;

 private:
  struct Entry {
    std::size_t checked = 0, failed = 0;
    std::vector<std::string> left_out;
    Json failures = Json::array();
  };
  Entry& entry_of(Check check) { return entries_[static_cast<std::size_t>(check)]; }

  std::array<Entry, 7> entries_;
};

// Times must rise strictly, those of a sensor at its rate to 1e-6 of a sample.
void check_times(const TrialRecord& record, Verification& verification);

// Values must be finite, except where README.md of tools/dataset allows NaN: without contact,
// or where the slip has no direction.
void check_values(const TrialRecord& record, Verification& verification);

// Events must be in order, onset times the first events, unit_state the state after the events, and
// the pad's states those of its units.
void check_events(const SensorRecord& sensor, std::size_t trial, Verification& verification);

// Coulomb's law in the labels, as far as README.md states that it holds for a unit.
// Parts of the law that the labels of one sensor obey.
struct ConeLaw {
  bool partial_margin = true;              // margin holds for partially slipping units
  bool partial_stick = true;               // stick holds for them
  bool margin = true;                      // stick and partial: margin >= 0
  bool stick = true;                       // stick and partial: f_t <= mu_static f_n
  bool margin_value = true;                // touching: margin = 1 - f_t/(mu_static f_n)
  bool slip_most = true;                   // slip: f_t <= mu_kinetic f_n
  bool slip_least = true;                  // slip: f_t >= mu_kinetic f_n
  std::vector<std::string> left_out = {};  // parts that do not hold, and why
};

// The law for sensor `index` of a trial's scene.
ConeLaw cone_law(const Scene& scene, std::size_t index);

void check_cone(const ConeLaw& law, const SensorRecord& sensor, std::size_t trial, Verification& verification);

}  // namespace slipbench::verify
