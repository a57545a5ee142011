// What counts of a detector's answers come to.
#pragma once

#include <array>
#include <cstddef>

#include "sim/core/pad_state.h"

namespace slipbench {

// Number of samples in each PadState.
using StateCounts = std::array<std::size_t, 4>;

// Samples by true state (strict) and by detector class: [truth][class].
using Confusion = std::array<StateCounts, 4>;

// One more sample; or of one that slips or holds, gross or non_slip.
void count(Confusion& confusion, PadState truth, PadState seen);
void count(Confusion& confusion, bool slips, bool seen);
void add(Confusion& sum, const Confusion& other);

// All shares below are of the samples in contact, 0 to 1; NaN where there is none to take a share of. The class no_contact, which
// is also "nothing seen yet", is wrong there. Incipient and gross are slip.

// Number of samples whose true state is `truth`, and of those seen as `seen`.
std::size_t samples_in(const Confusion& confusion, PadState truth);
std::size_t samples_in(const Confusion& confusion, PadState truth, PadState seen);
std::size_t samples_in_contact(const Confusion& confusion);
// Share of the samples of a true state that have its class.
double recall(const Confusion& confusion, PadState truth);
// Share of the samples that truly slip that are seen as slip, whichever of the two. Always "gross" has 1: read it beside the
// next.
double recall_of_slip(const Confusion& confusion);
// Mean of recall() over the k states that occur. Every answer that is always the same one of them has 1/k.
double balanced_accuracy(const Confusion& confusion);
// That 1/k.
double constant_balanced_accuracy(const Confusion& confusion);
// Share that have their true state's class. It goes by what is common: see the next.
double accuracy(const Confusion& confusion);
// The accuracy of the best answer that is always the same: the share of the commonest state.
double constant_accuracy(const Confusion& confusion);

// The two below ask of every sample, in contact or not, whether it slips: what touches nothing does not, and no_contact is an answer of no slip.

// Mean of recall_of_slip() and of the share of the samples without slip that are not seen as slip: 1/2 for any constant answer. NaN where one of
// the two does not occur.
double balanced_slip_accuracy(const Confusion& confusion);
// 2 P R/(P + R) of slip, P the share of slip among the samples seen as slip and R recall_of_slip(). NaN where nothing slips or is seen to.
double f1_of_slip(const Confusion& confusion);

}  // namespace slipbench
