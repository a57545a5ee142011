// The steps of a scene whose pads are fields.
#pragma once

#include "sim/mujoco/modes/dynamic_setup.h"
#include "sim/mujoco/modes/dynamic_world.h"
#include "sim/mujoco/modes/field_contacts.h"
#include "sim/stage/step_plan.h"

namespace slipbench {

struct FieldPlan {
  StepPlan steps;
  bool averages = false;            // a grasp is stepped by average_acceleration.h
  bool stored_energy_known = true;  // of the pads
};

// Plans the longest step. `world`: at the scene's start, after measure_scale(). Throws
// SceneValueError if the scene's step or solver does not fit its pads.
FieldPlan plan_fields(const DynamicWorld& world, const FieldContacts& contacts, const DynamicSetup& setup);

}  // namespace slipbench
