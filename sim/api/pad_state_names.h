// Names of the states of a pad.
#pragma once

#include <array>
#include <span>

#include "sim/api/pad_state.h"

namespace slipbench {

// A row of a table for sim/core/choice.h. `name`: in files, results and Python. `title`: in tables and
// on pages.
struct PadStateName {
  const char* name;
  PadState value;
  const char* title;
};

// In the order of the codes.
inline constexpr std::array pad_states{
    PadStateName{"no_contact", PadState::no_contact, "no contact"}, PadStateName{"non_slip", PadState::non_slip, "non-slip"},
    PadStateName{"incipient", PadState::incipient, "incipient"},  // some touching units slip
    PadStateName{"gross", PadState::gross, "gross"},              // all touching units slip
};
inline constexpr std::span<const PadStateName> pad_states_in_contact = std::span(pad_states).subspan<1>();

}  // namespace slipbench
