#include "tools/program/calibrate/model.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sensors/electronics/electronics.h"
#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/random.h"
#include "sim/scene/sweep.h"
#include "sim/scene/yaml_tree.h"
#include "tools/program/run/run_trial.h"

namespace slipbench::calibrate {
namespace {

void check_keys(const SceneFile& file, const std::vector<FitKey>& keys, Trials kind) {
  std::vector<std::vector<std::string>> fitted;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (std::ranges::find(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(k), keys[k].path, &FitKey::path) !=
        keys.begin() + static_cast<std::ptrdiff_t>(k))
      throw InputError(fmt::format("calibrate: {} is fitted twice; allowed: once", keys[k].path));
    fitted.push_back(split_path(keys[k].path, {}));
    if (kind == Trials::groups && (keys[k].each || keys[k].path == lag_key))
      throw InputError(fmt::format("calibrate: {} is a value of single recordings; allowed with --groups: a value of all",
                                   keys[k].each ? keys[k].path + " with each: true" : keys[k].path));
  }
  if (kind == Trials::groups) return;
  for (const FitKey& key : keys) {
    if (key.path.starts_with("sweep."))
      throw InputError(fmt::format("calibrate: {} is a value of all trials; allowed with --groups", key.path));
  }
  const Sweep sweep(file.root().find("sweep"), fitted);
  for (const SweptPath& swept : sweep.paths()) {
    if (swept.draw)
      fail(swept.origin,
           fmt::format("sweep.{} is drawn at random, and a recording has a value of its own; allowed: --set {}=.., or "
                       "--fit '{}: {{min: .., max: .., each: true}}'",
                       swept.path, swept.path, swept.path));
  }
}

double own_place(const SceneFile& file, const Trace& values, const FitKey& key) {
  if (key.path.starts_with("sweep.")) {
    const YamlNode* node = node_at(file.root(), swept_parts(file.root(), key.path));
    try {
      if (node == nullptr || node->kind != YamlNode::Kind::scalar) throw std::invalid_argument("no number");
      const double place = key.place(parse_quantity(node->text, quantity_of(node->text)));
      return place >= 0.0 && place <= 1.0 ? place : 0.5;
    } catch (const std::invalid_argument&) {
      throw InputError(fmt::format(
          "--fit {}: the scene's sweep has no such number; allowed: one that it has, such as sweep.motion.tilt.0.mean",
          key.path));
    }
  }
  const auto found = values.find(key.path);
  if (found == values.end()) return 0.5;
  const nlohmann::json value = nlohmann::json::parse(found->second.json);
  const double place = value.is_number() ? key.place(value.get<double>()) : -1.0;
  return place >= 0.0 && place <= 1.0 ? place : 0.5;
}

}  // namespace

Model::Model(const SceneFile& file, const Catalogues& catalogues, std::vector<FitKey> keys, std::uint64_t seed, Trials kind)
    : catalogues_(&catalogues), keys_(std::move(keys)), seed_(seed) {
  check_keys(file, keys_, kind);
  // With the units that the bounds have: the scene refuses those of another quantity, and bounds beyond what it allows.
  const auto planned = [&](double place) {
    SceneFile fitted = file;
    for (const FitKey& key : keys_) {
      if (key.path != lag_key) fitted.apply({key.path, format_quantity(key.value(place), key.quantity), "--fit"});
    }
    return TrialPlan(fitted, catalogues, 0, seed);
  };
  for (const FitKey& key : keys_) {
    if (key.path == lag_key && key.quantity != Quantity::time) {
      throw InputError(
          fmt::format("--fit lag: bounds of {} are no times; allowed: times with a unit, such as -5 ms", key.text(key.min)));
    }
  }
  for (const double bound : {0.0, 1.0}) static_cast<void>(planned(bound).trial(0));
  const TrialPlan plan = planned(0.5);
  trials_ = plan.size();
  draws_ = plan.draws();
  for (std::size_t trial = 0; kind == Trials::recordings && trial < plan.size(); ++trial) {
    SceneFile one = file;
    one.apply({"sweep", "{trials: 1}"});
    for (const auto& [path, json] : plan.trial(trial).drawn) one.apply({path, json});
    files_.push_back(std::move(one));
  }
  if (kind == Trials::groups) files_.push_back(file);
  Trace values;
  static_cast<void>(TrialPlan(files_.front(), catalogues, 1, seed).read(0, values));
  own_.resize(static_cast<Eigen::Index>(keys_.size()));
  std::ranges::transform(keys_, own_.begin(), [&](const FitKey& key) { return own_place(file, values, key); });
  recordings_ = trials_;
}

