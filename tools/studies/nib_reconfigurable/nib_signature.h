// Where the nib pad's signal below 8 Hz comes from: its energy while the pad slips, under one friction law after the other.
#pragma once

#include <optional>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/studies/nib_reconfigurable/nib_trace.h"
#include "tools/studies/result.h"

namespace slipbench::reproduce {

// Of the difference of FL in the windows that lie within one slip.
struct Signature {
  bool wavy = false;                // the plate has waves
  double share = 0.0;               // of the energy above 0 Hz that is below 8 Hz
  double time = 0.0;                // s, that the slip takes
  double below = 0.0, above = 0.0;  // counts rms, below and above 8 Hz
};

// From when the lever has gone 0.3 mm beyond where it stood when the detector began to count, to 10 mm. Empty where that is
// shorter than a window, or the pad does not slip.
std::optional<Signature> signature_of(const Scene& scene, const NibTrace& trace);

// The table, without rows, and those of one law: in it and in `figures`, an array.
ResultTable signature_table();
void add_signatures(const char* law, const std::vector<std::optional<Signature>>& found, ResultTable& table, Json& figures);

}  // namespace slipbench::reproduce
