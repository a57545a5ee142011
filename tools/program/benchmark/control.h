// The negative controls: what is known without feeling anything.
#pragma once

#include <limits>
#include <string>

#include "sim/scene/scene.h"

namespace slipbench::benchmark {

// A detector by this name says slip from its parameter `from` [s] to `until` [s], and stick else, whatever its sensor feels.
inline constexpr const char* control_type = "benchmark_control";

inline constexpr double never = std::numeric_limits<double>::infinity();  // s

// Makes it known to the catalogue of detectors in this process.
void register_control();

// Between `from` and `until` [s]; `never` is allowed.
DetectorScene control_of(double from, double until);

// What a scene is told to do, without its truth: slip from the instant when the motion, or the actuator `mover`, begins to move what is in
// contact, until it stops. In a grasp from the lift on.
DetectorScene motion_known(const Scene& scene, const std::string& mover);

// The same with a time [s] beside it: in an open recording slip is said so much later; in a grasp for so long.
DetectorScene motion_known_and(double time, const Scene& scene, const std::string& mover);

}  // namespace slipbench::benchmark
