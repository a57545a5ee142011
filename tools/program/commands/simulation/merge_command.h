// `merge`: the shards of a sweep put together.
#pragma once

#include <string>
#include <vector>

#include "tools/program/cli/command.h"

namespace slipbench {

class MergeCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> shards;
  std::string output;
};

}  // namespace slipbench
