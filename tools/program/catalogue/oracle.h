// The oracle: the true state of a pad in a detector's place. With it a loop shows the faults of its controller alone.
#pragma once

#include <cstddef>
#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

// The catalogue's entry, whose name is oracle_type.
Entry oracle_entry();

// At each frame of the sensor of pad `pad` the pad's true class, by the rule strict, and stuck fraction. `parameters`: those of oracle_entry(),
// all present. `simulation` must outlive it.
std::unique_ptr<Detector> make_oracle(const Parameters& parameters, const Simulation& simulation, std::size_t pad);

}  // namespace slipbench
