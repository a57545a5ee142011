#include "tools/cli/commands/detectors/detector_commands.h"

#include <algorithm>
#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "tools/calibrate/calibrate_page.h"
#include "tools/calibrate/snapshots.h"
#include "tools/cli/arguments.h"
#include "tools/cli/terminal.h"
#include "tools/files/project/project_file.h"
#include "tools/files/reject.h"
#include "tools/formats/import/import.h"
#include "tools/registry/program_catalogues.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench {
namespace {

std::string command_text(const calibrate::Options& options, const std::vector<std::string>& fits) {
  std::string text = "slipbench calibrate " + shell_word(options.scene_path);
  for (const std::string& recording : options.recordings) text += " " + shell_word(recording);
  if (options.format != nullptr) text += " --format " + shell_word(format_name(*options.format));
  if (options.groups)
    text += " --groups " + shell_word(fmt::format("{}={}", options.groups->label, fmt::join(options.groups->values, ",")));
  for (const std::string& fit : fits) text += " --fit " + shell_word(fit);
  for (const Override& change : options.overrides) text += " --set " + shell_word(change.path + "=" + change.value);
  if (options.seed) text += fmt::format(" --seed {}", *options.seed);
  text += fmt::format(" --starts {}", options.starts);
  return options.synthetic_truth ? text + " --synthetic-truth" : text;
}

}  // namespace

void CalibrateCommand::declare(Arguments& arguments) {
  arguments.about("calibrate", "Fit a scene to recordings of a real sensor",
                  fmt::format(R"(
Fits what --fit names to recordings, by simulation alone, and says how well each is known and what the recordings do not determine. The scene's
sweep has a trial for each recording, in their order, or one trial that all repeat: it says how the stage moved. The first samples of both are
taken for the same instant; --fit 'lag: {{min: -50 ms, max: 50 ms}}' fits the difference.

  --fit 'KEY: {{min: .., max: ..}}'         a key of the scene between two bounds
  draw: log_uniform                       searched by its logarithm
  each: true                              a value for each recording; the fitted scene draws it with the scatter that was found

--groups class=n,e,s compares recordings whose motion nobody knows: those whose label class is n belong to the first cell of the grid of the scene's sweep,
and so on. Its trials are draws, and means over a group are compared. What the sweep draws can be fitted: sweep.motion.compression.median.

-o writes the scene with the fitted values, and beside it FILE.html and FILE.json: intervals, profiles, residuals, real beside synthetic.
--synthetic-truth simulates the recordings from values drawn between the bounds, with the scene's electronics, and shows how well it finds
them: status 1 where a value is missed by more than twice its interval.

--snapshots needs no scene: REAL are recordings with the force and the displacement of every unit, in any order. It fits a stiffness matrix to
each unit by least squares and prints k_normal, k_tangential and, for a PapillArray, the limits of coupling and the scales of gain and noise, with standard errors.

Formats:
{}
Examples:
  slipbench calibrate pad.yaml logs --format papillarray-csv --fit 'sensors.pad.k_normal: {{min: 2 N/mm, max: 12 N/mm}}' -o mine.yaml
  slipbench calibrate scenes/papillarray/recordings.yaml --synthetic-truth --fit 'motion.tilt.0: {{min: -2 deg, max: 2 deg}}'
  slipbench calibrate --snapshots snapshots.h5)",
                              import_formats_text()));
  arguments
      .inputs("SCENE REAL ...", words_,
              "Scene file (YAML), unless --snapshots is given, then datasets, or with --format CSV files and folders")
      .required();
  arguments.lines("--fit KEY:BOUNDS ...", fits_,
                  "What is fitted, e.g. 'friction.static: {min: 0.2, max: 1}'; several may follow");
  arguments
      .read("--format NAME", fmt::format("REAL are {}, see below", fmt::join(import_format_names(), " or ")),
            [this](const std::string& name) { options.format = &import_format(name); })
      .offers(import_format_names);
  arguments.read("--groups LABEL=VALUES",
                 "Unknown motion: recordings by a label, a value for each cell of the grid, e.g. class=n,e,s",
                 [this](const std::string& text) { options.groups = calibrate::parse_groups(text); });
  arguments.flag("--synthetic-truth", options.synthetic_truth, "In place of REAL: recordings of drawn parameters");
  arguments.flag("--snapshots", snapshots_, "Stiffness, coupling and noise from force against displacement");
  arguments.text("--sensor NAME", sensor_, "Sensor of the snapshots (default: the only one with force and displacement)");
  arguments.quantity("--idle LENGTH", idle_, "Units that moved less are idle (default: 20 um)", Quantity::length);
  arguments.overrides(options.overrides, options.seed);
  arguments.number("--starts N", starts_, "Searches from different points, 1 to 64 (default: 4)", 1, 64);
  arguments.jobs(jobs_);
  arguments.flag("-q,--quiet", quiet, "No progress and no summary");
  arguments.file("-o,--output FILE.yaml", output, "Fitted scene to write, with FILE.html and FILE.json beside it");
  arguments.then([this] {
    if (snapshots_) {
      for (const auto& [given, name] : {std::pair{!fits_.empty(), "--fit"},
                                        {options.groups.has_value(), "--groups"},
                                        {options.synthetic_truth, "--synthetic-truth"},
                                        {!options.overrides.empty(), "--set"},
                                        {options.seed.has_value(), "--seed"},
                                        {starts_.has_value(), "--starts"},
                                        {jobs_.has_value(), "--jobs"},
                                        {!output.empty(), "-o"}}) {
        if (given) reject("calibrate: --snapshots fits a fixed law without a scene and cannot be combined with {}", name);
      }
      options.recordings = words_;
      return;
    }
    for (const auto& [given, name] : {std::pair{!sensor_.empty(), "--sensor"}, {idle_.has_value(), "--idle"}}) {
      if (given) reject("calibrate: {} needs --snapshots", name);
    }
    options.starts = starts_.value_or(options.starts);
    options.scene_path = scene_path(words_.front());
    options.recordings.assign(words_.begin() + 1, words_.end());
    if (options.recordings.empty() != options.synthetic_truth)
      throw InputError("calibrate: recordings and --synthetic-truth: allowed: one of the two");
    for (const std::string& fit : fits_) {
      for (calibrate::FitKey& key : calibrate::parse_fit_keys(fit)) options.keys.push_back(std::move(key));
    }
    if (options.keys.empty()) throw InputError("calibrate: --fit is required");
    options.jobs = jobs_.value_or(std::max(1U, std::thread::hardware_concurrency()));
    options.command = command_text(options, fits_);
  });
}

