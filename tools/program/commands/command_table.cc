#include "tools/program/commands/command_table.h"

#include <memory>
#include <utility>

#include "tools/program/commands/dataset_commands.h"
#include "tools/program/commands/detectors/detector_commands.h"
#include "tools/program/commands/simulation/simulation_commands.h"

namespace slipbench {

Commands command_table() {
  Commands commands = make_commands<RunCommand, SweepCommand, CheckCommand, ReportCommand, ViewCommand, ExportCommand,
                                    ImportCommand, VerifyCommand, MergeCommand, ClusterCommand, HdCommand, TrainCommand,
                                    EvalCommand, BenchmarkCommand, CalibrateCommand>();
  commands.push_back(std::make_unique<CommandElsewhere>("reproduce", "Reproduce a table of a paper", "slipbench-studies"));
  commands.push_back(std::make_unique<CostCommand>());
  for (auto& command : make_commands<ListCommand, DescribeCommand, SchemaCommand, DoctorCommand, PluginPathCommand>())
    commands.push_back(std::move(command));
  return commands;
}

}  // namespace slipbench