void Model::use_recordings(std::size_t count) {
  if (trials() != 1 && trials() != count)
    throw InputError(fmt::format(
        "calibrate: {} recordings, and the scene's sweep has {} trials; allowed: a trial for each recording, in their order, or one for all",
        count, trials()));
  recordings_ = count;
}

std::size_t Model::parameters() const {
  std::size_t count = 0;
  for (const FitKey& key : keys_) count += key.each ? recordings_ : 1;
  return count;
}

std::size_t Model::parameter_of(std::size_t key, std::size_t recording) const {
  std::size_t first = 0;
  for (std::size_t k = 0; k < key; ++k) first += keys_[k].each ? recordings_ : 1;
  return first + (keys_[key].each ? recording : 0);
}

std::size_t Model::key_of(std::size_t parameter) const {
  std::size_t key = 0;
  while (key + 1 < keys_.size() && parameter_of(key + 1, 0) <= parameter) ++key;
  return key;
}

std::optional<std::size_t> Model::recording_of(std::size_t parameter) const {
  const std::size_t key = key_of(parameter);
  if (!keys_[key].each) return std::nullopt;
  return parameter - parameter_of(key, 0);
}

Eigen::VectorXd Model::spread(const Eigen::VectorXd& by_key) const {
  Eigen::VectorXd places(static_cast<Eigen::Index>(parameters()));
  for (std::size_t p = 0; p < parameters(); ++p)
    places(static_cast<Eigen::Index>(p)) = by_key(static_cast<Eigen::Index>(key_of(p)));
  return places;
}

double Model::value(const Eigen::VectorXd& places, std::size_t key, std::size_t recording) const {
  return keys_[key].value(places(static_cast<Eigen::Index>(parameter_of(key, recording))));
}

double Model::lag(const Eigen::VectorXd& places, std::size_t recording) const {
  for (std::size_t key = 0; key < keys_.size(); ++key) {
    if (keys_[key].path == lag_key) return value(places, key, recording);
  }
  return 0.0;
}

std::string Model::apply(SceneFile& file, const Eigen::VectorXd& places, std::size_t recording) const {
  std::string values;
  for (std::size_t key = 0; key < keys_.size(); ++key) {
    if (keys_[key].path == lag_key) continue;
    const double fitted = value(places, key, recording);
    file.apply({keys_[key].path, format_quantity(fitted, keys_[key].quantity), "--fit"});
    values += fmt::format("{}{} = {}", values.empty() ? "" : ", ", keys_[key].path, keys_[key].text(fitted));
  }
  return values;
}

std::vector<SensorRecord> Model::simulate_drawn(const Eigen::VectorXd& places, std::size_t trial, std::uint64_t seed,
                                                std::uint64_t device, const std::atomic<bool>* interrupt) const {
  SceneFile file = files_.front();
  const std::string values = apply(file, places, trial);
  try {
    Scene scene = TrialPlan(file, *catalogues_, 0, seed).trial(trial).scene;
    scene.seed = device;
    scene.detector.reset();
    return run_trial(scene, trial, Recording::full, max_record_bytes, interrupt).record.sensors;
  } catch (const Interrupted&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(fmt::format("calibrate: trial {} with {}: {}", trial, values, error.what()));
  }
}

std::vector<SensorRecord> Model::simulate(const Eigen::VectorXd& places, std::size_t recording, Readings readings,
                                          std::uint64_t seed, const std::atomic<bool>* interrupt, std::size_t again) const {
  SceneFile file = files_[trials() == 1 ? 0 : recording];
  const std::string values = apply(file, places, recording);
  try {
    Scene scene = parse_scene(file, *catalogues_);
    scene.seed = seed;
    scene.detector.reset();
    if (readings == Readings::ideal) {
      for (SensorScene& sensor : scene.sensors)
        std::erase_if(sensor.electronics, [](const Named& part) { return draws_numbers(part.name); });
    }
    return run_trial(scene, recording + again * recordings_, Recording::full, max_record_bytes, interrupt).record.sensors;
  } catch (const Interrupted&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(fmt::format("calibrate: recording {} with {}: {}", recording, values, error.what()));
  }
}

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number, const std::string& what) {
  return RandomStream(seed, number, "calibrate." + what).integer(std::uint64_t{1} << 62U);
}

}  // namespace slipbench::calibrate
