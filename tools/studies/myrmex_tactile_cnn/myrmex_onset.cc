#include "tools/studies/myrmex_tactile_cnn/myrmex_networks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "sensors/myrmex/foam_cell.h"
#include "sim/core/error.h"
#include "sim/core/math/rotation.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

constexpr double rest = myrmex::full_scale;

const std::vector<float>& taxels_of(const SensorRecord& sensor) {
  for (const SensorColumn& column : sensor.channels) {
    if (column.name == "taxels") return column.values;
  }
  throw InputError("sensor " + sensor.name + " has no taxels; allowed: a myrmex");
}

// Of each sample, the counts that are missing of the taxel that misses most.
std::vector<double> most_missing(const SensorRecord& sensor) {
  const std::vector<float>& taxels = taxels_of(sensor);
  const std::size_t units = sensor.labels.units();
  std::vector<double> missing;
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    missing.push_back(rest - static_cast<double>(*std::ranges::min_element(std::span(taxels).subspan(k * units, units))));
  }
  return missing;
}

constexpr double still = bench_apart - bench_settled;

struct NamedRule {
  const char* name;
  const char* text;
  OnsetRule rule;
  bool noisy;  // of the counts; else of the true force, without any noise
};
constexpr std::array rules{NamedRule{"w20_2", "counts, mean of 20 ms, 2 sd", {0.02, 2.0}, true},
                           NamedRule{"w20_3", "counts, mean of 20 ms, 3 sd", {0.02, 3.0}, true},
                           NamedRule{"w20_5", "counts, mean of 20 ms, 5 sd", {0.02, 5.0}, true},
                           NamedRule{"w100_3", "counts, mean of 100 ms, 3 sd", {0.1, 3.0}, true},
                           NamedRule{"w100_5", "counts, mean of 100 ms, 5 sd", {0.1, 5.0}, true},
                           NamedRule{"force", "true force, 5 % below", {0.0, 0.0}, false}};
constexpr double force_fall = 0.05;  // of the last rule

// How the end of a trial is told. A single taxel: by the public tools (llach/myrmex_tools: 5 % of full scale), and by 3 sd of its
// noise. The sum of an array: sum_end().
struct NamedEnd {
  const char* name;
  std::string text;
  std::optional<ContactGate> gate;  // empty: by the truth
};
const std::array<NamedEnd, 4> ends{
    NamedEnd{"public", "a taxel, 205 counts", ContactGate{false, 0.0, 0.05 * myrmex::full_scale}},
    NamedEnd{"taxel_3", fmt::format("a taxel, 3 sd of noise, {:.0f} counts", 3.0 * taxel_noise_sd),
             ContactGate{false, 0.0, 3.0 * taxel_noise_sd}},
    NamedEnd{"sum_5", fmt::format("an array's sum, mean of 20 ms, 5 sd above its rest, {:.0f} counts", sum_end().counts),
             sum_end()},
    NamedEnd{"truth", "the truth", {}}};
constexpr std::size_t end_count = 4;

struct OnsetTrial {
  std::string object;
  bool rotational = false;
  TrueSlip truth;
  std::array<double, end_count> end{};                                              // s
  std::array<std::array<std::optional<double>, rules.size()>, end_count> labelled;  // s, by end and rule
};

OnsetTrial onset_trial(const Scene& scene, const TrialRecord& record) {
  const SensorRecord &left = bench_sensor(record, "left"), &right = bench_sensor(record, "right"),
                     &top = bench_sensor(record, "top");
  const BodyScene& body = scene.bodies.front();
  OnsetTrial trial{fmt::format("{}, {:.0f} g", object_name(body), 1e3 * body.shape.parameters.number("mass")),
                   is_rotational(body),
                   {},
                   {},
                   {}};
  trial.truth = true_slip(left, right, bench_apart);
  const std::vector<double> counts = sum_of_contacts(top);
  std::vector<double> force;
  const std::size_t units = top.labels.units();
  for (std::size_t k = 0; k < top.time.size(); ++k) {
    double sum = 0.0;
    for (std::size_t u = 0; u < units; ++u) sum += top.labels.force[3 * (k * units + u) + 2];
    force.push_back(sum);
  }
  const auto held = static_cast<std::size_t>(std::ranges::lower_bound(top.time, bench_apart) - top.time.begin());
  for (std::size_t e = 0; e < end_count; ++e) {
    const std::optional<ContactGate>& gate = ends[e].gate;
    trial.end[e] = gate ? contact_end(left, right, *gate) : trial.truth.end;
    for (std::size_t r = 0; r < rules.size(); ++r) {
      const double least = rules[r].noisy ? 0.0 : force_fall * force[held];
      trial.labelled[e][r] = decrease_onset(top.time, rules[r].noisy ? counts : force, rules[r].rule, bench_settled, bench_apart,
                                            trial.end[e], least);
    }
  }
  return trial;
}

