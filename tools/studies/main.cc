#include "tools/studies/study_catalogue.h"

int main(int argc, char** argv) {
  return slipbench::run_program(slipbench::make_commands<slipbench::reproduce::ReproduceCommand>(), {argv + 1, argv + argc});
}
