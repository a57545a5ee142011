// `bench`: instruction counts of reference scenes, and what grew since they were stored.
#pragma once

#include <cstddef>
#include <string>

#include "tools/program/cli/command.h"

namespace slipbench::counts {

class BenchCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  bool compares = false;
  std::string compare_with;  // a file of results; empty: the committed one of this build
  std::string output;        // JSON file to write, and SVG beside it; empty: none
  std::size_t jobs = 1;      // scenes counted at a time
};

}  // namespace slipbench::counts
