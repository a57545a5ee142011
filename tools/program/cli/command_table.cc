#include <memory>
#include <utility>

#include "tools/program/cli/benchmark_command.h"
#include "tools/program/cli/calibrate_command.h"
#include "tools/program/cli/catalogue_commands.h"
#include "tools/program/cli/check_command.h"
#include "tools/program/cli/cluster_command.h"
#include "tools/program/cli/command.h"
#include "tools/program/cli/command_elsewhere.h"
#include "tools/program/cli/cost_command.h"
#include "tools/program/cli/dataset_commands.h"
#include "tools/program/cli/eval_command.h"
#include "tools/program/cli/hd_commands.h"
#include "tools/program/cli/import_command.h"
#include "tools/program/cli/installation_commands.h"
#include "tools/program/cli/merge_command.h"
#include "tools/program/cli/simulation_commands.h"
#include "tools/program/cli/train_command.h"
#include "tools/program/cli/verify_command.h"
#include "tools/program/cli/view_command.h"

namespace slipbench {

Commands command_table() {
  const auto study = [](const char* name, const char* summary) {
    return std::make_unique<CommandElsewhere>(name, summary, "slipbench-studies");
  };
  Commands commands = make_commands<RunCommand, SweepCommand, CheckCommand, ReportCommand, ViewCommand, ExportCommand,
                                    ImportCommand, VerifyCommand, MergeCommand, ClusterCommand, HdCommand, TrainCommand,
                                    EvalCommand, BenchmarkCommand, CalibrateCommand>();
  commands.push_back(study("reproduce", "Reproduce a table of a paper"));
  commands.push_back(std::make_unique<CostCommand>());
  commands.push_back(study("bench", "Count the instructions of the reference scenes"));
  for (auto& command : make_commands<ListCommand, DescribeCommand, DoctorCommand, PluginPathCommand>())
    commands.push_back(std::move(command));
  return commands;
}

}  // namespace slipbench
