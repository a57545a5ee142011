// Whether the normal forces of a dataset are those of elements that each press on one surface.
#pragma once

#include <cstddef>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/verify/verify.h"

namespace slipbench::verify {

// Holds the labels of the sensor `index` of the trial's scene against where its elements are in the bodies that it may touch, which the recorded
// poses and the bodies' shapes tell. With d_e the depth of element e in the body in which it is deepest [m], of a unit's elements,
//   f_n <= sum k_n,e d_e            (two surfaces under one element would bear more)
// and a unit that touched in the sample before is not detached while an element of it is still in a body by more than half of the depth that it
// had (its force would have vanished inside). Both to 10 um: poses are float32. Leaves out, with the reason, what it cannot know: scenes without
// bodies of a known shape, sensors that follow another one's pad, curved pads whose units have several elements, effects that change the springs or where the surface is.
void check_contact(const Scene& scene, std::size_t index, const TrialRecord& record, const SensorRecord& sensor,
                   Verification& verification);

}  // namespace slipbench::verify
