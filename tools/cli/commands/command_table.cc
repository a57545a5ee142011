#include "tools/cli/commands/command_table.h"

#include "tools/cli/commands/dataset_commands.h"
#include "tools/cli/commands/detectors/detector_commands.h"
#include "tools/cli/commands/help_commands.h"
#include "tools/cli/commands/reproduce_command.h"
#include "tools/cli/commands/simulation/simulation_commands.h"

namespace slipbench {

Commands command_table() {
  return make_commands<RunCommand, SweepCommand, CheckCommand, ReportCommand, ViewCommand, ExportCommand, ImportCommand,
                       VerifyCommand, MergeCommand, ClusterCommand, HdCommand, TrainCommand, TrainHdCommand, EvalCommand,
                       DetectCommand, BenchmarkCommand, CalibrateCommand, ReproduceCommand, CostCommand, ListCommand,
                       DescribeCommand, SchemaCommand, DoctorCommand, PluginPathCommand, HelpCommand, CompletionCommand,
                       ManCommand>();
}

}  // namespace slipbench
