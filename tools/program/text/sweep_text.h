// What a person reads after a run: when each unit slipped, the share of time in each class, and how fast it went.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"
#include "tools/base/record/json.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/cost/explore.h"
#include "tools/program/sweep/run_sweep.h"
#include "tools/program/sweep/warnings.h"

namespace slipbench {

// "none 7.5 %, non-slip 44 %, incipient 0.2 %, gross 48 %"
std::string shares_text(const StateCounts& counts);

// "2.0312 s" to 0.1 ms, or "-" where it never happened.
std::string onset_text(double time);

// The files of a dataset, as many as fit a line: "a.h5, a-0001.h5", or of more than three "a.h5 and 499 further files up to a-0499.h5".
std::string files_text(const std::vector<std::string>& files);

// What the scene is: description, surface, friction, motion, effects.
std::string scene_text(const Scene& scene, const Catalogues& catalogues, const Style& style, std::size_t width);

// What the table of a trial says of a sensor beside its outcome.
struct SensorAbout {
  std::string type;                     // "papillarray"
  double rate = 0.0;                    // Hz
  std::vector<std::string> unit_names;  // "P0", ...
};

// Of each sensor of a scene. A unit is named where its sensor names it ("P0_FX"), else it has its number.
std::vector<SensorAbout> sensors_of(const Scene& scene);

// One trial in full: a table of the units of each sensor, of one with more than 40 of those that touch (touch, first micro-slip, full slip and its rank, slipped distance, load
// and margin at the end), the pad's gross slip, the shares of the classes, and a line each on the detector and the grasp where
// there are such. `sensors` in the order of the trial's.
std::string trial_text(const TrialSummary& trial, const std::vector<SensorAbout>& sensors, const Style& style);

// How the grasps of a sweep with one detector and controller ended. Medians, in SI; NaN where there is nothing to take one of.
struct GraspRow {
  std::string name;  // "force_ratio (ratio 0.3), step_on_slip": swept parameters of the two with their values
  std::size_t trials = 0;
  std::size_t held = 0, dropped = 0, not_lifted = 0;  // together all trials
  Interval held_share;                                // exact, 95 %
  double slip_translation;                            // m, of the held
  double slip_rotation;                               // rad, of the held
  double force_ratio;                                 // largest grip force over the ideal one
  double reaction_time;                               // s, of those that tightened after a slip
};

// A row for each detector and controller in order of their first trial; empty where no trial is a grasp. Where swept parameters
// make more than 24 rows, trials that differ in these alone share one.
std::vector<GraspRow> grasp_rows(const SweepSummary& summary);

// The rows as a JSON array: {"name", "trials", "held", "dropped", "not_lifted", "held_share_95": [low, high], "median_slip_translation_m",
// "median_slip_rotation_rad", "median_force_ratio", "median_reaction_time_s"}; null for NaN.
Json grasp_json(const std::vector<GraspRow>& rows);

// A table of how the detectors did; empty where there is none.
std::string detectors_text(const std::vector<DetectorScore>& scores, const Style& style);

// The same as a JSON array: {"type", "oracle", "recall_of_slip", "balanced_accuracy", "constant_balanced_accuracy",
// "median_delay_s", "worst_delay_s", "trials", "slipping", "seen", "early", "missed", "false_alarms", "accuracy",
// "constant_accuracy", "confusion"}; null for NaN.
Json detectors_json(const std::vector<DetectorScore>& scores);

// Several trials: how many reached each stage of slip and when (earliest, median, latest), the shares of the classes, and tables
// of the detectors and of the grasps.
std::string sweep_text(const SweepSummary& summary, const Style& style);

// "800 s simulated in 3.2 s: 250 x real time, 62 trials/s; one core steps at 400 x real time". The first rate is that of the
// whole command, with reading and writing; the second is that of the simulation alone.
std::string speed_text(const SweepSummary& summary, double elapsed);

// Of grasps with fields, the steps that their trials took and what these are good for: "time step
// 0.625 ms to 0.714 ms (auto): a slip begins ...". Empty of all other scenes. Measured on
// scenes/learn/grasp.yaml (tools/program/cost/README.md).
std::string steps_text(const SweepSummary& summary);

// A line each on stderr, also where there is no progress and no summary: "slipbench: warning: stage.yaml:14: motion.start ...".
void print_warnings(const std::vector<Warning>& warnings);

// `result`: of eval::evaluate(). The figures that mislead least come first.
std::string eval_text(const Json& result, const Style& style);

// The sentences, a table of all settings by series with their worst errors, why some did not run, the price of each effect.
std::string cost_text(const cost::Exploration& exploration, const Style& style, std::size_t width);

}  // namespace slipbench
