// Table IV of the paper: with and without recordings of motors alone, against the level of the motors' vibration.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/studies/grid.h"
#include "tools/studies/piezo_fft_gru/piezo_networks.h"

namespace slipbench::reproduce {
namespace {

using train::LabelRule;

constexpr std::size_t usual_level_recordings = 120;  // of each level
constexpr std::size_t level_steps = 400;             // of the MLP at each level

const std::vector<double>& all_levels() {
  static const std::vector<double> levels{0.0, 0.5, 1.0, bench_level, 4.0, 8.0};
  return levels;
}

// Level of a dataset that sweeps none: as recorded.
constexpr double no_level = -1.0;
std::string level_name(double level) { return level == no_level ? "as recorded" : fmt::format("{}", level); }

std::map<double, std::vector<PiezoRecording>> by_level(std::vector<PiezoRecording> recordings) {
  std::map<double, std::vector<PiezoRecording>> levels;
  for (PiezoRecording& recording : recordings)
    levels[std::isnan(recording.level) ? no_level : recording.level].push_back(std::move(recording));
  return levels;
}

// As the paper's bench is taken to be: no motor runs but those that move the tip.
NetworkRow gru_32_tip() {
  NetworkRow row = gru_32();
  row.name = "gru_32_tip";
  row.text += ", no motor but the tip's";
  return row;
}

struct Point {
  NetworkRow network;
  LabelRule rule;
  double level;
  std::size_t both, slip_alone;  // validations
};

std::vector<std::string> cells_of(const Point& point, const Validations& validations) {
  const std::vector<GroupCounts>&both = validations.folds(point.both), &alone = validations.folds(point.slip_alone);
  return {cell(on_all(both)), cell(on_slip(both)), cell(on_all(alone)), cell(on_slip(alone)),
          fmt::format("{:+.1f}", on_all(alone).accuracy.mean - on_slip(alone).accuracy.mean)};
}

// The tables' first row, and what all columns but the first two are.
ResultTable begun_table(const std::string& title, const std::string& first) {
  return {title,
          {first, "label", "learnt slip + noise: on slip + noise", "on slip", "learnt slip: on slip + noise", "on slip",
           "slip to slip + noise"},
          {},
          ""};
}

bool is_wanted(const NetworkRow& row, const ReproduceOptions& options) {
  return options.only.empty() || std::ranges::find(options.only, row.name) != options.only.end();
}

using Levels = std::map<double, std::vector<PiezoRecording>>;

// What is validated: the paper's networks at the level `bench`, the MLP at all levels. `tip`: recordings whose motors move the tip alone; may be empty.
std::vector<Point> queue_points(const ReproduceOptions& options, const Levels& levels, const Levels& tip,
                                Levels::const_iterator bench, Validations& validations) {
  std::vector<Point> points;
  const auto add = [&](const NetworkRow& network, LabelRule rule, const auto& level) {
    points.push_back({network, rule, level.first, validations.queue_folds(level.second, network, rule),
                      validations.queue_folds(level.second, network, rule, true)});
  };
  const std::array rules{LabelRule::paper, LabelRule::micro};
  for (const LabelRule rule : rules) {
    if (!tip.empty()) add(gru_32_tip(), rule, *tip.begin());
  }
  for (const LabelRule rule : rules) {
    if (is_wanted(gru_32(), options)) add(gru_32(), rule, *bench);
  }
  NetworkRow of_levels = mlp_32();
  of_levels.training.steps = level_steps;
  for (const LabelRule rule : rules) {
    if (!is_wanted(of_levels, options)) break;
    for (const auto& level : levels) {
      if (options.full || rule == LabelRule::paper || level.first == bench->first) add(of_levels, rule, level);
    }
  }
  return points;
}

}  // namespace

Result piezo_table4(const ReproduceOptions& options) {
  const StudySize size = size_of(options, usual_level_recordings);
  check_only(options.only, {gru_32_tip().name, gru_32().name, mlp_32().name});
  if (!options.data.empty() && std::ranges::find(options.only, gru_32_tip().name) != options.only.end()) {
    throw InputError(fmt::format("reproduce: --only {} needs recordings of its own; allowed: without --data", gru_32_tip().name));
  }
  const Levels levels = by_level(recordings_for(options, size, all_levels(), {published_spectra()}));
  const auto bench = levels.contains(bench_level) ? levels.find(bench_level) : levels.begin();
  Validations validations(options, size);
  // A dataset has the motors that it was recorded with.
  Levels tip;
  if (is_wanted(gru_32_tip(), options) && options.data.empty())
    tip = by_level(recordings_for(options, size, {bench_level}, {published_spectra()}, Motors::of_the_tip));
  const std::vector<Point> points = queue_points(options, levels, tip, bench, validations);
  validations.run();

  Result result;
  result.title = "Networks of the piezoelectric skin that learn with and without recordings of motors alone";
  result.source = fmt::format("Table IV of {}", table_source);
  ResultTable table = begun_table(fmt::format("Table IV: motor level {}", level_name(bench->first)), "network");
  table.rows.push_back({"paper, GRU 32", "position", "98.5, 0.974", "98.2, 0.977", "86.5, 0.678", "98.6, 0.983", "-12.1"});
  ResultTable curve = begun_table("MLP 32 against the motors' level", "motor level");
  for (const Point& point : points) {
    const std::vector<std::string> cells = cells_of(point, validations);
    const auto row = [&](const std::string& first) {
      std::vector<std::string> whole{first, label_name(point.rule)};
      whole.insert(whole.end(), cells.begin(), cells.end());
      return whole;
    };
    if (point.level == bench->first) table.rows.push_back(row(point.network.text));
    if (point.network.name == "mlp_32") curve.rows.push_back(row(level_name(point.level)));
    result.figures[label_name(point.rule)][point.network.name][level_name(point.level)] = {
        {"slip_and_noise", json_of(validations.folds(point.both))}, {"slip", json_of(validations.folds(point.slip_alone))}};
  }
  result.tables = {table};
  if (!curve.rows.empty()) result.tables.push_back(curve);
  result.setup = setup_lines(options, size, bench->second.size());
  result.setup.push_back(fmt::format("The number of recordings is that of each level; the MLP has {} steps.", level_steps));
  if (!options.full) result.setup.emplace_back("By the true label it learns at one level; at all with `--full`.");
  result.remarks = {
      "The paper's tip is moved by the motors that make the noise, as here; how loud they were is not printed, and the curve shows what it decides.",
      "In half of the recordings with contact a motor that does not move the tip runs, so a network that learns slip alone has heard motors without a slip, too."};
  if (!tip.empty()) result.remarks.back() += " The row \"no motor but the tip's\" is without it.";
  return result;
}

}  // namespace slipbench::reproduce
