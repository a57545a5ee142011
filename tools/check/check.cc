#include "tools/check/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/scene/entry_reader.h"
#include "tools/page/page.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/report.h"
#include "tools/trial/libraries.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench {
namespace {

using Comparison = ExpectationKind::Comparison;

constexpr double never = std::numeric_limits<double>::quiet_NaN();

const ExpectationKind& kind_of(const std::string& name) {
  const auto& kinds = expectation_catalogue();
  const auto found = std::ranges::find_if(kinds, [&](const ExpectationKind& kind) { return kind.about.name == name; });
  if (found == kinds.end()) throw std::logic_error("no such expectation: " + name);
  return *found;
}

// A value in the unit of the limit.
std::string value_text(const ExpectationKind& kind, double value, double limit) {
  if (std::isnan(value)) return kind.absent;
  if (kind.comparison == Comparison::equal) return value == 0.0 ? "false" : "true";
  const Quantity quantity = kind.about.parameters.front().quantity;
  const std::string text = format_quantity(limit, quantity);
  const std::size_t space = text.find(' ');
  if (space == std::string::npos) return fmt::format("{:.4g}", value);
  const std::string symbol = text.substr(space + 1);
  const auto units = units_of(quantity);
  const auto unit = std::ranges::find(units, symbol, &Unit::symbol);
  return fmt::format("{:.4g} {}", value / unit->factor, symbol);
}

std::string limit_text(const ExpectationKind& kind, double limit) {
  const std::string text = kind.comparison == Comparison::equal ? value_text(kind, limit, limit)
                                                                : format_quantity(limit, kind.about.parameters.front().quantity);
  return (kind.comparison == Comparison::at_most    ? "at most "
          : kind.comparison == Comparison::at_least ? "at least "
                                                    : "") +
         text;
}

// A trial, or the failure to run it.
struct CheckedTrial : TrialSummary {
  std::string failure;  // the reason of the failure; empty: it ran
};

// All trials of a sweep in order.
std::vector<CheckedTrial> checked_trials(const SweepSummary& summary) {
  std::vector<CheckedTrial> trials;
  for (const TrialSummary& trial : summary.trials) trials.push_back(CheckedTrial{trial, ""});
  for (const FailedTrial& failed : summary.failed) {
    trials.emplace_back().trial = failed.trial;
    trials.back().failure = failed.message;
  }
  std::ranges::sort(trials, {}, &CheckedTrial::trial);
  return trials;
}

double observed_in(const ExpectationKind& kind, const CheckedTrial& trial) {
  return trial.failure.empty() ? kind.observed(trial.outcome) : never;
}

bool keeps(const Named& expectation, const CheckedTrial& trial) {
  const ExpectationKind& kind = kind_of(expectation.name);
  return trial.failure.empty() && kind.kept(kind.observed(trial.outcome), kind.limit(expectation.parameters));
}

std::size_t kept_by(const Named& expectation, const std::vector<CheckedTrial>& trials) {
  return static_cast<std::size_t>(
      std::ranges::count_if(trials, [&](const CheckedTrial& trial) { return keeps(expectation, trial); }));
}

// Number of trials that must keep an expectation by its `pass` alone, at least one.
std::size_t share_of(const Named& expectation, std::size_t trials) {
  constexpr double rounding = 1e-9;  // 0.95 of 20 is 19 although 0.95 is inexact as a double
  const double share = std::ceil(expectation.parameters.number("pass") * static_cast<double>(trials) - rounding);
  return static_cast<std::size_t>(std::max(1.0, share));
}

// Number of trials that must keep an expectation, its `reliability` included.
std::size_t needed_of(const Named& expectation, std::size_t trials, double confidence) {
  const double reliability = expectation.parameters.number("reliability");
  const std::size_t shown = least_successes(trials, reliability, confidence);
  if (shown > trials) {
    throw SceneValueError(
        "expect." + expectation.name + ".reliability",
        fmt::format(
            "{} cannot be demonstrated with {}: if all meet the expectation, the {} % interval begins at {:.4f}; lower the reliability, or run more trials",
            reliability, counted(trials, "trial"), 100.0 * confidence, clopper_pearson(trials, trials, confidence).low));
  }
  return std::max(share_of(expectation, trials), shown);
}

// Options of the run that repeats one trial. `run` numbers trials by the scene's own sweep, so
// their number is set there.
SweepOptions replay_of(const CheckOptions& options, std::uint64_t seed, std::size_t trial) {
  SweepOptions run;
  run.verb = "run";
  run.scene_path = options.scene_path;
  run.overrides = options.overrides;
  if (options.trials > 0) run.overrides.push_back({"sweep.trials", std::to_string(options.trials)});
  run.seed = seed;
  run.only = trial;
  run.isolation = options.isolation;
  run.interrupt = options.interrupt;
  return run;
}

// The call in Python that repeats the trial: the program does not know parts that Python registered.
std::string python_command(const SweepOptions& replay) {
  std::string changes;
  for (const Override& change : replay.overrides) {
    changes += fmt::format("{}{}: {}", changes.empty() ? "" : ", ", json_text(change.path), json_text(change.value));
  }
  return fmt::format("in Python, where its parts are registered: slipbench.Scene.load({}){}.run({}, seed={})",
                     json_text(replay.scene_path), changes.empty() ? "" : ".set({" + changes + "})", *replay.only, *replay.seed);
}

ExpectationResult result_of(const Named& expectation, const CheckOptions& options, const SweepSummary& summary,
                            const std::vector<CheckedTrial>& trials) {
  const ExpectationKind& kind = kind_of(expectation.name);
  const double limit = kind.limit(expectation.parameters);
  const double confidence = summary.scene.expect.confidence;
  ExpectationResult result;
  result.name = expectation.name;
  result.limit = limit_text(kind, limit);
  result.trials = trials.size();
  result.kept = kept_by(expectation, trials);
  result.needed = needed_of(expectation, result.trials, confidence);
  result.rate = clopper_pearson(result.kept, result.trials, confidence);

  // Worst first: a trial that fails to run, then one that misses the expectation, then by value,
  // then by number.
  std::vector<const CheckedTrial*> order;
  for (const CheckedTrial& trial : trials) order.push_back(&trial);
  const auto rank = [&](const CheckedTrial* trial) {
    return std::tuple(trial->failure.empty(), keeps(expectation, *trial), -kind.badness(observed_in(kind, *trial)));
  };
  std::ranges::stable_sort(order, {}, rank);
  result.worst = {order.front()->trial, observed_in(kind, *order.front())};
  result.worst_text = order.front()->failure.empty() ? value_text(kind, result.worst.value, limit) : "failed to run";
  // Median: for an even number the mean of the middle two; the worse one for a flag, or if either
  // has no value.
  const CheckedTrial& middle = *order[(order.size() - 1) / 2];
  const double other = observed_in(kind, *order[order.size() / 2]);
  result.median = observed_in(kind, middle);
  if (kind.comparison != Comparison::equal && !std::isnan(other)) result.median = 0.5 * (result.median + other);
  result.median_text = middle.failure.empty() ? value_text(kind, result.median, limit) : "failed to run";
  const SweepOptions replay = replay_of(options, summary.seed, result.worst.trial);
  result.replay = has_registered_parts(summary.scene) ? python_command(replay) : canonical_command(replay);
  return result;
}

// The trial that misses most of the failed expectations; among equals `worst`, else the earliest. A
// trial that failed to run leaves nothing to inspect, so it is chosen only if there is no other.
std::size_t most_telling(const std::vector<CheckedTrial>& trials, const std::vector<Named>& failed, std::size_t worst) {
  const auto missed = [&](const CheckedTrial& trial) {
    return std::ranges::count_if(failed, [&](const Named& expectation) { return !keeps(expectation, trial); });
  };
  return std::ranges::max_element(trials, {},
                                  [&](const CheckedTrial& trial) {
                                    return std::tuple(missed(trial) > 0 && trial.failure.empty(), missed(trial),
                                                      trial.trial == worst);
                                  })
      ->trial;
}

// Throws Interrupted if the sweep was: some of the trials prove nothing.
SweepSummary run_whole(const SweepOptions& sweep, const Catalogues& catalogues, const ProgressCallback& progress = {}) {
  SweepSummary summary = run_sweep(sweep, catalogues, progress);
  if (summary.interrupted) throw Interrupted();
  return summary;
}

// Writes dataset and report of one trial. A trial that fails to run has neither; its message gives
// the reason.
std::vector<std::string> leave_trial(const SweepOptions& replay, const std::string& folder, const Catalogues& catalogues) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder + ": cannot be created: " + error.message());
  SweepOptions run = replay;
  const std::string name = (std::filesystem::path(folder) / fmt::format("trial_{}", *replay.only)).string();
  run.output = name + ".h5";
  std::vector<std::string> files = run_whole(run, catalogues).files;
  if (!files.empty()) {
    write_report(files.front(), name + ".html");
    files.push_back(name + ".html");
  }
  return files;
}

