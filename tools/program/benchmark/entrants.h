// Who is on the board.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/base/record/json.h"
#include "tools/program/benchmark/protocol.h"

namespace slipbench::benchmark {

enum class Kind {
  shipped,       // as it ships, with its own defaults
  trained,       // learns as a part of the protocol
  given,         // named by who runs the board
  control,       // knows nothing of what is felt
  known_signal,  // knows the slip's signal beforehand and sees it in the sensor's own noise (known_signal.h)
  oracle,        // reads the truth: what no detector beats
};
// "shipped", ...
std::string kind_word(Kind kind);

// What a control is told of the trials that are judged (protocol.h).
enum class Told {
  nothing,
  clock,            // Held::clock
  motion,           // when each trial's motion begins and ends
  motion_and_time,  // the same, and Held::time
};

struct Entrant {
  std::string name;  // "shear_rate", "my.onnx"
  Kind kind = Kind::shipped;
  DetectorScene detector{};  // but for the sensor, and for the instants of a control that is told them
  Told told = Told::nothing;
  std::string reads{};                  // type of sensor that it learnt from; empty: whichever it can
  Json parameters = Json::object();     // that were set, as text
  std::string sha256{};                 // of what it is: type, parameters, files; of one that learns: of what it learns from
  std::set<std::string> sha256_seen{};  // trials that it says it has learnt from
};

// A detector as the command line names it: a name of the catalogue, FILE.onnx, a folder of memories; with parameters of it. Throws InputError as
// eval::chosen_detector(), and for a network's file as network::load_engine().
Entrant given_entrant(const std::string& word, const std::vector<Override>& parameters);

// The control that never says slip.
inline constexpr const char* never_slip = "never slip";

// Whether a control of the board can be told what it wants to know of these trials.
bool can_be_told(const Entrant& entrant, const Held& held);

// Someone who is not there, and why.
struct Missing {
  std::string name, sensor, why;
};

// All detectors that ship, but for those that are nothing without a file of the user's; and the networks that ship, which are missing where nothing
// runs them. register_control() must have been called.
std::vector<Entrant> shipped_entrants();
std::vector<Missing> missing_entrants();
std::vector<Entrant> control_entrants();
Entrant oracle_entrant();
Entrant known_signal_entrant();

// The file or folder that a detector is made from; empty: it has none.
std::string file_of(const DetectorScene& detector);

struct Teaching {
  std::string sensor;  // lessons of this type of sensor alone; empty: all
  std::size_t jobs = 0;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> say{};  // what is being done; may be empty
};
struct Taught {
  std::vector<Entrant> entrants;
  std::vector<Missing> untaught;
  Json data = Json::array();  // [{scene, trials, sha256}] of what was learnt from
};
// Simulates the scenes of the lessons and teaches each from it, in `folder`. Throws InputError for a scene that cannot be simulated or a folder that
// cannot be written, and Interrupted.
Taught teach(const std::vector<Lesson>& lessons, const Teaching& teaching, const std::string& folder);

// The negative controls: what is known without feeling anything.

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

// From when on the slip of an open recording is judged [s]: by slip-3 from the motion on, since a sensor may slip as it is touched. -inf: all of it, as
// by the protocols before, and in disturbed recordings.
double judged_from(const Held& held, const Scene& scene);

}  // namespace slipbench::benchmark
