#include "tools/studies/myrmex_tactile_cnn/myrmex_networks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "sim/core/random.h"
#include "tools/base/files/reject.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/samples/myrmex_images.h"
#include "tools/program/train/network/examples.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/recipes/recipe.h"
#include "tools/studies/grid.h"

namespace slipbench::reproduce {
namespace {

constexpr std::size_t edge = 12, taxels = edge * edge, bins = 32;
constexpr std::size_t cut_bins = 4;  // of 15.625 Hz: 0 to 46.9 Hz, below the paper's 60 Hz
constexpr std::array objects{"cylinder", "remote", "glass"};
constexpr std::size_t usual_draws = 8;           // 64 trials, the paper's
constexpr std::size_t published_steps = 700000;  // "converges after around 700000 iterations" of 64 windows
constexpr std::size_t forward_passes = 201;
constexpr std::array<std::array<double, 2>, 3> published_accuracy{{{91.01, 92.65}, {96.12, 96.5}, {97.45, 97.89}}};

bool of_taxels(MyrmexInput input) {
  return input == MyrmexInput::spectra || input == MyrmexInput::high_pass || input == MyrmexInput::static_image;
}

std::pair<std::size_t, std::size_t> bins_of(MyrmexInput input) {  // first and end
  if (input == MyrmexInput::high_pass) return {cut_bins, bins};
  return {0, input == MyrmexInput::static_image ? 1 : bins};
}

void append(train::FrameSequence& sequence, const std::vector<float>& features, std::uint8_t label) {
  sequence.features.insert(sequence.features.end(), features.begin(), features.end());
  sequence.label.push_back(label);
}

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

// Windows of `left` and `right` of a trial of scenes/myrmex/dataset.yaml: those drawn, and all that are late().
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

}  // namespace

std::size_t inputs_of(MyrmexInput input) {
  const auto [first, end] = bins_of(input);
  switch (input) {
    case MyrmexInput::spectra:
    case MyrmexInput::high_pass:
    case MyrmexInput::static_image: return taxels * (end - first);
    case MyrmexInput::load:
    case MyrmexInput::clock: return 1;
    case MyrmexInput::placement: return 1 + objects.size();
    case MyrmexInput::clock_placement: return 2 + objects.size();
  }
  return 0;
}

std::vector<float> told(const MyrmexTrial& trial, const MyrmexWindow& window, MyrmexInput input) {
  std::vector<float> values;
  if (of_taxels(input)) {
    const auto [first, end] = bins_of(input);
    for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
      const auto at = window.spectra.begin() + static_cast<std::ptrdiff_t>(taxel * bins);
      values.insert(values.end(), at + static_cast<std::ptrdiff_t>(first), at + static_cast<std::ptrdiff_t>(end));
    }
    return values;
  }
  if (input == MyrmexInput::load) {
    double sum = 0.0;
    for (std::size_t taxel = 0; taxel < taxels; ++taxel) sum += static_cast<double>(window.spectra[taxel * bins]);
    return {static_cast<float>(sum / static_cast<double>(taxels))};
  }
  if (input != MyrmexInput::placement) values.push_back(static_cast<float>(window.time));
  if (input == MyrmexInput::clock) return values;
  values.push_back(trial.rotational ? 1.0F : 0.0F);
  for (const char* object : objects) values.push_back(trial.object == object ? 1.0F : 0.0F);
  return values;
}

const char* slip_word(SlipWord word) {
  constexpr std::array<const char*, slip_words> words{"true", "bench", "motion"};
  return words[static_cast<std::size_t>(word)];
}

MyrmexRow network_row(std::size_t net, MyrmexInput input, SlipWord word) {
  const bool passed = input == MyrmexInput::high_pass;
  MyrmexRow row;
  row.name = fmt::format("net_{}{}{}", net, passed ? "_high_pass" : "",
                         word == SlipWord::truth ? std::string() : fmt::format("_{}", slip_word(word)));
  row.text = fmt::format("net {}{}", net, passed ? ", from 62.5 Hz" : "");
  row.layers = fmt::format("myrmex_net{}", net);
  row.input = input;
  row.word = word;
  row.published = published_accuracy.at(net - 1)[passed ? 1 : 0];
  return row;
}

train::NetworkShape shape_of(const MyrmexRow& row) {
  if (row.layers.empty()) return {inputs_of(row.input), {train::Linear{32}, train::Tanh{}, train::Linear{kinds}}};
  train::NetworkShape shape = train::find_recipe(row.layers).network;
  shape.inputs = inputs_of(row.input);
  shape.layers.front() = train::Reshape{{edge, edge, shape.inputs / taxels}};
  return shape;
}

void KindCounts::add(const KindCounts& other) {
  for (std::size_t label = 0; label < kinds; ++label) {
    for (std::size_t called = 0; called < kinds; ++called) windows[label][called] += other.windows[label][called];
  }
}

double KindCounts::share(std::size_t label, std::size_t called) const {
  return share_of(windows[label][called], std::accumulate(windows[label].begin(), windows[label].end(), std::uint64_t{0}));
}

