#include <chrono>
#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/base/workers/interrupt.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/accuracy_setting.h"
#include "tools/program/cli/commands.h"
#include "tools/program/cli/progress.h"
#include "tools/program/cli/sweep_text.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/run/run_sweep.h"

namespace slipbench {
namespace {

// What a sweep gave, and how long it took on the clock.
struct Finished {
  SweepSummary summary;
  double elapsed = 0.0;  // s
};

SweepOptions sweep_options(const Options& options) {
  SweepOptions sweep;
  sweep.verb = options.command;
  sweep.scene_path = options.scene;
  sweep.overrides = options.overrides;
  sweep.seed = options.seed;
  sweep.jobs = options.jobs.value_or(0);
  sweep.output = options.output;
  sweep.recording = options.record;
  return sweep;
}

Finished simulate(SweepOptions sweep, const Options& options, const Catalogues& catalogues) {
  // Until the scene is checked there is nothing to keep: a signal ends the program as usual.
  std::optional<InterruptGuard> guard;
  sweep.on_start = [&guard] { guard.emplace(); };
  sweep.interrupt = &InterruptGuard::flag();
  Progress progress = Progress::for_stream(stderr, options.quiet || options.json);
  const auto start = std::chrono::steady_clock::now();
  try {
    SweepSummary summary = run_sweep(sweep, catalogues, [&progress](const SweepProgress& state) {
      progress.update(state.done, state.total, state.simulated);
    });
    progress.clear();
    return {std::move(summary), std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
  } catch (...) {
    progress.clear();  // the message that follows starts on a line of its own
    throw;
  }
}

std::string joined(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

void print_json(const Finished& finished) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(summary_json(finished.summary));
  json["elapsed_s"] = finished.elapsed;
  json["computed_s"] = finished.summary.computed;
  json["times_real_time"] = finished.summary.simulated / finished.elapsed;
  json["times_real_time_per_core"] = finished.summary.simulated / finished.summary.computed;
  if (std::vector<GraspRow> rows = grasp_rows(finished.summary); !rows.empty()) json["grasps"] = grasp_json(rows);
  fmt::print("{}\n", json.dump());
}

void print_only_trial(const Options& options, const SweepSummary& summary, const Catalogues& catalogues, const Style& style) {
  fmt::print("{}{}", scene_text(summary.scene, catalogues, style, terminal_width(stdout)),
             trial_text(summary.trials.front(), sensors_of(summary.scene), style));
  if (summary.available > 1) {
    fmt::print("  this is trial {} of the {} of the scene's sweep; all of them: slipbench sweep {}\n",
               summary.trials.front().trial, summary.available, options.scene);
  }
}

void print_next(const Options& options, const SweepSummary& summary, const Style& style) {
  if (summary.files.empty()) {
    fmt::print("{} slipbench {} {} -o FILE.h5 keeps the recordings\n", style.dim("next:"), options.command, options.scene);
  } else {
    fmt::print("{} {}\n{} slipbench report {}\n", style.good("written:"), joined(summary.files), style.dim("next:"),
               summary.files.front());
  }
}

void print_summary(const Options& options, const Finished& finished, const Catalogues& catalogues) {
  const SweepSummary& summary = finished.summary;
  const Style style = style_for(stdout);
  if (summary.trials.size() == 1) {
    print_only_trial(options, summary, catalogues, style);
  } else {
    fmt::print("{}", sweep_text(summary, style));
  }
  fmt::print("\n{}\n", speed_text(summary, finished.elapsed));
  print_next(options, summary, style);
}

int report_interrupted(const SweepSummary& summary) {
  const std::string kept = summary.files.empty() ? "nothing is kept" : "kept in " + joined(summary.files);
  say(stderr,
      fmt::format("slipbench: interrupted: {} of {} trials finished; {}\n", summary.trials.size(), summary.planned, kept));
  return exit_interrupted;
}

int simulate_and_print(SweepOptions sweep, const Options& options) {
  const Catalogues catalogues = program_catalogues();
  settle_accuracy(sweep, catalogues, options.quiet || options.json);
  const Finished finished = simulate(sweep, options, catalogues);
  if (options.json) {
    print_json(finished);
  } else if (!options.quiet && !finished.summary.interrupted) {
    print_summary(options, finished, catalogues);
  }
  return finished.summary.interrupted ? report_interrupted(finished.summary) : exit_good;
}

}  // namespace

int run_command(const Options& options) {
  SweepOptions sweep = sweep_options(options);
  sweep.only = options.trial;
  sweep.limit = options.trials.value_or(options.trial ? 0 : 1);
  return simulate_and_print(sweep, options);
}

int sweep_command(const Options& options) {
  SweepOptions sweep = sweep_options(options);
  sweep.trials = options.trials.value_or(0);
  return simulate_and_print(sweep, options);
}

}  // namespace slipbench
