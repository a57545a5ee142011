#include "tools/program/commands/command_table.h"

int main(int argc, char** argv) { return slipbench::run_program(slipbench::command_table(), {argv + 1, argv + argc}); }
