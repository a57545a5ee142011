// `cluster`: a sweep for other machines.
#pragma once

#include "tools/program/cli/command.h"
#include "tools/program/cluster/cluster.h"

namespace slipbench {

class ClusterCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  ClusterOptions options;
};

}  // namespace slipbench
