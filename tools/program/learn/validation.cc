#include "tools/program/learn/validation.h"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>

#include "sim/core/random.h"
#include "tools/program/learn/frames.h"

namespace slipbench::learn {
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

std::vector<Counts> judge_fold(std::span<const Example> examples, std::span<const std::size_t> fold_of, std::size_t fold,
                               const Validation& validation) {
  std::vector<FrameSequence> learnt;
  std::size_t groups = 0;
  for (std::size_t i = 0; i < examples.size(); ++i) {
    groups = std::max(groups, examples[i].group + 1);
    if (fold_of[i] != fold && validation.learns(examples[i].group)) learnt.push_back(examples[i].frames);
  }
  const Standardiser standardise(learnt, validation.shape.inputs);
  for (FrameSequence& sequence : learnt) sequence = standardise(std::move(sequence));
  const std::unique_ptr<Network> network = make_network(validation.shape, validation.training.seed);
  network->train(learnt, validation.training);
  std::vector<Counts> counts(groups);
  for (std::size_t i = 0; i < examples.size(); ++i) {
    if (fold_of[i] != fold) continue;
    const FrameSequence judged = standardise(examples[i].frames);
    const std::vector<float> odds = network->log_odds(judged.features);
    for (std::size_t frame = 0; frame < odds.size(); ++frame) {
      counts[examples[i].group].add(judged.slip[frame] != 0, odds[frame] > 0.0F);
    }
  }
  return counts;
}

}  // namespace slipbench::learn
