// `reproduce`: a table of a paper beside ours. The studies are in Python (tools/studies).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/command.h"

namespace slipbench {

struct ReproduceCommand final : Command {
  void declare(Arguments& arguments) override;
  // Becomes the Python package slipbench_studies, which checks that the study takes the options. Throws InputError where it
  // is not there, and for an output that is not a page's.
  int run() override;

  std::string name;      // PAPER/TABLE; empty: list what there is
  std::string output;    // HTML file to write, and JSON beside it; empty: none
  std::string data;      // dataset to use instead of a fresh one; empty: none
  std::string real;      // dataset of imported recordings that also judges; empty: none
  std::string memories;  // folder of the published classifier; empty: the source tree's
  std::optional<std::uint64_t> seed;
  std::size_t jobs = 0, trials = 0;  // 0: not given
  std::vector<std::string> only;     // names of rows to keep
  bool full = false, synthesise = false, resume = false;
};

}  // namespace slipbench
