// `calibrate`: a scene fitted to recordings.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/program/calibrate/calibrate.h"
#include "tools/program/cli/command.h"

namespace slipbench {

class CalibrateCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  // What the words ask for, once they have been read.
  calibrate::Options options;
  std::string output;  // YAML file; empty: nothing is written

 private:
  std::vector<std::string> words_;  // SCENE REAL...
  std::vector<std::string> fits_;
  std::optional<std::size_t> jobs_;
};

}  // namespace slipbench
