// `check`: the trials of scenes held against what they expect.
#pragma once

#include <string>
#include <vector>

#include "tools/program/check/check.h"
#include "tools/program/cli/command.h"

namespace slipbench {

class CheckCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> scenes;
  CheckOptions options;                    // but for scene_path and folder, which are each scene's own
  std::string junit;                       // XML file to write; empty: none
  std::string output = "slipbench-check";  // folder for the trials of failed checks
};

}  // namespace slipbench