double KindCounts::accuracy() const {
  std::vector<double> recalls;
  for (std::size_t label = 0; label < kinds; ++label) {
    if (const double recall = share(label, label); !std::isnan(recall)) recalls.push_back(recall);
  }
  return mean_sd(recalls).mean;
}

double WrongCount::share() const { return share_of(wrong, all); }

KindCounts MyrmexFigures::all() const {
  KindCounts sum;
  for (const KindCounts& fold : folds) sum.add(fold);
  return sum;
}

std::vector<std::uint8_t> called_kinds(const train::NetworkShape& shape, train::FrameSequence learnt, train::FrameSequence judged,
                                       const train::TrainingOptions& training) {
  const std::array<const train::FrameSequence*, 1> by{&learnt};
  const train::Scale scale = train::scale_of(by, shape.inputs, train::Scaling::standard);
  apply(scale, learnt);
  apply(scale, judged);
  const std::unique_ptr<train::Network> network = train::make_network(shape, training.seed);
  network->train(std::span(&learnt, 1), {}, training);
  const std::vector<float> logits = network->logits(judged.features);
  std::vector<std::uint8_t> called;
  for (auto at = logits.begin(); at != logits.end(); at += kinds)
    called.push_back(static_cast<std::uint8_t>(std::max_element(at, at + kinds) - at));
  return called;
}

MyrmexSize myrmex_size(const ReproduceOptions& options) {
  if (!train::networks_available()) static_cast<void>(train::network_libraries());  // says what is missing before anything is run
  const std::size_t usual_steps = train::find_recipe("myrmex_net3").training.steps;
  MyrmexSize size{options.trials != 0 ? options.trials : usual_draws, options.full ? published_steps : usual_steps,
                  options.full ? std::size_t{11} : std::size_t{0}};
  if (size.draws < 2)
    throw InputError(
        "reproduce: --trials 1: one trial of each object and placement leaves nothing to judge by; allowed: 2 or more");
  return size;
}

std::vector<MyrmexTrial> myrmex_trials(const ReproduceOptions& options, const MyrmexSize& size) {
  WindowOptions windows;
  windows.turned = size.turned;
  windows.seed = options.seed.value_or(1);
  std::vector<MyrmexTrial> trials =
      run_grid<MyrmexTrial>({{"trials", "scenes/myrmex/dataset.yaml", {}, {}, size.draws}}, options, [&](const GridTrial& trial) {
        return myrmex_trial(trial.scene, trial.record(), windows);
      }).front();
  for (const SlipWord word : {SlipWord::truth, SlipWord::bench, SlipWord::motion}) {
    if (balanced_windows(trials, word, false, windows.seed).empty())
      reject("reproduce: {} trials have no window of one of stable, translation and rotation; allowed: more --trials",
             trials.size());
  }
  return trials;
}

std::size_t MyrmexValidations::queue(const MyrmexRow& row, MyrmexSplit split, std::size_t count, std::size_t last) {
  const std::uint64_t seed = options_.seed.value_or(1);
  Plan plan{row, split, balanced_windows(trials_, row.word, row.late, seed), {}};
  plan.fold_of = window_folds(trials_, plan.places, row.word, split, count, seed);
  const std::set<std::size_t> folds(plan.fold_of.begin(), plan.fold_of.end());  // a small set of trials may leave one empty
  for (const std::size_t fold : folds) {
    if (fold < last) tasks_.emplace_back(plans_.size(), fold);
  }
  plans_.push_back(std::move(plan));
  results_.emplace_back();
  return plans_.size() - 1;
}

MyrmexFold MyrmexValidations::judged(const Plan& plan, std::size_t fold) const {
  const auto word = static_cast<std::size_t>(plan.row.word);
  train::FrameSequence learnt, asked;
  std::set<std::size_t> judging;  // trials of which none is learnt from
  std::vector<const MyrmexWindow*> windows;
  const auto ask = [&](const MyrmexTrial& trial, const MyrmexWindow& window) {
    append(asked, told(trial, window, plan.row.input), window.label[word]);
    windows.push_back(&window);
  };
  std::set<std::pair<std::size_t, double>> times;  // of what is learnt, for its turned copies
  for (std::size_t k = 0; k < plan.places.size(); ++k) {
    const MyrmexTrial& trial = trials_[plan.places[k].trial];
    const MyrmexWindow& window = trial.windows[plan.places[k].window];
    if (plan.fold_of[k] == fold) {
      ask(trial, window);
      if (plan.split != MyrmexSplit::window) judging.insert(plan.places[k].trial);
    } else {
      append(learnt, told(trial, window, plan.row.input), window.label[word]);
      times.insert({plan.places[k].trial, window.time});
    }
  }
  for (std::size_t t = 0; t < trials_.size() && of_taxels(plan.row.input); ++t) {
    for (const MyrmexWindow& window : trials_[t].windows) {
      if (window.turn != 0 && window.label[word] != train::masked && times.contains({t, window.time}))
        append(learnt, told(trials_[t], window, plan.row.input), window.label[word]);
    }
  }
  const std::size_t drawn = windows.size();
  for (const std::size_t t : judging) {
    for (const MyrmexWindow& window : trials_[t].windows) {
      if (window.turn == 0 && window.late() && window.label[word] == 0) ask(trials_[t], window);
    }
  }
  train::TrainingOptions training = train::find_recipe("myrmex_net3").training;
  training.steps = size_.steps * plan.row.longer;
  training.seed = options_.seed.value_or(1);
  const std::vector<std::uint8_t> labels = asked.label;
  const std::vector<std::uint8_t> called = called_kinds(shape_of(plan.row), std::move(learnt), std::move(asked), training);
  MyrmexFold result;
  for (std::size_t k = 0; k < called.size(); ++k) {
    const MyrmexWindow& window = *windows[k];
    if (k < drawn) result.counts.add(labels[k], called[k]);
    if (labels[k] != 0) continue;
    if (k >= drawn) result.late.add(called[k] != 0);
    if (k < drawn && std::isnan(window.to_onset)) result.holds.add(called[k] != 0);
    if (k < drawn && window.to_onset > last_seconds) result.earlier.add(called[k] != 0);
  }
  return result;
}

