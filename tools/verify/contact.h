// Checks that the normal forces of a dataset are consistent with elements that each press on one
// surface.
#pragma once

#include <cstddef>

#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/verify/verification.h"
#include "tools/verify/verify.h"

namespace slipbench::verify {

// Compares the labels of sensor `index` of the trial's scene with the depths of its elements in the
// bodies that it may touch, computed from the recorded poses and the bodies' shapes. With d_e the
// depth of element e in the body in which it is deepest [m], for the elements of a unit
//   f_n <= sum k_n,e d_e            (two surfaces under one element would carry more)
// must hold. A unit that touched in the previous sample must not be detached while an element is
// still in a body by more than half of its depth before, unless its elements have come out by as
// much as its force had pressed them in: its force would have vanished inside the body. Both hold to 10 um: poses are float32. Omits, with the reason, what cannot be checked:
// scenes without bodies of a known shape, sensors that follow another's pad, units of several
// elements on a curved pad or a round body, effects that change the springs or the surface.
void check_contact(const Scene& scene, std::size_t index, const TrialRecord& record, const SensorRecord& sensor,
                   Verification& verification);

}  // namespace slipbench::verify
