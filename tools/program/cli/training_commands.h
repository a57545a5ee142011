// `train` and `eval`: slip detectors taught and judged on datasets.
#pragma once

#include "tools/program/cli/command.h"
#include "tools/program/train/train.h"

namespace slipbench {

class TrainCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  TrainOptions options;
  bool context = false, no_context = false;  // neither: the encoding's own default
};

class EvalCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  EvalOptions options;
};

}  // namespace slipbench
