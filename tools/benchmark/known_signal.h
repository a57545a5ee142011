// The earliest time at which a slip stands out from the sensor's noise, if its signal is known
// beforehand.
#pragma once

#include <cstddef>

#include "sim/scene/scene.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"

namespace slipbench::benchmark {

// Slip is reported when its signal exceeds the noise by so many standard deviations: one false
// alarm in 740 decisions, which is one a minute if a decision takes 80 ms.
inline constexpr double known_signal_deviations = 3.0;

// Returns the same scene with a surface on which nothing slips. Its trials are bit-identical until
// the first slip, noise included.
Scene without_slip(const Scene& scene);

// Returns the answers of a detector that never reports slip.
eval::Replayed no_reports(const eval::Truth& truth);

// Returns the answers of a matched filter for a known signal in noise of one pole (H. L. Van Trees,
// Detection, Estimation, and Modulation Theory I, 4.2). It reports slip when the energy of the
// slip's own signal reaches known_signal_deviations squared:
//   D^2(t) = sum over values and samples until t of (d - phi d')^2/sigma^2
// d      difference to the trial without slip, from truth.first_slip on, minus the difference that
// an
//        earlier slip has left
// d'     d one sample before phi    correlation of the noise from one sample to the next, before
// contact sigma  standard deviation of the noise that a sample adds, from second differences in
// contact and
//        without slip, which a steady or ramped load does not change: 1.4826 times their median deviation
//        from the median, times sqrt((1 + phi)/(2 (3 - phi))); at least the value's smallest step over
//        sqrt(12)
// `record`, `slipless`: the trial and the same trial of without_slip(). `sensor`: its number in both.
// Nothing is reported before `truth.first_slip`; from the decision on, slip is reported in the
// first sample and in all samples that truly slip.
eval::Replayed signal_known(const TrialRecord& record, const TrialRecord& slipless, std::size_t sensor, const eval::Truth& truth);

}  // namespace slipbench::benchmark
