// Errors of a stated probability, for any detector: how a loop fares with one that is wrong so often.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The declaration of "flip", a parameter of every detector.
ParameterSpec flip_spec();

// `detector`, each of whose new estimates in contact is replaced with `probability`, 0 to 1, by one of the other two classes in contact
// (non-slip, incipient, gross), either as likely: of estimates that are right with probability a there remain
// a (1 - p) + (1 - a) p / 2. A stuck fraction that was told becomes that of the new class: 1, 1/2, 0. An estimate that is repeated is flipped
// as before, one of no contact never. One draw an estimate, from the stream "detector.flip" of the source's seed and trial. With probability 0
// it is `detector` itself.
std::unique_ptr<Detector> with_flips(std::unique_ptr<Detector> detector, double probability, const FrameSource& source);

}  // namespace slipbench
