// The negative controls of the board: detectors that do not read a sensor.
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "sim/api/detector.h"
#include "sim/scene/scene.h"
#include "tools/benchmark/protocol.h"

namespace slipbench::benchmark {

inline constexpr double never = std::numeric_limits<double>::infinity();  // s

// Reports slip from one time to another, whatever its sensor reads.
struct Control {
  double from = never;   // s
  double until = never;  // s
};

std::unique_ptr<Detector> make_detector(const Control& control);

// Returns a control that knows the commands of a trial of `test_set` but not its truth: slip from the
// instant at which the motion, or the actuator TestSet::mover, begins until it stops. In a grasp: for
// TestSet::time from the lift on.
Control motion_known(const TestSet& test_set, const Scene& scene);

// Returns the time [s] from which on the slip of a recording is judged: the beginning of the motion,
// since a sensor may slip as it is touched. In disturbed recordings -inf: from the start.
double judged_from(const TestSet& test_set, const Scene& scene);

}  // namespace slipbench::benchmark
