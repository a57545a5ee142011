// Table I of the nib pad's paper: forces and moments out of the 36 capacitances, under uniform and under partial loads.
#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "sim/simulation/stage_simulation.h"
#include "tools/base/project/project_file.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/catalogue/sensor_catalogue.h"
#include "tools/studies/grid.h"
#include "tools/studies/nib_reconfigurable/nib_tables.h"

namespace slipbench::reproduce {
namespace {

// The paper: 4000 rows train, 1000 test.
constexpr std::size_t fit_rows = 3000, choose_rows = 1000, test_rows = 1000;

enum CalibrationLoad : std::size_t { plate, end_face, lying, load_count };
constexpr std::array<const char*, load_count> calibration_scenes{
    "scenes/nib_pad/calibrate_uniform.yaml", "scenes/nib_pad/calibrate_end_face.yaml", "scenes/nib_pad/calibrate_lying.yaml"};
constexpr std::array<const char*, load_count> load_names{"uniform", "end face", "lying"};
using LoadRecordings = std::array<CalibrationRecording, load_count>;

// What is changed of the recordings, one thing at a time.
struct CalibrationVariant {
  std::string name;
  std::vector<Override> overrides = {};
  bool averaged_reference = true;
  std::size_t apart = 1;  // so many times as many recordings, of which every so manieth image is kept
};

// Which loads teach and are tested, in equal parts.
struct CalibrationCase {
  const char* name;
  std::vector<CalibrationLoad> loads;
};

// One fit: of which variant, and how its rows are dealt out.
struct CalibrationFit {
  std::size_t variant;
  const CalibrationCase* loads;
  SplitKind kind;
};

// A fit of uniform loads, asked about each kind of load: RMS error and mean error.
struct LoadTransfer {
  std::array<PadWrench, load_count> rms, bias;
};

// Trials of each cell of a scene's own sweep.
std::size_t own_draws(const char* scene) {
  const Catalogues catalogues = program_catalogues();
  return TrialPlan(SceneFile::load(project_file(scene)), catalogues, 0, 1).draws();
}

// The rows of several loads as those of one recording.
CalibrationSplit split_of(const CalibrationCase& one, const LoadRecordings& recordings, SplitKind kind, RandomStream& stream) {
  CalibrationSplit all;
  Eigen::Index first = 0;
  const std::size_t parts = one.loads.size();
  for (const CalibrationLoad load : one.loads) {
    const std::size_t rows = recordings[load].size();
    const CalibrationSplit part = split_rows(rows, fit_rows / parts, choose_rows / parts, test_rows / parts, kind, stream);
    for (const auto member : {&CalibrationSplit::fit, &CalibrationSplit::choose, &CalibrationSplit::test}) {
      for (const Eigen::Index row : part.*member) (all.*member).push_back(first + row);
    }
    first += static_cast<Eigen::Index>(rows);
  }
  return all;
}

CalibrationRecording recording_of(const CalibrationCase& one, const LoadRecordings& recordings) {
  std::vector<CalibrationRecording> parts;
  for (const CalibrationLoad load : one.loads) parts.push_back(recordings[load]);
  return joined(parts);
}

PadWrench error_of(const CalibrationCase& one, const LoadRecordings& recordings, SplitKind kind, std::uint64_t seed) {
  RandomStream stream(seed, 0, "nib_table1.split");
  const CalibrationRecording data = recording_of(one, recordings);
  const CalibrationSplit split = split_of(one, recordings, kind, stream);
  const QuadraticFit fit(data.si, data.averaged, split.fit, split.choose);
  return rms_error(fit.predict(rows_of(data.si, split.test)), rows_of(data.averaged, split.test));
}

// The scenes as they are first.
const std::vector<CalibrationVariant> calibration_variants{
    {"as it is"},
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

// The recordings of each variant. Throws InputError and Interrupted as run_grid does.
std::vector<LoadRecordings> record_loads(const ReproduceOptions& options) {
  std::vector<GridCell> cells;
  for (const CalibrationVariant& variant : calibration_variants) {
    for (const char* scene : calibration_scenes) {
      cells.push_back({variant.name, scene, variant.overrides, {}, variant.apart * own_draws(scene)});
    }
  }
  const auto found = run_grid<CalibrationRecording>(cells, options, [](const GridTrial& trial) {
    return record_calibration(trial.scene, trial.number,
                              static_cast<Eigen::Index>(calibration_variants[trial.cell / load_count].apart));
  });
  std::vector<LoadRecordings> all(calibration_variants.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    CalibrationRecording& recording = all[k / load_count][k % load_count];
    recording = joined(found[k]);
    if (!calibration_variants[k / load_count].averaged_reference) recording.averaged = recording.wrench;
  }
  return all;
}

const std::array<CalibrationCase, 4> calibration_cases{{{"uniform", {plate}},
                                                        {"uniform + end face", {plate, end_face}},
                                                        {"uniform + lying", {plate, lying}},
                                                        {"uniform + both", {plate, end_face, lying}}}};

// The RMS error of each fit on its test rows. Throws Interrupted.
std::vector<PadWrench> fit_errors(const std::vector<CalibrationFit>& fits, const std::vector<LoadRecordings>& recordings,
                                  const ReproduceOptions& options) {
  return run_in_order<PadWrench>(
      fits.size(), options, [](std::size_t) { return "fits"; },
      [&](std::size_t k) {
        return error_of(*fits[k].loads, recordings[fits[k].variant], fits[k].kind, options.seed.value_or(1));
      });
}

LoadTransfer transfer_of(const LoadRecordings& recordings, std::uint64_t seed) {
  RandomStream stream(seed, 0, "nib_table1.split");
  const CalibrationSplit split = split_of(calibration_cases[0], recordings, SplitKind::random, stream);
  const QuadraticFit fit(recordings[plate].si, recordings[plate].averaged, split.fit, split.choose);
  LoadTransfer transfer;
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

// Fx, Fy, Fz in N, Mx, My, Mz in mN m, as the paper prints them.
constexpr std::array<double, 6> published_uniform{0.12, 0.11, 0.56, 3.0, 3.1, 1.3};
constexpr std::array<double, 6> published_partial{0.15, 0.12, 1.2, 5.1, 6.7, 1.5};
constexpr std::array<const char*, 6> component_names{"Fx", "Fy", "Fz", "Mx", "My", "Mz"};
std::array<double, 6> printed(const PadWrench& wrench) {
  std::array<double, 6> values{};
  for (std::size_t c = 0; c < values.size(); ++c) values[c] = (c < 3 ? 1.0 : 1e3) * wrench[static_cast<Eigen::Index>(c)];
  return values;
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

// Rows of the main table: of which variant, and how they are split.
struct MainSplit {
  const char* how;
  std::size_t variant;
  SplitKind kind;
};
std::vector<MainSplit> main_splits() {
  std::size_t apart = 0;
  while (calibration_variants[apart].apart == 1) ++apart;
  return {{"random split", 0, SplitKind::random},
          {"chronological split", 0, SplitKind::chronological},
          {"images 0.3 s apart", apart, SplitKind::random}};
}

ResultTable main_table(const std::vector<LoadRecordings>& recordings, const ReproduceOptions& options, Json& figures) {
  ResultTable table{"RMS error of a second-order polynomial of the 36 capacitances",
                    wrench_head,
                    {row_of("paper: uniform", published_uniform), row_of("paper: uniform + partial", published_partial)}};
  for (const auto& [how, variant, kind] : main_splits()) {
    std::vector<CalibrationFit> fits;
    for (const CalibrationCase& one : calibration_cases) fits.push_back({variant, &one, kind});
    const std::vector<PadWrench> errors = fit_errors(fits, recordings, options);
    for (std::size_t k = 0; k < fits.size(); ++k) {
      table.rows.push_back(row_of(fmt::format("{}, {}", fits[k].loads->name, how), printed(errors[k])));
      figures[how][fits[k].loads->name] = json_of(printed(errors[k]));
    }
  }
  table.note =
      "Random: test rows are drawn from among the others, so that their neighbours, 30 ms away and sharing four of the five images of the mean, may have taught. Chronological: the last fifth of each load tests, for a cylinder the last two of its ten places. 0.3 s apart: ten times as long a calibration of which every tenth image is kept, so that no test row has such a neighbour; random split.";
  return table;
}

ResultTable transfer_table(const LoadRecordings& recordings, std::uint64_t seed, Json& figures) {
  ResultTable table{"A fit of uniform loads alone, asked about others: RMS error, and mean error of Fz", wrench_head};
  table.head.push_back("Fz too high by, N");
  const LoadTransfer transfer = transfer_of(recordings, seed);
  for (std::size_t load = 0; load < load_count; ++load) {
    const std::array<double, 6> error = printed(transfer.rms[load]);
    table.rows.push_back(row_of(load_names[load], error));
    table.rows.back().push_back(fmt::format("{:.2f}", transfer.bias[load][2]));
    figures[load_names[load]] = json_of(error);
    figures[load_names[load]]["Fz_bias"] = transfer.bias[load][2];
  }
  return table;
}

ResultTable ranges_table(const LoadRecordings& recordings, Json& figures) {
  ResultTable table{"Loads of the recordings: 1st and 99th percentile",
                    wrench_head,
                    {{"paper, range", "+-3.5", "+-3.5", "0 to 15", "+-50", "+-50", "+-50"}}};
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

// Of each variant the first three cases.
ResultTable causes_table(const std::vector<LoadRecordings>& recordings, const ReproduceOptions& options, Json& figures) {
  constexpr std::size_t columns = 3;
  ResultTable table{"What decides it: one thing changed at a time, random split, RMS error of Fz in N and of Mx and My in mNm",
                    {"", "Fz: uniform", "+ end face", "+ lying", "Mx: uniform", "+ end face", "+ lying", "My: uniform",
                     "+ end face", "+ lying"}};
  std::vector<CalibrationFit> fits;
  for (std::size_t variant = 0; variant < calibration_variants.size(); ++variant) {
    for (std::size_t one = 0; one < columns; ++one) fits.push_back({variant, &calibration_cases.at(one), SplitKind::random});
  }
  const std::vector<PadWrench> errors = fit_errors(fits, recordings, options);
  for (std::size_t variant = 0; variant < calibration_variants.size(); ++variant) {
    const auto own = std::span(errors).subspan(columns * variant, columns);
    std::vector<std::string>& row = table.rows.emplace_back(1, calibration_variants[variant].name);
    for (const std::size_t component : {2U, 3U, 4U}) {
      for (const PadWrench& error : own) row.push_back(fmt::format("{:.{}f}", printed(error)[component], component < 3 ? 2 : 1));
    }
    for (std::size_t one = 0; one < columns; ++one) {
      figures[calibration_variants[variant].name][calibration_cases.at(one).name] = json_of(printed(own[one]));
    }
  }
  return table;
}

constexpr std::array<double, 9> ridges{1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0};

// All inputs, then all products of two.
Eigen::MatrixXd quadratic_terms(const Eigen::MatrixXd& x) {
  const Eigen::Index n = x.cols();
  Eigen::MatrixXd terms(x.rows(), n + n * (n + 1) / 2);
  terms.leftCols(n) = x;
  Eigen::Index column = n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) terms.col(column++) = x.col(i).cwiseProduct(x.col(j));
  }
  return terms;
}

Eigen::RowVectorXd scale_of(const Eigen::MatrixXd& x, const Eigen::RowVectorXd& mean) {
  const Eigen::RowVectorXd sd = ((x.rowwise() - mean).colwise().squaredNorm() / static_cast<double>(x.rows())).cwiseSqrt();
  return sd.unaryExpr([](double value) { return value > 0.0 ? value : 1.0; });  // what never changes teaches nothing
}

Eigen::MatrixXd scaled(const Eigen::MatrixXd& x, const Eigen::RowVectorXd& mean, const Eigen::RowVectorXd& scale) {
  return ((x.rowwise() - mean).array().rowwise() / scale.array()).matrix();
}

// The mean of each row and of those before it, `count` in all.
Eigen::MatrixXd running_mean(const Eigen::MatrixXd& rows, std::size_t count) {
  Eigen::MatrixXd means(rows.rows(), rows.cols());
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const Eigen::Index taken = std::min(row + 1, static_cast<Eigen::Index>(count));
    means.row(row) = rows.middleRows(row + 1 - taken, taken).colwise().mean();
  }
  return means;
}

// Shuffles and keeps the first `count`.
std::vector<Eigen::Index> draw(std::vector<Eigen::Index> rows, std::size_t count, RandomStream& stream) {
  if (rows.size() < count) throw std::invalid_argument("split_rows: too few rows");
  for (std::size_t i = 0; i < count; ++i) std::swap(rows[i], rows[i + stream.integer(rows.size() - i)]);
  rows.resize(count);
  return rows;
}

std::vector<Eigen::Index> range(std::size_t first, std::size_t end) {
  std::vector<Eigen::Index> rows(end - first);
  std::iota(rows.begin(), rows.end(), static_cast<Eigen::Index>(first));
  return rows;
}

}  // namespace

Result nib_table1(const ReproduceOptions& options) {
  const std::uint64_t seed = options.seed.value_or(1);
  const std::vector<LoadRecordings> recordings = record_loads(options);
  Result result;
  result.title = "Calibration of the nib pad";
  result.source =
      "Table I and section IV-A of \"Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation\", IEEE RA-L 2020";
  result.tables.push_back(main_table(recordings, options, result.figures["rms"]));
  const Json& uniform = result.figures["rms"][main_splits().front().how][calibration_cases.front().name];
  for (std::size_t c = 0; c < published_uniform.size(); ++c) {
    result.real.push_back({fmt::format("calibrated {}, rms error, {}", component_names[c], c < 3 ? "N" : "N mm"),
                           published_uniform[c], uniform.at(component_names[c]).get<double>(),
                           "electronics assumed; random split of one recording"});
  }
  result.tables.push_back(transfer_table(recordings.front(), seed, result.figures["of_uniform"]));
  result.tables.push_back(ranges_table(recordings.front(), result.figures["loads"]));
  result.tables.push_back(causes_table(recordings, options, result.figures["causes"]));
  result.setup = {
      fmt::format("Data: {}, {} and {} afresh, seed {}: 5,000 images of si or more each, electronics typical.",
                  calibration_scenes[plate], calibration_scenes[end_face], calibration_scenes[lying], seed),
      fmt::format(
          "Fit: 703 coefficients a component on {} rows, ridge chosen on {} others of the training part out of nine powers of ten, then both teach; {} rows test. Several loads share these numbers in equal parts. The paper has 4000 and 1000, and does not say how it kept 703 coefficients in check.",
          fit_rows, choose_rows, test_rows),
      "Reference: the true forces on all nibs and their moments about the pad's origin, through the same mean of five images as si.",
  };
  return result;
}

PadWrench wrench_on_pad(const PadLayout& layout, const ContactFrame& truth) {
  PadWrench wrench = PadWrench::Zero();
  for (std::size_t unit = 0; unit < layout.units.size(); ++unit) {
    const auto column = static_cast<Eigen::Index>(unit);
    const Eigen::Vector3d force = truth.force.col(column);
    const Eigen::Vector3d place = layout.elements[layout.units[unit].first].tip + truth.displacement.col(column).matrix();
    wrench.head<3>() += force.transpose();
    wrench.tail<3>() += place.cross(force).transpose();
  }
  return wrench;
}

CalibrationRecording record_calibration(const Scene& scene, std::uint64_t trial, Eigen::Index every) {
  const std::unique_ptr<Sensor> sensor = make_sensor(scene.sensors.front(), scene.seed, trial);
  const PadLayout* const pad = &sensor->layout();
  const double rate = sensor->rate() * static_cast<double>(sensor->scans());
  StageSimulation simulation(scene, {&pad, 1}, {&rate, 1}, trial);
  const std::size_t readings_an_image = sensor->scans() * sensor->channels().front().every;

  std::vector<double> time, si;
  std::vector<double> wrench;
  std::size_t readings = 0;
  for (std::size_t tick = 0; tick < simulation.ticks(0); ++tick) {
    simulation.step();
    if (tick % simulation.stride(0) != 0) continue;
    const ContactFrame& truth = simulation.contact(0);
    const SensorFrame& frame = sensor->measure(truth);
    if (++readings % readings_an_image != 0) continue;
    time.push_back(truth.time);
    si.insert(si.end(), frame.values.begin(), frame.values.begin() + si_count);
    const PadWrench now = wrench_on_pad(*pad, truth);
    wrench.insert(wrench.end(), now.begin(), now.end());
  }
  const auto images = static_cast<Eigen::Index>(time.size());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd all_si = Eigen::Map<const Rows>(si.data(), images, si_count);
  const Eigen::MatrixXd all_wrenches = Eigen::Map<const Rows>(wrench.data(), images, wrench_size);
  const Eigen::MatrixXd averaged = running_mean(all_wrenches, averaged_images);

  const Eigen::Index untouched = std::ranges::lower_bound(time, scene.motion.parameters.number("start")) - time.begin();
  const Eigen::RowVectorXd rest = all_si.topRows(untouched).colwise().mean();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index image = untouched; image < images; image += every) kept.push_back(image);
  return {rows_of(all_si, kept).rowwise() - rest, rows_of(all_wrenches, kept), rows_of(averaged, kept)};
}

CalibrationRecording joined(std::span<const CalibrationRecording> recordings) {
  Eigen::Index rows = 0;
  for (const CalibrationRecording& one : recordings) rows += one.si.rows();
  CalibrationRecording all{Eigen::MatrixXd(rows, si_count), Eigen::MatrixXd(rows, wrench_size),
                           Eigen::MatrixXd(rows, wrench_size)};
  Eigen::Index row = 0;
  for (const CalibrationRecording& one : recordings) {
    all.si.middleRows(row, one.si.rows()) = one.si;
    all.wrench.middleRows(row, one.si.rows()) = one.wrench;
    all.averaged.middleRows(row, one.si.rows()) = one.averaged;
    row += one.si.rows();
  }
  return all;
}

CalibrationSplit split_rows(std::size_t rows, std::size_t fit, std::size_t choose, std::size_t test, SplitKind kind,
                            RandomStream& stream) {
  if (kind == SplitKind::chronological) {
    const std::size_t judged = rows - rows / 5, chosen = judged - judged / 4;
    return {draw(range(0, chosen), fit, stream), draw(range(chosen, judged), choose, stream),
            draw(range(judged, rows), test, stream)};
  }
  const std::vector<Eigen::Index> drawn = draw(range(0, rows), fit + choose + test, stream);
  const auto chosen = drawn.begin() + static_cast<std::ptrdiff_t>(fit), judged = chosen + static_cast<std::ptrdiff_t>(choose);
  return {{drawn.begin(), chosen}, {chosen, judged}, {judged, drawn.end()}};
}

// The columns of some rows, and what least squares needs of them.
struct QuadraticFit::Columns {
  Eigen::MatrixXd terms;  // scaled
  Eigen::MatrixXd gram;   // terms' terms / n, lower triangle
  Eigen::MatrixXd right;  // terms' (y - mean) / n

