#include "tools/calibrate/model.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sensors/electronics/electronics.h"
#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "sim/core/random.h"
#include "sim/scene/entry_reader.h"
#include "sim/scene/sweep.h"
#include "sim/scene/yaml_tree.h"
#include "tools/files/reject.h"
#include "tools/trial/run_trial.h"

namespace slipbench::calibrate {
namespace {

void check_keys(const SceneFile& file, const std::vector<FitKey>& keys, Trials kind) {
  std::vector<std::vector<std::string>> fitted;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (std::ranges::find(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(k), keys[k].path, &FitKey::path) !=
        keys.begin() + static_cast<std::ptrdiff_t>(k))
      reject("calibrate: {} is fitted twice", keys[k].path);
    fitted.push_back(split_path(keys[k].path, {}));
    if (kind == Trials::groups && (keys[k].each || keys[k].path == lag_key))
      reject("calibrate: {} is fitted to each recording alone; with --groups only values of all recordings can be fitted",
             keys[k].each ? keys[k].path + " with each: true" : keys[k].path);
  }
  if (kind == Trials::groups) return;
  for (const FitKey& key : keys) {
    if (key.path.starts_with("sweep.")) reject("calibrate: {} is a value of all trials, which needs --groups", key.path);
  }
  const Sweep sweep(file.root().find("sweep"), fitted);
  for (const SweptPath& swept : sweep.paths()) {
    if (swept.draw)
      fail(swept.origin, fmt::format("sweep.{} is drawn at random, but each recording has a fixed value; use --set {}=.., or "
                                     "--fit '{}: {{min: .., max: .., each: true}}'",
                                     swept.path, swept.path, swept.path));
  }
}

double own_place(const SceneFile& file, const Trace& values, const FitKey& key) {
  if (key.path.starts_with("sweep.")) {
    const YamlNode* node = node_at(file.root(), swept_parts(file.root(), key.path));
    try {
      if (node == nullptr || node->kind != YamlNode::Kind::scalar) throw std::invalid_argument("not a number");
      const double place = key.place(parse_quantity(node->text, quantity_of(node->text)));
      return place >= 0.0 && place <= 1.0 ? place : 0.5;
    } catch (const std::invalid_argument&) {
      reject("--fit {}: the scene's sweep has no such number; expected a path such as sweep.motion.tilt.0.mean", key.path);
    }
  }
  const auto found = values.find(key.path);
  if (found == values.end()) return 0.5;
  const nlohmann::json value = nlohmann::json::parse(found->second.json);
  const double place = value.is_number() ? key.place(value.get<double>()) : -1.0;
  return place >= 0.0 && place <= 1.0 ? place : 0.5;
}

bool chosen(const YamlNode& map, const char* key, const std::string& path, std::string_view no, std::string_view yes) {
  const YamlNode* node = map.find(key);
  if (node == nullptr) return false;
  const std::string where = path + "." + key;
  const std::string text = text_of(*node, where, fmt::format("{} or {}", no, yes));
  if (text != no && text != yes) fail(node->origin, fmt::format("{} is {}; allowed: {} or {}", where, quote(text), no, yes));
  return text == yes;
}

FitKey read_fit_key(const YamlNode& node) {
  FitKey key{.path = node.key};
  static_cast<void>(split_path(key.path, node.key_origin));
  require_map(node, key.path, "{min: .., max: ..}");
  check_keys(node, key.path, {"draw", "each", "max", "min"});
  const auto bound = [&](const char* name) {
    const YamlNode* found = node.find(name);
    if (found == nullptr) fail(node.origin, fmt::format("no key '{}' in {}; expected {{min: .., max: ..}}", name, key.path));
    const std::string where = key.path + "." + name;
    const std::string text = text_of(*found, where, "a number");
    try {
      const Quantity quantity = quantity_of(text);
      if (key.quantity != Quantity::none && quantity != Quantity::none && quantity != key.quantity)
        fail(found->origin, fmt::format("{} is {}; allowed: a number in {}", where, quote(text), si_symbol(key.quantity)));
      if (quantity != Quantity::none) key.quantity = quantity;
      return parse_quantity(text, quantity);
    } catch (const std::invalid_argument& error) {
      fail(found->origin, where + ": " + error.what());
    }
  };
  key.min = bound("min");
  key.max = bound("max");
  key.logarithmic = chosen(node, "draw", key.path, "uniform", "log_uniform");
  key.each = chosen(node, "each", key.path, "false", "true");
  if (!(key.min < key.max) || !std::isfinite(key.max - key.min))
    fail(node.origin, fmt::format("{}: min is {} and max is {}; they must be finite, and min below max", key.path,
                                  format_quantity(key.min, key.quantity), format_quantity(key.max, key.quantity)));
  if (key.logarithmic && !(key.min > 0.0))
    fail(node.origin, fmt::format("{}: min is {}; with draw: log_uniform it must be above 0", key.path,
                                  format_quantity(key.min, key.quantity)));
  return key;
}

// Returns a scalar for use inside [] and {}: in quotes, with JSON's rules, unless the plain text
// has the same meaning there.
std::string scalar(const std::string& text) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view(" ./_%+-()").find(c) != std::string_view::npos;
  };
  const bool begins =
      !text.empty() && (std::isalnum(static_cast<unsigned char>(text.front())) != 0 ||
                        (text.size() > 1 && text.front() == '-' && std::isdigit(static_cast<unsigned char>(text[1])) != 0));
  return begins && text.back() != ' ' && std::ranges::all_of(text, plain) ? text : json_text(text);
}

