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

// The options that say whether trials run in processes of their own.
struct IsolationOptions {
  bool isolate = false, together = false;                  // neither: several trials with a plugin are isolated
  double limit = std::numeric_limits<double>::infinity();  // s

  void declare(Arguments& arguments);
  // For the trials of a sweep. There may be plugins where their type stands in the scene or in a --set.
  [[nodiscard]] Isolation chosen(const ReadSweep& read, const SweepOptions& sweep) const;
};

// `run` and `sweep`: trials of a scene.
// What the two have in common.
class SimulationCommand : public Command {
 public:
  int run() override;

  SweepOptions sweep;
  IsolationOptions isolation;
  bool brief = false;  // progress and errors, no summary: for a command that says itself what came of it

 protected:
  // The options of both; --trials, which they read differently, goes to `trials`.
  void declare_both(Arguments& arguments, std::size_t& trials, const std::string& trials_help);
};

struct RunCommand final : SimulationCommand {
  void declare(Arguments& arguments) override;
};

struct SweepCommand final : SimulationCommand {
  void declare(Arguments& arguments) override;
};

// `merge`: the shards of a sweep put together.
struct MergeCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> shards;
  std::string output;
};

// `cluster`: a sweep for other machines.
struct ClusterCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  ClusterOptions options;
};

// `check`: the trials of scenes held against what they expect.
struct CheckCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  std::vector<std::string> scenes;
  IsolationOptions isolation;
  CheckOptions options;                    // but for isolation, scene_path and folder, which are each scene's own
  std::string junit;                       // XML file to write; empty: none
  std::string output = "slipbench-check";  // folder for the trials of failed checks
};

// `cost`: what accuracy costs in time.
struct CostCommand final : Command {
  void declare(Arguments& arguments) override;
  int run() override;

  cost::ExploreOptions explore;  // its scene_path is empty where none is given
  bool stability = false;        // the map of the longest stable steps
  std::string output;            // HTML file to write, and JSON beside it; empty: none
};

// `view`: the report of a dataset or of a scene, opened.
struct ViewCommand final : Command {
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

// The words of --record.
inline constexpr std::array recording_words{Choice<Recording>{"full", Recording::full},
                                            Choice<Recording>{"outcome", Recording::outcome}};

// Where the scene says `accuracy`, appends to `sweep.overrides` the setting that meets it in the trials that `sweep` asks for
// (tools/cost/kept_setting.h), so that from here on it is a scene like any other and its command says how it was computed.
// `command` tells what it is. Throws InputError.
void settle_accuracy(SweepOptions& sweep, const Catalogues& catalogues, const Command& command);

}  // namespace slipbench