  [[nodiscard]] Eigen::MatrixXd solved(double ridge) const {
    Eigen::MatrixXd system = gram;
    system.diagonal().array() += ridge;
    return Eigen::LLT<Eigen::MatrixXd, Eigen::Lower>(system).solve(right);
  }
};

QuadraticFit::QuadraticFit(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y, std::span<const Eigen::Index> teach,
                           std::span<const Eigen::Index> choose)
    : ridge_(static_cast<std::size_t>(y.cols()), ridges.front()) {
  const auto learn = [&](std::span<const Eigen::Index> rows) {
    const Eigen::MatrixXd inputs = rows_of(x, rows), outputs = rows_of(y, rows);
    x_mean_ = inputs.colwise().mean();
    x_scale_ = scale_of(inputs, x_mean_);
    Columns columns;
    columns.terms = quadratic_terms(scaled(inputs, x_mean_, x_scale_));
    column_mean_ = columns.terms.colwise().mean();
    column_scale_ = scale_of(columns.terms, column_mean_);
    columns.terms = scaled(columns.terms, column_mean_, column_scale_);
    y_mean_ = outputs.colwise().mean();
    const double share = 1.0 / static_cast<double>(rows.size());
    columns.gram = Eigen::MatrixXd::Zero(columns.terms.cols(), columns.terms.cols());
    columns.gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.terms.transpose(), share);
    columns.right = share * (columns.terms.transpose() * (outputs.rowwise() - y_mean_));
    return columns;
  };

