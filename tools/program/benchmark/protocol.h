// The protocols slip-1, slip-2 and slip-3: what is judged, what learns, and the constants of the score. Their scenes are scenes/benchmark/NAME/*.yaml.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/eval/metrics.h"
#include "tools/program/train/network/operating_point.h"

namespace slipbench::benchmark {

// Constants of the score.
using train::alarm_limit;
using train::half_delay;
inline constexpr double half_slip_distance =
    0.25e-3;  // m, path slipped over the pad at the alarm, for which a slip earns a half by slip-3
// m: by slip-3 a recording in which the object slips less has nothing to earn, whoever sees it. It is a fifth of half_slip_distance: an object that
// creeps by micrometres would earn nearly all of the credit at any time.
inline constexpr double least_slip_distance = 0.05e-3;
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
  bool by_distance = false;            // a slip that is seen earns by how far the object has slipped, not by how long
  std::string disturbance{};  // "knock": what disturbs a recording in which nothing slips; empty: slip is to be seen (Score)
  bool needless = false;      // a grasp's score is lowered by force that its box did not need (Score)
  // What controls are told, which feel nothing: what scores best on these very trials, so that nothing of the kind scores better. NaN: never to say
  // slip scores better than any. The steps are those of the README.
  double clock = std::numeric_limits<double>::quiet_NaN();  // s after the start, from which the control `clock` says slip
  // s, for which the control `motion known, timed` waits after the motion begins; in a loop: for which it says slip from the lift on
  double time = std::numeric_limits<double>::quiet_NaN();
};

// A network that learns as a part of the protocol, from a scene that shares no seed with those held out. The memory cl_gst_hd of gst_hd has learnt from
// learn_papillarray.yaml.
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
  bool judged = true;     // false: a recording that was to have no slip has one, and is left out
  bool silent = true;     // no alarm counts
  double credit = 0.0;    // 0 to 1
  bool credited = true;   // false: the trial has nothing to earn, as a recording without slip
  double alarms = 0.0;    // false alarms begun, the early ones among them
  double quiet = 0.0;     // s without true slip in which they are counted
  double needless = 0.0;  // 0 to 1, of a grasp that needs no tightening
  double said = 0.0;      // samples without true slip that are called slip,
  double still = 0.0;     // of so many
};

// Of a recording: the credit of a slip that is seen is half_delay / (half_delay + delay), or with Held::by_distance half_slip_distance /
// (half_slip_distance + Judgement::slip_distance); it is 0 of one that is missed or alarmed early. With Held::by_distance a recording that slips by less
// than least_slip_distance in all has nothing to earn.
Part recording_part(const eval::Judgement& judgement, const Held& held);
// Of a grasp that `untightened`, that of who never tightens, does not hold: the credit is (worst_force_ratio - r) / (worst_force_ratio - 1) of a box that is
// held, r the greatest grip force over the least that holds, at most 1 and at least 0; 0 of one that is dropped or not lifted. Of a grasp that who never
// tightens holds there is nothing to earn; its `needless` is (r - 1) / (worst_force_ratio - 1), r the greatest grip force over that of who never
// tightens, at most 1 and at least 0.
Part grasp_part(const eval::Judgement& judgement, const GraspOutcome& grasp, const GraspOutcome& untightened);

struct Score {
  double credit = 0.0;             // mean over the trials that have something to earn; 0 where none has
  double alarms_per_minute = 0.0;  // of time without true slip
  double said = 0.0;               // share of the samples without true slip that are called slip
  double needless = 0.0;           // mean over the grasps that need no tightening; 0 where there is none
  double specificity = 0.0;        // share of the recordings without an alarm
  std::size_t judged = 0;          // trials
  // The specificity of disturbed recordings. Else the credit times min(1, alarm_limit / alarms_per_minute), less `said`: -1 to 1. In a loop the credit
  // less `said`, since a false alarm has cost force there, and where Held::needless less `needless`: -2 to 1.
  double value = 0.0;
};
Score score_of(std::span<const Part> parts, const Held& held);

// 95 % by trial, by bootstrap as eval::summarised(); NaN of fewer than eval::fewest_experiments.
Interval score_interval(std::span<const Part> parts, const Held& held);

}  // namespace slipbench::benchmark
