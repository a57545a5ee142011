// The commands. Each prints its result on stdout and returns the exit status; bad input is an InputError.
#pragma once

#include "tools/program/cli/options.h"

namespace slipbench {

inline constexpr int exit_good = 0;
inline constexpr int exit_check_failed = 1;
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_interrupted = 130;  // 128 + SIGINT, as shells count

int run_command(const Options& options);          // run
int sweep_command(const Options& options);        // sweep
int check_command(const Options& options);        // check
int report_command(const Options& options);       // report
int export_command(const Options& options);       // export
int hd_replay_command(const Options& options);    // hd replay
int train_command(const Options& options);        // train
int eval_command(const Options& options);         // eval
int reproduce_command(const Options& options);    // reproduce
int cost_command(const Options& options);         // cost
int bench_command(const Options& options);        // bench
int list_command(const Options& options);         // list
int describe_command(const Options& options);     // describe
int plugin_path_command(const Options& options);  // plugin-path
int version_command(const Options& options);      // --version

}  // namespace slipbench
