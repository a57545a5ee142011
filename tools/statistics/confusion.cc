#include "tools/statistics/confusion.h"

#include <algorithm>
#include <numeric>

#include "tools/statistics/descriptive.h"

namespace slipbench {
namespace {

constexpr std::array contact_states{PadState::non_slip, PadState::incipient, PadState::gross};
constexpr std::array slip_states{PadState::incipient, PadState::gross};

// Recalls of the states that occur.
std::vector<double> recalls(const Confusion& confusion) {
  std::vector<double> found;
  for (const PadState truth : contact_states) {
    if (samples_in(confusion, truth) > 0) found.push_back(recall(confusion, truth));
  }
  return found;
}

}  // namespace

void count(Confusion& confusion, PadState truth, PadState seen) {
  ++confusion[static_cast<std::size_t>(truth)][static_cast<std::size_t>(seen)];
}

void count(Confusion& confusion, bool slips, bool seen) {
  count(confusion, slips ? PadState::gross : PadState::non_slip, seen ? PadState::gross : PadState::non_slip);
}

void add(Confusion& sum, const Confusion& other) {
  for (std::size_t truth = 0; truth < sum.size(); ++truth) {
    for (std::size_t seen = 0; seen < sum.size(); ++seen) sum[truth][seen] += other[truth][seen];
  }
}

std::size_t samples_in(const Confusion& confusion, PadState truth) {
  const StateCounts& row = confusion[static_cast<std::size_t>(truth)];
  return std::accumulate(row.begin(), row.end(), std::size_t{0});
}

std::size_t samples_in(const Confusion& confusion, PadState truth, PadState seen) {
  return confusion[static_cast<std::size_t>(truth)][static_cast<std::size_t>(seen)];
}

std::size_t samples_in_contact(const Confusion& confusion) {
  std::size_t all = 0;
  for (const PadState truth : contact_states) all += samples_in(confusion, truth);
  return all;
}

double recall(const Confusion& confusion, PadState truth) {
  return share_of(samples_in(confusion, truth, truth), samples_in(confusion, truth));
}

double recall_of_slip(const Confusion& confusion) {
  std::size_t seen = 0;
  std::size_t all = 0;
  for (const PadState truth : slip_states) {
    for (const PadState answer : slip_states) seen += samples_in(confusion, truth, answer);
    all += samples_in(confusion, truth);
  }
  return share_of(seen, all);
}

double balanced_accuracy(const Confusion& confusion) { return mean_sd(recalls(confusion)).mean; }

double constant_balanced_accuracy(const Confusion& confusion) { return share_of(1, recalls(confusion).size()); }

double accuracy(const Confusion& confusion) {
  std::size_t right = 0;
  for (const PadState truth : contact_states) right += samples_in(confusion, truth, truth);
  return share_of(right, samples_in_contact(confusion));
}

double constant_accuracy(const Confusion& confusion) {
  std::size_t most = 0;
  for (const PadState truth : contact_states) most = std::max(most, samples_in(confusion, truth));
  return share_of(most, samples_in_contact(confusion));
}

double balanced_slip_accuracy(const Confusion& confusion) {
  std::size_t quiet = 0, still = 0;
  for (const PadState truth : {PadState::no_contact, PadState::non_slip}) {
    for (const PadState answer : {PadState::no_contact, PadState::non_slip}) quiet += samples_in(confusion, truth, answer);
    still += samples_in(confusion, truth);
  }
  return 0.5 * (recall_of_slip(confusion) + share_of(quiet, still));
}

double f1_of_slip(const Confusion& confusion) {
  std::size_t right = 0, slips = 0, called = 0;
  for (const PadState slip : slip_states) {
    for (const PadState answer : slip_states) right += samples_in(confusion, slip, answer);
    slips += samples_in(confusion, slip);
    for (const StateCounts& row : confusion) called += row[static_cast<std::size_t>(slip)];
  }
  return share_of(2 * right, slips + called);
}

}  // namespace slipbench
