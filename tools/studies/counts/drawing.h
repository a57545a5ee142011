// The reference scenes' cost as a picture.
#pragma once

#include <string>

#include "tools/studies/counts/results.h"

namespace slipbench::counts {

// An SVG of its own, readable on light and dark pages: for each scene two bars on logarithmic axes, instructions per simulated
// second and times real time, with build and machine below. The same results give the same bytes.
std::string drawing(const Results& results);

}  // namespace slipbench::counts
