// Which libraries of others compute in a scene.
#pragma once

#include <string>

#include "sim/scene/scene.h"

namespace slipbench {

// "MuJoCo, FFTW": what TrialRecord::libraries holds for a trial of this scene. Empty: the project's own code alone computes, whose results have the
// same bits on every processor. What a Python program registers counts as a user's library.
std::string libraries_of(const Scene& scene);

}  // namespace slipbench
