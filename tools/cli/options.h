// The command line, turned into checked values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "detectors/hd/model.h"
#include "sim/scene/parser.h"
#include "tools/export/export.h"

namespace slipbench {

// What the user asked for. Only the members of the command given are filled in.
struct Options {
  std::string command;  // "run", "hd replay", ...; "--version"; empty when `help` is asked for
  std::string help;     // to be printed on stdout
  bool json = false;
  bool quiet = false;

  // run and sweep
  std::string scene;
  std::vector<Override> overrides;
  std::optional<std::uint64_t> seed;
  std::optional<std::size_t> trials;
  std::optional<std::size_t> jobs;

  std::string output;  // run, sweep: dataset; report: HTML file; export: folder. Empty: not given

  // report and export
  std::string dataset;
  std::optional<std::size_t> trial;
  ExportFormat format{};                  // export
  SlipRule slip_rule = SlipRule::strict;  // export
  std::optional<double> label_speed;      // export [m/s]
  std::string sensor;                     // export; empty: the only one

  // hd replay
  std::string vectors;   // CSV file
  std::string memories;  // folder
  std::optional<hd::Compat> hd_compat;
  std::optional<hd::Ties> hd_ties;
  std::string engine = "kernel";

  std::string name;  // list: a catalogue or empty; describe: the entry
};

// The commands, in the order the help shows them.
std::vector<std::string> command_names();

// Reads the arguments after the program's name. Throws InputError: unknown command, option or format with the nearest known one,
// a missing argument, a number that is none.
Options parse_options(const std::vector<std::string>& arguments);

}  // namespace slipbench
