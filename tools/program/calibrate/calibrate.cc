#include "tools/program/calibrate/calibrate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/random.h"
#include "tools/program/calibrate/disturbances.h"
#include "tools/program/calibrate/fitted_scene.h"
#include "tools/program/calibrate/model.h"
#include "tools/program/calibrate/recordings.h"
#include "tools/program/calibrate/search.h"

namespace slipbench::calibrate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Pairs from which the electronics are learned, a device each.
constexpr std::size_t learning_pairs = 4;
// Least remainder of a column, as a share of its range: below it stretches and steps of the simulation tell.
constexpr double least_remainder = 1e-3;
// Correlations worth a line.
constexpr double strong_correlation = 0.9;

std::uint64_t seed_for(std::uint64_t seed, std::uint64_t number, const char* what) {
  return RandomStream(seed, number, std::string("calibrate.") + what).integer(std::uint64_t{1} << 62U);
}

// What is compared: recordings on their grids.
struct Compared {
  Columns columns;
  std::vector<std::vector<double>> edges;
  Waves real;
  VectorXd roughness;  // RMS over the recordings
};

VectorXd rms_over(const std::vector<VectorXd>& values) {
  VectorXd squares = VectorXd::Zero(values.front().size());
  for (const VectorXd& value : values) squares += value.cwiseAbs2();
  return (squares / static_cast<double>(values.size())).cwiseSqrt();
}

// `lag`: of each recording's clock; a drawn one has its own.
Compared compared(const std::vector<RawRecording>& recordings, const std::vector<SensorRecord>& scene,
                  const std::function<double(std::size_t)>& lag) {
  Compared result;
  std::vector<VectorXd> rough;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const RawRecording& recording = recordings[r];
    if (recording.sensors.empty()) throw InputError(fmt::format("{}: holds no sensor; allowed: at least one", recording.name));
    Columns columns = shared_columns(recording, scene);
    if (result.real.empty()) result.columns = columns;
    if (columns.count != result.columns.count)
      throw InputError(fmt::format("{}: holds other channels than {}; allowed: recordings of one kind", recording.name,
                                   recordings.front().name));
    result.edges.push_back(bin_edges(recording, scene));
    const double shift = scene.front().time.front() - recording.sensors.front().time.front() + lag(r);
    result.real.push_back(bin_means(recording.sensors, Side::real, columns, result.edges.back(), shift));
    rough.push_back(calibrate::roughness(recording.sensors, Side::real, columns));
  }
  result.roughness = rms_over(rough);
  return result;
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
    const std::uint64_t seed = seed_for(model.seed(), pair, "device");
    read.push_back(waves_of(model, places, Readings::read, seed, data, options));
    ideal.push_back(waves_of(model, places, Readings::ideal, seed, data, options));
  }
  return {data.columns, read, ideal, least_remainder};
}

Json interval_json(const FitKey& key, double place, const Known& known) {
  const double half = half_interval * known.sd;
  Json json{{"value", key.value(place)}, {"determined", known.determined}};
  json["low"] = known.determined ? key.value(std::max(0.0, place - half)) : key.min;
  json["high"] = known.determined ? key.value(std::min(1.0, place + half)) : key.max;
  constexpr double edge = 0.005;
  json["at_bound"] = known.determined && (place < edge || place > 1.0 - edge);
  return json;
}

void tell_truth(Json& json, const FitKey& key, double drawn) {
  json["truth"] = key.value(drawn);
  json["error"] = json.at("value").get<double>() - key.value(drawn);
}

// The centre and scatter of a key that every recording has a value of, less what the values themselves are uncertain by.
struct Scatter {
  double centre, sd;  // of the value; of draw log_uniform the median and the sd of the logarithm
};
Scatter scatter_of(const Model& model, std::size_t k, const Solution& solution) {
  const FitKey& key = model.keys()[k];
  const auto count = static_cast<double>(model.recordings());
  const double width = key.logarithmic ? std::log(key.max / key.min) : key.max - key.min;
  double mean = 0.0, square = 0.0, uncertain = 0.0;
  for (std::size_t r = 0; r < model.recordings(); ++r) {
    const std::size_t p = model.parameter_of(k, r);
    const double place = solution.places(static_cast<Index>(p));
    mean += place / count;
    square += place * place / count;
    uncertain += solution.known[p].sd * solution.known[p].sd / count;
  }
  const double variance = model.recordings() > 1 ? (square - mean * mean) * count / (count - 1.0) : 0.0;
  return {key.value(mean), width * std::sqrt(std::max(0.0, variance - uncertain))};
}

