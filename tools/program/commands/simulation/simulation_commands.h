// `run` and `sweep`: trials of a scene.
#pragma once

#include <cstddef>
#include <string>

#include "tools/program/cli/command.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

// What the two have in common.
class SimulationCommand : public Command {
 public:
  int run() override;

  SweepOptions sweep;
  bool brief = false;  // progress and errors, no summary: for a command that says itself what came of it

 protected:
  // The options of both; --trials, which they read differently, goes to `trials`.
  void declare_both(Arguments& arguments, std::size_t& trials, const std::string& trials_help);
};

class RunCommand final : public SimulationCommand {
 public:
  void declare(Arguments& arguments) override;
};

class SweepCommand final : public SimulationCommand {
 public:
  void declare(Arguments& arguments) override;
};

}  // namespace slipbench
