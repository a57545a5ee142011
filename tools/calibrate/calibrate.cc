#include "tools/calibrate/calibrate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "sim/core/math.h"
#include "sim/core/math/decade.h"
#include "sim/core/random.h"
#include "sim/scene/scene_reader.h"
#include "tools/calibrate/disturbances.h"
#include "tools/calibrate/recordings.h"
#include "tools/calibrate/search.h"
#include "tools/files/reject.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Number of pairs of recordings from which the electronics are estimated, one device per pair.
constexpr std::size_t learning_pairs = 4;
// Least remainder of a column, as a share of its range; below it, stretches and steps of the
// simulation dominate.
constexpr double least_remainder = 1e-4;
// Smallest correlation that is reported.
constexpr double strong_correlation = 0.9;

// The recordings on their grids, as compared.
struct Compared {
  Columns columns;
  std::vector<std::vector<double>> edges;
  Waves real;
  VectorXd roughness;  // RMS over the recordings
};

// `scene_of`: returns the ideal trial of a recording. `lag`: returns the offset of a recording's
// clock [s]; a drawn recording has its own. `most_lag` [s]: largest lag if it is fitted, else 0.
Compared compared(const std::vector<RawRecording>& recordings,
                  const std::function<std::vector<SensorRecord>(std::size_t)>& scene_of,
                  const std::function<double(std::size_t)>& lag, double most_lag) {
  Compared result;
  std::vector<VectorXd> rough;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const RawRecording& recording = recordings[r];
    const std::vector<SensorRecord> scene = scene_of(r);
    if (recording.sensors.empty()) reject("{}: contains no sensor", recording.name);
    Columns columns = shared_columns(recording, scene);
    if (result.real.empty()) result.columns = columns;
    check_same_columns(recording.name, columns, recordings.front().name, result.columns);
    check_same_sampling(recording, scene, columns, most_longer_curves, most_lag);
    result.edges.push_back(bin_edges(recording, scene));
    const double shift = scene.front().time.front() - recording.sensors.front().time.front() + lag(r);
    result.real.push_back(bin_means(recording.sensors, Side::real, columns, result.edges.back(), shift));
    rough.push_back(calibrate::roughness(recording.sensors, Side::real, columns));
  }
  result.roughness = rms_over(rough);
  return result;
}

// How far the fitted lag can be from 0 [s]; 0 where it is not fitted.
double most_lag(const std::vector<FitKey>& keys) {
  const auto found = std::ranges::find(keys, lag_key, &FitKey::path);
  return found == keys.end() ? 0.0 : std::max(std::abs(found->min), std::abs(found->max));
}

// Recordings simulated from parameters that are drawn between the bounds.
struct Truth {
  VectorXd places;
  std::uint64_t seed = 0;
};

std::vector<RawRecording> drawn_recordings(const Model& model, const Truth& truth, const Options& options) {
  std::vector<RawRecording> recordings;
  for (std::size_t r = 0; r < model.recordings(); ++r) {
    recordings.push_back(
        {fmt::format("synthetic {}", r), model.simulate(truth.places, r, Readings::read, truth.seed, options.interrupt)});
  }
  return recordings;
}

Waves waves_of(const Model& model, const VectorXd& places, Readings readings, std::uint64_t seed, const Compared& data,
               const Options& options, std::size_t again = 0) {
  Waves waves;
  for (std::size_t r = 0; r < model.recordings(); ++r) {
    waves.push_back(bin_means(model.simulate(places, r, readings, seed, options.interrupt, again), Side::scene, data.columns,
                              data.edges[r], model.lag(places, r)));
  }
  return waves;
}

Disturbances learned(const Model& model, const VectorXd& places, const Compared& data, const Options& options) {
  std::vector<Waves> read, ideal;
  for (std::size_t pair = 0; pair < learning_pairs; ++pair) {
    const std::uint64_t seed = seed_of(model.seed(), pair, "device");
    read.push_back(waves_of(model, places, Readings::read, seed, data, options));
    ideal.push_back(waves_of(model, places, Readings::ideal, seed, data, options));
  }
  return {data.columns, read, ideal, least_remainder};
}

Json interval_json(const FitKey& key, double place, const Known& known) {
  const double half = half_interval * known.sd;
  Json json{{"value", key.value(place)}, {"determined", known.determined}};
  const bool circular = key.circular();  // its interval may reach beyond the bounds, which are one angle
  json["low"] = known.determined ? key.value(circular ? place - half : std::max(0.0, place - half)) : key.min;
  json["high"] = known.determined ? key.value(circular ? place + half : std::min(1.0, place + half)) : key.max;
  json["at_bound"] = !circular && (at_lower_bound(place) || at_upper_bound(place));
  return json;
}

