// `eval`: slip detectors judged on datasets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/program/cli/command.h"
#include "tools/program/eval/evaluate.h"

namespace slipbench {

class EvalCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string detector;                   // a name, FILE.onnx or a folder
  std::vector<Override> parameters;       // of it, by name
  std::string output;                     // HTML file; empty: none
  eval::Options options;                  // but for the detector and, until run(), labels
  std::optional<eval::TruthRule> labels;  // empty: what a network learnt by, else strict
};

}  // namespace slipbench
