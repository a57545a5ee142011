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
#include "tools/benchmark/control.h"
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

struct Entrant {
  std::string name;  // "shear_rate", "my.onnx"
  Kind kind = Kind::shipped;
  DetectorScene detector{};             // without the sensor; not of a control
  Control control{};                    // unless knows_motion
  bool knows_motion = false;            // a control that knows the motion of each trial: motion_known()
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

// A detector that is missing, and why.
struct Missing {
  std::string name, sensor, why;
};

// Return all detectors that ship, except yardsticks and those that need a file of the user's. The networks that
// ship are in missing_entrants() if OpenVINO is not installed.
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

}  // namespace slipbench::benchmark
