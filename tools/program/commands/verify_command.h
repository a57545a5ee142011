// `verify`: is a dataset what it says?
#pragma once

#include <string>
#include <vector>

#include "tools/program/cli/command.h"

namespace slipbench {

class VerifyCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> datasets;
};

}  // namespace slipbench
