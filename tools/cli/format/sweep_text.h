// Text output after a run: slip times of the units, the share of time in each class, and the speed.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/record/json.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/warnings.h"

namespace slipbench {

// "none 7.5 %, non-slip 44 %, incipient 0.2 %, gross 48 %"
std::string shares_text(const StateCounts& counts);

// "2.0312 s", to 0.1 ms; "-" for NaN.
std::string onset_text(double time);

// The files of a dataset, shortened to one line: "a.h5, a-0001.h5", or for more than three "a.h5
// and 499 further files up to a-0499.h5".
std::string files_text(const std::vector<std::string>& files);

// Describes the scene: description, surface, friction, motion, effects.
std::string scene_text(const Scene& scene, const Catalogues& catalogues, const Style& style, std::size_t width);

// Properties of a sensor for the table of a trial.
struct SensorAbout {
  std::string type;                     // "papillarray"
  double rate = 0.0;                    // Hz
  std::vector<std::string> unit_names;  // "P0", ...
};

// Properties of each sensor of a scene. A unit has the name that its sensor gives it ("P0_FX"),
// else its number.
std::vector<SensorAbout> sensors_of(const Scene& scene);

// One trial in full: a table of each sensor's units, for more than 40 units of the touching ones
// (touch, first micro-slip, full slip and its rank, slipped distance, load and margin at the end),
// the pad's gross slip, the shares of the classes, and one line each on the detector and the grasp,
// if any. `sensors` in the order of the trial's.
std::string trial_text(const TrialSummary& trial, const std::vector<SensorAbout>& sensors, const Style& style);

// Outcomes of a sweep's grasps with one detector and controller. Medians, in SI; NaN without
// values.
struct GraspRow {
  std::string name;  // "force_ratio (ratio 0.3), step_on_slip": detector and controller with their swept parameters
  std::size_t trials = 0;
  std::size_t held = 0, dropped = 0, not_lifted = 0;  // sum: all trials
  Interval held_share;                                // exact, 95 %
  double slip_translation;                            // m, of held grasps
  double slip_rotation;                               // rad, of held grasps
  double force_ratio;                                 // largest grip force over the ideal one
  double reaction_time;                               // s, of grasps that tightened after a slip
};

// One row for each detector and controller, in order of their first trial; empty if no trial is a
// grasp. If swept parameters would give more than 24 rows, they are ignored.
std::vector<GraspRow> grasp_rows(const SweepSummary& summary);

// The rows as a JSON array: {"name", "trials", "held", "dropped", "not_lifted", "held_share_95":
// [low, high], "median_slip_translation_m", "median_slip_rotation_rad", "median_force_ratio",
// "median_reaction_time_s"}; null for NaN.
Json grasp_json(const std::vector<GraspRow>& rows);

// A table of the detectors' scores; empty if there are none.
std::string detectors_text(const std::vector<DetectorScore>& scores, const Style& style);

// As a JSON array: {"type", "oracle", "recall_of_slip", "balanced_accuracy",
// "constant_balanced_accuracy",
// "median_delay_s", "worst_delay_s", "trials", "slipping", "seen", "early", "missed",
// "false_alarms", "accuracy", "constant_accuracy", "confusion"}; null for NaN.
Json detectors_json(const std::vector<DetectorScore>& scores);

// Several trials: number that reached each stage of slip with the times (earliest, median, latest),
// the shares of the classes, and tables of the detectors and of the grasps.
std::string sweep_text(const SweepSummary& summary, const Style& style);

// "800 s simulated in 3.2 s: 250 x real time, 62 trials/s; one core steps at 400 x real time". The
// first rate covers the whole command with reading and writing, the second the simulation alone.
std::string speed_text(const SweepSummary& summary, double elapsed);

// For grasps with fields, the time steps of their trials and the resulting accuracy: "time step
// 0.625 ms to 0.714 ms (auto): a slip begins ...". Empty for other scenes. Measured on
// scenes/learn/grasp.yaml (tools/cost/README.md).
std::string steps_text(const SweepSummary& summary);

// Prints each warning as a line on stderr, even without progress and summary: "slipbench: warning:
// stage.yaml:14: motion.start ...".
void print_warnings(const std::vector<Warning>& warnings);

}  // namespace slipbench
