// The commands that run scenes.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/choice.h"
#include "sim/scene/catalogues.h"
#include "tools/check/check.h"
#include "tools/cli/command.h"
#include "tools/cost/explore.h"
#include "tools/trial/cluster/cluster.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

// The options for running trials in child processes.
struct IsolationOptions {
  bool isolate = false, together = false;                  // neither is set: several trials with a plugin are isolated
  double limit = std::numeric_limits<double>::infinity();  // s

  void declare(Arguments& arguments);
  // Returns how to run the trials of a sweep. A scene may contain plugins if it, or a --set, names
  // the type of one.
  [[nodiscard]] Isolation chosen(const ReadSweep& read, const SweepOptions& sweep) const;
};

// Common parts of `run` and `sweep`, which run the trials of a scene.
class SimulationCommand : public Command {
 public:
  int run() override;

  SweepOptions sweep;
  IsolationOptions isolation;
  bool brief = false;  // prints progress and errors, but no summary: for a command that reports the result itself

 protected:
  // Declares the options of both commands. --trials, which they interpret differently, is stored in
  // `trials`.
  void declare_both(Arguments& arguments, std::size_t& trials, const std::string& trials_help);
};

struct RunCommand final : SimulationCommand {
  void declare(Arguments& arguments) override;
};

struct SweepCommand final : SimulationCommand {
  void declare(Arguments& arguments) override;
};

// `merge` joins the shards of a sweep.
struct MergeCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> shards;
  std::string output;
};

// `cluster` prepares a sweep for other machines.
struct ClusterCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  ClusterOptions options;
};

// `check` compares the trials of scenes with their expectations.
struct CheckCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> scenes;
  IsolationOptions isolation;
  CheckOptions options;                    // isolation, scene_path and folder are set for each scene
  std::string junit;                       // XML file to write; empty: none
  std::string output = "slipbench-check";  // folder for the trials of failed checks
};

// `cost` measures the CPU time that accuracy costs.
struct CostCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  cost::ExploreOptions explore;       // scene_path is empty without a scene
  bool stability = false;             // measure the map of the longest stable steps
  std::vector<std::string> accuracy;  // "onset=1 %": find the cheapest setting with these errors instead
  std::string output;                 // HTML file to write, with a JSON file next to it; empty: none

 private:
  // Finds and prints the setting with the required accuracy; returns the exit status.
  [[nodiscard]] int search() const;
};

// `view` opens the report of a dataset or of a scene.
struct ViewCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::string subject;               // a dataset, or a scene
  std::string output;                // HTML file, with --rerun an .rrd file; empty: named after the subject
  std::optional<std::size_t> trial;  // trial to show; for a scene, the trial to simulate
  SweepOptions sweep;                // for a scene
  bool rerun = false;                // open the viewer Rerun instead of the page

 private:
  [[nodiscard]] bool of_scene() const;
  // Sends the dataset to Rerun; returns the exit status.
  [[nodiscard]] int show(const std::string& dataset) const;
  // Simulates the scene, writes the dataset next to the page and returns the exit status.
  [[nodiscard]] int simulate(const std::string& dataset) const;
};

// The values of --record.
inline constexpr std::array recording_words{Choice<Recording>{"full", Recording::full},
                                            Choice<Recording>{"outcome", Recording::outcome}};

}  // namespace slipbench
