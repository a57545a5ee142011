#include "tools/studies/hd_papillarray/hd_tables.h"

#include <fstream>
#include <functional>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "detectors/hd/engine.h"
#include "detectors/hd/features.h"
#include "detectors/hd/memories.h"
#include "sim/core/random.h"
#include "tools/base/files/reject.h"
#include "tools/base/project/project_file.h"
#include "tools/program/doctor/doctor.h"
#include "tools/studies/grid.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

double number_at(const Json& entry, const char* key, const std::string& subject) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number() || found->get<double>() < 0.0) {
    reject("{}: {} is {}; allowed: a number from 0 on", subject, key, found == entry.end() ? "missing" : quote(found->dump()));
  }
  return found->get<double>();
}

std::string text_at(const Json& entry, const char* key, const std::string& subject) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_string()) reject("{}: {} is no text", subject, key);
  return found->get<std::string>();
}

constexpr double published_cpu = 5985e-6;   // s, Core i7-10700, C++
constexpr double published_fpga = 0.42e-6;  // s, 42 cycles at 100 MHz, level to class
constexpr double published_core = 4.63e-6;  // s, 463 cycles: the published gripper core as simulated

constexpr std::size_t frames = 4096;
constexpr std::size_t kernel_passes = 101;
constexpr std::size_t reference_frames = 64;
constexpr std::size_t reference_passes = 11;

// Keeps the compiler from leaving out what is not read.
volatile std::uint64_t sink = 0;

// Levels and displacements by chance: the time does not depend on them, and chance spares the caches nothing.
std::vector<hd::Frame> random_frames() {
  RandomStream random(1, 0, "latency");
  std::vector<hd::Frame> result(frames);
  for (hd::Frame& frame : result) {
    for (std::uint8_t& level : frame.level) level = static_cast<std::uint8_t>(random.integer(hd::level_count));
    frame.context = static_cast<std::uint8_t>(random.integer(hd::context_count));
  }
  return result;
}

std::vector<std::array<float, 3 * hd::pillar_count>> random_displacements() {
  RandomStream random(1, 1, "latency");
  std::vector<std::array<float, 3 * hd::pillar_count>> result(frames);
  for (auto& frame : result) {
    for (float& value : frame) value = static_cast<float>(random.uniform(-2e-3, 2e-3));
  }
  return result;
}

// Of a frame; `update`: what makes a decision of it.
template <class Frame, class Update>
double time_of(std::span<const Frame> input, std::size_t passes, const Update& update) {
  const double pass = median_time(passes, [&] {
    std::uint64_t sum = 0;
    for (const Frame& frame : input) sum += update(frame).distance[0];
    sink = sum;
  });
  return pass / static_cast<double>(input.size());
}

constexpr std::array path_names{"portable", "AVX2", "AVX-512"};  // of hd::KernelPath

std::string time_text(double seconds) {
  return seconds < 1e-6 ? fmt::format("{:.1f} ns", 1e9 * seconds) : fmt::format("{:.2f} us", 1e6 * seconds);
}

std::string factor_text(double factor) {
  return factor < 100.0 ? fmt::format("{:.2g} x", factor) : fmt::format("{:.0f} x", factor);
}

using AddRow = std::function<void(const std::string& what, const std::string& cycles, double seconds)>;

// Plain C++ and every kernel that this CPU runs.
void add_software(const AddRow& add, const ReproduceOptions& options, const hd::Model& model) {
  const auto say = [&](const std::string& what) {
    if (options.say) options.say(what);
  };
  hd::Memories memories = hd::generate(model, 1);
  memories.associative = {memories.item[0], memories.item[1], memories.item[2]};
  const std::vector<hd::Frame> input = random_frames();
  const auto displacements = random_displacements();
  say("plain C++");
  const auto reference = hd::make_reference(model, memories);
  add("ours: plain C++, reads like the equations", "-",
      time_of(std::span(input).first(reference_frames), reference_passes,
              [&](const hd::Frame& frame) { return reference->update(frame); }));
  for (const hd::KernelPath path : hd::kernel_paths()) {
    const std::string name = path_names.at(static_cast<std::size_t>(path));
    say("kernel, " + name);
    const auto kernel = hd::make_kernel(model, memories, path);
    const auto decide = [&](const hd::Frame& frame) { return kernel->update(frame); };
    add(fmt::format("ours: kernel, {}", name), "-", time_of(std::span(input), kernel_passes, decide));
    add(fmt::format("ours: kernel, {}, from displacements", name), "-",
        time_of(std::span(displacements), kernel_passes,
                [&](const auto& frame) { return decide(hd::quantise(frame, hd::Quantiser::fixed_point)); }));
  }
}

}  // namespace

