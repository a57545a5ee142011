// From what is told of each unit to what is told of the pad.
#pragma once

#include <cstddef>
#include <limits>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Units of a pad, as a detector sees them.
struct UnitCounts {
  std::size_t touching = 0;
  std::size_t slipping = 0;  // of those that touch

  // no_contact: none touches; non_slip: none slips; incipient: some do; gross: all do.
  [[nodiscard]] PadState state() const {
    if (touching == 0) return PadState::no_contact;
    if (slipping == 0) return PadState::non_slip;
    return slipping == touching ? PadState::gross : PadState::incipient;
  }

  // Share of the touching units that stick; NaN where none touches.
  [[nodiscard]] double stuck_fraction() const {
    if (touching == 0) return std::numeric_limits<double>::quiet_NaN();
    return static_cast<double>(touching - slipping) / static_cast<double>(touching);
  }
};

// The estimate that follows from the counts in the frame at `time`, there at once.
inline SlipEstimate estimate_of(const UnitCounts& counts, double time) {
  return {.time = time, .latency = 0.0, .state = counts.state(), .stuck_fraction = counts.stuck_fraction()};
}

// Declarations of the parameters that say what counts, "touch" [N] and "least_friction".
inline ParameterSpec touch_spec() {
  return number_spec("touch", Quantity::force, "0.05 N", positive, "Normal force from which on a unit counts as touching.",
                     "the force resolution of the PapillArray: less is noise, whose ratio means nothing");
}

inline ParameterSpec least_friction_spec() {
  return number_spec(
      "least_friction", Quantity::none, "0.2", non_negative,
      "Ratio f_t/f_n below which a unit sticks in any case: the fingers' own bending shears a closing pad, far from any friction.",
      "assumed: below the friction of every material of the catalogue but the soaped one");
}

}  // namespace slipbench