Json parameters_json(const Model& model, const Solution& solution, const std::optional<Truth>& truth) {
  Json list = Json::array();
  for (std::size_t k = 0; k < model.keys().size(); ++k) {
    const FitKey& key = model.keys()[k];
    const auto first = static_cast<Index>(model.parameter_of(k, 0));
    Json json{{"key", key.path},
              {"unit", si_symbol(key.quantity)},
              {"min", key.min},
              {"max", key.max},
              {"draw", key.logarithmic ? "log_uniform" : "uniform"},
              {"each", key.each}};
    if (!key.each) {
      const Known& known = solution.known[static_cast<std::size_t>(first)];
      json.update(interval_json(key, solution.places(first), known));
      if (truth) tell_truth(json, key, truth->places(first));
      json["profile"] = known.profile;
    } else {
      const Scatter scatter = scatter_of(model, k, solution);
      json["value"] = scatter.centre;
      json["scatter"] = scatter.sd;
      json["by_recording"] = Json::array();
      bool all = true;
      for (std::size_t r = 0; r < model.recordings(); ++r) {
        const auto p = static_cast<Index>(model.parameter_of(k, r));
        Json one = interval_json(key, solution.places(p), solution.known[static_cast<std::size_t>(p)]);
        if (truth) tell_truth(one, key, truth->places(p));
        all = all && one.at("determined").get<bool>();
        json["by_recording"].push_back(std::move(one));
      }
      json["determined"] = all;
    }
    list.push_back(std::move(json));
  }
  return list;
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
        gains += std::pow(solution.distance.gain(column) - 1.0, 2);
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
  for (const double value : values) list.push_back(std::stod(fmt::format("{:.5g}", value)));
  return list;
}

// Of each component the mean over the units and the unit that is worst fitted.
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
    list.push_back({{"name", recordings[r].name},
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

}  // namespace

Result calibrate(const Options& options, const Catalogues& catalogues) {
  std::vector<RawRecording> recordings;
  if (!options.synthetic_truth) recordings = read_recordings(options.recordings, options.format);
  SceneFile file = SceneFile::load(options.scene_path);
  for (const Override& change : options.overrides) file.apply(change);
  Model model(file, catalogues, options.keys, options.seed.value_or(read_seed(file.root())));
  if (!options.synthetic_truth) model.use_recordings(recordings.size());

  std::optional<Truth> truth;
  const VectorXd own = model.spread(Eigen::Map<const VectorXd>(model.own_places().data(), static_cast<Index>(model.keys().size())));
  if (options.synthetic_truth) {
    truth.emplace(own, seed_for(model.seed(), 0, "truth"));
    RandomStream stream(model.seed(), 1, "calibrate.truth");
    for (double& place : truth->places) place = stream.uniform();
    recordings = drawn_recordings(model, *truth, options);
  }
  Compared data = compared(recordings, model.simulate(own, 0, Readings::ideal, model.seed(), options.interrupt),
                           [&](std::size_t r) { return truth ? model.lag(truth->places, r) : 0.0; });
  const Disturbances disturbances = learned(model, own, data, options);
  if (truth) {
    // What all gains share is the stiffness of the drawn device, as it is of a real one (disturbances.h). Told by the device's readings of the same
    // once more: by those that are fitted it would take their noise off too.
    const Waves ideal = waves_of(model, truth->places, Readings::ideal, truth->seed, data, options);
    const VectorXd common = disturbances.common_gain(waves_of(model, truth->places, Readings::read, truth->seed, data, options, 1), ideal);
    for (MatrixXd& wave : data.real) wave.array().rowwise() /= common.transpose().array();
  }

  const Problem problem{&model, &disturbances, data.edges, data.real, options.jobs, options.interrupt};
  const Solution solution = search(problem, {options.starts, options.progress});
  std::vector<VectorXd> rough;
  for (std::size_t r = 0; r < model.recordings(); ++r)
    rough.push_back(roughness(model.simulate(solution.places, r, Readings::read, model.seed(), options.interrupt), Side::scene,
                              data.columns));

  Result result;
  result.json = {{result_key, 1},
                 {"scene", options.scene_path},
                 {"command", options.command},
                 {"seed", model.seed()},
                 {"synthetic_truth", options.synthetic_truth},
                 {"parameters", parameters_json(model, solution, truth)},
                 {"correlations", correlations_json(model, solution)},
                 {"cost", solution.cost},
                 {"residual_over_repeatability", std::sqrt(solution.scale)},
                 {"residuals", residuals_json(data, disturbances, solution, rms_over(rough))},
                 {"starts", starts_json(model, solution)},
                 {"recordings", recordings_json(recordings, data, solution)}};
  result.fitted = fitted_scene(file, model.keys(), result.json);
  return result;
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
