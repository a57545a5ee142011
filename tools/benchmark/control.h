// The negative controls of the board: detectors that do not read a sensor.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "sim/api/detector.h"
#include "sim/scene/scene.h"
#include "tools/benchmark/protocol.h"

namespace slipbench::benchmark {

// A control's knowledge of the judged trials (protocol.h).
enum class SideInformation {
  nothing,
  clock,            // TestSet::clock
  motion,           // when the motion of each trial begins and ends
  motion_and_time,  // the motion and TestSet::time
  speed,            // the motion, TestSet::speed and TestSet::speed_time
  travel,           // the motion and TestSet::travel
};

inline constexpr double never = std::numeric_limits<double>::infinity();  // s

// Reports slip from one time to another, whatever its sensor reads.
struct Control {
  double from = never;   // s
  double until = never;  // s
  bool once = false;     // report slip in the first sample of this time only
};

std::unique_ptr<Detector> make_detector(const Control& control);

// Returns a control that knows the scene's commands but not its truth: slip from the instant at
// which the motion, or the actuator `mover`, begins until it stops. In a grasp: from the lift on.
Control motion_known(const Scene& scene, const std::string& mover);

// How the hand moves in an open recording, as the scene commands it: the pad's distance from where
// its motion begins, a turn counted at 10 mm from the axis [m], or the change of the actuator
// `mover` [m or N].
struct HandMotion {
  static constexpr double step = 1e-3;  // s
  std::vector<double> travel;           // at every step from 0 s to the end of the recording
  double start = 0.0;                   // s
  double top_speed = 0.0;               // greatest change of a step [1/s]

  // s, the first step with so much travel; `never` if there is none.
  [[nodiscard]] double passes(double distance) const;
};
HandMotion hand_motion(const Scene& scene, const std::string& mover);

// Returns the control with this knowledge, which is not `nothing`, of a trial of `test_set`. With
// the best values of `test_set` it reports slip in a single sample of an open recording, which costs
// least; in a grasp it reports slip for TestSet::time from the lift on.
Control informed_control(SideInformation side_information, const TestSet& test_set, const Scene& scene);

// Returns the time [s] from which on the slip of a recording is judged: the beginning of the motion,
// since a sensor may slip as it is touched. In disturbed recordings -inf: from the start.
double judged_from(const TestSet& test_set, const Scene& scene);

}  // namespace slipbench::benchmark
