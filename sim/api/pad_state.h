// The state of a whole pad, in the terms that truth, detectors and controllers share.
#pragma once

#include <cstddef>
#include <cstdint>

namespace slipbench {

// State of a whole pad. Values are those of the dataset (state, state_micro, detector_class).
enum class PadState : std::uint8_t { no_contact = 0, non_slip = 1, incipient = 2, gross = 3 };

inline bool slips(PadState state) { return state == PadState::incipient || state == PadState::gross; }
inline bool slips(std::uint8_t state) { return slips(static_cast<PadState>(state)); }

// Returns the state of a pad with `touching` units in contact, `slipping` of which slip.
inline PadState pad_state(std::size_t touching, std::size_t slipping) {
  if (touching == 0) return PadState::no_contact;
  if (slipping == 0) return PadState::non_slip;
  return slipping == touching ? PadState::gross : PadState::incipient;
}

}  // namespace slipbench
