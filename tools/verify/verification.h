// Checks of a trial and their failures.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::verify {

enum class Check : std::size_t { digests, order, times, values, events, cone, slip, contact };

// s; an event at the instant of a sample may count before or after the sample.
inline constexpr double same_instant = 1e-9;

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

  std::array<Entry, 8> entries_;
};

// Times must rise strictly, those of a sensor at its rate to 1e-6 of a sample. Rates must be
// positive and finite.
void check_times(const TrialRecord& record, Verification& verification);

// Values must be finite, except where README.md of tools/dataset allows NaN: without contact,
// or where the slip has no direction.
void check_values(const TrialRecord& record, Verification& verification);

// Events must be in order, each must be possible in the state that the unit's earlier events leave,
// onset times must be the first events, unit_state the state after the events, and the pad's states
// those of its units. Returns false if the events name units or kinds that do not exist, or are out
// of order: no other check can use them.
bool check_events(const SensorRecord& sensor, std::size_t trial, Verification& verification);

// The outcome's first touch and first micro-slip must be the earliest of the labels, and no slipped
// distance of the labels may exceed the outcome's greatest one. Sensors that follow another pad do
// not count.
void check_outcome(const TrialRecord& record, Verification& verification);

}  // namespace slipbench::verify