// Runs every trial of the negative control with the same draws. A path fixed by --set leaves the
// sweep, so a controller axis has one value.
SweepSummary run_control(const SweepOptions& options, const std::string& control, const Catalogues& catalogues,
                         const ProgressCallback& progress) {
  SweepOptions sweep = options;
  sweep.on_start = nullptr;
  sweep.overrides.push_back({"controller", "{type: " + control + "}"});
  return run_whole(sweep, catalogues, progress);
}

SceneFile load_scene(const CheckOptions& options) {
  SceneFile file = SceneFile::load(options.scene_path);
  for (const Override& change : options.overrides) file.apply(change);
  return file;
}

// Throws InputError for a reliability that the number of trials cannot show.
void check_reliabilities(const TrialPlan& plan, const ExpectScene& expect) {
  try {
    for (const Named& expectation : expect.expectations)
      static_cast<void>(needed_of(expectation, plan.size(), expect.confidence));
  } catch (const SceneValueError& error) {
    throw InputError(plan.where(0, error.path()) + ": " + error.what());
  }
}

// Text inside double quotes. Line ends and tabs are escaped, since XML reads plain ones as spaces.
// XML has no escapes for other control characters, which escape_html() writes as text.
std::string attribute(std::string_view text) {
  std::string result;
  for (const char c : page::escape_html(text))
    result += c == '\n' || c == '\t' ? fmt::format("&#{};", int{c}) : std::string(1, c);
  return result;
}