CoreFigures read_core_figures(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  const Json json = Json::parse(std::string(std::istreambuf_iterator<char>(file), {}), nullptr, false);
  if (!json.is_object()) throw InputError(path + ": is no JSON object");
  const auto tools = json.find("tools");
  if (tools == json.end() || !tools->is_object()) throw InputError(path + ": tools is no object; allowed: {\"yosys\": version}");
  const std::string version = text_at(*tools, "yosys", path + ": tools");
  CoreFigures figures{version.substr(0, version.find(" (")), {}};  // "Yosys 0.70 (git sha1 ..."
  const auto unrollings = json.find("unrollings");
  if (unrollings == json.end() || !unrollings->is_object() || unrollings->empty()) {
    throw InputError(path + ": unrollings is no object; allowed: one entry for each degree of unrolling");
  }
  for (const auto& [name, entry] : unrollings->items()) {
    const std::string subject = fmt::format("{}: unrolling '{}'", path, name);
    if (!entry.is_object()) throw InputError(subject + ": is no JSON object");
    const auto number = [&entry = entry, &subject](const char* key) { return number_at(entry, key, subject); };
    figures.configurations.push_back({name, static_cast<std::size_t>(number("latency_cycles")),
                                      static_cast<std::size_t>(number("interval_cycles")), number("lut"), number("ff"),
                                      number("bram36"), number("dsp"), number("levels")});
  }
  return figures;
}

std::optional<CoreFigures> stored_core_figures() {
  const std::optional<std::string> path = find_project_file(core_figures_file);
  if (!path) return std::nullopt;
  return read_core_figures(*path);
}

// Section IV.C of the paper: time from a frame to its class, in software and in hardware.
Result hd_latency(const ReproduceOptions& options) {
  const hd::Model model;
  Result result;
  result.title = "Latency of the hyperdimensional slip detector";
  result.source =
      "Section IV.C and table III of \"Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor\": 5,985 us on a Core i7-10700 in C++, 0.42 us on an xc7a200t FPGA";
  ResultTable table{"From a frame to its class",
                    {"what", "cycles", "a sample", "faster than the published CPU", "than the published FPGA"},
                    {},
                    "Software from levels to class unless the row says otherwise; medians. Cycles at 100 MHz."};
  const AddRow add = [&](const std::string& what, const std::string& cycles, double seconds) {
    table.rows.push_back(
        {what, cycles, time_text(seconds), factor_text(published_cpu / seconds), factor_text(published_fpga / seconds)});
    result.figures[what] = seconds;
  };
  add("paper: C++ on a Core i7-10700", "-", published_cpu);
  add_software(add, options, model);
  add("paper: FPGA", "42", published_fpga);
  add("published gripper core, as simulated", "463", published_core);
  const std::optional<CoreFigures> core = stored_core_figures();
  for (const CoreConfiguration& one : core.value_or(CoreFigures{}).configurations) {
    add(fmt::format("ours: RTL core, {}", one.name), std::to_string(one.cycles), static_cast<double>(one.cycles) / core_clock);
  }
  result.tables.push_back(std::move(table));
  result.setup = {
      fmt::format("CPU: {}; one thread.", cpu_name()),
      fmt::format("Compiler: {}, {}.", build_info().compiler, build_info().flags),
      fmt::format(
          "D = {}, N = {}, CL-gstHDC. Kernel: median of {} passes over {} frames by chance; plain C++: of {} passes over {}.",
          model.dimension, model.window, kernel_passes, frames, reference_passes, reference_frames),
      fmt::format("RTL: cycles from {}.", core ? core_figures_file : fmt::format("nowhere: there is no {}", core_figures_file)),
  };
  result.remarks = {
      "How the paper's C++ program computes is not said. Ours that reads like the equations computes the whole window of 15 frames anew at each sample, an entry of a vector at a time. Nothing in the method asks for that: in the kernel the window advances by one frame, the graphs collapse to counts, and 64 entries are one word. The paper's factor of 10,000 is one between two programs more than between two machines.",
      "The paper's 0.42 us is level to class, without the feature, the bus and the transfer from the sensor. Our core's cycles begin with nine displacements and end with the class, feature included; the software has a row of its own for that. The sensor delivers a frame each 10 ms.",
  };
  return result;
}

}  // namespace slipbench::reproduce
