// What is known of the register-level core: clock cycles, and what synthesis made of it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace slipbench::reproduce {

inline constexpr double core_clock = 100e6;  // Hz, of the published boards

// One degree of unrolling.
struct CoreConfiguration {
  std::string name;
  std::size_t cycles = 0;    // from accepted sample to class
  std::size_t interval = 0;  // cycles from one sample to the next
  double lut = 0.0;
  double ff = 0.0;
  double bram = 0.0;  // blocks of 36 kbit
  double dsp = 0.0;
  double levels = 0.0;  // longest path in levels of logic
};

struct CoreFigures {
  std::string tool;  // what made them: "Yosys 0.70"
  std::vector<CoreConfiguration> configurations;
};

// The figures committed beside the core, relative to the project's root.
inline constexpr const char* core_figures_file = "rtl/hd/syn/results.json";

// Reads such a file, which rtl/hd/syn/report.py writes: {"tools": {"yosys"}, "unrollings": {NAME: {"latency_cycles", "interval_cycles",
// "lut", "ff", "bram36", "dsp", "levels"}}}; other keys are let pass. Throws InputError, naming the file, for what is not that.
CoreFigures read_core_figures(const std::string& path);

// Of core_figures_file; empty where the project has none.
std::optional<CoreFigures> stored_core_figures();

}  // namespace slipbench::reproduce
