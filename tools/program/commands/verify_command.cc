#include "tools/program/commands/verify_command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/verify/verify.h"

namespace slipbench {
namespace {

using Json = nlohmann::ordered_json;

// The text of a dataset's value, as a terminal may get it: it comes from a file.
std::string text_of(const Json& value) { return printable(value.get<std::string>()); }

// "trial 3, labels/pad/force, sample 17: ".
std::string place_of(const Json& failure) {
  std::string place;
  const auto add = [&place](const std::string& part) { place += (place.empty() ? "" : ", ") + part; };
  if (!failure["trial"].is_null()) add(fmt::format("trial {}", failure["trial"].get<std::size_t>()));
  if (!failure["array"].is_null()) add(text_of(failure["array"]));
  if (!failure["sample"].is_null()) add(fmt::format("sample {}", failure["sample"].get<std::size_t>()));
  return place.empty() ? "" : place + ": ";
}

std::string report_of(const Json& dataset, const Style& style) {
  const bool holds = dataset["holds"].get<bool>();
  std::string text = fmt::format("{} {}: {} trials in {} files{}\n", holds ? style.good("holds:") : style.error("does not hold:"),
                                 text_of(dataset["file"]), dataset["trials"].get<std::size_t>(), dataset["files"].size(),
                                 dataset["complete"].get<bool>() ? "" : ", of a run that did not come to its end");
  for (const Json& check : dataset["checks"]) {
    const std::string name = check["check"].get<std::string>();
    const auto failed = check["failed"].get<std::size_t>();
    text += fmt::format("  {:<8} {:>12} {}{}\n", name, check["checked"].get<std::size_t>(), check["of"].get<std::string>(),
                        failed == 0 ? "" : ", " + style.error(fmt::format("{} failed", failed)));
    for (const Json& failure : dataset["failures"]) {
      if (failure["check"] == name) text += fmt::format("    {}{}\n", place_of(failure), text_of(failure["what"]));
    }
    for (const Json& reason : check["left_out"]) text += fmt::format("    {} {}\n", style.dim("left out:"), text_of(reason));
  }
  return text;
}

std::string sweep_report(const Json& sweep, const Style& style) {
  std::string text =
      fmt::format("{} the {} shards together", sweep["holds"].get<bool>() ? style.good("holds:") : style.error("does not hold:"),
                  sweep["shards"].get<std::size_t>());
  if (!sweep["trials"].is_null()) text += fmt::format(": {} trials", sweep["trials"].get<std::size_t>());
  if (!sweep["duplicates"].is_null() && sweep["duplicates"] != 0) {
    text += fmt::format(", {} of them twice with the same digest, which is harmless", sweep["duplicates"].get<std::size_t>());
  }
  text += "\n";
  for (const Json& failure : sweep["failures"]) text += fmt::format("  {}\n", text_of(failure));
  return text;
}

}  // namespace

void VerifyCommand::declare(Arguments& arguments) {
  arguments.about("verify", "Hold datasets against themselves", R"(
Checks digests, order and masks of trials, times, that values are finite, events against onset times and states, and Coulomb's law in the
labels. Shards of a sweep (sweep --shard k/n) are held against each other too: one sweep, no gaps, no trial twice with different digests. Says what was checked, what was left out and why, and what does not hold, with trial, array and sample.
Exit status 1: something does not hold; 2: a file cannot be read.

Examples:
  slipbench verify hexapod.h5
  slipbench verify shard-1.h5 shard-2.h5
  slipbench verify hexapod.h5 --json)");
  arguments.texts("FILE ...", datasets, "Datasets (HDF5), by their first files").required();
}

int VerifyCommand::run() {
  const Verified verified = verify_datasets(datasets);
  const Style style = style_for(stdout);
  if (json) {
    Json object{{"holds", verified.holds && verified.readable}, {"datasets", verified.datasets}};
    if (!verified.sweep.is_null()) object["sweep"] = verified.sweep;
    fmt::print("{}\n", object.dump(-1, ' ', false, Json::error_handler_t::replace));
  }
  for (const Json& dataset : verified.datasets) {
    if (dataset.contains("error")) {
      say(stderr,
          fmt::format("{} {}\n", style_for(stderr).error("slipbench:"), printable(dataset["error"].get<std::string>(), true)));
    } else if (!json) {
      fmt::print("{}", dataset.contains("part_of") ? fmt::format("verified with its first file: {}\n", text_of(dataset["file"]))
                                                   : report_of(dataset, style));
    }
  }
  if (!json && !verified.sweep.is_null()) fmt::print("{}", sweep_report(verified.sweep, style));
  if (!verified.readable) return exit_bad_input;
  return verified.holds ? exit_good : exit_check_failed;
}

}  // namespace slipbench
