// Table I of the nib pad's paper: forces and moments out of the 36 capacitances, under uniform and under partial loads.
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "sim/scene/parser.h"
#include "tools/base/project/project_file.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/base/workers/interrupt.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/studies/nib_reconfigurable/nib_calibration.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce {
namespace {

constexpr std::size_t fit_rows = 3000, choose_rows = 1000, test_rows = 1000;  // the paper: 4000 train, 1000 test

enum Load : std::size_t { plate, end_face, lying, load_count };
constexpr std::array<const char*, load_count> scenes{
    "scenes/nib_pad/calibrate_uniform.yaml", "scenes/nib_pad/calibrate_end_face.yaml", "scenes/nib_pad/calibrate_lying.yaml"};
constexpr std::array<const char*, load_count> load_names{"uniform", "end face", "lying"};
using Recordings = std::array<CalibrationRecording, load_count>;

// Which loads teach and are tested, in equal parts.
struct Case {
  const char* name;
  std::vector<Load> loads;
};
const std::array<Case, 4> cases{{{"uniform", {plate}},
                                 {"uniform + end face", {plate, end_face}},
                                 {"uniform + lying", {plate, lying}},
                                 {"uniform + both", {plate, end_face, lying}}}};

// Fx, Fy, Fz in N, Mx, My, Mz in mN m, as the paper prints them.
constexpr std::array<double, 6> published_uniform{0.12, 0.11, 0.56, 3.0, 3.1, 1.3};
constexpr std::array<double, 6> published_partial{0.15, 0.12, 1.2, 5.1, 6.7, 1.5};
constexpr std::array<const char*, 6> component_names{"Fx", "Fy", "Fz", "Mx", "My", "Mz"};
std::array<double, 6> printed(const PadWrench& wrench) {
  std::array<double, 6> values{};
  for (std::size_t c = 0; c < values.size(); ++c) values[c] = (c < 3 ? 1.0 : 1e3) * wrench[static_cast<Eigen::Index>(c)];
  return values;
}

// What is changed of the recordings, one thing at a time.
struct Variant {
  std::string name;
  std::vector<Override> overrides = {};
  bool averaged_reference = true;
  std::size_t apart = 1;  // so many times as many recordings, of which every so manieth image is kept
};
std::vector<Variant> variants() {
  return {{"as it is"},
          {"linear capacitor", {{"sensors.pad.capacitor", "linear"}}},
          {"no noise", {{"sensors.pad.electronics", "ideal"}}},
          {"nibs of one height", {{"sensors.pad.height_sd", "0 mm"}}},
          {"all read at one instant", {{"sensors.pad.scan", "simultaneous"}}},
          {"k_tangential 0.4 N/mm", {{"sensors.pad.k_tangential", "0.4 N/mm"}}},
          {"reference not averaged", {}, false},
          {"nibs that lean (P-delta)", {{"effects", "[lean]"}}},
          {"as it is, images 0.3 s apart", {}, true, 10},
          {"linear capacitor, images 0.3 s apart", {{"sensors.pad.capacitor", "linear"}}, true, 10},
          {"nibs that lean (P-delta), images 0.3 s apart", {{"effects", "[lean]"}}, true, 10}};
}

void stop_if_interrupted() {
  if (InterruptGuard::flag()) throw Interrupted();
}

Recordings record(const Variant& variant, std::uint64_t seed, const Catalogues& catalogues) {
  Recordings recordings;
  for (std::size_t load = 0; load < load_count; ++load) {
    SceneFile file = SceneFile::load(project_file(scenes[load]));
    for (const Override& change : variant.overrides) file.apply(change);
    const TrialPlan plan(file, catalogues, variant.apart * TrialPlan(file, catalogues, 0, seed).draws(), seed);
    std::vector<CalibrationRecording> trials;
    for (std::size_t trial = 0; trial < plan.size(); ++trial) {
      stop_if_interrupted();
      trials.push_back(record_calibration(plan.trial(trial).scene, trial, static_cast<Eigen::Index>(variant.apart)));
    }
    recordings[load] = joined(trials);
    if (!variant.averaged_reference) recordings[load].averaged = recordings[load].wrench;
  }
  return recordings;
}

// The rows of several loads as those of one recording.
CalibrationSplit split_of(const Case& one, const Recordings& recordings, SplitKind kind, RandomStream& stream) {
  CalibrationSplit all;
  Eigen::Index first = 0;
  const std::size_t parts = one.loads.size();
  for (const Load load : one.loads) {
    const std::size_t rows = recordings[load].size();
    const CalibrationSplit part = split_rows(rows, fit_rows / parts, choose_rows / parts, test_rows / parts, kind, stream);
    for (const auto member : {&CalibrationSplit::fit, &CalibrationSplit::choose, &CalibrationSplit::test}) {
      for (const Eigen::Index row : part.*member) (all.*member).push_back(first + row);
    }
    first += static_cast<Eigen::Index>(rows);
  }
  return all;
}

CalibrationRecording recording_of(const Case& one, const Recordings& recordings) {
  std::vector<CalibrationRecording> parts;
  for (const Load load : one.loads) parts.push_back(recordings[load]);
  return joined(parts);
}

PadWrench error_of(const Case& one, const Recordings& recordings, SplitKind kind, std::uint64_t seed) {
  stop_if_interrupted();
  RandomStream stream(seed, 0, "nib_table1.split");
  const CalibrationRecording data = recording_of(one, recordings);
  const CalibrationSplit split = split_of(one, recordings, kind, stream);
  const QuadraticFit fit(data.si, data.averaged, split.fit, split.choose);
  return rms_error(fit.predict(rows_of(data.si, split.test)), rows_of(data.averaged, split.test));
}

// A fit of uniform loads, asked about each kind of load: error and mean error.
struct Transfer {
  std::array<PadWrench, load_count> rms, bias;
};
Transfer transfer_of(const Recordings& recordings, std::uint64_t seed) {
  RandomStream stream(seed, 0, "nib_table1.split");
  const CalibrationSplit split = split_of(cases[0], recordings, SplitKind::random, stream);
  const QuadraticFit fit(recordings[plate].si, recordings[plate].averaged, split.fit, split.choose);
  Transfer transfer;
  for (std::size_t load = 0; load < load_count; ++load) {
    const CalibrationRecording& asked = recordings[load];
    const std::vector<Eigen::Index> all = split_rows(asked.size(), 0, 0, asked.size(), SplitKind::random, stream).test;
    const std::vector<Eigen::Index>& rows = load == plate ? split.test : all;
    const Eigen::MatrixXd error = fit.predict(rows_of(asked.si, rows)) - rows_of(asked.averaged, rows);
    transfer.rms[load] = rms_error(error, Eigen::MatrixXd::Zero(error.rows(), error.cols()));
    transfer.bias[load] = error.colwise().mean();
  }
  return transfer;
}

std::vector<std::string> row_of(std::string name, const std::array<double, 6>& values) {
  std::vector<std::string> row{std::move(name)};
  for (std::size_t c = 0; c < values.size(); ++c) row.push_back(fmt::format("{:.{}f}", values[c], c < 3 ? 2 : 1));
  return row;
}

Json json_of(const std::array<double, 6>& values) {
  Json figures;
  for (std::size_t c = 0; c < values.size(); ++c) figures[component_names[c]] = values[c];
  return figures;
}

const std::vector<std::string> wrench_head{"", "Fx, N", "Fy, N", "Fz, N", "Mx, mNm", "My, mNm", "Mz, mNm"};

// Adds the rows of all cases.
void add_errors(ResultTable& table, const Recordings& recordings, SplitKind kind, const std::string& how, std::uint64_t seed,
                Json& figures) {
  for (const Case& one : cases) {
    const std::array<double, 6> error = printed(error_of(one, recordings, kind, seed));
    table.rows.push_back(row_of(fmt::format("{}, {}", one.name, how), error));
    figures[how][one.name] = json_of(error);
  }
}

ResultTable main_table(const Recordings& recordings, std::uint64_t seed, Json& figures) {
  ResultTable table;
  table.title = "RMS error of a second-order polynomial of the 36 capacitances";
  table.head = wrench_head;
  table.rows = {row_of("paper: uniform", published_uniform), row_of("paper: uniform + partial", published_partial)};
  add_errors(table, recordings, SplitKind::random, "random split", seed, figures);
  add_errors(table, recordings, SplitKind::chronological, "chronological split", seed, figures);
  table.note =
      "Random: test rows are drawn from among the others, so that their neighbours, 30 ms away and sharing four of the five images of the mean, may have taught. Chronological: the last fifth of each load tests, for a cylinder the last two of its ten places. 0.3 s apart: ten times as long a calibration of which every tenth image is kept, so that no test row has such a neighbour; random split.";
  return table;
}

ResultTable transfer_table(const Recordings& recordings, std::uint64_t seed, Json& figures) {
  ResultTable table;
  table.title = "A fit of uniform loads alone, asked about others: RMS error, and mean error of Fz";
  table.head = wrench_head;
  table.head.push_back("Fz too high by, N");
  const Transfer transfer = transfer_of(recordings, seed);
  for (std::size_t load = 0; load < load_count; ++load) {
    const std::array<double, 6> error = printed(transfer.rms[load]);
    table.rows.push_back(row_of(load_names[load], error));
    table.rows.back().push_back(fmt::format("{:.2f}", transfer.bias[load][2]));
    figures[load_names[load]] = json_of(error);
    figures[load_names[load]]["Fz_bias"] = transfer.bias[load][2];
  }
  return table;
}

ResultTable ranges_table(const Recordings& recordings, Json& figures) {
  ResultTable table;
  table.title = "Loads of the recordings: 1st and 99th percentile";
  table.head = wrench_head;
  table.rows = {{"paper, range", "+-3.5", "+-3.5", "0 to 15", "+-50", "+-50", "+-50"}};
  for (std::size_t load = 0; load < load_count; ++load) {
    std::vector<std::string> row{load_names[load]};
    for (Eigen::Index c = 0; c < wrench_size; ++c) {
      const double factor = c < 3 ? 1.0 : 1e3;
      std::vector<double> values(recordings[load].size());
      Eigen::VectorXd::Map(values.data(), recordings[load].wrench.rows()) = factor * recordings[load].wrench.col(c);
      const double low = quantile(values, 0.01), high = quantile(values, 0.99);
      row.push_back(fmt::format("{:.{}f} to {:.{}f}", low, c < 3 ? 1 : 0, high, c < 3 ? 1 : 0));
      figures[load_names[load]][component_names[static_cast<std::size_t>(c)]] = {low, high};
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Result nib_table1(const ReproduceOptions& options) {
  const InterruptGuard guard("ending after the step at hand");
  const std::uint64_t seed = options.seed.value_or(1);
  const Catalogues catalogues = program_catalogues();

  Result result;
  result.title = "Calibration of the nib pad";
  result.source =
      "Table I and section IV-A of \"Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation\", IEEE RA-L 2020";
  ResultTable causes;
  causes.title = "What decides it: one thing changed at a time, random split, RMS error of Fz in N and of Mx and My in mNm";
  causes.head = {"",           "Fz: uniform", "+ end face",  "+ lying",    "Mx: uniform",
                 "+ end face", "+ lying",     "My: uniform", "+ end face", "+ lying"};
  for (const Variant& variant : variants()) {
    if (options.say) options.say(variant.name);
    const Recordings recordings = record(variant, seed, catalogues);
    if (result.tables.empty()) {
      result.tables.push_back(main_table(recordings, seed, result.figures["rms"]));
      result.tables.push_back(transfer_table(recordings, seed, result.figures["of_uniform"]));
      result.tables.push_back(ranges_table(recordings, result.figures["loads"]));
    }
    std::vector<std::array<double, 6>> errors;
    for (std::size_t one = 0; one < 3; ++one) {
      errors.push_back(printed(error_of(cases[one], recordings, SplitKind::random, seed)));
      result.figures["causes"][variant.name][cases[one].name] = json_of(errors.back());
    }
    std::vector<std::string> row{variant.name};
    for (const std::size_t component : {2, 3, 4}) {
      for (const auto& error : errors) row.push_back(fmt::format("{:.{}f}", error[component], component < 3 ? 2 : 1));
    }
    causes.rows.push_back(std::move(row));
    if (variant.apart > 1 && variant.overrides.empty()) {
      add_errors(result.tables.front(), recordings, SplitKind::random, "images 0.3 s apart", seed, result.figures["rms"]);
    }
  }
  result.tables.push_back(std::move(causes));

  result.setup = {
      fmt::format("Data: {}, {} and {} afresh, seed {}: 5,000 images of si or more each, electronics typical.", scenes[plate],
                  scenes[end_face], scenes[lying], seed),
      fmt::format(
          "Fit: 703 coefficients a component on {} rows, ridge chosen on {} others of the training part out of nine powers of ten, then both teach; {} rows test. Several loads share these numbers in equal parts. The paper has 4000 and 1000, and does not say how it kept 703 coefficients in check.",
          fit_rows, choose_rows, test_rows),
      "Reference: the true forces on all nibs and their moments about the pad's origin, through the same mean of five images as si.",
  };
  return result;
}

}  // namespace slipbench::reproduce
