// Everything that a scene may name in this program.
#pragma once

#include <vector>

#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"
#include "tools/base/record/trial_record.h"

namespace slipbench {

Catalogues program_catalogues();

// What a scene may expect of its trials, and how a trial's outcome is held against it.

// One kind of expectation.
struct ExpectationKind {
  enum class Comparison {
    at_most,   // observed <= limit; what never happened does not keep it
    at_least,  // observed >= limit; what never happened keeps it
    equal,     // a flag
  };

  ExpectationEntry about;
  Comparison comparison = Comparison::at_most;
  double (*observed)(const TrialOutcome&) = nullptr;  // SI, a flag as 0 or 1; NaN: it never happened, or has no value
  bool of_box = false;                                // what becomes of the box, not how it is gripped

  // Whether a trial keeps the expectation. `limit`: SI, a flag as 0 or 1.
  [[nodiscard]] bool kept(double observed, double limit) const;
  // How bad an observation is: the larger the worse; infinite for what never happened and should have.
  [[nodiscard]] double badness(double observed) const;
  // The expectation's parameter `limit` in SI, a flag as 0 or 1.
  [[nodiscard]] double limit(const Parameters& parameters) const;
};

// All kinds that a scene may name in `expect`.
const std::vector<ExpectationKind>& expectation_catalogue();

// Their declarations, in the same order.
std::vector<ExpectationEntry> expectation_entries();

}  // namespace slipbench
