// Section 2.2 of the Myrmex paper: the onset of slip by a third sensor on the object, beside the true one.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/reproduce/catalogue.h"
#include "tools/reproduce/myrmex_onset.h"
#include "tools/reproduce/nib_bench.h"
#include "tools/train/figures.h"

namespace slipbench::reproduce {
namespace {

constexpr double settled = 2.0, apart = 2.5;  // s, dataset.yaml: the third sensor rests on the object, the arms begin to move
constexpr double rotational_from = 5e-3;      // m, centre of mass to the side of the grip
constexpr double noise_gate = 0.05 * 4095.0;  // counts, of the public tools (llach/myrmex_tools)

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

struct OnsetTrial {
  std::string object;
  bool rotational = false;
  TrueSlip truth;
  double gated_end = 0.0;                                    // s
  std::array<std::optional<double>, rules.size()> labelled;  // s
};

std::string object_text(const BodyScene& body) {
  const Parameters& p = body.shape.parameters;
  const bool hollow = p.values().contains("bore") && p.number("bore") > 0.0;
  const std::string what = hollow ? "glass" : body.shape.name == "box" ? "remote" : body.shape.name;
  return fmt::format("{}, {:.0f} g", what, 1e3 * p.number("mass"));
}

const SensorRecord& sensor_of(const TrialRecord& record, const std::string& name) {
  const auto found = std::ranges::find(record.sensors, name, &SensorRecord::name);
  if (found == record.sensors.end()) throw std::logic_error("scenes/myrmex/dataset.yaml has no sensor " + name);
  return *found;
}

OnsetTrial onset_trial(const Scene& scene, const TrialRecord& record) {
  const SensorRecord &left = sensor_of(record, "left"), &right = sensor_of(record, "right"), &top = sensor_of(record, "top");
  OnsetTrial trial{
      object_text(scene.bodies.front()), std::abs(side_of_mass(scene.bodies.front())) > rotational_from, {}, 0.0, {}};
  trial.truth = true_slip(left, right, apart);
  trial.gated_end = contact_end(left, right, noise_gate);
  const std::vector<double> counts = sum_of_contacts(top);
  std::vector<double> force;
  const std::size_t units = top.labels.units();
  for (std::size_t k = 0; k < top.time.size(); ++k) {
    double sum = 0.0;
    for (std::size_t u = 0; u < units; ++u) sum += top.labels.force[3 * (k * units + u) + 2];
    force.push_back(sum);
  }
  const auto held = static_cast<std::size_t>(std::ranges::lower_bound(top.time, apart) - top.time.begin());
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const double least = rules[r].noisy ? 0.0 : force_fall * force[held];
    trial.labelled[r] =
        decrease_onset(top.time, rules[r].noisy ? counts : force, rules[r].rule, settled, apart, trial.truth.end, least);
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
  return fmt::format("{:+.0f} ({:+.0f} to {:+.0f}; {:+.0f}){}", quantile(bias.all, 0.5), quantile(bias.all, 0.25),
                     quantile(bias.all, 0.75), worst, bias.missed == 0 ? "" : fmt::format(", {} missed", bias.missed));
}

Json bias_json(const Bias& bias) {
  Json json{{"n", bias.all.size()}, {"missed", bias.missed}, {"bias_ms", bias.all}};
  if (!bias.all.empty()) json["median_ms"] = quantile(bias.all, 0.5);
  return json;
}

template <class Chosen>
std::vector<Bias> biases(const std::vector<OnsetTrial>& trials, Chosen&& chosen) {
  std::vector<Bias> found(rules.size());
  for (const OnsetTrial& trial : trials) {
    if (!trial.truth.onset || !chosen(trial)) continue;
    for (std::size_t r = 0; r < rules.size(); ++r) {
      if (trial.labelled[r]) {
        found[r].all.push_back(1e3 * (*trial.labelled[r] - *trial.truth.onset));
      } else {
        ++found[r].missed;
      }
    }
  }
  return found;
}

}  // namespace

Result myrmex_onset_label(const ReproduceOptions& options) {
  const std::uint64_t seed = options.seed.value_or(1);
  constexpr std::size_t usual_trials = 8;
  const std::size_t draws = options.trials == 0 ? usual_trials : options.trials;
  const std::vector<OnsetTrial> trials = run_lever_scene<OnsetTrial>(
      "scenes/myrmex/dataset.yaml", [](Scene&) {}, draws, seed, options, "dataset.yaml",
      [](const Scene& scene, const TrialRecord& record, std::size_t) { return onset_trial(scene, record); });

  Result result;
  result.title = "Onset of slip by a third sensor on the object";
  result.source = "Section 2.2 of \"Tactile Convolutional Networks for Online Slip and Rotation Detection\"";
  ResultTable table{"Labelled less true onset, ms: median (quartiles; worst)", {"kind", "object", "trials"}, {}, ""};
  for (const NamedRule& rule : rules) table.head.emplace_back(rule.text);
  std::vector<std::string> objects;
  for (const OnsetTrial& trial : trials) {
    if (std::ranges::find(objects, trial.object) == objects.end()) objects.push_back(trial.object);
  }
  std::size_t held = 0;
  std::vector<double> lengths, ends;
  for (const OnsetTrial& trial : trials) {
    if (!trial.truth.onset) {
      ++held;
      continue;
    }
    lengths.push_back(1e3 * (trial.truth.end - *trial.truth.onset));
    ends.push_back(1e3 * (trial.gated_end - trial.truth.end));
  }
  const auto add = [&](const std::string& kind, const std::string& object, const auto& chosen) {
    const auto count = std::ranges::count_if(trials, [&](const OnsetTrial& trial) { return trial.truth.onset && chosen(trial); });
    if (count == 0) return;
    const std::vector<Bias> found = biases(trials, chosen);
    std::vector<std::string> row{kind, object, std::to_string(count)};
    Json figures{{"kind", kind}, {"object", object}};
    for (std::size_t r = 0; r < rules.size(); ++r) {
      row.push_back(bias_text(found[r]));
      figures[rules[r].name] = bias_json(found[r]);
    }
    table.rows.push_back(std::move(row));
    result.figures["bias"].push_back(std::move(figures));
  };
  for (const bool rotational : {false, true}) {
    const std::string kind = rotational ? "rotation" : "translation";
    for (const std::string& object : objects) {
      add(kind, object, [&](const OnsetTrial& trial) { return trial.rotational == rotational && trial.object == object; });
    }
    add(kind, "all", [&](const OnsetTrial& trial) { return trial.rotational == rotational; });
  }
  add("both", "all", [](const OnsetTrial&) { return true; });
  table.note =
      "A label is late where its bias is positive. Missed: the sum is not below the threshold when the object leaves the pads.";
  result.tables.push_back(std::move(table));
  result.setup = {
      fmt::format("scenes/myrmex/dataset.yaml, seed {}: {} trials of 10.356 s, electronics typical; {} of them hold to the end.",
                  seed, trials.size(), held),
      "True onset: from then on slipping taxels carry at least half of the normal force, on both pads, until one has lost "
      "contact.",
      "Rule: the sum of 4095 - counts over the third sensor's taxels (500 Hz), averaged backwards, lies below its mean from 2.0 "
      "to 2.5 s, "
      "when nothing moves, by some standard deviations of that stretch, and stays there. What the paper leaves open is the "
      "average and the "
      "threshold. True force: what the sensor is pressed with, without its noise and memory."};
  if (!lengths.empty()) {
    result.setup.push_back(
        fmt::format("From the true onset to the loss of contact {:.0f} ms in the median. The paper's end, no more contact on the "
                    "holding sensors, with the "
                    "public tools' gate of 205 counts: {:+.0f} ms (quartiles {:+.0f} to {:+.0f}) against the truth.",
                    quantile(lengths, 0.5), quantile(ends, 0.5), quantile(ends, 0.25), quantile(ends, 0.75)));
    result.figures["slip_ms"] = lengths;
    result.figures["end_bias_ms"] = ends;
  }
  return result;
}

}  // namespace slipbench::reproduce