// Biases of one rule over some trials [ms].
struct Bias {
  std::vector<double> all;
  std::size_t missed = 0;
};

std::string bias_text(const Bias& bias) {
  if (bias.all.empty()) return "-";
  const double worst = *std::ranges::max_element(bias.all, {}, [](double b) { return std::abs(b); });
  return fmt::format("{:+.0f} ({:+.0f} to {:+.0f}; {:+.0f}){}", median(bias.all), quantile(bias.all, 0.25),
                     quantile(bias.all, 0.75), worst, bias.missed == 0 ? "" : fmt::format(", {} missed", bias.missed));
}

Json bias_json(const Bias& bias) {
  Json json{{"n", bias.all.size()}, {"missed", bias.missed}, {"bias_ms", bias.all}};
  if (!bias.all.empty()) json["median_ms"] = median(bias.all);
  return json;
}

template <class Chosen>
std::vector<Bias> biases(const std::vector<OnsetTrial>& trials, std::size_t end, Chosen&& chosen) {
  std::vector<Bias> found(rules.size());
  for (const OnsetTrial& trial : trials) {
    if (!trial.truth.onset || !chosen(trial)) continue;
    for (std::size_t r = 0; r < rules.size(); ++r) {
      if (trial.labelled[end][r]) {
        found[r].all.push_back(1e3 * (*trial.labelled[end][r] - *trial.truth.onset));
      } else {
        ++found[r].missed;
      }
    }
  }
  return found;
}

// Of each end, where it lies, and how many trials have an onset before it.
ResultTable kept_table(const std::vector<OnsetTrial>& trials, Json& figures) {
  ResultTable table{"Trials that keep an onset before their end",
                    {"end: no more contact by", "less true end, ms: median (quartiles)", "true onset"}};
  for (const NamedRule& rule : rules) table.head.emplace_back(rule.text);
  for (std::size_t e = 0; e < end_count; ++e) {
    std::vector<double> late;
    std::size_t slips = 0;
    std::array<std::size_t, rules.size()> kept{};
    for (const OnsetTrial& trial : trials) {
      if (!trial.truth.onset) continue;
      late.push_back(1e3 * (trial.end[e] - trial.truth.end));
      slips += trial.end[e] > *trial.truth.onset ? 1 : 0;
      for (std::size_t r = 0; r < rules.size(); ++r) kept[r] += trial.labelled[e][r] ? 1 : 0;
    }
    if (late.empty()) continue;
    std::vector<std::string> row{
        ends[e].text, fmt::format("{:+.0f} ({:+.0f} to {:+.0f})", median(late), quantile(late, 0.25), quantile(late, 0.75)),
        fmt::format("{} of {}", slips, late.size())};
    Json json{{"end", ends[e].name}, {"less_true_end_ms", late}, {"true_onset", slips}};
    for (std::size_t r = 0; r < rules.size(); ++r) {
      row.push_back(std::to_string(kept[r]));
      json[rules[r].name] = kept[r];
    }
    table.rows.push_back(std::move(row));
    figures["ends"].push_back(std::move(json));
  }
  return table;
}

ResultTable bias_table(const std::vector<OnsetTrial>& trials, const std::vector<std::string>& objects, std::size_t end,
                       Json& figures) {
  ResultTable table{fmt::format("Labelled less true onset, ms: median (quartiles; worst). End by {}", ends[end].text),
                    {"kind", "object", "trials"},
                    {},
                    "A label is late where its bias is positive. Missed: the sum is not below the threshold at the end."};
  for (const NamedRule& rule : rules) table.head.emplace_back(rule.text);
  const auto add = [&](const std::string& kind, const std::string& object, const auto& chosen) {
    const auto count = std::ranges::count_if(trials, [&](const OnsetTrial& trial) { return trial.truth.onset && chosen(trial); });
    if (count == 0) return;
    const std::vector<Bias> found = biases(trials, end, chosen);
    std::vector<std::string> row{kind, object, std::to_string(count)};
    Json json{{"end", ends[end].name}, {"kind", kind}, {"object", object}};
    for (std::size_t r = 0; r < rules.size(); ++r) {
      row.push_back(bias_text(found[r]));
      json[rules[r].name] = bias_json(found[r]);
    }
    table.rows.push_back(std::move(row));
    figures["bias"].push_back(std::move(json));
  };
  for (const bool rotational : {false, true}) {
    const std::string kind = rotational ? "rotation" : "translation";
    for (const std::string& object : objects) {
      add(kind, object, [&](const OnsetTrial& trial) { return trial.rotational == rotational && trial.object == object; });
    }
    add(kind, "all", [&](const OnsetTrial& trial) { return trial.rotational == rotational; });
  }
  add("both", "all", [](const OnsetTrial&) { return true; });
  return table;
}

}  // namespace

