// Table III of the paper: the recurrent network that it compares itself with, on the published protocol.
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "detectors/network/engine.h"
#include "sim/core/error.h"
#include "tools/base/files/output_file.h"
#include "tools/program/eval/evaluate.h"
#include "tools/program/eval/replay.h"
#include "tools/studies/grid.h"
#include "tools/studies/hd_papillarray/hd_tables.h"

namespace slipbench::reproduce {
namespace {

constexpr std::size_t cells = 200;     // motions and compressions of hexapod.yaml
constexpr std::size_t many_draws = 4;  // of each: 640 sequences are learnt from, 160 judge
constexpr std::size_t steps_timed = 201;

struct GruRow {
  std::string name;
  std::size_t draws = 1;
  train::LabelRule labels{};
  std::string recipe = "papillarray_gru";
};
const std::vector<GruRow> gru_rows{{"gru_micro", 1, train::LabelRule::micro},
                                   {"gru_micro_640", many_draws, train::LabelRule::micro},
                                   {"gru_latched", 1, train::LabelRule::latched},
                                   {"gru_latched_640", many_draws, train::LabelRule::latched},
                                   {"gru5_latched", 1, train::LabelRule::latched, "papillarray_gru5"}};

// gru_figures(); "learnt", the sequences with those that choose the state; "kilobytes", "step_s".
Json run_row(const GruRow& row, const std::string& dataset, const std::string& model, const ReproduceOptions& options) {
  const train::NetworkSummary summary = teach(row.name, train::find_recipe(row.recipe), row.labels, dataset, model, options);
  const std::unique_ptr<network::Engine> engine = network::load_engine(model);
  eval::Options judged;
  judged.detector = eval::chosen_detector(model, {});
  judged.dataset = dataset;
  judged.labels = eval::parse_label_rule(hd::name_of(train::label_words, row.labels));
  judged.trained = engine->description().trained;
  Json figures = gru_figures(eval::evaluate(judged));
  figures["learnt"] = summary.learnt + summary.validated;
  figures["kilobytes"] = 1e-3 * static_cast<double>(std::filesystem::file_size(model));
  figures["step_s"] = median_time(steps_timed, [&, nothing = std::vector<float>(engine->inputs())] { engine->run(nothing); });
  end_if_interrupted();
  return figures;
}

std::string in_percent(double share) { return std::isnan(share) ? "-" : fmt::format("{:.1f}", 100.0 * share); }
// "-" of null.
std::string in_ms(const Json& seconds) { return seconds.is_null() ? "-" : fmt::format("{:.0f}", 1e3 * seconds.get<double>()); }
std::string count_of(const Json& figure) { return std::to_string(figure.get<std::size_t>()); }

ResultTable frames_table() {
  return {
      "Slip or not",
      {"detector", "label", "sequences learnt", "balanced accuracy, %", "AUC", "trials right, %", "with early ones", "size, kB",
       "a step, us"},
      {{"paper: GRU", "incipient or not", "-", "-", "-", "95.6", "-", "1468", "25000 (GPU)"},
       {"paper: CL-gstHDC, accuracy of three classes", "paper", "-", "-", "-", "-", "91.8 of frames", "0.375",
        "5985; 0.42 (FPGA)"}},
      "Trials right: slip called at or after the true first slip, or none called where there is none; with early ones: a call before it, "
      "too. The paper does not say when an early call is right."};
}

ResultTable events_table() {
  return {"By event",
          {"detector", "label", "trials that slip", "seen", "early", "missed", "delay, ms: median", "10 to 90 %",
           "false alarms: trials", "a minute of stick"},
          {},
          "Delay: from the true first slip, of the trials seen. Early: called before it."};
}

std::string text_of(const GruRow& row) { return row.recipe == "papillarray_gru5" ? "five GRUs averaged" : "GRU"; }
std::string label_of(const GruRow& row) { return std::string(hd::name_of(train::label_words, row.labels)); }

std::vector<std::string> frames_row(const GruRow& row, const Json& figures) {
  const auto number = [&](const char* key) { return number_or_nan(figures.at(key)); };
  return {text_of(row),
          label_of(row),
          count_of(figures.at("learnt")),
          in_percent(number("balanced_accuracy")),
          fmt::format("{:.3f}", number("auc")),
          in_percent(right_share(figures, false)),
          in_percent(right_share(figures, true)),
          fmt::format("{:.0f}", number("kilobytes")),
          fmt::format("{:.0f}", 1e6 * number("step_s"))};
}

std::vector<std::string> events_row(const GruRow& row, const Json& figures) {
  const auto count = [&](const char* key) { return figures.at(key).get<std::size_t>(); };
  return {fmt::format("{}, {} learnt", text_of(row), count("learnt")),
          label_of(row),
          count_of(figures.at("slipping")),
          count_of(figures.at("seen")),
          count_of(figures.at("early")),
          count_of(figures.at("missed")),
          in_ms(figures.at("delay_s")),
          fmt::format("{} to {}", in_ms(figures.at("delay_p10_s")), in_ms(figures.at("delay_p90_s"))),
          fmt::format("{} of {}", count("false_alarms"), count("trials") - count("slipping")),
          fmt::format("{:.1f}", number_or_nan(figures.at("false_alarms_a_minute")))};
}

}  // namespace

double right_share(const Json& figures, bool early_counts) {
  const auto count = [&](const char* key) { return figures.at(key).get<std::size_t>(); };
  const std::size_t quiet = count("trials") - count("slipping") - count("false_alarms");
  return static_cast<double>(count("seen") + quiet + (early_counts ? count("early") : 0)) / static_cast<double>(count("trials"));
}

Json gru_figures(const Json& result) {
  const Json& all = result.at("all");
  Json figures;
  for (const char* key : {"trials", "slipping", "seen", "early", "missed", "false_alarms"}) figures[key] = all.at(key);
  for (const auto& [name, key] : {std::pair{"balanced_accuracy", "balanced_slip_accuracy"},
                                  {"auc", "auc"},
                                  {"delay_s", "delay_median_s"},
                                  {"delay_p10_s", "delay_p10_s"},
                                  {"delay_p90_s", "delay_p90_s"},
                                  {"false_alarms_a_minute", "false_alarms_per_minute"}})
    figures[name] = all.at("figures").at(key).at("value");
  return figures;
}

Result hd_table3(const ReproduceOptions& options) {
  const std::vector<GruRow> rows = rows_asked_for(gru_rows, options);
  static_cast<void>(train::network_libraries());  // says what is missing before anything is run
  const InterruptGuard guard("ending after the step at hand");
  const ScratchFolder folder;
  Result result;
  result.title = "The recurrent network on the published protocol";
  result.source =
      "Table III, offline evaluation, of \"Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray "
      "Tactile Sensor\"";
  ResultTable frames = frames_table(), events = events_table();
  std::vector<std::string> datasets(many_draws + 1);
  for (const GruRow& row : rows) {
    std::string& dataset = datasets.at(row.draws);
    if (dataset.empty()) {
      dataset = folder.file(fmt::format("hexapod{}.h5", row.draws));
      make_dataset(dataset, hexapod_scene, {}, row.draws, "sequences", options);
    }
    const Json& figures = result.figures[row.name] = run_row(row, dataset, folder.file(row.name + ".onnx"), options);
    frames.rows.push_back(frames_row(row, figures));
    events.rows.push_back(events_row(row, figures));
  }
  result.tables = {frames, events};
  result.setup = {
      fmt::format(
          "{}, seed {}: {} sequences, or {} of them by {} draws; a fifth judges, a fifth of the rest chooses the state and the threshold.",
          hexapod_scene, options.seed.value_or(1), cells, cells * many_draws, many_draws),
      "The network is the published one (recipe papillarray_gru): 25 Hz, tangential forces of the eight outer pillars. Labels: micro, a part of a "
      "pillar slips; latched, it has slipped and still touches."};
  result.remarks = {
      "CL-gstHDC on the same sequences is hd-papillarray/table1.",
      "After a brake the pad sticks under the shear of its slip. By micro those frames are hold, and look like slip: so latched is the easier label, and "
      "nearest to the published one, which goes by a pillar's first slip.",
      "Early calls are mostly of slow motions, which bring a frame of 40 ms close to the first slip long before it."};
  return result;
}

}  // namespace slipbench::reproduce
