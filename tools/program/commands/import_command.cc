#include "tools/program/commands/import_command.h"

#include <cstdio>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/process/interrupted.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"

namespace slipbench {

void ImportCommand::declare(Arguments& arguments) {
  arguments.about("import", "Read recordings of real sensors into a dataset",
                  fmt::format(R"(
The dataset has the readings, and in place of the truth a sentence that says so. What the recordings say of slip is their state_paper.

Formats:
{}
Examples:
  slipbench import logs --format papillarray-csv -o recorded.h5
  slipbench import training --format training-csv -o published.h5 --seed 3)",
                              import_formats_text()));
  arguments.texts("SOURCE ...", options.sources, "Files, and folders whose .csv files are all meant").required();
  arguments
      .read("--format NAME", fmt::format("{}, see below", fmt::join(import_format_names(), " or ")),
            [this](const std::string& name) { options.format = &import_format(name); })
      .required();
  arguments.file("-o,--output FILE.h5", options.output, "Dataset to write (default: none, the sources are only checked)");
  arguments.number("--seed N", options.seed, "Of the split into training, validation and test (default: 1)", 0);
}

int ImportCommand::run() {
  ImportSummary summary;
  try {
    const InterruptGuard guard("stopping; nothing is kept");
    const InterruptScope scope(&InterruptGuard::flag());
    summary = import_recordings(options);
  } catch (const Interrupted&) {
    say(stderr, "slipbench: interrupted; nothing is written\n");
    return exit_interrupted;
  }
  if (json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"sources", summary.sources},
                                              {"trials", summary.trials},
                                              {"samples", summary.samples},
                                              {"repeated_rows", summary.repeated_rows},
                                              {"objects", summary.objects},
                                              {"files", summary.files}}
                           .dump());
    return exit_good;
  }
  const Style style = style_for(stdout);
  fmt::print("{} recordings of {} files, {} samples{}\n", summary.trials, summary.sources, summary.samples,
             summary.objects.empty() ? "" : fmt::format(", {} objects", summary.objects.size()));
  if (summary.repeated_rows > 0)
    fmt::print("{} rows left out that say the one before again, word for word\n", summary.repeated_rows);
  for (const std::string& file : summary.files) fmt::print("{} {}\n", style.good("written:"), file);
  if (summary.files.empty()) {
    say(stderr, "slipbench: nothing is written\n");
  } else {
    fmt::print("{} slipbench verify {}\n", style.dim("next:"), summary.files.front());
  }
  return exit_good;
}

}  // namespace slipbench
