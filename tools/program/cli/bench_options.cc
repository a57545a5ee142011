#include "tools/program/cli/bench_options.h"

#include <CLI/CLI.hpp>

namespace slipbench {

const std::string_view bench_footer = R"(
Runs the first trial of six reference scenes under callgrind, which counts the instructions that the trial takes, and prints them
by simulated second and by step, with times real time (the median CPU time of nine runs). Counts are the same at every run to
1e-6; they depend on compiler, flags, instruction set and libraries, so that results are compared with those of the same build only.

--compare counts and compares with FILE.json, or with the results in tests/benchmarks/results that are of this build: it prints each
scene's change and the functions whose own instructions changed most. Exit status 1 where a scene grew by more than 2 %, 2 where
there are no results of this build. -o writes the results, and a drawing of them as FILE.svg beside them.

Examples:
  slipbench bench
  slipbench bench --compare
  slipbench bench -o tests/benchmarks/results/ci.json)";

void add_bench_options(CLI::App& command, BenchOptions& options) {
  command.add_flag("--compare", options.compare, "Compare with stored results (default: the committed ones of this build)");
  command.add_option("FILE.json", options.compare_with, "Results to compare with")->option_text(" ");
}

}  // namespace slipbench
