#include "tools/calibrate/groups.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "sim/core/math/decade.h"
#include "sim/core/process/interrupted.h"
#include "tools/files/reject.h"
#include "tools/workers/ordered_workers.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr std::size_t sets = 8;          // simulated sets, each with another device, for the scatter
constexpr double least_band = 0.1;       // share of the steps between samples; smaller bands are rounding
constexpr double refused = 1e12;         // the distance where nothing can be simulated
constexpr Index least_blocks = 4;        // of a band
constexpr const char* band_unit = "ln";  // bands are natural logarithms

std::string label_of(const RawRecording& recording, const std::string& label) {
  const nlohmann::json params = nlohmann::json::parse(recording.params, nullptr, false);
  if (!params.is_object() || !params.contains(label))
    reject("{}: has no label {}; expected recordings with that label", recording.name, label);
  const nlohmann::json& value = params.at(label);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void check_cells(const Model& model, const Groups& groups) {
  const std::size_t cells = model.trials() / model.draws();
  if (cells != groups.values.size())
    reject("--groups: {}, but the grid of the scene's sweep has {}; give one value for each cell",
           counted(groups.values.size(), "value"), counted(cells, "cell"));
}

// Returns a trial's readings; empty if the scene refuses the drawn values.
std::optional<std::vector<SensorRecord>> possible_trial(const Model& model, const VectorXd& places, std::size_t trial,
                                                        std::uint64_t seed, std::uint64_t device,
                                                        const std::atomic<bool>* interrupt) {
  try {
    return model.simulate_drawn(places, trial, seed, device, interrupt);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// Returns the first trial that the scene does not refuse, which shows the arrays of a trial. If the
// scene refuses all, throws the error of the last one.
std::vector<SensorRecord> some_trial(const Model& model, const VectorXd& places, const std::atomic<bool>* interrupt) {
  for (std::size_t trial = 0; trial + 1 < model.trials(); ++trial) {
    if (auto sensors = possible_trial(model, places, trial, model.seed(), model.seed(), interrupt)) return std::move(*sensors);
  }
  return model.simulate_drawn(places, model.trials() - 1, model.seed(), model.seed(), interrupt);
}

}  // namespace

Groups parse_groups(const std::string& text) {
  Groups groups;
  const std::size_t equals = text.find('=');
  const std::string rest = equals == std::string::npos ? "" : text.substr(equals + 1);
  groups.label = text.substr(0, equals);
  for (std::size_t begin = 0; begin <= rest.size();) {
    const std::size_t comma = std::min(rest.find(',', begin), rest.size());
    groups.values.push_back(rest.substr(begin, comma - begin));
    begin = comma + 1;
  }
  std::vector<std::string> sorted = groups.values;
  std::ranges::sort(sorted);
  const bool twice = std::ranges::adjacent_find(sorted) != sorted.end();
  if (groups.label.empty() || sorted.front().empty() || twice)
    reject("--groups is '{}'; expected LABEL=VALUE,VALUE,... with different values, such as class=n,e,s", text);
  return groups;
}

std::vector<RawRecording> drawn_session(const Model& model, const Groups& groups, const VectorXd& places, std::uint64_t seed,
                                        const std::atomic<bool>* interrupt) {
  check_cells(model, groups);
  std::vector<RawRecording> recordings;
  for (std::size_t trial = 0; trial < model.trials(); ++trial) {
    const nlohmann::json params{{groups.label, groups.values.at(trial / model.draws())}};
    std::optional<std::vector<SensorRecord>> sensors = possible_trial(model, places, trial, seed, seed, interrupt);
    if (sensors) recordings.push_back({fmt::format("synthetic {}", trial), std::move(*sensors), params.dump()});
  }
  return recordings;
}

MatrixXd figures_of(const MatrixXd& samples, const RowVectorXd& floor) {
  std::vector<RowVectorXd> figures{samples.colwise().mean()};
  const Index part = samples.rows() / 2;
  figures.emplace_back(samples.bottomRows(part).colwise().mean() - samples.topRows(part).colwise().mean());
  MatrixXd blocks = samples;
  while (blocks.rows() >= least_blocks) {
    const MatrixXd steps = blocks.bottomRows(blocks.rows() - 1) - blocks.topRows(blocks.rows() - 1);
    const RowVectorXd squares = 0.5 * steps.colwise().squaredNorm() / static_cast<double>(steps.rows()) + floor.cwiseAbs2();
    figures.emplace_back(squares.unaryExpr([](double square) { return square > 0.0 ? 0.5 * math::log(square) : 0.0; }));
    MatrixXd means(blocks.rows() / 2, blocks.cols());
    for (Index k = 0; k < means.rows(); ++k) means.row(k) = 0.5 * (blocks.row(2 * k) + blocks.row(2 * k + 1));
    blocks = std::move(means);
  }
  MatrixXd rows(static_cast<Index>(figures.size()), samples.cols());
  for (Index k = 0; k < rows.rows(); ++k) rows.row(k) = figures[static_cast<std::size_t>(k)];
  return rows;
}

GroupProblem::GroupProblem(const Model* fitted, const Groups& groups, const std::vector<RawRecording>& recordings,
                           const VectorXd& own, std::size_t threads, const std::atomic<bool>* stop)
    : Problem(fitted, threads, stop), groups_(groups) {
  check_cells(*model, groups_);
  if (recordings.empty()) throw InputError("calibrate: all draws of the truth fail; choose bounds within which the scene runs");
  lay_out(recordings, some_trial(*model, own, interrupt));
  read_real(recordings);
  learn_scatter(own);
}

void GroupProblem::lay_out(const std::vector<RawRecording>& recordings, const std::vector<SensorRecord>& scene) {
  for (const RawRecording& recording : recordings) {
    of_recording_.push_back(shared_columns(recording, scene));
    if (columns_.channels.empty()) columns_ = of_recording_.back();
    check_same_columns(recording.name, of_recording_.back(), recordings.front().name, columns_);
    check_same_sampling(recording, scene, of_recording_.back(), most_longer_groups, 0.0);
  }
  std::vector<VectorXd> rough;
  for (std::size_t r = 0; r < recordings.size(); ++r)
    rough.push_back(roughness(recordings[r].sensors, Side::real, of_recording_[r]));
  floor_ = least_band * rms_over(rough);

  std::size_t figures = 0;
  for (std::size_t c = 0; c < columns_.channels.size(); ++c) {
    const ChannelPlace& place = columns_.channels[c];
    const Samples simulated = samples_of(scene, Side::scene, place);
    Index rows = simulated.values.rows();
    for (std::size_t r = 0; r < recordings.size(); ++r) {
      const RawRecording& recording = recordings[r];
      const Samples real = samples_of(recording.sensors, Side::real, of_recording_[r].channels[c]);
      rows = std::min(rows, real.values.rows());
    }
    if (rows < least_blocks)
      reject("{}/{}: the shortest recording has {}; at least {} are needed", place.sensor, place.channel,
             counted(static_cast<std::size_t>(rows), "sample"), least_blocks);
    rows_.push_back(static_cast<std::size_t>(rows));
    const auto add = [&](const std::string& name, const std::string& unit) {
      statistics_.push_back({c, name, unit, figures});
      figures += place.units * place.components;
    };
    add("level", place.unit);
    add("trend", place.unit);
    double length = simulated.step;
    for (Index blocks = rows; blocks >= least_blocks; blocks /= 2, length *= 2.0)
      add(fmt::format("{:.3g} ms", 1e3 * length), band_unit);
  }
}

RowVectorXd GroupProblem::figures(const std::vector<SensorRecord>& sensors, Side side, const Columns& columns,
                                  const std::string& name) const {
  const std::size_t count = statistics_.back().first + columns_.channels.back().units * columns_.channels.back().components;
  RowVectorXd all(static_cast<Index>(count));
  std::size_t statistic = 0;
  for (std::size_t c = 0; c < columns_.channels.size(); ++c) {
    const ChannelPlace& place = columns.channels[c];
    const Samples samples = samples_of(sensors, side, place);
    const auto rows = static_cast<Index>(rows_[c]), width = samples.values.cols();
    if (samples.values.rows() < rows)
      reject("{}: {}/{} has {}, but other trials have {}; all trials must last equally long", name, place.sensor, place.channel,
             counted(static_cast<std::size_t>(samples.values.rows()), "sample"), rows);
    const MatrixXd found =
        figures_of(samples.values.bottomRows(rows), floor_.segment(static_cast<Index>(place.first), width).transpose());
    for (Index k = 0; k < found.rows(); ++k)
      all.segment(static_cast<Index>(statistics_[statistic++].first), width) = found.row(k);
  }
  return all;
}

void GroupProblem::read_real(const std::vector<RawRecording>& recordings) {
  sizes_.assign(groups_.values.size(), 0);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const std::string value = label_of(recordings[r], groups_.label);
    const auto found = std::ranges::find(groups_.values, value);
    if (found == groups_.values.end())
      reject("{}: its {} is '{}'; allowed by --groups: {}", recordings[r].name, groups_.label, value,
             fmt::join(groups_.values, ", "));
    group_of_.push_back(static_cast<std::size_t>(found - groups_.values.begin()));
    ++sizes_[group_of_.back()];
    const RowVectorXd row = figures(recordings[r].sensors, Side::real, of_recording_[r], recordings[r].name);
    if (r == 0) real_.resize(static_cast<Index>(recordings.size()), row.size());
    real_.row(static_cast<Index>(r)) = row;
  }
  real_means_ = MatrixXd::Zero(static_cast<Index>(sizes_.size()), real_.cols());
  for (std::size_t r = 0; r < group_of_.size(); ++r)
    real_means_.row(static_cast<Index>(group_of_[r])) +=
        real_.row(static_cast<Index>(r)) / static_cast<double>(sizes_[group_of_[r]]);
  for (std::size_t g = 0; g < sizes_.size(); ++g) {
    if (sizes_[g] < 2)
      reject("calibrate: found {} whose {} is {}; at least two are needed to estimate their scatter",
             counted(sizes_[g], "recording"), groups_.label, groups_.values[g]);
  }
}

RowVectorXd GroupProblem::recordings_variance() const {
  RowVectorXd variance = RowVectorXd::Zero(real_.cols());
  for (std::size_t r = 0; r < group_of_.size(); ++r)
    variance += (real_.row(static_cast<Index>(r)) - real_means_.row(static_cast<Index>(group_of_[r]))).cwiseAbs2();
  return variance / static_cast<double>(group_of_.size() - sizes_.size());
}

std::vector<MatrixXd> GroupProblem::means_of_sets(const VectorXd& own) const {
  OrderedWorkers<RowVectorXd> workers(
      sets * model->trials(), std::min(jobs, sets * model->trials()),
      [&] {
        return [&](std::size_t task) {
          const std::uint64_t seed = seed_of(model->seed(), task / model->trials(), "set");
          return trial_figures(own, task % model->trials(), seed, seed);
        };
      },
      interrupt);
  std::vector<Waves> simulated(sets);
  for (std::size_t task = 0; std::optional<RowVectorXd> row = workers.next(); ++task)
    simulated[task / model->trials()].emplace_back(std::move(*row));
  end_if(interrupt);
  std::vector<MatrixXd> means;
  for (const Waves& set : simulated) {
    means.push_back(simulated_means(set));
    if (!means.back().array().isFinite().all())
      throw InputError("calibrate: with its own values all draws of a cell of the scene fail; run the scene with slipbench run");
  }
  return means;
}

void GroupProblem::leave_out_unmoved_bands() {
  for (const Statistic& statistic : statistics_) {
    const ChannelPlace& place = columns_.channels[statistic.channel];
    for (std::size_t v = 0; statistic.unit == band_unit && v < place.units * place.components; ++v) {
      if (floor_(static_cast<Index>(place.first + v)) == 0.0) scatter_.col(static_cast<Index>(statistic.first + v)).setZero();
    }
  }
}

void GroupProblem::learn_scatter(const VectorXd& own) {
  const auto groups = static_cast<Index>(sizes_.size()), figure_count = real_.cols();
  const RowVectorXd variance = recordings_variance();
  const std::vector<MatrixXd> means = means_of_sets(own);
  MatrixXd mean = MatrixXd::Zero(groups, figure_count);
  for (const MatrixXd& set : means) mean += set / static_cast<double>(sets);
  RowVectorXd of_sets = RowVectorXd::Zero(figure_count);
  for (const MatrixXd& set : means)
    of_sets += (set - mean).cwiseAbs2().colwise().sum() / static_cast<double>((sets - 1) * sizes_.size());
  scatter_.resize(groups, figure_count);
  for (std::size_t g = 0; g < sizes_.size(); ++g)
    scatter_.row(static_cast<Index>(g)) = (variance / static_cast<double>(sizes_[g]) + of_sets).cwiseSqrt();
  leave_out_unmoved_bands();

  const auto scaled = [&](const MatrixXd& away) {
    const MatrixXd share = (scatter_.array() > 0.0).select(away.array() / scatter_.array(), 0.0);
    return VectorXd(share.reshaped());
  };
  chance_.resize(groups * figure_count, static_cast<Index>(group_of_.size() + sets));
  Index column = 0;
  for (std::size_t r = 0; r < group_of_.size(); ++r) {
    const auto g = static_cast<Index>(group_of_[r]);
    const auto size = static_cast<double>(sizes_[group_of_[r]]);
    MatrixXd away = MatrixXd::Zero(groups, figure_count);
    away.row(g) = (real_.row(static_cast<Index>(r)) - real_means_.row(g)) / std::sqrt(size * (size - 1.0));
    chance_.col(column++) = scaled(away);
  }
  for (const MatrixXd& set : means) chance_.col(column++) = scaled((set - mean) / std::sqrt(static_cast<double>(sets - 1)));
}

RowVectorXd GroupProblem::trial_figures(const VectorXd& places, std::size_t trial, std::uint64_t seed,
                                        std::uint64_t device) const {
  const std::optional<std::vector<SensorRecord>> sensors = possible_trial(*model, places, trial, seed, device, interrupt);
  if (!sensors) return RowVectorXd::Constant(real_.cols(), std::numeric_limits<double>::quiet_NaN());
  return figures(*sensors, Side::scene, columns_, fmt::format("trial {}", trial));
}

MatrixXd GroupProblem::wave(const VectorXd& places, std::size_t trial) const {
  // The draws never change. Each repetition of a cell has another device, so that the mean depends
  // less on a single device.
  const std::uint64_t device = seed_of(model->seed(), trial % model->draws(), "repetition");
  return trial_figures(places, trial, model->seed(), device);
}

std::vector<std::size_t> GroupProblem::possible_trials(const Waves& simulated, std::size_t group) const {
  std::vector<std::size_t> trials;
  for (std::size_t trial = group * model->draws(); trial < (group + 1) * model->draws(); ++trial) {
    if (simulated[trial].array().isFinite().all()) trials.push_back(trial);
  }
  return trials;
}

MatrixXd GroupProblem::simulated_means(const Waves& simulated) const {
  MatrixXd means = MatrixXd::Zero(static_cast<Index>(sizes_.size()), real_.cols());
  for (std::size_t g = 0; g < sizes_.size(); ++g) {
    const std::vector<std::size_t> trials = possible_trials(simulated, g);
    for (const std::size_t trial : trials) means.row(static_cast<Index>(g)) += simulated[trial].row(0);
    means.row(static_cast<Index>(g)) /= static_cast<double>(trials.size());
  }
  return means;
}

Distance GroupProblem::distance(const Waves& simulated) const {
  const MatrixXd away = real_means_ - simulated_means(simulated);
  Distance distance;
  distance.possible = away.array().isFinite().all();
  distance.residual = VectorXd::Zero(away.size());
  if (distance.possible)
    distance.residual = (scatter_.array() > 0.0).select(away.array() / scatter_.array(), 0.0).matrix().reshaped();
  distance.squared = distance.possible ? distance.residual.squaredNorm() : refused;
  distance.compared = std::max<Index>(1, (scatter_.array() > 0.0).count());
  distance.compared_squared = distance.residual.squaredNorm();
  return distance;
}

MatrixXd GroupProblem::scores(const Distance& /*distance*/, const MatrixXd& slopes) const { return slopes.transpose() * chance_; }

Json GroupProblem::json(const Solution& solution) const {
  const MatrixXd simulated = simulated_means(solution.ideal);
  Json list = Json::array();
  for (std::size_t g = 0; g < sizes_.size(); ++g) {
    const std::size_t trials = possible_trials(solution.ideal, g).size();
    Json group{{"name", groups_.values[g]},
               {"recordings", sizes_[g]},
               {"trials", trials},
               {"refused", model->draws() - trials},
               {"statistics", Json::array()}};
    for (const Statistic& statistic : statistics_) {
      const ChannelPlace& place = columns_.channels[statistic.channel];
      for (std::size_t k = 0; k < place.components; ++k) {
        Json real = Json::array(), synthetic = Json::array();
        double squares = 0.0;
        for (std::size_t unit = 0; unit < place.units; ++unit) {
          const auto row = static_cast<Index>(g), column = static_cast<Index>(statistic.first + unit * place.components + k);
          real.push_back(rounded_to_digits(real_means_(row, column), 5));
          synthetic.push_back(rounded_to_digits(simulated(row, column), 5));
          const double sd = scatter_(row, column);
          if (sd > 0.0)
            squares += math::pow((real_means_(row, column) - simulated(row, column)) / sd, 2) / static_cast<double>(place.units);
        }
        group["statistics"].push_back({{"sensor", place.sensor},
                                       {"channel", place.channel},
                                       {"component", place.names[k]},
                                       {"statistic", statistic.name},
                                       {"unit", statistic.unit},
                                       {"residual", std::sqrt(squares)},
                                       {"real", std::move(real)},
                                       {"synthetic", std::move(synthetic)}});
      }
    }
    list.push_back(std::move(group));
  }
  return list;
}

}  // namespace slipbench::calibrate
