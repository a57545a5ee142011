// The commands that say what there is: to name in a scene, and on this machine.
#pragma once

#include <string>

#include "tools/program/cli/command.h"

namespace slipbench {

// `list` and `describe`: what a scene may name.
class ListCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string catalogue;  // empty: all
};

class DescribeCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string name;
};

// `doctor` and `plugin-path`: what is installed, and where.
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
