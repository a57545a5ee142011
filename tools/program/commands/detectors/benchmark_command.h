// `benchmark`: a board of slip detectors, and submissions to it.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/json.h"
#include "tools/program/benchmark/benchmark.h"
#include "tools/program/cli/command.h"

namespace slipbench {

class BenchmarkCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  benchmark::Asked asked;
  std::size_t jobs = 0;
  std::string output, submission, verified;  // files; empty: none

 private:
  // The board, while an interrupt ends it.
  [[nodiscard]] Json made(benchmark::Asked asked_for) const;
  [[nodiscard]] int verify() const;
  [[nodiscard]] std::string text(const Json& result) const;
};

}  // namespace slipbench
