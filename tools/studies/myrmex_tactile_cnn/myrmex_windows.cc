#include "tools/studies/myrmex_tactile_cnn/myrmex_windows.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "sim/core/random.h"
#include "tools/program/samples/myrmex_images.h"
#include "tools/program/train/network/examples.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/recipes/recipe.h"
#include "tools/studies/myrmex_tactile_cnn/myrmex_onset.h"

namespace slipbench::reproduce {
namespace {

// Of the third sensor: its sum's mean of 100 ms lies 3 sd below its rest. That reading of the paper's rule has an onset in every trial that slips.
constexpr OnsetRule sinks{0.1, 3.0};

// Of one array: at most so many of each class.
void draw_windows(std::vector<MyrmexWindow>& windows, std::size_t word, std::size_t at_most, RandomStream& random) {
  std::map<std::uint8_t, std::vector<std::size_t>> of_class;
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (windows[k].label[word] != train::masked) of_class[windows[k].label[word]].push_back(k);
  }
  for (auto& [label, numbers] : of_class) {
    for (std::size_t i = 0; i < std::min(at_most, numbers.size()); ++i) {
      std::swap(numbers[i], numbers[i + random.integer(numbers.size() - i)]);
      windows[numbers[i]].drawn[word] = true;
    }
  }
}

}  // namespace

std::uint8_t kind_at(double t, const SlipSpan& span, std::uint8_t kind) {
  if (t > span.end) return train::masked;
  return span.onset && t >= *span.onset ? kind : std::uint8_t{0};
}

MyrmexTrial myrmex_trial(const Scene& scene, const TrialRecord& record, const WindowOptions& options) {
  const SensorRecord &left = bench_sensor(record, "left"), &right = bench_sensor(record, "right"),
                     &top = bench_sensor(record, "top");
  const TrueSlip slip = true_slip(left, right, bench_apart);
  const SlipSpan real{slip.onset, slip.end};
  SlipSpan labelled{{}, contact_end(left, right, sum_end())};
  // A trial that holds is known to: its third sensor may still drift below a threshold.
  if (real.onset)
    labelled.onset = decrease_onset(top.time, sum_of_contacts(top), sinks, bench_settled, bench_apart, labelled.end);
  MyrmexTrial trial{object_name(scene.bodies.front()), is_rotational(scene.bodies.front()), real.onset.has_value(), {}};
  const std::uint8_t placed = trial.rotational ? 2 : 1;
  train::ExampleOptions how;
  how.input = train::find_recipe("myrmex_net3").input;
  how.classes = train::ClassRule::kind;
  RandomStream random(options.seed, record.trial, "windows");
  for (const SensorRecord* array : {&left, &right}) {
    const train::Example example = train::example_of(record, *array, how);
    const std::size_t size = example.frames.features.size() / example.time.size();
    std::vector<MyrmexWindow> windows(example.time.size());
    for (std::size_t k = 0; k < windows.size(); ++k) {
      MyrmexWindow& window = windows[k];
      window.time = example.time[k];
      if (real.onset) window.to_onset = *real.onset - window.time;
      // While half of the load slips something moves, but for a single sample whose motion is that of no unit.
      const std::uint8_t moves = example.frames.label[k] == 0 ? train::masked : example.frames.label[k];
      window.label = {kind_at(window.time, real, placed), kind_at(window.time, labelled, placed),
                      kind_at(window.time, real, moves)};
    }
    for (std::size_t word = 0; word < slip_words; ++word) draw_windows(windows, word, options.at_most, random);
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < windows.size(); ++k) {
      if (std::ranges::find(windows[k].drawn, true) != windows[k].drawn.end() || windows[k].late()) kept.push_back(k);
    }
    const auto take = [&](const std::vector<float>& features, std::uint8_t turn) {
      for (const std::size_t k : kept) {
        MyrmexWindow& window = trial.windows.emplace_back(windows[k]);
        const auto from = features.begin() + static_cast<std::ptrdiff_t>(k * size);
        window.spectra.assign(from, from + static_cast<std::ptrdiff_t>(size));
        window.turn = turn;
      }
    };
    take(example.frames.features, 0);
    std::vector<std::size_t> turns(rotations - 1);
    std::iota(turns.begin(), turns.end(), 1U);
    for (std::size_t copy = 0; copy < options.turned; ++copy) {
      std::swap(turns[copy], turns[copy + random.integer(turns.size() - copy)]);
      take(train::example_of(record, *array, how, turns[copy]).frames.features, static_cast<std::uint8_t>(turns[copy]));
    }
  }
  return trial;
}

std::vector<WindowPlace> balanced_windows(const std::vector<MyrmexTrial>& trials, SlipWord word, bool late, std::uint64_t seed) {
  const auto by = static_cast<std::size_t>(word);
  std::array<std::vector<WindowPlace>, kinds> of_class;
  for (std::size_t t = 0; t < trials.size(); ++t) {
    for (std::size_t w = 0; w < trials[t].windows.size(); ++w) {
      const MyrmexWindow& window = trials[t].windows[w];
      const std::uint8_t label = window.label[by];
      if (window.turn != 0 || label >= kinds) continue;
      if (late && label == 0 ? window.late() : window.drawn[by]) of_class[label].push_back({t, w});
    }
  }
  std::size_t least = of_class[0].size();
  for (const std::vector<WindowPlace>& places : of_class) least = std::min(least, places.size());
  RandomStream random(seed, 0, "balance");
  std::vector<WindowPlace> all;
  for (std::vector<WindowPlace>& places : of_class) {
    for (std::size_t i = 0; i < least; ++i) {
      std::swap(places[i], places[i + random.integer(places.size() - i)]);
      all.push_back(places[i]);
    }
  }
  std::ranges::sort(all, {}, [](const WindowPlace& place) { return std::pair{place.trial, place.window}; });
  return all;
}

std::vector<std::size_t> window_folds(const std::vector<MyrmexTrial>& trials, const std::vector<WindowPlace>& places,
                                      SlipWord word, MyrmexSplit split, std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> fold_of;
  if (split == MyrmexSplit::window) {
    std::array<std::size_t, kinds> seen{};
    for (const WindowPlace& place : places)
      fold_of.push_back(seen[trials[place.trial].windows[place.window].label[static_cast<std::size_t>(word)]]++ % count);
    return fold_of;
  }
  std::map<std::string, std::size_t> groups;
  const auto number_of = [&](const std::string& group) { return groups.try_emplace(group, groups.size()).first->second; };
  std::vector<std::size_t> of_trial;
  for (const MyrmexTrial& trial : trials) {
    of_trial.push_back(number_of(
        split == MyrmexSplit::object ? trial.object : fmt::format("{} {} {}", trial.object, trial.rotational, trial.slips)));
  }
  if (split == MyrmexSplit::trial) of_trial = train::folds(of_trial, count, seed);
  for (const WindowPlace& place : places) fold_of.push_back(of_trial[place.trial]);
  return fold_of;
}

}  // namespace slipbench::reproduce
