// `slipbench benchmark`: every slip detector on recordings and in grasps that none of them has seen.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/scene/parser.h"
#include "sim/scene/scene.h"
#include "tools/base/page/page.h"
#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/eval/metrics.h"
#include "tools/program/train/network/operating_point.h"

namespace slipbench::benchmark {

// The protocols slip-1 and slip-2: what is judged, what learns, and the constants of the score. Their scenes are scenes/benchmark/NAME/*.yaml.

// Constants of the score.
using train::alarm_limit;
using train::half_delay;
inline constexpr double worst_force_ratio =
    2.5;  // greatest grip force over the least that holds, from which on a grasp earns nothing

enum class Track { open, loop, transfer };
// "open recordings", "closed loop", "transfer"
std::string_view track_name(Track track);

// Held-out trials of one sensor.
struct Held {
  Track track = Track::open;
  std::string sensor{};                // its type: "papillarray"
  std::string scene{};                 // from the project's root
  std::vector<std::string> readers{};  // the scene's names of the sensors that a detector may read; it gets the first that it can
  std::string mover{};                 // the actuator that makes it slip; empty: the motion itself
  std::string domain{};                // "inside" or "outside" of what scenes/learn draws; empty: not told apart
  bool grace = false;                  // an alarm less than a sample period before the slip is no early one
  bool needless = false;               // a grasp's score is lowered by force that its box did not need (Score)
  // What controls are told, which feel nothing: what scores best on these very trials, so that nothing of the kind scores better. NaN: never to say
  // slip scores better than any. The steps are those of the README.
  double clock = std::numeric_limits<double>::quiet_NaN();  // s after the start, from which the control `clock` says slip
  // s, for which the control `motion known, timed` waits after the motion begins; in a loop: for which it says slip from the lift on
  double time = std::numeric_limits<double>::quiet_NaN();
};

// A network that learns as a part of the protocol, from a scene that shares no seed with those held out. The memories of gst_hd that ship have
// learnt from learn_papillarray.yaml.
struct Lesson {
  std::string recipe;  // of train::recipes(), with its own number of steps
  std::string sensor;  // type
  std::string scene;   // from the project's root, with its own seed
  std::size_t trials;  // of each cell of its grid; 0: the scene's
};

struct Protocol {
  std::string name;  // "slip-2"
  std::vector<Held> held_out;
  std::vector<Lesson> lessons;
};
inline constexpr const char* default_protocol = "slip-2";
// In the order in which they were made.
const std::vector<Protocol>& protocols();
// Throws InputError where none has this name; `subject` is who names it, a command or a file.
const Protocol& find_protocol(const std::string& name, const std::string& subject);

// SHA-256, 64 hexadecimal digits, over the name, the constants, both tables and the bytes of every scene and model that they name. Throws
// InputError where one cannot be read.
std::string protocol_sha256(const Protocol& protocol);

// The rank score: what a detector is worth. README.md says what raises it and what does not.

// What one trial gives.
struct Part {
  double credit = 0.0;    // 0 to 1
  bool credited = true;   // false: the trial has nothing to earn, as a recording without slip
  double alarms = 0.0;    // false alarms begun, the early ones among them
  double quiet = 0.0;     // s without true slip in which they are counted
  double needless = 0.0;  // 0 to 1, of a grasp that needs no tightening
  double said = 0.0;      // samples without true slip that are called slip,
  double still = 0.0;     // of so many
};

// Of a recording: the credit is half_delay / (half_delay + delay) of a slip that is seen, 0 of one that is missed or alarmed early.
Part recording_part(const eval::Judgement& judgement);
// Of a grasp that `untightened`, that of who never tightens, drops: the credit is (worst_force_ratio - r) / (worst_force_ratio - 1) of a box that is
// held, r the greatest grip force over the least that holds, at most 1 and at least 0; 0 of one that is dropped. Of a grasp that who never
// tightens holds there is nothing to earn; its `needless` is (r - 1) / (worst_force_ratio - 1), r the greatest grip force over that of who never
// tightens, at most 1 and at least 0.
Part grasp_part(const eval::Judgement& judgement, const GraspOutcome& grasp, const GraspOutcome& untightened);

struct Score {
  double credit = 0.0;             // mean over the trials that have something to earn; 0 where none has
  double alarms_per_minute = 0.0;  // of time without true slip
  double said = 0.0;               // share of the samples without true slip that are called slip
  double needless = 0.0;           // mean over the grasps that need no tightening; 0 where there is none
  // The credit times min(1, alarm_limit / alarms_per_minute), less `said`: -1 to 1. In a loop the credit less `said`, since a false alarm has cost
  // force there, and where Held::needless less `needless`: -2 to 1.
  double value = 0.0;
};
Score score_of(std::span<const Part> parts, const Held& held);

// 95 % by trial, by bootstrap as eval::summarised(); NaN of fewer than eval::fewest_experiments.
Interval score_interval(std::span<const Part> parts, const Held& held);

enum class Kind {
  shipped,  // as it ships, with its own defaults
  trained,  // learns as a part of the protocol
  given,    // named by who runs the board
  control,  // knows nothing of what is felt
  oracle,   // reads the truth: what no detector beats
};
// "shipped", ...
std::string kind_word(Kind kind);

// What a control is told of the trials that are judged.
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
  std::string reads{};                     // type of sensor that it learnt from; empty: whichever it can
  Json parameters = Json::object();        // that were set, as text
  std::string sha256{};                    // of what it is: type, parameters, files; of one that learns: of what it learns from
  std::vector<std::string> sha256_seen{};  // trials that it says it has learnt from
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

// What decides a board's bytes on one machine.
struct Asked {
  std::vector<std::string> detectors;  // beside those that ship: names, FILE.onnx, folders of memories
  std::vector<Override> parameters;    // of each of them
  std::vector<std::string> real;       // datasets of real recordings, for the track transfer
  std::string sensor;                  // its type alone; empty: all
  // To try things, which makes no board of the protocol: so many trials of each scene, spread over it (0: all), and nobody learns.
  std::size_t trials = 0;
  bool untaught = false;
};

struct Options {
  Asked asked;
  std::string protocol = default_protocol;
  std::size_t jobs = 0;  // worker threads; 0: one a hardware thread
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> say = {};  // what is being done; may be empty
};

inline constexpr const char* result_key = "slipbench_benchmark";

// The board as one object, which --submit writes; its first key is result_key: 1.
//   asked       as asked_json()
//   protocol    {name, sha256, half_delay_s, alarms_per_minute, force_ratio, whole}; whole: false of a part of it, to try things
//   machine     environment_json() without its load
//   learnt_from [{scene, trials, sha256}]
//   sets        [{track, sensor, scene or file, trials, data_sha256, labels, rows, left_out: [{detector, why}], by}] in the protocol's order,
//               transfer last; with `domain` where the protocol tells domains apart
//     rows      the best first: {rank (null of the oracle), detector, kind, sensor, parameters, sha256, score: {value, low, high}, credit,
//               false_alarms_per_minute, said, figures (eval::summary_json()), and of a closed loop
//               grasps: {trials, dropped, low, high, force_ratio, slip_m} and, where the protocol counts it, needless}
//     by        [{by, groups: [{name, trials, scores: [of each row]}]}] of what the scene's grid varies
//   transfer    why the track transfer is empty, where it is
// Times in s. No clock time: the same on one machine whatever the threads. Throws InputError: no such protocol or sensor, a detector or file that cannot be
// read, a scene that cannot be simulated; Interrupted.
Json benchmark(const Options& options);

Json asked_json(const Asked& asked);
// The inverse. Throws InputError, which names `file` and the key.
Asked parse_asked(const Json& json, const std::string& file);

// The bytes of a submission.
std::string submission_text(const Json& result);
// Throws InputError for a text that is no submission of a protocol of this program, by its name and its digest: nothing has to be computed to see
// that.
Json parse_submission(const std::string& text, const std::string& name);

// How a recomputed board, with the submission's own `machine` in the place of this one, differs from the submission's bytes:
// "/sets/0/rows/2/credit: 0.41 in the file, 0.43 here". Empty: in nothing.
std::string difference(const std::string& text, const Json& submitted, Json recomputed);

// The board as a page and as a table.

// One HTML page without scripts of a board (benchmark.h).
std::string board_page(const Json& result);

// The page and the board as they are written.
inline constexpr page::PageKind page_kind{
    "a board", "slipbench benchmark", "page of slipbench benchmark", "board of slipbench benchmark", {result_key}};

// The columns of one set's table, "score" among them, and its rows in order.
struct BoardTable {
  std::string title;  // "open recordings, papillarray: 96 trials"
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> left_out;  // "gst_hd: why"
};
BoardTable board_table(const Json& set);

}  // namespace slipbench::benchmark
