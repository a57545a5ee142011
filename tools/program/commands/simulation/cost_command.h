// `cost`: what accuracy costs in time.
#pragma once

#include <string>

#include "tools/program/cli/command.h"
#include "tools/program/cost/explore.h"

namespace slipbench {

class CostCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  cost::ExploreOptions explore;  // its scene_path is empty where none is given
  bool stability = false;        // the map of the longest stable steps
  std::string output;            // HTML file to write, and JSON beside it; empty: none
};

}  // namespace slipbench
