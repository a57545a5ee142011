// The detectors on the board, the yardsticks, the controls and the measures.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/benchmark/protocol.h"
#include "tools/dataset/record/json.h"

namespace slipbench::benchmark {

enum class Kind {
  shipped,       // a detector of the catalogue with its defaults, or a network that ships
  given,         // named on the command line
  yardstick,     // a rule of one line (detectors/yardstick), whose threshold the board chooses
  control,       // does not read a sensor
  known_signal,  // knows the slip's signal beforehand (known_signal.h)
  oracle,        // reads the truth
};
// Returns "shipped" and so on, as tables have it.
std::string kind_word(Kind kind);

// A control's knowledge of the judged trials (protocol.h).
enum class SideInformation {
  nothing,
  clock,            // TestSet::clock
  motion,           // when the motion of each trial begins and ends
  motion_and_time,  // the motion and TestSet::time
  speed,            // the motion, TestSet::speed and TestSet::speed_time
  travel,           // the motion and TestSet::travel
};

struct Entrant {
  std::string name;  // "shear_rate", "my.onnx"
  Kind kind = Kind::shipped;
  DetectorScene detector{};  // without the sensor, and without the times of a control
  SideInformation side_information = SideInformation::nothing;
  std::string reads{};                  // type of sensor that it was trained on; empty: any that it can read
  Json parameters = Json::object();     // those that were set, as text
  std::string sha256{};                 // of type, parameters and files
  std::set<std::string> sha256_seen{};  // trials that it was trained on, as its file says
  // A yardstick whose threshold is not chosen yet: it is evaluated with each of
  // threshold_factors() times its default.
  bool chooses_threshold = false;
};

// Returns the entrant for a DETECTOR of the command line: a name of the catalogue, FILE.onnx or a
// folder of memories, with its parameters. Throws InputError as eval::chosen_detector(), and for a
// network's file as network::load_engine().
Entrant given_entrant(const std::string& word, const std::vector<Override>& parameters);

// The control that never reports slip.
inline constexpr const char* never_slip = "never slip";

// Returns true if the protocol has the times that this control needs for these trials.
bool has_side_information(const Entrant& entrant, const TestSet& test_set);

// A detector that is missing, and why.
struct Missing {
  std::string name, sensor, why;
};

// Return all detectors that ship, except yardsticks and those that need a file of the user's. The networks that
// ship are in missing_entrants() if OpenVINO is not installed. Call register_control() first.
std::vector<Entrant> shipped_entrants();
std::vector<Missing> missing_entrants();
std::vector<Entrant> yardstick_entrants();
std::vector<Entrant> control_entrants();
Entrant oracle_entrant();
Entrant known_signal_entrant();

// The thresholds among which a yardstick's is chosen, in units of its default: descending, four a
// decade, wide enough for signals in counts, N, m and T.
std::vector<double> threshold_factors();
// Returns the yardstick with its threshold set.
Entrant with_threshold(const Entrant& yardstick, double threshold);

// Returns the file or folder that a detector is made from; empty if there is none.
std::string file_of(const DetectorScene& detector);

// The negative controls: detectors that do not read a sensor.

// The detector of this name reports slip from its parameter `from` [s] to `until` [s], whatever its
// sensor reads.
inline constexpr const char* control_type = "benchmark_control";

inline constexpr double never = std::numeric_limits<double>::infinity();  // s

// Registers that detector in the catalogue of this process.
void register_control();

// Returns that detector with its times [s]; `never` is allowed. `once`: it reports slip in the
// first sample from then on alone.
DetectorScene control_of(double from, double until, bool once = false);

// Returns a control that knows the scene's commands but not its truth: slip from the instant at
// which the motion, or the actuator `mover`, begins until it stops. In a grasp: from the lift on.
DetectorScene motion_known(const Scene& scene, const std::string& mover);

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

// Returns the controls `clock`, `motion known, timed`, `motion and speed known` and `travel known`
// that know the best values of `test_set`. In an open recording they report slip in a single sample,
// which costs least; in a grasp `motion known, timed` reports slip for TestSet::time from the lift
// on.
DetectorScene timed_control(SideInformation side_information, const TestSet& test_set, const Scene& scene);

// Returns the time [s] from which on the slip of a recording is judged: the beginning of the motion,
// since a sensor may slip as it is touched. In disturbed recordings -inf: from the start.
double judged_from(const TestSet& test_set, const Scene& scene);

}  // namespace slipbench::benchmark
