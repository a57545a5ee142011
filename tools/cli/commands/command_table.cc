#include "tools/program/commands/command_table.h"

#include "tools/program/commands/dataset_commands.h"
#include "tools/program/commands/detectors/detector_commands.h"
#include "tools/program/commands/help_commands.h"
#include "tools/program/commands/reproduce_command.h"
#include "tools/program/commands/simulation/simulation_commands.h"

namespace slipbench {

Commands command_table() {
  return make_commands<RunCommand, SweepCommand, CheckCommand, ReportCommand, ViewCommand, ExportCommand, ImportCommand,
                       VerifyCommand, MergeCommand, ClusterCommand, HdCommand, TrainCommand, EvalCommand, DetectCommand,
                       BenchmarkCommand, CalibrateCommand, ReproduceCommand, CostCommand, ListCommand, DescribeCommand,
                       SchemaCommand, DoctorCommand, PluginPathCommand, HelpCommand, CompletionCommand, ManCommand>();
}

}  // namespace slipbench
