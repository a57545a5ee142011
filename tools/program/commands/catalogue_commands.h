// `list` and `describe`: what a scene may name.
#pragma once

#include <string>

#include "tools/program/cli/command.h"

namespace slipbench {

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

}  // namespace slipbench
