// What can be said of a whole pad: the word that truth, detectors and controllers share.
#pragma once

#include <cstdint>

namespace slipbench {

// State of a whole pad. Values are those of the dataset (state, state_micro, detector_class).
enum class PadState : std::uint8_t { no_contact = 0, non_slip = 1, incipient = 2, gross = 3 };

inline bool slips(PadState state) { return state == PadState::incipient || state == PadState::gross; }
inline bool slips(std::uint8_t state) { return slips(static_cast<PadState>(state)); }

}  // namespace slipbench
