// Records all trials of a scene and writes their report: slipbench_demo SCENE.yaml FILE.h5 FILE.html.
// `slipbench sweep` and `slipbench report` do the same with any scene.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/cli/format/sweep_text.h"
#include "tools/cli/terminal.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/report.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {
namespace {

void record_and_report(const std::string& scene, const std::string& dataset, const std::string& page) {
  const auto start = std::chrono::steady_clock::now();
  const Catalogues catalogues = program_catalogues();
  SweepOptions options;
  options.scene_path = scene;
  options.output = dataset;
  options.keep_units = false;
  Progress progress = Progress::for_stream(stderr, false);
  const SweepSummary summary = run_sweep(options, catalogues, [&progress](const SweepProgress& state) {
    progress.update(state.done, state.total, state.simulated);
  });
  if (!summary.failed.empty()) throw InputError(summary.failed.front().message);
  const Style style = style_for(stdout);
  if (summary.trials.size() == 1) {
    print_text("{}{}", scene_text(summary.scene, catalogues, style, terminal_width(stdout)),
               trial_text(summary.trials.front(), sensors_of(summary.scene), style));
  } else {
    print_text("{}", sweep_text(summary, style));
  }
  print_text("\n{}\n", speed_text(summary, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()));
  write_report(dataset, page);
  print_written({dataset, page});
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw InputError("cannot write to standard output");
}

}  // namespace
}  // namespace slipbench

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // writing beyond the limit of a file's size then fails as on a full disk
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() != 3) throw slipbench::InputError("expected: slipbench_demo SCENE.yaml FILE.h5 FILE.html");
    slipbench::record_and_report(words[0], words[1], words[2]);
    return 0;
  } catch (const std::exception& error) {
    slipbench::say(stderr, fmt::format("slipbench: {}\n", error.what()));
    return 2;
  }
}