void MyrmexValidations::run() {
  static_cast<void>(train::network_libraries());  // loaded once, not by every child
  const std::vector<std::vector<MyrmexFold>> done = run_in_processes<MyrmexFold>(
      tasks_.size(), options_, [this](std::size_t k) { return plans_[tasks_[k].first].row.text; },
      [this](std::size_t k) { return std::vector{judged(plans_[tasks_[k].first], tasks_[k].second)}; });
  for (std::size_t k = 0; k < tasks_.size(); ++k) {
    MyrmexFigures& figures = results_[tasks_[k].first];
    const MyrmexFold& fold = done[k].front();
    figures.folds.push_back(fold.counts);
    figures.late.add(fold.late);
    figures.earlier.add(fold.earlier);
    figures.holds.add(fold.holds);
  }
}

double forward_seconds(const MyrmexRow& row) {
  const train::NetworkShape shape = shape_of(row);
  const std::unique_ptr<train::Network> network = train::make_network(shape, 1);
  const std::vector<float> window(shape.inputs, 0.5F);
  return median_time(forward_passes, [&] { static_cast<void>(network->logits(window)); });
}

std::string percent_text(double share) { return std::isnan(share) ? "-" : fmt::format("{:.1f}", 100.0 * share); }

std::vector<std::string> myrmex_setup(const ReproduceOptions& options, const MyrmexSize& size,
                                      const std::vector<MyrmexTrial>& trials) {
  const std::uint64_t seed = options.seed.value_or(1);
  const auto slipping = std::ranges::count_if(trials, &MyrmexTrial::slips);
  const auto windows = [&](SlipWord word) { return balanced_windows(trials, word, false, seed).size(); };
  std::size_t placed = 0, moving = 0;
  for (const MyrmexTrial& trial : trials) {
    for (const MyrmexWindow& window : trial.windows) {
      const std::uint8_t label = window.label[static_cast<std::size_t>(SlipWord::motion)];
      if (window.turn != 0 || label == 0 || label == train::masked) continue;
      ++moving;
      placed += (label == 2) == trial.rotational ? 1 : 0;
    }
  }
  return {
      fmt::format("scenes/myrmex/dataset.yaml, seed {}: {} trials (paper: 64), {} of them hold to the end; both arrays.", seed,
                  trials.size(), trials.size() - static_cast<std::size_t>(slipping)),
      fmt::format(
          "Windows of 64 ms at 1 kHz every 8 ms, amplitudes of 12 x 12 x 32, at most 60 of a class, trial and array, then as many of each class: {} by the "
          "true label, {} by the bench's, {} by the motion{}.",
          windows(SlipWord::truth), windows(SlipWord::bench), windows(SlipWord::motion),
          size.turned == 0 ? "; images as recorded"
                           : fmt::format("; {} copies of each, turned, are learnt from as well", size.turned)),
      fmt::format("{} steps of 64 windows by Adam (paper: about {}); the last state is judged.", size.steps, published_steps),
      "Label true: from when slipping taxels carry half of the load on both pads until one has lost contact; class by how the object was placed.",
      "Label bench, the paper's: from when the sum of the third sensor falls (mean of 100 ms, 3 sd) until the arrays' sums are at rest; class likewise.",
      "Label motion: as true, with the class of the rigid motion that fits the slip of the taxels, the part with more energy.",
      fmt::format("The motion names the class of the placement in {} % of the true slip.",
                  percent_text(static_cast<double>(placed) / static_cast<double>(moving))),
      "Accuracy: mean of the shares of stable, translation and rotation that are called so, of all folds together. High pass: the bins from 62.5 Hz on."};
}

std::uint8_t kind_at(double t, const SlipSpan& span, std::uint8_t kind) {
  if (t > span.end) return train::masked;
  return span.onset && t >= *span.onset ? kind : std::uint8_t{0};
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
