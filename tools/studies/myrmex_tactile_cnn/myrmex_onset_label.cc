// Section 2.2 of the Myrmex paper: the onset of slip by a third sensor on the object, beside the true one.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "sensors/myrmex/foam_cell.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/grid.h"
#include "tools/studies/myrmex_tactile_cnn/myrmex_onset.h"

namespace slipbench::reproduce {
namespace {

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
const std::array<NamedEnd, 4>& ends() {
  static const std::array<NamedEnd, 4> all{
      NamedEnd{"public", "a taxel, 205 counts", ContactGate{false, 0.0, 0.05 * myrmex::full_scale}},
      NamedEnd{"taxel_3", fmt::format("a taxel, 3 sd of noise, {:.0f} counts", 3.0 * taxel_noise_sd),
               ContactGate{false, 0.0, 3.0 * taxel_noise_sd}},
      NamedEnd{"sum_5", fmt::format("an array's sum, mean of 20 ms, 5 sd above its rest, {:.0f} counts", sum_end().counts),
               sum_end()},
      NamedEnd{"truth", "the truth", {}}};
  return all;
}
constexpr std::size_t end_count = 4;

struct OnsetTrial {
  std::string object;
  bool rotational = false;
  TrueSlip truth;
  std::array<double, end_count> end{};                                              // s
  std::array<std::array<std::optional<double>, rules.size()>, end_count> labelled;  // s, by end and rule
};

std::string object_text(const BodyScene& body) {
  return fmt::format("{}, {:.0f} g", object_name(body), 1e3 * body.shape.parameters.number("mass"));
}

OnsetTrial onset_trial(const Scene& scene, const TrialRecord& record) {
  const SensorRecord &left = bench_sensor(record, "left"), &right = bench_sensor(record, "right"),
                     &top = bench_sensor(record, "top");
  OnsetTrial trial{object_text(scene.bodies.front()), is_rotational(scene.bodies.front()), {}, {}, {}};
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
    const std::optional<ContactGate>& gate = ends()[e].gate;
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
                    {"end: no more contact by", "less true end, ms: median (quartiles)", "true onset"},
                    {},
                    ""};
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
        ends()[e].text, fmt::format("{:+.0f} ({:+.0f} to {:+.0f})", median(late), quantile(late, 0.25), quantile(late, 0.75)),
        fmt::format("{} of {}", slips, late.size())};
    Json json{{"end", ends()[e].name}, {"less_true_end_ms", late}, {"true_onset", slips}};
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
  ResultTable table{fmt::format("Labelled less true onset, ms: median (quartiles; worst). End by {}", ends()[end].text),
                    {"kind", "object", "trials"},
                    {},
                    "A label is late where its bias is positive. Missed: the sum is not below the threshold at the end."};
  for (const NamedRule& rule : rules) table.head.emplace_back(rule.text);
  const auto add = [&](const std::string& kind, const std::string& object, const auto& chosen) {
    const auto count = std::ranges::count_if(trials, [&](const OnsetTrial& trial) { return trial.truth.onset && chosen(trial); });
    if (count == 0) return;
    const std::vector<Bias> found = biases(trials, end, chosen);
    std::vector<std::string> row{kind, object, std::to_string(count)};
    Json json{{"end", ends()[end].name}, {"kind", kind}, {"object", object}};
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
