// The command line, turned into checked values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "detectors/hd/features.h"
#include "detectors/hd/model.h"
#include "sim/scene/parser.h"
#include "tools/program/cli/bench_options.h"
#include "tools/program/export/export.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

// What the user asked for. Only the members of the command given are filled in.
struct Options {
  std::string command;  // "run", "hd replay", ...; "--version"; empty when `help` is asked for
  std::string help;     // to be printed on stdout
  bool json = false;
  bool quiet = false;

  // run, sweep and check
  std::string scene;                // run, sweep, cost; empty: not given
  std::vector<std::string> scenes;  // check
  std::vector<Override> overrides;
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> trials;
  std::optional<std::size_t> jobs;
  Recording record = Recording::full;  // what `output` holds

  std::string output;  // run, sweep: dataset; report, reproduce, cost: HTML file; export, train, check: folder. Empty: not given
  std::string junit;   // check: XML file. Empty: not given

  std::optional<std::size_t> trial;  // run, report, export, cost

  double budget = 60.0;    // cost [s]
  bool stability = false;  // cost: the map of stable steps

  // report, export, train and eval
  std::string dataset;
  ExportFormat format{};                  // export
  SlipRule slip_rule = SlipRule::strict;  // export, train, eval; the last two have paper as their default
  std::optional<double> label_speed;      // export [m/s]
  std::optional<double> rate;             // export [Hz]
  std::string sensor;                     // export, train, eval; empty: the only one

  // hd replay
  std::string vectors;                  // CSV file
  std::string memories;                 // folder or the shipped classifier's name, of eval too; reproduce: the published one
  std::optional<hd::Compat> hd_compat;  // of train too
  std::optional<hd::Ties> hd_ties;      // of train too
  std::string engine = "kernel";

  // train
  hd::Model model;  // but for its compat and ties
  hd::Quantiser quantiser = hd::Quantiser::fixed_point;

  // reproduce
  std::string data;               // a dataset; empty: a fresh one
  bool synthesise = false;        // run the synthesis again
  std::vector<std::string> only;  // rows to keep

  BenchOptions simulation;

  std::string name;  // list: a catalogue or empty; describe: the entry; reproduce: PAPER/TABLE or empty
};

// The commands, in the order the help shows them.
std::vector<std::string> command_names();

// Reads the arguments after the program's name. Throws InputError: unknown command, option or format with the nearest known one,
// a missing argument, a number that is none.
Options parse_options(const std::vector<std::string>& arguments);

}  // namespace slipbench
