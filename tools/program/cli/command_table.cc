#include "tools/program/cli/catalogue_commands.h"
#include "tools/program/cli/check_command.h"
#include "tools/program/cli/command.h"
#include "tools/program/cli/cost_command.h"
#include "tools/program/cli/dataset_commands.h"
#include "tools/program/cli/hd_commands.h"
#include "tools/program/cli/installation_commands.h"
#include "tools/program/cli/simulation_commands.h"
#include "tools/program/cli/training_commands.h"
#include "tools/studies/counts/bench_command.h"
#include "tools/studies/reproduce_command.h"

namespace slipbench {
namespace {

template <class... Kinds>
Commands make() {
  Commands commands;
  (commands.push_back(std::make_unique<Kinds>()), ...);
  return commands;
}

}  // namespace

Commands command_table() {
  return make<RunCommand, SweepCommand, CheckCommand, ReportCommand, ExportCommand, HdCommand, TrainCommand, EvalCommand,
              reproduce::ReproduceCommand, CostCommand, counts::BenchCommand, ListCommand, DescribeCommand, DoctorCommand,
              PluginPathCommand>();
}

}  // namespace slipbench
