#include "detectors/detector_kinds.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "detectors/hd/hd_detector.h"
#include "detectors/hd/words.h"
#include "rtl/verilated/rtl_engine.h"
#include "sim/core/choice.h"
#include "sim/core/error.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace hd {
namespace {

constexpr const char* no_waveform = "none";
constexpr std::array unrolling_words{Choice<Unrolling>{"fastest", Unrolling::fastest},
                                     Choice<Unrolling>{"middle", Unrolling::middle},
                                     Choice<Unrolling>{"smallest", Unrolling::smallest}};

// A classified frame's number is exact as a double after a day at 1 MHz.
constexpr Range within_a_day{0.0, 86400.0};

// True if `path` is a file other than FST, whose header is a block of type 0 and 329 bytes.
bool is_something_else(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return false;
  constexpr std::array<char, 9> header{0, 0, 0, 0, 0, 0, 0, 1, 73};
  std::array<char, 9> found{};
  std::ifstream(path, std::ios::binary).read(found.data(), found.size());
  return found != header;
}

void set_waveform(const Parameters& parameters, const FrameSource& source, RtlOptions& options) {
  const std::string& file = parameters.path("waveform");
  if (file == no_waveform) return;
  const std::string folder = std::filesystem::path(file).parent_path().string();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    throw SceneValueError("detector.waveform", "the folder " + folder + " does not exist");
  }
  constexpr double rounding = 1e-9;  // frames
  const double rate = parameters.number("rate");
  const double first = std::ceil(parameters.number("waveform_from") * rate - rounding);
  const double last = std::floor(parameters.number("waveform_to") * rate + rounding);
  if (last < first) {
    throw SceneValueError("detector.waveform_to", format_quantity(parameters.number("waveform_to"), Quantity::time) +
                                                      ": no frame is classified between waveform_from and this time");
  }
  // Only this trial is checked: others may be shorter, or run while the file is being written.
  if (source.trial != static_cast<std::uint64_t>(parameters.integer("waveform_trial"))) return;
  if (first >= source.duration * rate - rounding) {
    throw SceneValueError("detector.waveform_from", format_quantity(parameters.number("waveform_from"), Quantity::time) +
                                                        ": no frame is classified after this time; the trial takes " +
                                                        format_quantity(source.duration, Quantity::time));
  }
  if (is_something_else(file)) {
    throw SceneValueError("detector.waveform",
                          file + " exists and is not a waveform; choose a new name, or an FST file to replace");
  }
  options.trace = file;
  options.trace_first = static_cast<std::uint64_t>(first);
  options.trace_count = static_cast<std::uint64_t>(last - first) + 1;
}

// A busy core takes no sample, and there is no buffer for one.
void check_clock(const Parameters& parameters, Unrolling unrolling, const FrameSource& source) {
  const double rate = source.rate / static_cast<double>(stride_of(parameters.number("rate"), source));
  const double clock = parameters.number("clock");
  const double least = core_interval(unrolling) * rate;
  constexpr double rounding = 1e-9;
  if (clock >= (1.0 - rounding) * least) return;
  throw SceneValueError("detector.clock", format_quantity(clock, Quantity::frequency) +
                                              " is too slow: the core takes a sample every " +
                                              std::to_string(core_interval(unrolling)) + " cycles, but the samples come at " +
                                              format_quantity(rate, Quantity::frequency) + "; allowed: at least " +
                                              readable_quantity(least, Quantity::frequency));
}

std::shared_ptr<RtlEngine> make_engine(const SavedModel& saved, const Parameters& parameters, const FrameSource& source) {
  if (saved.quantiser != Quantiser::fixed_point) {
    throw SceneValueError("detector.quantiser",
                          choice_name(quantiser_words, saved.quantiser) + " is not supported by the core; allowed: fixed_point");
  }
  RtlOptions options;
  options.unrolling = choice_value(unrolling_words, parameters.choice("unrolling")).value();
  check_clock(parameters, options.unrolling, source);
  if (parameters.flag("lockstep")) options.golden = make_kernel(saved.model, saved.memories);
  set_waveform(parameters, source, options);
  try {
    return make_rtl_engine(saved.model, saved.memories, options);
  } catch (const InputError& error) {
    throw SceneValueError("detector", error.what());
  }
}

std::vector<ParameterSpec> rtl_parameters() {
  return joined(
      detector_parameters(),
      {choice_spec("unrolling", "fastest", choice_names(unrolling_words),
                   "How much of a frame the core processes in parallel: more area gives less latency.",
                   "rtl/hd/README.md has the table"),
       number_spec("clock", Quantity::frequency, "100 MHz", positive, "Clock of the core.", "paper, section IV"),
       choice_spec("latency", "true", {"true", "zero"},
                   "true: the loop gets a decision after the core's cycles at `clock`; zero: at once, as from gst_hd.",
                   "the core's own cycles"),
       flag_spec("lockstep", "false",
                 "True: the software kernel runs too and is compared with the core; a difference ends the trial with an error.",
                 "free"),
       path_spec("waveform", no_waveform, "FST file of the core's signals.", "free"),
       number_spec("waveform_from", Quantity::time, "0 s", within_a_day, "Time at which the waveform begins.", "free"),
       number_spec("waveform_to", Quantity::time, "86400 s", within_a_day, "Time at which the waveform ends.", "free"),
       integer_spec("waveform_trial", "0", non_negative, "Trial whose waveform is written.", "free")});
}

}  // namespace
}  // namespace hd

namespace {

void check_waveform_trial(const Parameters& parameters, std::uint64_t trials) {
  const auto trial = static_cast<std::uint64_t>(parameters.integer("waveform_trial"));
  if (parameters.path("waveform") == hd::no_waveform || trial < trials) return;
  throw SceneValueError("detector.waveform_trial",
                        std::to_string(trial) + " is not a trial of the run; allowed: 0 to " + std::to_string(trials - 1));
}

std::unique_ptr<Detector> make_gst_hd_rtl(const Parameters& parameters, const FrameSource& source) {
  const hd::SavedModel saved = hd::detector_model(parameters);
  const std::shared_ptr<hd::RtlEngine> engine = hd::make_engine(saved, parameters, source);
  const double period = parameters.choice("latency") == "true" ? 1.0 / parameters.number("clock") : 0.0;
  const auto classify = [engine, period](std::span<const float> displacement) {
    const PadState state = engine->update(hd::to_fixed(displacement)).state;
    return hd::Classified{state, engine->cycles() * period};
  };
  return hd::make_detector(classify, parameters.number("rate"), saved.alarm, source);
}

}  // namespace

DetectorKind gst_hd_rtl_detector() {
  return {
      {.name = "gst_hd_rtl",
       .summary = "The classifier of gst_hd as a register-level core, cycle by cycle, with its latency.",
       .law = "classes: those of gst_hd with fixed_point\nlatency: cycles from the accepted sample to the class, over the clock",
       .source = "rtl/hd: the synthesisable core, as Verilator translates it; the paper's own has 42 cycles at 100 MHz",
       .parameters = hd::rtl_parameters()},
      make_gst_hd_rtl,
      check_waveform_trial,
      FrameSpacing::even,
      {},
      false,
      false,
      DetectorFile{"memories", DetectorFile::Content::memories}};
}

}  // namespace slipbench
