#include "tools/program/train/network/validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/core/math.h"
#include "sim/core/random.h"
#include "tools/base/files/reject.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/train/network/examples.h"

namespace slipbench::train {
namespace {

// Probabilities of the frames that are not masked, by truth: hold, slip.
std::array<std::vector<double>, 2> sorted_by_truth(std::span<const SlipSeries> series) {
  std::array<std::vector<double>, 2> of;
  for (const SlipSeries& one : series) {
    for (std::size_t t = 0; t < one.truth.size(); ++t) {
      if (one.truth[t] != masked) of.at(one.truth[t]).push_back(one.probability[t]);
    }
  }
  for (std::vector<double>& part : of) std::ranges::sort(part);
  return of;
}

std::vector<double> merged(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all;
  std::ranges::merge(a, b, std::back_inserter(all));
  return all;
}

// `experiment`: the first trial with the example's truth.
std::string group_of(const Example& example, std::size_t experiment, Split split) {
  switch (split) {
    case Split::trial: return std::to_string(experiment);
    case Split::material: return example.material;
    case Split::object: return example.object;
    case Split::speed:
      return std::isnan(example.speed) || example.speed <= 0.0 ? ""
                                                               : fmt::format("{}", std::lround(math::log2(example.speed * 1e3)));
  }
  return {};
}

// What is dealt out apart: which classes occur, and whether something touches.
using Kinds = std::set<int>;

void add_kinds(Kinds& kinds, const Example& example) {
  constexpr int touching = -1;
  if (example.touches) kinds.insert(touching);
  for (const std::uint8_t label : example.frames.label) {
    if (label != masked) kinds.insert(label);
  }
}

// So many of `items`, shuffled, of each of `kind_of` its share, rounded up all together.
template <class Item, class Kind>
std::vector<Item> dealt(std::vector<Item> items, double share, RandomStream& random, Kind&& kind_of) {
  const auto wanted = static_cast<std::size_t>(std::ceil(share * static_cast<double>(items.size()) - 1e-9));
  shuffle(items, random);
  // In turn from each kind by its place within it, so that any beginning has all kinds in proportion.
  std::map<Kinds, double> size, place;
  for (const Item& item : items) size[kind_of(item)] += 1.0;
  std::vector<std::pair<double, Item>> order;
  for (const Item& item : items) {
    const Kinds kind = kind_of(item);
    order.emplace_back((place[kind] + 0.5) / size[kind], item);
    place[kind] += 1.0;
  }
  std::ranges::stable_sort(order, {}, &std::pair<double, Item>::first);
  std::vector<Item> first;
  for (std::size_t i = 0; i < wanted; ++i) first.push_back(order[i].second);
  return first;
}

// The parts of examples without one of their own, in their order.
std::vector<Part> dealt_parts(std::span<const Example* const> examples, Split split, double held_out, std::uint64_t seed) {
  const std::string word = hd::name_of(split_words, split);
  std::map<std::string, Kinds> groups;
  std::map<std::size_t, Kinds> kinds_of_trial;
  std::map<std::size_t, std::string> of_trial;  // its group
  std::map<std::string, std::size_t> experiments;
  for (const Example* const one : examples) {
    const Example& example = *one;
    const std::size_t experiment = example.twin.empty()
                                       ? example.trial
                                       : experiments.try_emplace(example.sensor + example.twin, example.trial).first->second;
    const std::string group = group_of(example, experiment, split);
    if (group.empty())
      reject("trial {}: the dataset sweeps no {}, so it cannot be split by it; allowed: trial, or a dataset that sweeps it",
             example.trial, word);
    of_trial.try_emplace(example.trial, group);
    add_kinds(groups[of_trial[example.trial]], example);
    add_kinds(kinds_of_trial[example.trial], example);
  }
  RandomStream random(seed, 0, "split");
  std::vector<std::string> names;
  for (const auto& [name, kinds] : groups) names.push_back(name);
  const std::vector<std::string> judging = dealt(names, held_out, random, [&](const std::string& name) { return groups[name]; });
  std::vector<std::string> left;
  std::ranges::copy_if(names, std::back_inserter(left),
                       [&](const std::string& name) { return std::ranges::find(judging, name) == judging.end(); });
  std::vector<std::string> validating;
  std::vector<std::size_t> validating_trials;
  if (split == Split::trial || left.size() >= 5) {
    validating = dealt(left, 0.2, random, [&](const std::string& name) { return groups[name]; });
  } else {
    std::vector<std::size_t> trials;
    for (const auto& [trial, group] : of_trial) {
      if (std::ranges::find(left, group) != left.end()) trials.push_back(trial);
    }
    validating_trials = dealt(trials, 0.2, random, [&](std::size_t trial) { return kinds_of_trial[trial]; });
  }
  std::vector<Part> parts;
  std::size_t learning = 0, validates = 0;
  for (const Example* const one : examples) {
    const Example& example = *one;
    const std::string& group = of_trial[example.trial];
    Part part = Part::learns;
    if (std::ranges::find(judging, group) != judging.end()) {
      part = Part::judges;
    } else if (std::ranges::find(validating, group) != validating.end() ||
               std::ranges::find(validating_trials, example.trial) != validating_trials.end()) {
      part = Part::validates;
    }
    if (example.turn != 0 && part != Part::learns) part = Part::left_out;
    learning += part == Part::learns ? 1 : 0;
    validates += part == Part::validates ? 1 : 0;
    parts.push_back(part);
  }
  if (learning == 0 || validates == 0) {
    reject("{} different {} leave nothing to learn from and to validate on; allowed: three or more, or a split by another fact",
           groups.size(), split == Split::trial ? "experiments" : word + "s");
  }
  return parts;
}

}  // namespace

std::vector<std::size_t> folds(std::span<const std::size_t> groups, std::size_t count, std::uint64_t seed) {
  if (count < 2) throw std::invalid_argument("fewer than two folds");
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t item = 0; item < groups.size(); ++item) members[groups[item]].push_back(item);
  std::vector<std::size_t> fold_of(groups.size());
  RandomStream random(seed, 0, "folds");
  for (auto& [group, items] : members) {
    shuffle(items, random);
    for (std::size_t i = 0; i < items.size(); ++i) fold_of[items[i]] = i % count;
  }
  return fold_of;
}

