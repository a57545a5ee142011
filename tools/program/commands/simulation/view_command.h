// `view`: the report of a dataset or of a scene, opened.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "tools/program/cli/command.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

class ViewCommand final : public Command {
 public:
  void declare(Arguments& arguments) override;
  int run() override;

  std::string subject;               // a dataset, or a scene
  std::string output;                // HTML file, with --rerun an .rrd file; empty: named after the subject
  std::optional<std::size_t> trial;  // to open on; of a scene the one to simulate
  SweepOptions sweep;                // of a scene
  bool rerun = false;                // in the viewer Rerun, in place of the page

 private:
  [[nodiscard]] bool of_scene() const;
  // Sends the dataset to Rerun; returns the exit status.
  [[nodiscard]] int show(const std::string& dataset) const;
  // Simulates the scene into the dataset beside the page; returns the exit status.
  [[nodiscard]] int simulate(const std::string& dataset) const;
};

}  // namespace slipbench