// A CDATA section. An end mark inside the text is split between two sections.
std::string cdata(std::string_view text) {
  std::string result = "<![CDATA[";
  for (const char c : printable(text, true)) {
    if (c == '>' && result.ends_with("]]")) result += "]]><![CDATA[";
    result += c;
  }
  return result + "]]>";
}

// `message`: empty for a case that passed.
std::string test_case(const std::string& suite, const std::string& name, const std::string& message, const std::string& text) {
  const std::string head = fmt::format("    <testcase classname=\"{}\" name=\"{}\"", attribute(suite), attribute(name));
  if (message.empty()) return head + "/>\n";
  return fmt::format("{}>\n      <failure message=\"{}\" type=\"expectation\">{}</failure>\n    </testcase>\n", head,
                     attribute(message), cdata(text));
}

struct Suite {
  std::size_t tests = 0;
  std::size_t failures = 0;
  std::size_t skipped = 0;
  std::string cases;
};

Suite suite_of(const SceneCheck& check) {
  Suite suite;
  const std::string& name = check.scene_path;
  if (check.verdict == Verdict::not_checked) {
    suite.cases = fmt::format(
        "    <testcase classname=\"{}\" name=\"expect\">\n      <skipped message=\"the scene has no expectations\"/>\n"
        "    </testcase>\n",
        attribute(name));
    suite.tests = suite.skipped = 1;
    return suite;
  }
  for (const ExpectationResult& result : check.expectations) {
    ++suite.tests;
    std::string message;
    std::string text;
    if (!result.passed()) {
      ++suite.failures;
      message = failure_text(result);
      text = message + "\nreplay: " + result.replay;
      for (const std::string& failure : check.failures) text += "\n" + failure;
      for (const std::string& file : check.files) text += "\nfile: " + file;
    }
    suite.cases += test_case(name, result.name, message, text);
  }
  if (!check.control.empty()) {
    ++suite.tests;
    const bool nothing = check.verdict == Verdict::tests_nothing;
    if (nothing) ++suite.failures;
    suite.cases += test_case(name, "negative_control", nothing ? "tests nothing" : "", tests_nothing_text(check));
  }
  return suite;
}

}  // namespace

std::string verdict_text(Verdict verdict) {
  constexpr std::array<const char*, 4> words{"passed", "failed", "tests nothing", "not checked"};
  return words.at(static_cast<std::size_t>(verdict));
}

bool expects_anything(const CheckOptions& options, const Catalogues& catalogues) {
  return !parse_scene(load_scene(options), catalogues).expect.expectations.empty();
}