void write_truth(Json& json, const FitKey& key, double drawn) {
  json["truth"] = key.value(drawn);
  double error = json.at("value").get<double>() - key.value(drawn);
  if (const double turn = key.max - key.min; key.circular()) error -= turn * std::round(error / turn);
  json["error"] = error;
}

// Returns the centre and scatter of a key with one value per recording; the variance of the values
// is reduced by their mean uncertainty.
struct Scatter {
  double centre, sd;  // of the value; of draw log_uniform the median and the sd of the logarithm
};
Scatter scatter_of(const FitKey& key, const std::vector<double>& places, const std::vector<Known>& known) {
  const auto count = static_cast<double>(places.size());
  const double width = key.logarithmic ? math::log(key.max / key.min) : key.max - key.min;
  // Places of a circle are compared within half a turn of the first one.
  const auto unwrapped = [&](double place) { return key.circular() ? place - std::round(place - places.front()) : place; };
  double mean = 0.0, square = 0.0, uncertain = 0.0;
  for (std::size_t r = 0; r < places.size(); ++r) {
    const double place = unwrapped(places[r]);
    mean += place / count;
    square += place * place / count;
    uncertain += known[r].sd * known[r].sd / count;
  }
  const double variance = places.size() > 1 ? (square - mean * mean) * count / (count - 1.0) : 0.0;
  return {key.value(key.circular() ? mean - std::floor(mean) : mean), width * std::sqrt(std::max(0.0, variance - uncertain))};
}

// Fit of one key: one place, or one per recording.
struct Found {
  std::vector<double> places;
  std::vector<Known> known;
};
Found found_of(const Model& model, const Eigen::VectorXd& places, const std::vector<Known>& known, const std::string& path) {
  Found found;
  for (std::size_t p = 0; p < model.parameters(); ++p) {
    if (model.keys()[model.key_of(p)].path != path) continue;
    found.places.push_back(places(static_cast<Index>(p)));
    found.known.push_back(known[p]);
  }
  return found;
}

Json parameter_json(const FitKey& key, const Found& found, const std::vector<double>& drawn) {
  Json json{{"key", key.path},
            {"unit", si_symbol(key.quantity)},
            {"min", key.min},
            {"max", key.max},
            {"draw", key.logarithmic ? "log_uniform" : "uniform"},
            {"each", key.each}};
  if (!key.each) {
    json.update(interval_json(key, found.places.front(), found.known.front()));
    if (!drawn.empty()) write_truth(json, key, drawn.front());
    json["profile"] = Json::array();
    for (const auto& [place, rise] : found.known.front().profile) json["profile"].push_back({key.value(place), rise});
    return json;
  }
  const Scatter scatter = scatter_of(key, found.places, found.known);
  json["value"] = scatter.centre;
  json["scatter"] = scatter.sd;
  json["determined"] = std::ranges::all_of(found.known, &Known::determined);
  json["by_recording"] = Json::array();
  for (std::size_t r = 0; r < found.places.size(); ++r) {
    json["by_recording"].push_back(interval_json(key, found.places[r], found.known[r]));
    if (!drawn.empty()) write_truth(json["by_recording"].back(), key, drawn[r]);
  }
  return json;
}

Json correlations_json(const Model& model, const Solution& solution) {
  Json list = Json::array();
  const VectorXd sd = solution.covariance.diagonal().cwiseSqrt();
  for (Index a = 0; a < sd.size(); ++a) {
    for (Index b = 0; b < a; ++b) {
      if (model.recording_of(static_cast<std::size_t>(a)) || model.recording_of(static_cast<std::size_t>(b))) continue;
      const double correlation = solution.covariance(a, b) / (sd(a) * sd(b));
      if (std::abs(correlation) < strong_correlation) continue;
      list.push_back({{"first", model.keys()[model.key_of(static_cast<std::size_t>(b))].path},
                      {"second", model.keys()[model.key_of(static_cast<std::size_t>(a))].path},
                      {"correlation", correlation}});
    }
  }
  return list;
}

double rms_of(const Waves& real, const Waves& synthetic, const ChannelPlace& place, std::size_t k) {
  double squares = 0.0, count = 0.0;
  for (std::size_t r = 0; r < real.size(); ++r) {
    for (std::size_t unit = 0; unit < place.units; ++unit) {
      const auto column = static_cast<Index>(place.column(unit, k));
      squares += (real[r].col(column) - synthetic[r].col(column)).squaredNorm();
      count += static_cast<double>(real[r].rows());
    }
  }
  return std::sqrt(squares / count);
}

