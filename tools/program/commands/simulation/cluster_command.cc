#include "tools/program/commands/simulation/cluster_command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/commands/simulation/accuracy_setting.h"
#include "tools/program/commands/simulation/recording_words.h"

namespace slipbench {

void ClusterCommand::declare(Arguments& arguments) {
  arguments.about("cluster", "Write a folder of scripts that run a sweep on many machines", R"(
A Slurm array, a Snakefile, and the two scripts that both call: one runs a shard with sweep --shard, the other verifies the shards and merges
them. The merged dataset has the bytes of the undivided sweep. A shard may be killed, run again or run twice at once. The folder's README.md
says how to start; its paths are those of this machine.

Examples:
  slipbench cluster scenes/papillarray/hexapod.yaml -o hexapod-cluster --shards 64
  slipbench cluster scenes/grasp/map.yaml -o map-cluster --shards 1000 --throttle 200 --record outcome)");
  SweepOptions& sweep = options.sweep;
  arguments.text("SCENE", sweep.scene_path, "Scene file (YAML)").required();
  arguments.folder("-o,--output DIR", options.folder, "Folder to write, new or empty; always needed").required();
  arguments.number("--shards N", options.shards, "Parts that the sweep is cut into; always needed", 1).required();
  arguments.number("--throttle N", options.throttle, "Most Slurm tasks at a time (default: all)", 1);
  arguments.overrides(sweep.overrides, sweep.seed);
  arguments.number("--trials N", sweep.trials, "Number of random draws of each cell of the grid", 1);
  arguments.word("--record NAME", sweep.recording,
                 "What the shards hold: everything (full, the default), or outcomes alone (outcome)", recording_words);
  arguments.jobs(sweep.jobs, "Worker threads of each shard, 1 to 1024 (default: 1)");
}

int ClusterCommand::run() {
  const Catalogues catalogues = program_catalogues();
  settle_accuracy(options.sweep, catalogues, *this);
  const std::vector<std::string> files = write_cluster_folder(options, catalogues);
  if (json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"files", files}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return exit_good;
  }
  for (const std::string& file : files) fmt::print("{} {}\n", style_for(stdout).good("written:"), file);
  fmt::print("{} read {}\n", style_for(stdout).dim("next:"), files.front());
  return exit_good;
}

}  // namespace slipbench
