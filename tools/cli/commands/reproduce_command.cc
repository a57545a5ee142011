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
Without a name, lists the tables that can be reproduced. With -o, the table is written to FILE.html
and all figures to FILE.json. Studies that train networks keep finished networks in FILE.networks
until the page is written; after a killed or interrupted run, the same command with --resume
continues with them.

Examples:
  slipbench reproduce
  slipbench reproduce hd-papillarray/table1 --data hexapod.h5 -o table1.html
  slipbench reproduce real --recordings downloads -o real.html
  slipbench reproduce hd-papillarray/table2 --trials 2 --only as_recorded,light,rubber,gst_hd,hold_preset)");
  arguments.text("PAPER/TABLE", name, "Table to reproduce (default: list all)");
  arguments.file("-o,--output FILE.html", output, "Write the page, and FILE.json");
  arguments.number("--trials N", trials, "Trials or recordings of each row (default: a number that takes a few minutes)", 1);
  arguments.texts(
      "--only NAME,...", only,
      "Run only these: protocols, boxes, surfaces, loops (table2), loops (grasp_loop), sensors (scaling), sets (real), studies (realism), networks (table1, table3, table4)");
  arguments.text("--memories DIR", memories, "table2: folder of the published classifier");
  arguments.flag("--full", full, "Run at the size of the paper, which takes hours");
  arguments.input("--data FILE.h5", data, "Use this dataset instead of simulating a new one", ".h5");
  arguments.input(
      "--real FILE.h5", real,
      "biotac-stability-slip: recordings from slipbench import: format biotacsp-dos for table3, bts3v2 for other tables");
  arguments.text("--recordings DIR", recordings, "real: folder with public recordings, whose sets are found by their files");
  arguments.number("--seed N", seed, "Seed of dataset, item memories and draws (default: 1)", 0);
  arguments.jobs(jobs);
  arguments.flag("--resume", resume, "Continue with the networks of a killed or interrupted run of the same command");
  arguments.flag("--synthesise", synthesise, "Synthesise the hardware core again instead of reading the stored figures");
  arguments.flag("-q,--quiet", quiet, "Print no progress");
}

int ReproduceCommand::run() {
  if (!output.empty()) page::check_page_files(output, page_kind);
  const PythonModule module("slipbench_studies", name.empty() ? "reproduce" : "reproduce " + name, "studies");
  take_stdout_back();
  module.start({{"name", name},
                {"json", json},
                {"quiet", quiet},
                {"install", module.install()},
                {"data", data},
                {"real", real},
                {"recordings", recordings},
                {"seed", or_null(seed)},
                {"jobs", jobs},
                {"full", full},
                {"synthesise", synthesise},
                {"trials", trials},
                {"only", only},
                {"memories", memories},
                {"output", output},
                {"resume", resume}});
}

}  // namespace slipbench