std::string flow(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::null: return "null";
    case YamlNode::Kind::scalar: return scalar(node.text);
    case YamlNode::Kind::sequence:
    case YamlNode::Kind::map: break;
  }
  const bool map = node.kind == YamlNode::Kind::map;
  std::string inside;
  for (const YamlNode& child : node.children)
    inside += fmt::format("{}{}{}", inside.empty() ? "" : ", ", map ? scalar(child.key) + ": " : "", flow(child));
  return fmt::format("{}{}{}", map ? '{' : '[', inside, map ? '}' : ']');
}

// Returns YAML with one line per key, per entry of `sweep` and `sensors`, and per item of an axis
// of maps.
std::string block(const YamlNode& root) {
  std::string text;
  for (const YamlNode& child : root.children) {
    const bool lines = child.kind == YamlNode::Kind::map && (child.key == "sweep" || child.key == "sensors");
    if (!lines || child.children.empty()) {
      text += fmt::format("{}: {}\n", scalar(child.key), flow(child));
      continue;
    }
    text += fmt::format("{}:\n", scalar(child.key));
    for (const YamlNode& inner : child.children) {
      const bool items =
          inner.kind == YamlNode::Kind::sequence && !inner.children.empty() && inner.children.front().kind == YamlNode::Kind::map;
      if (!items) {
        text += fmt::format("  {}: {}\n", scalar(inner.key), flow(inner));
        continue;
      }
      text += fmt::format("  {}:\n", scalar(inner.key));
      for (const YamlNode& item : inner.children) text += fmt::format("    - {}\n", flow(item));
    }
  }
  return text;
}

std::string draw_of(const FitKey& key, const Json& parameter) {
  const double centre = parameter.at("value").get<double>(), sd = parameter.at("scatter").get<double>();
  const auto written = [&](double value) { return format_quantity(value, key.quantity); };
  if (key.circular()) return fmt::format("{{draw: normal, mean: {}, sd: {}}}", written(centre), written(sd));
  if (key.logarithmic) return fmt::format("{{draw: lognormal, median: {}, sd: {}}}", written(centre), format_number(sd));
  return fmt::format("{{draw: normal, mean: {}, sd: {}, min: {}, max: {}}}", written(centre), written(sd), written(key.min),
                     written(key.max));
}

// Returns the sensors' readings in trial number `trial` of a scene without its detector. Errors
// name `subject`.
template <class MakeScene>
std::vector<SensorRecord> read_of(const std::string& subject, std::size_t trial, const std::atomic<bool>* interrupt,
                                  const MakeScene& make_scene) {
  try {
    Scene scene = make_scene();
    scene.detector.reset();
    return run_trial(scene, trial, Recording::full, max_record_bytes, interrupt).record.sensors;
  } catch (const InputError& error) {
    reject("calibrate: {}: {}", subject, error.what());
  }
}

}  // namespace

