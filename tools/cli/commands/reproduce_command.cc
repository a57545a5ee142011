#include "tools/cli/commands/reproduce_command.h"

#include "tools/cli/arguments.h"
#include "tools/cli/terminal.h"
#include "tools/dataset/record/json.h"
#include "tools/page/page.h"
#include "tools/workers/python_package/python_package.h"

namespace slipbench {
namespace {

// Kind of the pages that tools/studies/page.py writes.
constexpr page::PageKind page_kind{
    "a result", "slipbench reproduce", "result page", "result of a reproduction", {"reproduction"}};

}  // namespace

void ReproduceCommand::declare(Arguments& arguments) {
  arguments.about("reproduce", "Reproduce a table of a paper", R"(
Without a name: what can be reproduced. With -o the table goes to FILE.html and all figures to FILE.json beside it. Studies that train networks
keep those that are done in FILE.networks until the page is written: where such a run was killed or interrupted, the same command with
--resume goes on with them.

Examples:
  slipbench reproduce
  slipbench reproduce hd-papillarray/table1 --data hexapod.h5 -o table1.html
  slipbench reproduce hd-papillarray/table2 --trials 2 --only as_recorded,light,rubber,gst_hd,hold_preset)");
  arguments.text("PAPER/TABLE", name, "What to reproduce (default: list what there is)");
  arguments.file("-o,--output FILE.html", output, "Write the page, and FILE.json beside it");
  arguments.number("--trials N", trials, "Trials of each row, or recordings (default: of a size that takes minutes)", 1);
  arguments.texts(
      "--only NAME,...", only,
      "table2: protocols, boxes, surfaces and loops to keep; grasp_loop: loops; scaling: sensors; realism: studies; table1, table3, "
      "table4: networks");
  arguments.text("--memories DIR", memories, "table2: folder of the published classifier");
  arguments.flag("--full", full, "The paper's size: hours");
  arguments.input("--data FILE.h5", data, "Use this dataset instead of a fresh one", ".h5");
  arguments.input("--real FILE.h5", real,
                  "biotac-stability-slip: recordings that `slipbench import` has read; table3: of biotacsp-dos, else of bts3v2");
  arguments.number("--seed N", seed, "Seed of dataset, item memories and draws (default: 1)", 0);
  arguments.jobs(jobs);
  arguments.flag("--resume", resume, "Go on with the networks that a killed or interrupted run of the same command has left");
  arguments.flag("--synthesise", synthesise, "Run the synthesis instead of reading its stored figures");
  arguments.flag("-q,--quiet", quiet, "No progress");
}

int ReproduceCommand::run() {
  if (!output.empty()) page::check_page_files(output, page_kind);
  const PythonModule module("slipbench_studies", name.empty() ? "reproduce" : "reproduce " + name, "studies");
  take_stdout_back();
  module.start(Json{
      {"name", name},
      {"json", json},
      {"quiet", quiet},
      {"install", module.install()},
      {"data", data},
      {"real", real},
      {"seed", or_null(seed)},
      {"jobs", jobs},
      {"full", full},
      {"synthesise", synthesise},
      {"trials", trials},
      {"only", only},
      {"memories", memories},
      {"output", output},
      {"resume",
       resume}}.dump());
}

}  // namespace slipbench
