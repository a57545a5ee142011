// How large the disturbances of a nib pad's electronics are.
#pragma once

#include <vector>

#include "sensors/electronics/electronics.h"

namespace slipbench::nib_pad {

// Of the values si {9,4}, fl {2}, fr {2}, in counts at 13 bit times `count` above the reading at rest, `rate` [Hz] samples a
// second. Every value is a reading of its own and so a source of its own.
SignalModel signal_model(double rate, double count);

// The parts that its electronics have, with these figures. Rounding to counts is not one of them: it is what the device does,
// parameter `bits`.
std::vector<Entry> electronics_parts();

}  // namespace slipbench::nib_pad