Logits logits_in_fold(std::span<const FoldExample> examples, std::span<const std::size_t> fold_of, std::size_t fold,
                      const Validation& validation) {
  std::vector<FrameSequence> learnt, validating;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (fold_of[i] != fold && validation.learns(examples[i].group)) learnt.push_back(examples[i].frames);
  }
  RandomStream random(validation.training.seed, fold, "validated");
  for (auto left = static_cast<std::size_t>(validation.validated * static_cast<double>(learnt.size())); left > 0; --left) {
    std::swap(learnt[random.integer(learnt.size())], learnt.back());
    validating.push_back(std::move(learnt.back()));
    learnt.pop_back();
  }
  std::vector<const FrameSequence*> scaled;
  for (const FrameSequence& sequence : learnt) scaled.push_back(&sequence);
  const Scale scale = scale_of(scaled, validation.shape.inputs, validation.scaling);
  for (std::vector<FrameSequence>* part : {&learnt, &validating}) {
    for (FrameSequence& sequence : *part) apply(scale, sequence);
  }
  const std::unique_ptr<Network> network = make_network(validation.shape, validation.training.seed);
  network->train(learnt, validating, validation.training);
  Logits logits(examples.size());
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (fold_of[i] != fold) continue;
    FrameSequence judged = examples[i].frames;
    apply(scale, judged);
    logits[i] = network->logits(judged.features);
  }
  return logits;
}

Calls called_in_fold(std::span<const FoldExample> examples, std::span<const std::size_t> fold_of, std::size_t fold,
                     const Validation& validation) {
  const Logits logits = logits_in_fold(examples, fold_of, fold, validation);
  const std::size_t before = history_of(validation.shape) - 1;
  Calls calls(examples.size());
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (fold_of[i] != fold) continue;
    calls[i].assign(examples[i].frames.label.size(), masked);
    for (std::size_t frame = before; frame < calls[i].size(); ++frame) {
      const std::size_t at = 2 * (frame - before);
      calls[i][frame] = logits[i][at + 1] > logits[i][at] ? 1 : 0;
    }
  }
  return calls;
}

