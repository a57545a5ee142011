#include "tools/program/cli/program.h"
#include "tools/studies/counts/bench_command.h"
#include "tools/studies/reproduce_command.h"

int main(int argc, char** argv) {
  return slipbench::run_program(
      slipbench::make_commands<slipbench::reproduce::ReproduceCommand, slipbench::counts::BenchCommand>(),
      {argv + 1, argv + argc});
}