int CalibrateCommand::fit_snapshots() const {
  const Json result = calibrate::fit_snapshots(calibrate::read_recordings(options.recordings, options.format), sensor_,
                                               idle_.value_or(calibrate::default_idle));
  if (json) {
    print_json(result);
  } else if (!quiet) {
    const Style style = style_for(stdout);
    fmt::print("{}{}{}", Table(calibrate::snapshot_key_table(result)).text(style),
               Table(calibrate::snapshot_unit_table(result)).text(style), calibrate::snapshot_text(result));
  }
  return exit_good;
}

int CalibrateCommand::run() {
  if (snapshots_) return fit_snapshots();
  std::vector<std::string> inputs = options.recordings;
  inputs.push_back(options.scene_path);
  if (!output.empty()) calibrate::check_calibration_target(output, inputs);
  const calibrate::Result result = [this] {
    const InterruptGuard guard("stopping; nothing is kept");
    const InterruptScope scope(&InterruptGuard::flag());
    Progress progress = Progress::for_stream(stderr, silent());
    options.interrupt = &InterruptGuard::flag();
    options.progress = [&](std::size_t done, std::size_t of) { progress.update(done, of, std::nullopt); };
    return calibrate::calibrate(options, program_catalogues());
  }();
  std::vector<std::string> files;
  if (!output.empty()) files = calibrate::write_calibration(output, result.fitted, result.json);
  if (json) {
    print_json(result.json);
  } else {
    if (!quiet)
      fmt::print("{}{}\n", Table(calibrate::parameter_table(result.json)).text(style_for(stdout)),
                 calibrate::residual_text(result.json));
    print_written(files);
  }
  return options.synthetic_truth && !calibrate::recovers(result.json) ? exit_check_failed : exit_good;
}

}  // namespace slipbench
