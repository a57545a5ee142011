// `doctor` and `plugin-path`: what is installed, and where.
#pragma once

#include <string>

#include "tools/program/cli/command.h"

namespace slipbench {

class DoctorCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;
};

class PluginPathCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

 private:
  std::string mujoco;  // version
};

}  // namespace slipbench
