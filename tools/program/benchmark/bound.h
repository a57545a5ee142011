// How early a slip stands out from the sensor's noise if its signal is known beforehand.
#pragma once

#include <cstddef>

#include "sim/scene/scene.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/eval/metrics.h"
#include "tools/program/eval/replay.h"

namespace slipbench::benchmark {

// From so many standard deviations of the noise on slip is said: one false alarm in 740 decisions, one a minute where a decision takes 80 ms.
inline constexpr double bound_deviations = 3.0;

// The same trial on a surface on which nothing slips: equal to the last bit until the first slip, noise included.
Scene without_slip(const Scene& scene);

// Says slip from when the energy of the slip's own signal reaches bound_deviations squared: D^2(t) = sum over values and samples until t of (d - phi d')^2/sigma^2. d is
// the value less that of the trial without slip, d' the sample before; phi is the correlation from one sample to the next of the noise before contact, and
// sigma the innovation's deviation (1.4826 times the median from the median, in contact, without slip), at least the smallest step of the value over
// sqrt(12). That is the matched filter of a known signal in noise of one pole (H. L. Van Trees, Detection, Estimation, and Modulation Theory I, 4.2).
// `record`, `stuck`: the trial and without_slip() of it. Nothing is said before `truth.first_slip`; from then on slip is said
// in the first sample and in all that truly slip.
eval::Replayed signal_known(const TrialRecord& record, const TrialRecord& stuck, std::size_t sensor, const eval::Truth& truth);

}  // namespace slipbench::benchmark
