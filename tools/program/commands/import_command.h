// `import`: recordings of real sensors as a dataset.
#pragma once

#include "tools/program/cli/command.h"
#include "tools/program/import/import.h"

namespace slipbench {

class ImportCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  ImportOptions options;
};

}  // namespace slipbench
