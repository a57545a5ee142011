// Random errors with a given probability for any detector, to test how a loop copes with them.
#pragma once

#include <memory>

#include "sim/api/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The declaration of "flip", a parameter of every detector.
ParameterSpec flip_spec();

// Wraps `detector`: each new estimate in contact is replaced with `probability` p (0 to 1) by one
// of the other two classes in contact (non-slip, incipient, gross), both equally likely. An
// accuracy a becomes a (1 - p) + (1 - a) p / 2. A reported stuck fraction becomes that of the new
// class: 1, 1/2, 0. A repeated estimate keeps its replacement; no contact is never replaced. One
// draw per estimate, from the stream "detector.flip" of the source's seed and trial. With
// probability 0 returns `detector` itself.
std::unique_ptr<Detector> with_flips(std::unique_ptr<Detector> detector, double probability, const FrameSource& source);

}  // namespace slipbench
