#include "tools/train/network/split.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/core/choice.h"
#include "sim/core/math.h"
#include "sim/core/random.h"
#include "tools/files/reject.h"

namespace slipbench::train {
namespace {

// Group of an example in the split. `experiment`: the first trial with the example's truth.
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

// Key by which trials are divided separately: their classes, and contact.
using Kinds = std::set<int>;

void add_kinds(Kinds& kinds, const Example& example) {
  constexpr int touching = -1;
  if (example.touches) kinds.insert(touching);
  for (const std::uint8_t label : example.frames.label) {
    if (label != masked) kinds.insert(label);
  }
}

// Selects `share` of the shuffled `items`, rounded up in total, in proportion from each kind of
// `kind_of`.
template <class Item, class Kind>
std::vector<Item> dealt(std::vector<Item> items, double share, RandomStream& random, Kind&& kind_of) {
  const auto wanted = static_cast<std::size_t>(std::ceil(share * static_cast<double>(items.size()) - 1e-9));
  shuffle(items, random);
  // Interleaves the kinds by relative rank, so that every prefix has all kinds in proportion.
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

// The parts of examples outside of a dataset's own split, in their order.
std::vector<Part> dealt_parts(std::span<const Example* const> examples, Split split, double held_out, std::uint64_t seed) {
  const std::string word = choice_name(split_words, split);
  std::map<std::string, Kinds> groups;
  std::map<std::size_t, Kinds> kinds_of_trial;
  std::map<std::size_t, std::string> of_trial;  // group of each trial
  std::map<std::string, std::size_t> experiments;
  for (const Example* const one : examples) {
    const Example& example = *one;
    const std::size_t experiment = example.twin.empty()
                                       ? example.trial
                                       : experiments.try_emplace(example.sensor + example.twin, example.trial).first->second;
    const std::string group = group_of(example, experiment, split);
    if (group.empty())
      reject(
          "trial {}: the dataset does not sweep {}, so it cannot be split by it; use --split trial, or a dataset that sweeps it",
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
    reject("{} different {} are too few for training, validation and test; at least three are needed; choose another --split",
           groups.size(), split == Split::trial ? "experiments" : word + "s");
  }
  return parts;
}

}  // namespace

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
    const std::vector<Part> dealt_to = dealt_parts(dealt, by, judging, seed);
    for (std::size_t i = 0; i < dealt.size(); ++i) parts[static_cast<std::size_t>(dealt[i] - examples.data())] = dealt_to[i];
  };
  if (!undivided.empty()) deal(undivided, split, held_out);
  if (!validates && !training.empty()) deal(training, Split::trial, 0.0);
  return parts;
}

}  // namespace slipbench::train
