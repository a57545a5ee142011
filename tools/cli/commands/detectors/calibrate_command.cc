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
Fits the parameters given by --fit to recordings, and reports how well the recordings determine each.
The sweep of the scene has one trial for each recording, in the same order, or a single trial
that all recordings repeat. The scene describes the motion of the stage. The first samples of
recording and trial count as simultaneous; --fit 'lag: {{min: -50 ms, max: 50 ms}}' fits the delay
between them.

  --fit 'KEY: {{min: .., max: ..}}'         a key of the scene, between two bounds
  draw: log_uniform                       search by the logarithm
  each: true                              fit one value per recording; the fitted scene draws it with
                                          the scatter of these values

--groups class=n,e,s is for recordings with unknown motion: recordings whose label class is n belong
to the first cell of the grid of the scene's sweep, and so on. The means of each group are compared
with those of random trials. Parameters of the sweep can be fitted:
sweep.motion.compression.median.

-o writes the scene with the fitted values, and FILE.html and FILE.json with intervals, profiles,
residuals, and real and synthetic curves. --synthetic-truth simulates recordings with values drawn
between the bounds, and reports how well the fit recovers them; the exit status is 1 if a value is
missed by more than twice its interval.

--snapshots needs no scene: REAL are recordings with force and displacement of each unit, in any
order. It fits a stiffness matrix to each unit by least squares, and prints k_normal, k_tangential
and, for a sensor that declares its disturbances, limits of coupling and scales of gain and noise,
with standard errors.

Formats:
{}
Examples:
  slipbench calibrate pad.yaml logs --format papillarray-csv --fit 'sensors.pad.k_normal: {{min: 2 N/mm, max: 12 N/mm}}' -o mine.yaml
  slipbench calibrate scenes/papillarray/recordings.yaml --synthetic-truth --fit 'motion.tilt.0: {{min: -2 deg, max: 2 deg}}'
  slipbench calibrate --snapshots snapshots.h5)",
                              import_formats_text()));
  arguments
      .inputs("SCENE REAL ...", words_,
              "Scene file (YAML; not with --snapshots), then datasets or, with --format, CSV files and folders")
      .required();
  arguments.lines("--fit KEY:BOUNDS ...", fits_,
                  "Key to fit with its bounds, e.g. 'friction.static: {min: 0.2, max: 1}'; repeatable");
  arguments
      .read("--format NAME", "Format of REAL (see the list below)",
            [this](const std::string& name) { options.format = &import_format(name); })
      .offers(import_format_names);
  arguments.read("--groups LABEL=VALUES", "For unknown motion: label, and its value for each cell of the grid, e.g. class=n,e,s",
                 [this](const std::string& text) { options.groups = calibrate::parse_groups(text); });
  arguments.flag("--synthetic-truth", options.synthetic_truth, "Instead of REAL: simulate recordings with random parameters");
  arguments.flag("--snapshots", snapshots_, "Fit stiffness, coupling and noise from force against displacement");
  arguments.text("--sensor NAME", sensor_, "Sensor of the snapshots (default: the only one with force and displacement)");
  arguments.quantity("--idle LENGTH", idle_, "Units that move less count as idle (default: 20 um)", Quantity::length);
  arguments.overrides(options.overrides, options.seed);
  arguments.number("--starts N", starts_, "Number of searches from different starting points, 1 to 64 (default: 4)", 1, 64);
  arguments.jobs(jobs_);
  arguments.flag("-q,--quiet", quiet, "Print no progress and no summary");
  arguments.file("-o,--output FILE.yaml", output, "Write the fitted scene, FILE.html and FILE.json");
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
        if (given) reject("calibrate: --snapshots fits a fixed law without a scene, so it cannot be combined with {}", name);
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
      throw InputError("calibrate: give either recordings or --synthetic-truth");
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
    print_text("{}{}{}", Table(calibrate::snapshot_key_table(result)).text(style),
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
    options.progress = [&](std::size_t done, std::size_t total) { progress.update(done, total, std::nullopt); };
    return calibrate::calibrate(options, program_catalogues());
  }();
  std::vector<std::string> files;
  if (!output.empty()) files = calibrate::write_calibration(output, result.fitted, result.json);
  if (json) {
    print_json(result.json);
  } else {
    if (!quiet)
      print_text("{}{}\n", Table(calibrate::parameter_table(result.json)).text(style_for(stdout)),
                 calibrate::residual_text(result.json));
    print_written(files);
  }
  return options.synthetic_truth && !calibrate::recovers(result.json) ? exit_check_failed : exit_good;
}

}  // namespace slipbench
