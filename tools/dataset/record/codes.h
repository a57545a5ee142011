// Names of the codes in a dataset: states of a pad and of a unit, kinds of events.
#pragma once

#include <array>
#include <string_view>

#include "sim/api/contact_frame.h"
#include "sim/core/choice.h"

namespace slipbench {

// In the order of the codes.
inline constexpr std::array unit_states{Choice<UnitState>{"detached", UnitState::detached},
                                        Choice<UnitState>{"stick", UnitState::stick}, Choice<UnitState>{"slip", UnitState::slip},
                                        Choice<UnitState>{"partial", UnitState::partial}};
inline constexpr std::array event_kinds{
    Choice<EventKind>{"touch", EventKind::touch}, Choice<EventKind>{"slip", EventKind::slip},
    Choice<EventKind>{"stick", EventKind::stick}, Choice<EventKind>{"detach", EventKind::detach},
    Choice<EventKind>{"micro", EventKind::micro}, Choice<EventKind>{"part_sticks", EventKind::part_sticks}};

// Name of unknown_state (trial_record.h).
inline constexpr const char* unknown_state_name = "unknown";

// Attribute `codes` of an array of labels, events or the control loop whose numbers are codes: a
// JSON object, name to number. Empty for other arrays.
std::string_view codes_of(std::string_view array);
// The same of `state_paper` of a recording with unknown_state.
std::string_view codes_with_unknown();

// Unit of an array for readers: "code", "index" or "counts" where the file has the pure number 1, else
// `unit`, which is that of the file.
std::string_view shown_unit(std::string_view array, std::string_view unit);

}  // namespace slipbench