Json residuals_json(const Compared& data, const Disturbances& disturbances, const Solution& solution, const VectorXd& rough) {
  Json list = Json::array();
  std::size_t component = 0;
  for (const ChannelPlace& place : data.columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k, ++component) {
      const Disturbance& disturbance = disturbances.by_component()[component];
      double gains = 0.0, offsets = 0.0, real = 0.0, synthetic = 0.0;
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        const auto column = static_cast<Index>(place.column(unit, k));
        const double change = solution.distance.gain(column) - 1.0;
        gains += change * change;
        offsets += solution.distance.offset.col(column).squaredNorm() / static_cast<double>(data.real.size());
        real += data.roughness(column) * data.roughness(column);
        synthetic += rough(column) * rough(column);
      }
      const auto units = static_cast<double>(place.units);
      list.push_back({{"sensor", place.sensor},
                      {"channel", place.channel},
                      {"component", place.names[k]},
                      {"unit", place.unit},
                      {"residual", rms_of(data.real, solution.distance.explained, place, k)},
                      {"repeatability", disturbance.remainder_sd},
                      {"gain_scatter", std::sqrt(gains / units)},
                      {"gain_scatter_expected", disturbance.gain_sd},
                      {"offset_scatter", std::sqrt(offsets / units)},
                      {"offset_scatter_expected", disturbance.offset_sd},
                      {"noise", std::sqrt(real / units)},
                      {"noise_expected", std::sqrt(synthetic / units)}});
    }
  }
  return list;
}

Json rounded(const VectorXd& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(rounded_to_digits(value, 5));
  return list;
}

// Returns, for each component, the mean over the units and the unit with the worst fit.
Json curves_json(const Compared& data, const Solution& solution, std::size_t r) {
  const MatrixXd& real = data.real[r];
  const MatrixXd& synthetic = solution.distance.explained[r];
  Json list = Json::array();
  for (const ChannelPlace& place : data.columns.channels) {
    for (std::size_t k = 0; k < place.components; ++k) {
      VectorXd mean_real = VectorXd::Zero(real.rows()), mean_synthetic = mean_real;
      std::size_t worst = 0;
      double most = -1.0;
      for (std::size_t unit = 0; unit < place.units; ++unit) {
        const auto column = static_cast<Index>(place.column(unit, k));
        mean_real += real.col(column) / static_cast<double>(place.units);
        mean_synthetic += synthetic.col(column) / static_cast<double>(place.units);
        const double away = (real.col(column) - synthetic.col(column)).squaredNorm();
        if (away > most) {
          most = away;
          worst = unit;
        }
      }
      const auto add = [&](const Json& unit, const VectorXd& x, const VectorXd& y) {
        list.push_back({{"sensor", place.sensor},
                        {"channel", place.channel},
                        {"component", place.names[k]},
                        {"unit", place.unit},
                        {"of", unit},
                        {"real", rounded(x)},
                        {"synthetic", rounded(y)}});
      };
      add("mean", mean_real, mean_synthetic);
      const auto column = static_cast<Index>(place.column(worst, k));
      if (place.units > 1) add(worst, real.col(column), synthetic.col(column));
    }
  }
  return list;
}

Json recordings_json(const std::vector<RawRecording>& recordings, const Compared& data, const Solution& solution) {
  Json list = Json::array();
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const double bins = static_cast<double>(data.real[r].rows()), span = data.edges[r].back() - data.edges[r].front();
    const std::vector<double>& time = recordings[r].sensors.front().time;
    list.push_back({{"name", recordings[r].name},
                    {"recorded_s", time.back() - time.front()},
                    {"compared_s", span},
                    {"begin_s", data.edges[r].front()},
                    {"step_s", span / bins},
                    {"curves", curves_json(data, solution, r)}});
  }
  return list;
}

Json starts_json(const Model& model, const Solution& solution) {
  Json list = Json::array();
  for (const Start& start : solution.starts) {
    Json values = Json::object();
    for (std::size_t k = 0; k < model.keys().size(); ++k)
      values[model.keys()[k].path] = model.keys()[k].value(start.places(static_cast<Index>(k)));
    list.push_back({{"cost", start.cost}, {"evaluations", start.evaluations}, {"values", std::move(values)}});
  }
  return list;
}

void check_noise_keys(const std::vector<FitKey>& of_curves, const std::vector<FitKey>& of_noise) {
  if (of_curves.empty()) throw InputError("calibrate: only keys of the electronics are fitted; fit at least one other key too");
  for (const FitKey& key : of_noise) {
    if (key.each) reject("calibrate: {} belongs to the device; fit it without each: true", key.path);
  }
}