std::vector<double> sum_of_contacts(const SensorRecord& sensor) {
  const std::vector<float>& taxels = taxels_of(sensor);
  const std::size_t units = sensor.labels.units();
  std::vector<double> sums;
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    double sum = 0.0;
    for (std::size_t u = 0; u < units; ++u) sum += rest - static_cast<double>(taxels[k * units + u]);
    sums.push_back(sum);
  }
  return sums;
}

std::vector<double> backward_mean(std::span<const double> time, std::span<const double> values, double window) {
  std::vector<double> averaged(values.begin(), values.end());
  if (!(window > 0.0)) return averaged;
  std::size_t first = 0;
  double total = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    total += values[k];
    while (first < k && time[k] - time[first] >= window) total -= values[first++];
    averaged[k] = total / static_cast<double>(k - first + 1);
  }
  return averaged;
}

std::optional<double> decrease_onset(std::span<const double> time, std::span<const double> sum, const OnsetRule& rule,
                                     double from, double to, double end, double least) {
  const std::vector<double> averaged = backward_mean(time, sum, rule.window);
  double n = 0.0, mean = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (time[k] < from || time[k] >= to) continue;
    n += 1.0;
    const double step = averaged[k] - mean;
    mean += step / n;
    squares += step * (averaged[k] - mean);
  }
  if (n < 2.0) return {};
  const double level = mean - std::max(least, rule.threshold * std::sqrt(squares / (n - 1.0)));
  std::optional<double> onset;
  for (std::size_t k = 0; k < sum.size() && time[k] <= end; ++k) {
    if (time[k] < to) continue;
    if (!(averaged[k] < level)) {
      onset.reset();
    } else if (!onset) {
      onset = time[k];
    }
  }
  return onset;
}

std::vector<double> slipping_share(const SensorRecord& sensor) {
  const std::size_t units = sensor.labels.units();
  std::vector<double> shares;
  for (std::size_t k = 0; k < sensor.time.size(); ++k) {
    double all = 0.0, slipping = 0.0;
    for (std::size_t u = 0; u < units; ++u) {
      const double force = sensor.labels.force[3 * (k * units + u) + 2];
      all += force;
      if (sensor.labels.unit_state[k * units + u] == static_cast<std::uint8_t>(UnitState::slip)) slipping += force;
    }
    shares.push_back(all > 0.0 ? slipping / all : 0.0);
  }
  return shares;
}

TrueSlip true_slip(const SensorRecord& left, const SensorRecord& right, double from) {
  const std::vector<double> a = slipping_share(left), b = slipping_share(right);
  const auto none = static_cast<std::uint8_t>(PadState::no_contact);
  TrueSlip slip;
  for (std::size_t k = 0; k < left.time.size(); ++k) {
    if (left.time[k] < from) continue;
    if (left.labels.state[k] == none || right.labels.state[k] == none) break;
    slip.end = left.time[k];
    if (std::min(a[k], b[k]) < 0.5) {
      slip.onset.reset();
    } else if (!slip.onset) {
      slip.onset = left.time[k];
    }
  }
  return slip;
}

ContactGate sum_end() {
  // Cut off above rest, a normal variable misses sd/sqrt(2 pi) in the mean, and has the standard deviation sqrt(1/2 - 1/(2 pi)) sd.
  constexpr double cut_mean = 0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2;
  const double cut_sd = std::sqrt(0.5 - cut_mean * cut_mean);
  constexpr double taxels = 256.0, images = 20.0;  // of an array; of its sum's mean of 20 ms at 1 kHz
  return {true, 0.02, taxels * taxel_noise_sd * (cut_mean + 5.0 * cut_sd / std::sqrt(taxels * images))};
}