SweepOptions sweep_of(const CheckOptions& options) {
  SweepOptions sweep;
  sweep.scene_path = options.scene_path;
  sweep.overrides = options.overrides;
  sweep.seed = options.seed;
  sweep.trials = options.trials;
  sweep.jobs = options.jobs;
  sweep.isolation = options.isolation;
  sweep.interrupt = options.interrupt;
  sweep.on_start = options.on_start;
  return sweep;
}

SceneCheck check_scene(const CheckOptions& options, const Catalogues& catalogues, const ProgressCallback& progress) {
  const InterruptScope scope(options.interrupt);
  const SceneFile file = load_scene(options);
  const std::uint64_t seed = options.seed ? *options.seed : parse_scene(file, catalogues).seed;
  const TrialPlan plan(file, catalogues, options.trials, seed);
  const ExpectScene expect = plan.trial(0).scene.expect;
  const std::vector<Named>& expectations = expect.expectations;
  SceneCheck check;
  check.scene_path = options.scene_path;
  check.seed = seed;
  check.confidence = expect.confidence;
  check.control = expect.control;
  if (expectations.empty()) return check;
  check_reliabilities(plan, expect);

  const SweepOptions sweep = sweep_of(options);
  const SweepSummary summary = run_whole(sweep, catalogues, progress);
  check.warnings = trial_warnings(summary.trials);
  check.detectors = detector_scores(summary.trials);
  const std::vector<CheckedTrial> trials = checked_trials(summary);
  for (const Named& expectation : expectations) check.expectations.push_back(result_of(expectation, options, summary, trials));
  for (const FailedTrial& trial : summary.failed) check.failures.push_back(trial.message);

  bool control_fails = check.control.empty();
  if (!check.control.empty()) {
    const SweepSummary control = run_control(sweep, check.control, catalogues, progress);
    check.control_trials = control.planned;
    // A control that does not tighten fails expectations of its reaction; if it keeps the box, the
    // scene needs no reaction.
    const bool about_box = std::ranges::any_of(expectations, [](const Named& asked) { return kind_of(asked.name).of_box; });
    for (std::size_t i = 0; i < expectations.size(); ++i) {
      const std::size_t kept = kept_by(expectations[i], checked_trials(control));
      check.expectations[i].control_kept = kept;
      const bool counts = !about_box || kind_of(expectations[i].name).of_box;
      control_fails = control_fails || (counts && kept < share_of(expectations[i], check.control_trials));
    }
  }

  std::vector<Named> failed;
  std::size_t worst = 0;  // of the first failed expectation
  for (std::size_t i = expectations.size(); i-- > 0;) {
    if (check.expectations[i].passed()) continue;
    failed.push_back(expectations[i]);
    worst = check.expectations[i].worst.trial;
  }
  check.verdict = !failed.empty() ? Verdict::failed : control_fails ? Verdict::passed : Verdict::tests_nothing;
  if (failed.empty()) return check;
  check.replayed = most_telling(trials, failed, worst);
  const bool runs = std::ranges::find(trials, *check.replayed, &CheckedTrial::trial)->failure.empty();
  if (runs && !options.folder.empty()) {
    check.files = leave_trial(replay_of(options, summary.seed, *check.replayed), options.folder, catalogues);
  }
  return check;
}

std::string failure_text(const ExpectationResult& result) {
  return fmt::format("{}: {} in {} of {}, needed in {}; worst: {} in trial {}", result.name, result.limit, result.kept,
                     counted(result.trials, "trial"), result.needed, result.worst_text, result.worst.trial);
}

std::string tests_nothing_text(const SceneCheck& check) {
  return fmt::format(
      "tests nothing: the negative control, controller {}, also meets all expectations; use a heavier box, a smoother surface or a lower preset",
      check.control);
}

std::string junit_xml(const std::vector<SceneCheck>& checks) {
  Suite all;
  for (const SceneCheck& check : checks) {
    const Suite suite = suite_of(check);
    all.tests += suite.tests;
    all.failures += suite.failures;
    all.skipped += suite.skipped;
    all.cases +=
        fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n{}  </testsuite>\n",
                    attribute(check.scene_path), suite.tests, suite.failures, suite.skipped, suite.cases);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"slipbench check\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\">\n{}</testsuites>\n",
      all.tests, all.failures, all.skipped, all.cases);
}

}  // namespace slipbench