std::vector<Confusion> counts_of(std::span<const FoldExample> examples, const Calls& calls) {
  std::size_t groups = 0;
  for (const FoldExample& example : examples) groups = std::max(groups, example.group + 1);
  std::vector<Confusion> counts(groups);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const std::vector<std::uint8_t>& label = examples[i].frames.label;
    for (std::size_t frame = 0; frame < calls[i].size(); ++frame) {
      if (label[frame] != masked && calls[i][frame] != masked)
        count(counts[examples[i].group], label[frame] == 1, calls[i][frame] == 1);
    }
  }
  return counts;
}

std::vector<Part> split_examples(std::span<const Example> examples, Split split, double held_out, std::uint64_t seed) {
  constexpr std::array<std::pair<std::string_view, Part>, 4> own{
      {{"train", Part::learns}, {"valid", Part::validates}, {"test", Part::judges}, {"none", Part::left_out}}};
  std::vector<Part> parts(examples.size(), Part::left_out);
  std::vector<const Example*> undivided, training;
  bool validates = false;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (examples[i].part.empty()) {
      undivided.push_back(&examples[i]);
      continue;
    }
    parts[i] = std::ranges::find(own, examples[i].part, &std::pair<std::string_view, Part>::first)->second;
    if (examples[i].turn != 0 && parts[i] != Part::learns) parts[i] = Part::left_out;
    validates = validates || parts[i] == Part::validates;
    if (parts[i] == Part::learns) training.push_back(&examples[i]);
  }
  const auto deal = [&](const std::vector<const Example*>& dealt, Split by, double judging) {
    const std::vector<Part> of = dealt_parts(dealt, by, judging, seed);
    for (std::size_t i = 0; i < dealt.size(); ++i) parts[static_cast<std::size_t>(dealt[i] - examples.data())] = of[i];
  };
  if (!undivided.empty()) deal(undivided, split, held_out);
  if (!validates && !training.empty()) deal(training, Split::trial, 0.0);
  return parts;
}

Scale scale_of(std::span<const FrameSequence* const> sequences, std::size_t inputs, Scaling scaling) {
  const std::size_t features = scaling == Scaling::common ? 1 : inputs;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> mean(features), square(features), least(features, infinity), greatest(features, -infinity);
  double count = 0.0;
  const auto for_each = [&](auto&& use) {
    for (const FrameSequence* sequence : sequences) {
      for (std::size_t i = 0; i < sequence->features.size(); ++i) use(i % inputs % features, double{sequence->features[i]});
    }
  };
  for (const FrameSequence* sequence : sequences) count += static_cast<double>(sequence->features.size());
  count /= static_cast<double>(features);
  if (count == 0.0) throw std::invalid_argument("no frame to scale by");
  for_each([&](std::size_t f, double x) {
    mean[f] += x / count;
    least[f] = std::min(least[f], x);
    greatest[f] = std::max(greatest[f], x);
  });
  for_each([&](std::size_t f, double x) { square[f] += (x - mean[f]) * (x - mean[f]) / count; });
  Scale scale;
  for (std::size_t f = 0; f < features; ++f) {
    const double spread = scaling == Scaling::range ? greatest[f] - least[f] : std::sqrt(square[f]);
    scale.offset.push_back(scaling == Scaling::range ? least[f] : mean[f]);
    scale.scale.push_back(greatest[f] > least[f] ? 1.0 / spread : 1.0);
  }
  return scale;
}

void apply(const Scale& scale, FrameSequence& sequence) {
  const std::vector<float> offset(scale.offset.begin(), scale.offset.end()), factor(scale.scale.begin(), scale.scale.end());
  for (std::size_t i = 0; i < sequence.features.size(); ++i) {
    const std::size_t f = i % offset.size();
    sequence.features[i] = (sequence.features[i] - offset[f]) * factor[f];
  }
}

double AlarmCounts::alarms_per_minute(double period) const {
  const double held = static_cast<double>(samples_in(frames, PadState::non_slip)) * period;
  return held > 0.0 ? 60.0 * static_cast<double>(false_alarms) / held : std::numeric_limits<double>::quiet_NaN();
}

double AlarmCounts::score(double period) const {
  const double wrong = share_of(samples_in(frames, PadState::non_slip, PadState::gross), samples_in(frames, PadState::non_slip));
  return credit / static_cast<double>(slips) * std::min(1.0, alarm_limit / alarms_per_minute(period)) - wrong;
}