double contact_end(const SensorRecord& left, const SensorRecord& right, const ContactGate& gate) {
  double end = 0.0;
  for (const SensorRecord* sensor : {&left, &right}) {
    const std::vector<double> missing =
        backward_mean(sensor->time, gate.of_sum ? sum_of_contacts(*sensor) : most_missing(*sensor), gate.window);
    for (std::size_t k = 0; k < missing.size(); ++k) {
      if (missing[k] > gate.counts) end = std::max(end, sensor->time[k]);
    }
  }
  return end;
}

const SensorRecord& bench_sensor(const TrialRecord& record, std::string_view name) {
  const auto found = std::ranges::find(record.sensors, name, &SensorRecord::name);
  if (found == record.sensors.end()) throw std::logic_error("scenes/myrmex/dataset.yaml has no sensor " + std::string(name));
  return *found;
}

std::string object_name(const BodyScene& body) {
  const Parameters& p = body.shape.parameters;
  if (p.values().contains("bore") && p.number("bore") > 0.0) return "glass";
  return body.shape.name == "box" ? "remote" : body.shape.name;
}

bool is_rotational(const BodyScene& body) {
  constexpr double from = 5e-3;  // m
  return std::abs(side_of_mass(body)) > from;
}

double side_of_mass(const BodyScene& body) {
  const Parameters& p = body.shape.parameters;
  const auto vector = [&](const char* name) { return Eigen::Vector3d::Map(p.vector(name).data()); };
  const Eigen::Vector3d angles = vector("rotation");
  const Eigen::Matrix3d turn = rotation_by_axes(angles);
  const bool known = p.values().contains("centre_of_mass");
  const Eigen::Vector3d centre = known ? Eigen::Vector3d(turn * vector("centre_of_mass")) : Eigen::Vector3d(0.0, 0.0, 0.0);
  return vector("position").y() + centre.y();
}

// Section 2.2 of the Myrmex paper: the onset of slip by a third sensor on the object, beside the true one.
Result myrmex_onset_label(const ReproduceOptions& options) {
  constexpr std::size_t usual_trials = 8;
  const std::size_t draws = options.trials == 0 ? usual_trials : options.trials;
  const std::vector<OnsetTrial> trials =
      run_grid<OnsetTrial>({{"dataset.yaml", "scenes/myrmex/dataset.yaml", {}, {}, draws}}, options, [](const GridTrial& trial) {
        return onset_trial(trial.scene, trial.record());
      }).front();

  Result result;
  result.title = "Onset of slip by a third sensor on the object";
  result.source = "Section 2.2 of \"Tactile Convolutional Networks for Online Slip and Rotation Detection\"";
  std::vector<std::string> objects;
  for (const OnsetTrial& trial : trials) {
    if (std::ranges::find(objects, trial.object) == objects.end()) objects.push_back(trial.object);
  }
  std::vector<double> lengths;
  for (const OnsetTrial& trial : trials) {
    if (trial.truth.onset) lengths.push_back(1e3 * (trial.truth.end - *trial.truth.onset));
  }
  result.tables.push_back(kept_table(trials, result.figures));
  for (std::size_t e = 0; e < end_count; ++e) result.tables.push_back(bias_table(trials, objects, e, result.figures));
  result.setup = {
      fmt::format("scenes/myrmex/dataset.yaml, seed {}: {} trials, electronics typical; {} of them hold to the end.",
                  options.seed.value_or(1), trials.size(), trials.size() - lengths.size()),
      "True onset: from then on slipping taxels carry at least half of the normal force, on both pads, until one has lost contact, the true end.",
      "Rule: the sum of 4095 - counts over the third sensor's taxels (500 Hz), averaged backwards, lies below its mean from 2.0 to 2.5 s, when nothing moves, by some standard deviations (sd) of that stretch, and stays there up to the end. The end: no more contact on the two holding arrays. What the paper leaves open is the average, the threshold and what a contact is. True force: what the sensor is pressed with, without its noise and memory.",
      fmt::format(
          "sd is that of the averaged sum over the 500 ms: {:.0f} independent means of 20 ms, {:.0f} of 100 ms, so that it is itself known to {:.0f} % and {:.0f} % (1/sqrt(2 (n - 1))).",
          still / 0.02, still / 0.1, 100.0 / std::sqrt(2.0 * (still / 0.02 - 1.0)),
          100.0 / std::sqrt(2.0 * (still / 0.1 - 1.0)))};
  if (!lengths.empty()) {
    result.setup.push_back(fmt::format("From the true onset to the true end {:.0f} ms in the median.", median(lengths)));
    result.figures["slip_ms"] = lengths;
  }
  return result;
}

}  // namespace slipbench::reproduce
