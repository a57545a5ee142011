// No slip, linear or rotational slip, from the three features of the nib pad's paper.
#pragma once

#include <cstdint>
#include <memory>

#include "detectors/nib/features.h"
#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {
namespace nib {

// Values are those of the feature `kind`.
enum class SlipKind : std::uint8_t { none = 0, linear = 1, rotational = 2 };

// Bounds in the space of the features, which the paper draws (Fig. 12) and gives no numbers for.
struct KindBounds {
  double fl, fr;  // counts: a magnitude above its bound is a slip
  double curl;    // |curl| from which on it is a rotation
};

SlipKind slip_kind(const Features& features, const KindBounds& bounds);

}  // namespace nib

// The catalogue's entry.
Entry nib_slip_kind_entry();

// `parameters`: those of nib_slip_kind_entry(), all present. `source` must be a nib pad (detectors/nib/features.h). An estimate a
// frame, without latency: no_contact, non_slip, gross. It hands on the features of nib::handed_on() and `kind`.
std::unique_ptr<Detector> make_nib_slip_kind(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench
