// Checks the slip labels of a dataset against the states and events of the units.
#pragma once

#include <cstddef>
#include <string_view>

#include "tools/dataset/record/trial_record.h"
#include "tools/verify/verification.h"

namespace slipbench::verify {

// Checks each unit: slip_velocity is 0 unless a part of the unit slips; slip_distance starts from 0,
// never falls, and is constant while no part slips. Checks the pad while no unit slips: slip_angle is
// constant, slip_centre is NaN, stuck_fraction is 1; it is 0 if all touching units slip as a whole,
// and between 0 and 1 otherwise. A unit counts as at rest between two samples if it does not slip
// in either and has no event between them. `fidelity`: of the scene; with mujoco_contact
// slip_distance includes creep.
void check_slip(std::string_view fidelity, const SensorRecord& sensor, std::size_t trial, Verification& verification);

}  // namespace slipbench::verify
