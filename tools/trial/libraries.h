// Finds the third-party libraries that compute in a scene.
#pragma once

#include <string>

#include "sim/scene/scene.h"

namespace slipbench {

// Value of TrialRecord::libraries for a trial of this scene: "MuJoCo, FFTW". Empty: only the
// project's own code computes, whose results are bit-identical on every processor. Types that a
// Python program registers count as a user's library.
std::string libraries_of(const Scene& scene);

// True if the scene has a sensor, detector or controller that a Python program registered, which the
// command line does not know.
bool has_registered_parts(const Scene& scene);

}  // namespace slipbench
