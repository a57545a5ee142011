// `hd`: what works with the hyperdimensional classifier.
#pragma once

#include <optional>
#include <string>

#include "detectors/hd/model.h"
#include "tools/program/cli/command.h"

namespace slipbench {

// `hd replay`: quantised input, step by step.
class HdReplayCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string vectors;               // CSV file
  std::string memories;              // folder, or the shipped classifier's name
  std::optional<hd::Compat> compat;  // these two replace what the folder says
  std::optional<hd::Ties> ties;
  std::string engine = "kernel";
};

// `hd` by itself says what is below it.
class HdCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  HdReplayCommand replay;
};

}  // namespace slipbench