Model::Model(const SceneFile& file, const Catalogues& catalogues, std::vector<FitKey> keys, std::uint64_t seed, Trials kind)
    : catalogues_(&catalogues), keys_(std::move(keys)), seed_(seed) {
  check_keys(file, keys_, kind);
  // Values keep the units of the bounds, so that the scene refuses another quantity or bounds
  // beyond its limits.
  const auto planned = [&](double place) {
    SceneFile fitted = file;
    for (const FitKey& key : keys_) {
      if (key.path != lag_key) fitted.apply({key.path, format_quantity(key.value(place), key.quantity), "--fit"});
    }
    return TrialPlan(fitted, catalogues, 0, seed);
  };
  for (const FitKey& key : keys_) {
    if (key.path == lag_key && key.quantity != Quantity::time) {
      reject("--fit lag: the bound {} is not a time; expected a time with a unit, such as -5 ms", key.text(key.min));
    }
  }
  for (const double bound : {0.0, 1.0}) static_cast<void>(planned(bound).trial(0));
  const TrialPlan plan = planned(0.5);
  trials_ = plan.size();
  draws_ = plan.draws();
  for (std::size_t trial = 0; kind == Trials::recordings && trial < plan.size(); ++trial) {
    SceneFile one = file;
    one.apply({"sweep", "{trials: 1}"});
    for (const auto& [path, json] : plan.trial(trial).drawn) {
      one.apply({.path = path, .value = json, .of_sweep = true}, SceneFile::MissingKey::ignored);  // null: not set in this trial
    }
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
    reject(
        "calibrate: {}, but the scene's sweep has {}; it needs one trial for each recording, in the same order, or a single trial",
        counted(count, "recording"), counted(trials(), "trial"));
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

Eigen::VectorXd Model::from_own(const Eigen::VectorXd& places) const {
  Eigen::VectorXd away = places - spread(own_);
  for (std::size_t p = 0; p < parameters(); ++p) {
    double& one = away(static_cast<Eigen::Index>(p));
    if (circular(p)) one -= std::round(one);
  }
  return away;
}

double Model::value(const Eigen::VectorXd& places, std::size_t key, std::size_t recording) const {
  const double place = places(static_cast<Eigen::Index>(parameter_of(key, recording)));
  return keys_[key].value(keys_[key].circular() ? place - std::floor(place) : place);
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
  return read_of(fmt::format("trial {} with {}", trial, values), trial, interrupt, [&] {
    Scene scene = TrialPlan(file, *catalogues_, 0, seed).trial(trial).scene;
    scene.seed = device;
    return scene;
  });
}

std::vector<SensorRecord> Model::simulate(const Eigen::VectorXd& places, std::size_t recording, Readings readings,
                                          std::uint64_t seed, const std::atomic<bool>* interrupt, std::size_t again) const {
  SceneFile file = files_[trials() == 1 ? 0 : recording];
  const std::string values = apply(file, places, recording);
  const std::string subject = fmt::format("recording {} with {}", recording, values);
  return read_of(subject, recording + again * recordings_, interrupt, [&] {
    Scene scene = parse_scene(file, *catalogues_);
    scene.seed = seed;
    if (readings == Readings::ideal) {
      for (SensorScene& sensor : scene.sensors)
        std::erase_if(sensor.electronics, [](const Named& part) { return draws_numbers(part.name); });
    }
    return scene;
  });
}

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t number, const std::string& what) {
  return RandomStream(seed, number, "calibrate." + what).integer(std::uint64_t{1} << 62U);
}

double FitKey::value(double place) const { return logarithmic ? min * math::pow(max / min, place) : min + (max - min) * place; }

bool FitKey::circular() const {
  constexpr double turn = 2.0 * std::numbers::pi, rounding = 1e-9;  // rad
  return quantity == Quantity::angle && std::abs(max - min - turn) < rounding;
}

double FitKey::place(double value) const {
  if (!logarithmic) return (value - min) / (max - min);
  return value > 0.0 ? math::log(value / min) / math::log(max / min) : -1.0;
}

std::string FitKey::text(double value, int digits) const {
  // Uses a unit in which the bounds have a readable size.
  const Unit* best = nullptr;
  const double size = std::max(std::abs(min), std::abs(max));
  for (const Unit& unit : units_of(quantity)) {
    const double scaled = size / unit.factor;
    if (best == nullptr || (scaled >= 1.0 && (scaled < size / best->factor || size / best->factor < 1.0))) best = &unit;
  }
  if (quantity == Quantity::angle) {
    for (const Unit& unit : units_of(quantity)) best = unit.symbol == "deg" ? &unit : best;
  }
  return fmt::format("{:.{}g}{}{}", value / best->factor, digits, best->symbol.empty() ? "" : " ", best->symbol);
}

std::vector<FitKey> parse_fit_keys(const std::string& text) {
  const YamlNode root = parse_yaml(text, "--fit " + text, false);
  require_map(root, "--fit", "KEY: {min: .., max: ..}");
  std::vector<FitKey> keys;
  for (const YamlNode& child : root.children) keys.push_back(read_fit_key(child));
  return keys;
}

std::string fitted_scene(const SceneFile& file, const std::vector<FitKey>& keys, const Json& result) {
  SceneFile fitted = file;
  std::string head = fmt::format("# {}\n", result.at("command").get<std::string>());
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const FitKey& key = keys[k];
    const Json& parameter = result.at("parameters").at(k);
    const bool determined = parameter.at("determined").get<bool>();
    const std::string bound = !key.each && parameter.at("at_bound").get<bool>() ? ", at its bound" : "";
    const std::string value = key.text(parameter.at("value").get<double>());
    if (!determined) {
      head += fmt::format("# {}: not determined by these recordings{}\n", key.path, bound);
    } else if (key.each) {
      head += fmt::format("# {}: {} over the recordings\n", key.path, draw_of(key, parameter));
    } else {
      head += fmt::format("# {}: {}, 95 % {} to {}{}\n", key.path, value, key.text(parameter.at("low").get<double>()),
                          key.text(parameter.at("high").get<double>()), bound);
    }
    if (key.path == lag_key) continue;
    // With all digits, so that the scene has the fitted values, not the rounded ones of the
    // comments.
    fitted.apply(key.each ? Override{"sweep." + key.path, draw_of(key, parameter)}
                          : Override{key.path, format_quantity(parameter.at("value").get<double>(), key.quantity)});
  }
  return head + block(fitted.root());
}

}  // namespace slipbench::calibrate
