#include "tools/program/commands/simulation/merge_command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/base/dataset/merge.h"
#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/text/sweep_text.h"

namespace slipbench {

void MergeCommand::declare(Arguments& arguments) {
  arguments.about("merge", "Put the shards of a sweep together", R"(
Writes the dataset that the undivided sweep would have written, byte for byte, from the files of sweep --shard k/n of all k. Arrays are copied
as they are compressed, so it takes little memory and no simulation. Shards of another scene, seed, version or n are refused, missing trials too.
A trial that stands in several files is taken once, if its digests agree. Trials are not unfolded: slipbench verify does that.

Examples:
  slipbench merge shard-1.h5 shard-2.h5 -o hexapod.h5)");
  arguments.texts("FILE ...", shards, "Shards (HDF5), by their first files").required();
  arguments.file("-o,--output FILE.h5", output, "Dataset to write; always needed").required();
}

int MergeCommand::run() {
  const Merged merged = merge_shards(shards, output);
  if (json) {
    fmt::print(
        "{}\n",
        nlohmann::ordered_json{
            {"files", merged.files}, {"trials", merged.trials}, {"failed", merged.failed}, {"duplicates", merged.duplicates}}
            .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    return exit_good;
  }
  std::string about = fmt::format("{} trials", merged.trials);
  if (merged.failed > 0) about += fmt::format(", {} have failed", merged.failed);
  if (merged.duplicates > 0) about += fmt::format(", {} stood in several files", merged.duplicates);
  fmt::print("{} {}: {}\n{} slipbench report {}\n", style_for(stdout).good("written:"), files_text(merged.files), about,
             style_for(stdout).dim("next:"), merged.files.front());
  return exit_good;
}

}  // namespace slipbench
