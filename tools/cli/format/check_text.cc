#include "tools/cli/format/check_text.h"

#include <cstddef>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "tools/cli/format/sweep_text.h"

namespace slipbench {
namespace {

std::string kept_text(std::size_t count, std::size_t total) { return fmt::format("{} of {}", count, total); }

}  // namespace

std::string check_text(const SceneCheck& check, const Style& style) {
  std::string text = style.heading(check.scene_path);
  if (check.verdict == Verdict::not_checked) return text + "  " + style.dim("not checked: the scene has no expectations") + '\n';
  text += fmt::format("  {}, seed {}\n", counted(check.expectations.front().trials, "trial"), check.seed);
  Table table({"expectation", "limit", "median", "worst", "trial", "met by", "needed",
               fmt::format("{:g} % interval", 100.0 * check.confidence), "control", ""});
  for (const ExpectationResult& result : check.expectations) {
    table.add({result.name, result.limit, result.median_text, result.worst_text, std::to_string(result.worst.trial),
               kept_text(result.kept, result.trials), std::to_string(result.needed),
               fmt::format("{:.3f} to {:.3f}", result.rate.low, result.rate.high),
               result.control_kept ? kept_text(*result.control_kept, check.control_trials) : "-",
               result.passed() ? "ok" : "FAIL"});
  }
  text += table.text(style) + detectors_text(check.detectors, style);
  for (const ExpectationResult& result : check.expectations) {
    if (!result.passed())
      text += fmt::format("  {} {}\n    replay: {}\n", style.error("FAIL"), failure_text(result), as_called(result.replay));
  }
  for (const std::string& failure : check.failures) text += "  " + failure + '\n';
  if (check.verdict == Verdict::tests_nothing) text += fmt::format("  {} {}\n", style.error("FAIL"), tests_nothing_text(check));
  if (!check.files.empty()) text += fmt::format("  files of trial {}: {}\n", *check.replayed, fmt::join(check.files, ", "));
  return text;
}

}  // namespace slipbench
