#include "tools/cli/commands/command_table.h"
#include "tools/cli/program.h"
#include "tools/cli/terminal.h"
#include "tools/trial/sweep/run_sweep.h"

int main(int argc, char** argv) {
  if (argc > 0 && *argv[0] != '\0') slipbench::keep_program_name(slipbench::shell_word(argv[0]));
  return slipbench::run_program(slipbench::command_table(), {argv + 1, argv + argc});
}
