#include "tools/program/train/network/validation.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>

#include "sim/core/random.h"

namespace slipbench::train {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

void Counts::add(bool slip, bool called) {
  ++(slip ? (called ? slip_called_slip : slip_called_hold) : (called ? hold_called_slip : hold_called_hold));
}

void Counts::add(const Counts& other) {
  slip_called_slip += other.slip_called_slip;
  slip_called_hold += other.slip_called_hold;
  hold_called_slip += other.hold_called_slip;
  hold_called_hold += other.hold_called_hold;
}

double Counts::balanced_accuracy() const {
  return 0.5 * (share(slip_called_slip, slip_called_slip + slip_called_hold) +
                share(hold_called_hold, hold_called_hold + hold_called_slip));
}

double Counts::f1() const { return share(2 * slip_called_slip, 2 * slip_called_slip + slip_called_hold + hold_called_slip); }

std::vector<std::size_t> folds(std::span<const std::size_t> groups, std::size_t count, std::uint64_t seed) {
  if (count < 2) throw std::invalid_argument("fewer than two folds");
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t item = 0; item < groups.size(); ++item) members[groups[item]].push_back(item);
  std::vector<std::size_t> fold_of(groups.size());
  RandomStream random(seed, 0, "folds");
  for (auto& [group, items] : members) {
    for (std::size_t left = items.size(); left > 1; --left) {  // Fisher-Yates
      std::swap(items[left - 1], items[static_cast<std::size_t>(random.integer(left))]);
    }
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
  std::vector<const FrameSequence*> scaled_by;
  for (const FrameSequence& sequence : learnt) scaled_by.push_back(&sequence);
  const Scale scale = scale_of(scaled_by, validation.shape.inputs, validation.scaling);
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

std::vector<Counts> counts_of(std::span<const FoldExample> examples, const Calls& calls) {
  std::size_t groups = 0;
  for (const FoldExample& example : examples) groups = std::max(groups, example.group + 1);
  std::vector<Counts> counts(groups);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    const std::vector<std::uint8_t>& label = examples[i].frames.label;
    for (std::size_t frame = 0; frame < calls[i].size(); ++frame) {
      if (label[frame] != masked && calls[i][frame] != masked)
        counts[examples[i].group].add(label[frame] == 1, calls[i][frame] == 1);
    }
  }
  return counts;
}

}  // namespace slipbench::train
