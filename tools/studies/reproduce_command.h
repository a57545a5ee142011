// `reproduce`: a paper's table beside ours.
#pragma once

#include <string>

#include "tools/program/cli/command.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {

class ReproduceCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string name;     // PAPER/TABLE; empty: list what there is
  std::string output;   // HTML file to write, and JSON beside it; empty: none
  bool resume = false;  // go on with the networks that lie beside `output`
  ReproduceOptions options;
};

}  // namespace slipbench::reproduce