// Returns the scene with the values fitted to the curves, on which the electronics are then fitted.
SceneFile with_values(const SceneFile& file, const Model& model, const VectorXd& places) {
  SceneFile fitted = file;
  for (std::size_t k = 0; k < model.keys().size(); ++k) {
    const FitKey& key = model.keys()[k];
    double place = 0.0;
    const std::size_t count = key.each ? model.recordings() : 1;
    for (std::size_t r = 0; r < count; ++r)
      place += places(static_cast<Index>(model.parameter_of(k, r))) / static_cast<double>(count);
    if (key.path != lag_key) fitted.apply({key.path, format_number(key.value(place))});
  }
  return fitted;
}

Truth drawn_truth(const Model& model, std::uint64_t seed) {
  Truth truth{VectorXd(static_cast<Index>(model.parameters())), seed_of(seed, 0, "truth")};
  RandomStream stream(seed, 1, "calibrate.truth");
  for (double& place : truth.places) place = stream.uniform();
  return truth;
}

// Returns the first keys of every result.
Json begun(const Options& options, std::uint64_t seed, Json parameters, Json correlations, const Solution& solution) {
  return {{result_key, 1},
          {"scene", options.scene_path},
          {"command", options.command},
          {"seed", seed},
          {"synthetic_truth", options.synthetic_truth},
          {"parameters", std::move(parameters)},
          {"correlations", std::move(correlations)},
          {"cost", solution.cost}};
}

// Removes the common gain of the units from `data`, readings of a drawn device, because for a real
// device a common gain is part of the stiffness (disturbances.cc). The common gain is estimated
// from a second reading of the device: the fitted readings would lose part of their noise too.
void take_common_gain(Compared& data, const Model& model, const Truth& truth, const Disturbances& disturbances,
                      const Options& options) {
  const Waves ideal = waves_of(model, truth.places, Readings::ideal, truth.seed, data, options);
  const VectorXd common =
      disturbances.common_gain(waves_of(model, truth.places, Readings::read, truth.seed, data, options, 1), ideal);
  for (std::size_t r = 0; r < data.real.size(); ++r) {
    const Eigen::RowVectorXd begin = ideal[r].row(0);
    const MatrixXd departure = data.real[r].rowwise() - begin;
    data.real[r] = (departure.array().rowwise() / common.transpose().array()).matrix().rowwise() + begin;
  }
}

// Returns the roughness of the fitted scene's readings, RMS over the recordings.
VectorXd roughness_at(const Model& model, const VectorXd& places, std::uint64_t seed, const Compared& data,
                      const Options& options) {
  std::vector<VectorXd> rough;
  for (std::size_t r = 0; r < model.recordings(); ++r)
    rough.push_back(roughness(model.simulate(places, r, Readings::read, seed, options.interrupt), Side::scene, data.columns));
  return rms_over(rough);
}

// Returns the places that were drawn for the key's parameters; empty without a synthetic truth.
std::vector<double> drawn_of(const Model& model, const std::optional<Truth>& truth, std::size_t key) {
  std::vector<double> drawn;
  for (std::size_t p = 0; truth && p < model.parameters(); ++p) {
    if (model.key_of(p) == key) drawn.push_back(truth->places(static_cast<Index>(p)));
  }
  return drawn;
}

