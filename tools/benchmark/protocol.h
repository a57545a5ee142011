// The protocols: held-out trials, the constants of the score and the score. A protocol has its scenes
// in scenes/benchmark/NAME and its data in tools/benchmark/NAME.yaml.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/dataset/record/trial_record.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"
#include "tools/statistics/descriptive.h"
#include "tools/statistics/slip_score.h"

namespace slipbench::benchmark {

// Constants of the score, besides those of tools/statistics/slip_score.h.
inline constexpr double half_delay = 0.1;         // s, delay for half of the credit in recordings of a real sensor
inline constexpr double worst_force_ratio = 2.5;  // greatest grip force over the least that holds from which on the credit is 0

enum class Track { open, loop, transfer };
// "open recordings", "closed loop", "transfer"
std::string_view track_name(Track track);

// Held-out trials of one sensor.
struct TestSet {
  Track track = Track::open;
  std::string sensor{};                // type: "papillarray"
  std::string scene{};                 // path from the project's root
  std::vector<std::string> readers{};  // names in the scene; a detector reads the first that it can
  std::string mover{};                 // actuator that causes the slip; empty: the motion does
  std::string domain{};                // "inside" or "outside" of the ranges of scenes/learn, "disturbed"; may be empty
  std::string disturbance{};           // "knock": scored by specificity; empty: not a disturbed recording
  // s, in loops: the control `motion known` reports slip for so long from the lift on; the time that
  // scored best in the grasps of slip-3. NaN: not a loop.
  double time = std::numeric_limits<double>::quiet_NaN();
};

struct Protocol {
  std::string name;  // "slip-4"
  std::vector<TestSet> held_out;
  std::map<std::string, std::string> real = {};  // by type of sensor: what is known from real recordings
};
// The oldest first.
inline constexpr std::array protocol_names{"slip-4"};
inline constexpr const char* default_protocol = protocol_names.back();
// Returns the protocol of this name, from its data file. Throws InputError, beginning with `subject`,
// if there is none, and as read_protocol().
Protocol find_protocol(std::string_view name, std::string_view subject);

// Returns the SHA-256 (64 hexadecimal digits) of name, constants, held-out sets, and the
// bytes of every scene and model in them. Throws InputError if a file cannot be read.
std::string protocol_sha256(const Protocol& protocol);

// The rank score; README.md defines it.

// One trial's contribution to a score.
struct Part {
  bool judged = true;             // false: a disturbed recording that slips, which is left out
  bool slips = true;              // the object slips by least_slip_distance or more
  bool no_alarm = true;           // there is no alarm that counts
  double credit = 0.0;            // 0 to 1
  bool credited = true;           // false: the trial has no credit to earn, such as a recording without slip
  double alarms = 0.0;            // false alarms begun, early ones included
  double quiet_seconds = 0.0;     // s without true slip, in which alarms are counted
  double needless = 0.0;          // 0 to 1; for a grasp that needs no tightening
  double reported_samples = 0.0;  // samples without true slip in which slip is reported
  double quiet_samples = 0.0;     // samples without true slip
};

// True for a recording that counts as one without slip: nothing slips, or the object by less than
// least_slip_distance in all.
bool counts_as_none(const eval::Judgement& judgement);
// Returns the part of a recording. The credit of a detected slip is
// distance_credit(Judgement::slip_distance). It is 0 after an early alarm or without an alarm. A
// recording that slips by less than least_slip_distance in all is not credited. In a recording of a
// real sensor, whose slipped distance is unknown, the credit is half_delay / (half_delay + delay); a
// recording in which the onset of the slip is unknown is not credited.
Part recording_part(const eval::Judgement& judgement, const TestSet& test_set);
// Returns the part of a grasp. `untightened`: the same grasp without tightening. If `untightened`
// loses the box: the credit is (worst_force_ratio - r) / (worst_force_ratio - 1) within 0 and 1,
// with r = greatest grip force over the least that holds; 0 if the box is dropped or not lifted. If
// `untightened` holds the box: the grasp is not credited, and `needless` is (r - 1) /
// (worst_force_ratio - 1) within 0 and 1, with r = greatest grip force over that of `untightened`.
Part grasp_part(const eval::Judgement& judgement, const GraspOutcome& grasp, const GraspOutcome& untightened);

struct Score {
  double credit = 0.0;             // mean over the credited trials; 0 if there are none
  double alarms_per_minute = 0.0;  // false alarms per minute without true slip
  double false_share = 0.0;        // share of the recordings without slip in which slip is reported; 0 if all slip
  double reported_share = 0.0;     // share of the samples without true slip in which slip is reported
  double needless = 0.0;           // mean over the grasps that need no tightening; 0 if there are none
  double specificity = 0.0;        // share of the recordings without an alarm
  std::size_t judged = 0;          // number of trials
  std::size_t credited = 0;        // of these, trials with a credit to earn
  // Open recordings: recording_score(), -1 to 1. Disturbed ones: specificity, 0 to 1. Recordings of a
  // real sensor, which may contain slip and none: credit - reported_share, -1 to 1. Loops: credit -
  // reported_share - needless, -2 to 1.
  double value = 0.0;
};
Score score_of(std::span<const Part> parts, const TestSet& test_set);

// Real recordings are often labelled by stretches of time rather than by instants, so they are
// judged by windows as well.
inline constexpr double window_length = 0.5;  // s, assumed: about the shortest slip that a person labels

// Windows of a recording, or of several: those that truly slip somewhere, and the others.
struct WindowCounts {
  std::size_t slipping = 0, detected = 0;    // windows that slip; of these, windows in which slip is reported
  std::size_t sticking = 0, unreported = 0;  // windows that do not; of these, windows in which it is not reported

  void add(const WindowCounts& other);
};

// Counts the windows of one recording; samples that Truth::masked leaves out belong to no window.
WindowCounts window_counts(const eval::Truth& truth, const eval::Replayed& replayed);

// Returns the 95 % interval of Score::value: exact for specificity, else by bootstrap over trials
// as eval::summarised(), NaN for fewer than eval::fewest_experiments trials.
Interval score_interval(std::span<const Part> parts, const TestSet& test_set);

}  // namespace slipbench::benchmark