  const Columns first = learn(teach);
  const Eigen::MatrixXd inputs = rows_of(x, choose), outputs = rows_of(y, choose);
  std::vector<double> least(ridge_.size(), std::numeric_limits<double>::infinity());
  for (const double ridge : ridges) {
    coefficients_ = first.solved(ridge);
    const Eigen::RowVectorXd errors = (predict(inputs) - outputs).colwise().squaredNorm();
    for (std::size_t c = 0; c < least.size(); ++c) {
      if (errors[static_cast<Eigen::Index>(c)] >= least[c]) continue;
      least[c] = errors[static_cast<Eigen::Index>(c)];
      ridge_[c] = ridge;
    }
  }

  std::vector<Eigen::Index> both(teach.begin(), teach.end());
  both.insert(both.end(), choose.begin(), choose.end());
  const Columns all = learn(both);
  for (const double ridge : ridges) {
    if (std::ranges::find(ridge_, ridge) == ridge_.end()) continue;
    const Eigen::MatrixXd solved = all.solved(ridge);
    for (std::size_t c = 0; c < ridge_.size(); ++c) {
      const auto component = static_cast<Eigen::Index>(c);
      if (ridge_[c] == ridge) coefficients_.col(component) = solved.col(component);
    }
  }
}

Eigen::MatrixXd QuadraticFit::predict(const Eigen::MatrixXd& x) const {
  const Eigen::MatrixXd terms = scaled(quadratic_terms(scaled(x, x_mean_, x_scale_)), column_mean_, column_scale_);
  return (terms * coefficients_).rowwise() + y_mean_;
}

PadWrench rms_error(const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& truth) {
  return ((predicted - truth).colwise().squaredNorm() / static_cast<double>(truth.rows())).cwiseSqrt();
}

Eigen::MatrixXd rows_of(const Eigen::MatrixXd& matrix, std::span<const Eigen::Index> which) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(which.size()), matrix.cols());
  for (std::size_t i = 0; i < which.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = matrix.row(which[i]);
  return rows;
}

}  // namespace slipbench::reproduce