Result calibrate_curves(const Options& options, const SceneFile& file, std::uint64_t seed, std::vector<RawRecording> recordings,
                        const Catalogues& catalogues) {
  std::vector<FitKey> of_curves, of_noise;
  for (const FitKey& key : options.keys) (of_electronics(key) ? of_noise : of_curves).push_back(key);
  check_noise_keys(of_curves, of_noise);
  Model all(file, catalogues, options.keys, seed), model(file, catalogues, of_curves, seed);
  std::optional<Truth> truth;
  if (options.synthetic_truth) {
    truth = drawn_truth(all, seed);
    recordings = drawn_recordings(all, *truth, options);
  } else {
    all.use_recordings(recordings.size());
    model.use_recordings(recordings.size());
  }

  const VectorXd own = model.spread(model.own_places());
  Compared data = compared(
      recordings, [&](std::size_t r) { return model.simulate(own, r, Readings::ideal, seed, options.interrupt); },
      [&](std::size_t r) { return truth ? all.lag(truth->places, r) : 0.0; }, most_lag(options.keys));
  const Disturbances disturbances = learned(model, own, data, options);
  if (truth) take_common_gain(data, all, *truth, disturbances, options);

  CurveProblem problem(&model, options.jobs, options.interrupt);
  problem.disturbances = &disturbances;
  problem.edges = data.edges;
  problem.real = data.real;
  const Solution solution = search(problem, {options.starts, options.progress});
  const VectorXd rough = roughness_at(model, solution.places, seed, data, options);

  std::optional<Model> noise_model;
  ElectronicsFit noise;
  if (!of_noise.empty()) {
    noise_model.emplace(with_values(file, model, solution.places), catalogues, of_noise, seed);
    if (!options.synthetic_truth) noise_model->use_recordings(recordings.size());
    noise = fit_electronics(*noise_model, problem, disturbance_sizes(data.columns, data.real, solution.distance, data.roughness));
  }
  Json parameters = Json::array();
  for (std::size_t k = 0; k < options.keys.size(); ++k) {
    const FitKey& key = options.keys[k];
    const Found found = of_electronics(key) ? found_of(*noise_model, noise.places, noise.known, key.path)
                                            : found_of(model, solution.places, solution.known, key.path);
    parameters.push_back(parameter_json(key, found, drawn_of(all, truth, k)));
  }

  Result result;
  result.json = begun(options, seed, std::move(parameters), correlations_json(model, solution), solution);
  result.json.update({{"residual_over_repeatability", std::sqrt(solution.scale)},
                      {"residuals", residuals_json(data, disturbances, solution, rough)},
                      {"starts", starts_json(model, solution)},
                      {"recordings", recordings_json(recordings, data, solution)}});
  result.fitted = fitted_scene(file, options.keys, result.json);
  return result;
}

Result calibrate_groups(const Options& options, const SceneFile& file, std::uint64_t seed, std::vector<RawRecording> recordings,
                        const Catalogues& catalogues) {
  const Model model(file, catalogues, options.keys, seed, Trials::groups);
  const VectorXd& own = model.own_places();
  std::optional<Truth> truth;
  if (options.synthetic_truth) {
    truth = drawn_truth(model, seed);
    recordings = drawn_session(model, *options.groups, truth->places, truth->seed, options.interrupt);
  }
  const GroupProblem problem(&model, *options.groups, recordings, own, options.jobs, options.interrupt);
  const Solution solution = search(problem, {options.starts, options.progress});
  if (!solution.distance.possible)
    throw InputError("calibrate: all draws of a cell fail within the bounds; choose bounds within which the scene runs");

  Json parameters = Json::array();
  for (Index k = 0; k < own.size(); ++k) {
    const FitKey& key = options.keys[static_cast<std::size_t>(k)];
    parameters.push_back(parameter_json(key, found_of(model, solution.places, solution.known, key.path),
                                        truth ? std::vector<double>{truth->places(k)} : std::vector<double>{}));
  }
  Json names = Json::array();
  for (const RawRecording& recording : recordings) names.push_back({{"name", recording.name}});
  Result result;
  result.json = begun(options, seed, std::move(parameters), correlations_json(model, solution), solution);
  result.json.update(
      {{"residual_over_scatter", std::sqrt(solution.distance.squared / static_cast<double>(solution.distance.compared))},
       {"groups", problem.json(solution)},
       {"starts", starts_json(model, solution)},
       {"recordings", std::move(names)}});
  result.fitted = fitted_scene(file, options.keys, result.json);
  return result;
}

}  // namespace

Result calibrate(const Options& options, const Catalogues& catalogues) {
  std::vector<RawRecording> recordings;
  if (!options.synthetic_truth) recordings = read_recordings(options.recordings, options.format);
  SceneFile file = SceneFile::load(options.scene_path);
  for (const Override& change : options.overrides) file.apply(change);
  const std::uint64_t seed = options.seed.value_or(read_seed(file.root()));
  const auto how = options.groups ? &calibrate_groups : &calibrate_curves;
  return how(options, file, seed, std::move(recordings), catalogues);
}

bool recovers(const Json& result) {
  const auto recovered = [](const Json& one) {
    if (!one.at("determined").get<bool>()) return true;
    const double value = one.at("value").get<double>();
    const double half = std::max(one.at("high").get<double>() - value, value - one.at("low").get<double>());
    return std::abs(one.at("error").get<double>()) <= 2.0 * half;
  };
  return std::ranges::all_of(result.at("parameters"), [&](const Json& parameter) {
    if (!parameter.at("each").get<bool>()) return recovered(parameter);
    return std::ranges::all_of(parameter.at("by_recording"), recovered);
  });
}

}  // namespace slipbench::calibrate