AlarmCounts counts_at(std::span<const SlipSeries> series, double period, double threshold, const network::Alarm& alarm) {
  AlarmCounts counts;
  for (const SlipSeries& one : series) {
    const std::size_t onset = static_cast<std::size_t>(std::ranges::find(one.truth, 1) - one.truth.begin());
    counts.slips += onset < one.truth.size() ? 1 : 0;
    network::AlarmGate gate(alarm);
    bool before = false, ever = false;
    for (std::size_t t = 0; t < one.truth.size(); ++t) {
      const bool said = gate.push(one.probability[t] >= threshold), begins = !std::exchange(before, said) && said;
      if (one.truth[t] == masked) continue;
      count(counts.frames, one.truth[t] == 1, said);
      counts.false_alarms += begins && one.truth[t] == 0 ? 1U : 0U;
      if (said && !std::exchange(ever, true) && t >= onset)
        counts.credit += half_delay / (half_delay + static_cast<double>(t - onset) * period);
    }
  }
  return counts;
}

OperatingPoint most_accurate_point(std::span<const SlipSeries> series, double period) {
  const auto [hold, slip] = sorted_by_truth(series);
  OperatingPoint point;
  if (!hold.empty() && !slip.empty()) {
    const std::vector<double> all = merged(hold, slip);
    double accuracy = 0.0;
    std::size_t held = 0, missed = 0;  // below the threshold, by truth
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      if (all[i] == all[i + 1]) continue;
      const double here = 0.5 * (all[i] + all[i + 1]);
      while (held < hold.size() && hold[held] < here) ++held;
      while (missed < slip.size() && slip[missed] < here) ++missed;
      const double right = static_cast<double>(held) / static_cast<double>(hold.size()) + 1.0 -
                           static_cast<double>(missed) / static_cast<double>(slip.size());
      if (right > accuracy || (right == accuracy && std::abs(here - 0.5) < std::abs(point.threshold - 0.5))) {
        point.threshold = here;
        accuracy = right;
      }
    }
  }
  point.alarms_per_minute = counts_at(series, period, point.threshold, point.alarm).alarms_per_minute(period);
  return point;
}

OperatingPoint best_point(std::span<const SlipSeries> series, double period, std::optional<double> alarms) {
  const auto [hold, slip] = sorted_by_truth(series);
  const bool timeless = std::ranges::all_of(series, [](const SlipSeries& one) { return one.truth.size() < 2; });
  if (timeless || hold.empty() || slip.empty()) return most_accurate_point(series, period);
  constexpr std::size_t steps = 48;
  const std::vector<double> all = merged(hold, slip);
  std::set<double> thresholds{most_accurate_point(series, period).threshold};
  for (std::size_t k = 0; k < steps; ++k) {
    const double above = math::pow(static_cast<double>(hold.size()), 1.0 - static_cast<double>(k) / (steps - 1));
    const double below = hold[hold.size() - static_cast<std::size_t>(above)];
    if (const auto next = std::ranges::upper_bound(all, below); next != all.end()) thresholds.insert(0.5 * (below + *next));
  }
  std::set<std::size_t> rows;
  for (const double seconds : {0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5})
    rows.insert(std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(seconds / period))));

  OperatingPoint best;
  std::pair<double, double> worth{-std::numeric_limits<double>::infinity(), 0.0};  // less alarms too many, then accuracy or score
  for (const std::size_t on : rows) {
    for (const std::size_t off : rows) {
      for (const std::size_t least : {std::size_t{1}, *rows.rbegin()}) {
        for (const double threshold : thresholds) {
          const network::Alarm alarm{on, off, least};
          const AlarmCounts counts = counts_at(series, period, threshold, alarm);
          const double rate = counts.alarms_per_minute(period);
          const std::pair here = alarms ? std::pair{-std::max(rate - *alarms, 0.0), balanced_slip_accuracy(counts.frames)}
                                        : std::pair{0.0, counts.score(period)};
          if (here <= worth) continue;
          worth = here;
          best = {threshold, alarm, rate};
        }
      }
    }
  }
  return best;
}

}  // namespace slipbench::train
