// Scores of a detector's answers, from counts.
#pragma once

#include <array>
#include <cstddef>

#include "sim/api/pad_state.h"

namespace slipbench {

// Number of samples in each PadState.
using StateCounts = std::array<std::size_t, 4>;

// Samples by true state (strict) and by detector class: [truth][class].
using Confusion = std::array<StateCounts, 4>;

// Counts one sample; the second form takes slip or hold, as gross or non_slip.
void count(Confusion& confusion, PadState truth, PadState seen);
void count(Confusion& confusion, bool slips, bool seen);
void add(Confusion& sum, const Confusion& other);

// All shares below are of the samples in contact, 0 to 1; NaN without such samples. The class
// no_contact, which also means "nothing seen yet", counts as wrong there. Incipient and gross are
// slip.

// Number of samples with true state `truth`, and number of them seen as `seen`.
std::size_t samples_in(const Confusion& confusion, PadState truth);
std::size_t samples_in(const Confusion& confusion, PadState truth, PadState seen);
std::size_t samples_in_contact(const Confusion& confusion);
// Share of the samples of a true state that have its class.
double recall(const Confusion& confusion, PadState truth);
// Share of the truly slipping samples that are seen as slip, incipient or gross. A constant answer
// "gross" scores 1: read it with balanced_accuracy().
double recall_of_slip(const Confusion& confusion);
// Mean of recall() over the k states that occur. A constant answer that is one of them scores 1/k.
double balanced_accuracy(const Confusion& confusion);
// 1/k as above.
double constant_balanced_accuracy(const Confusion& confusion);
// Share of samples that have their true state's class. Common states dominate it: compare with
// constant_accuracy().
double accuracy(const Confusion& confusion);
// Accuracy of the best constant answer: the share of the most frequent state.
double constant_accuracy(const Confusion& confusion);

// The two scores below cover all samples, with and without contact. A sample without contact does
// not slip, and the answer no_contact counts as no slip.

// Mean of recall_of_slip() and of the share of the samples without slip that are not seen as slip:
// 1/2 for any constant answer. NaN if one of the two does not occur.
double balanced_slip_accuracy(const Confusion& confusion);
// 2 P R/(P + R) of slip, with P the share of slip among the samples seen as slip and R
// recall_of_slip(). NaN if nothing slips or is seen as slip.
double f1_of_slip(const Confusion& confusion);

}  // namespace slipbench
