// `reproduce` repeats a table of a paper. The studies are in Python (tools/studies).
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
  // Replaces this process by the Python package slipbench_studies, which checks the options of the
  // study. Throws InputError if the package is missing, and if the output file is not a page of
  // `reproduce`.
  int run() override;

  std::string name;        // PAPER/TABLE; empty: list the studies
  std::string output;      // HTML file to write, with a JSON file next to it; empty: none
  std::string data;        // dataset to use instead of a fresh one; empty: none
  std::string real;        // dataset of imported recordings for an additional evaluation; empty: none
  std::string recordings;  // folder with public recordings, for `real`; empty: none
  std::string memories;    // folder of the published classifier; empty: the source tree's
  std::optional<std::uint64_t> seed;
  std::size_t jobs = 0, trials = 0;  // 0: not given
  std::vector<std::string> only;     // names of rows to keep
  bool full = false, synthesise = false, resume = false;
};

}  // namespace slipbench
