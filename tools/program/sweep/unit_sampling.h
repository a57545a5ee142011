// How the points of a unit, which together are one reading, sample a wave of the surface.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"

namespace slipbench {

// Of a wave exp(i k x) under one unit.
struct UnitSampling {
  double gain = 1.0;     // |sum_j w_j exp(i k x_j)|/sum_j w_j, w_j: normal stiffness; what the reading keeps of the wave
  double spacing = 0.0;  // m, from a point to those next to it; 0: all points of the unit are at one place
  double phase = 0.0;    // rad, largest |k (x_j - x_i)| of two points that are next to each other
  std::size_t harmonic =
      0;  // the least h > 1 of which the points are in phase: |sum_j w_j exp(i h k x_j)| > 0.9 sum_j w_j; 0: none up to 16
};

// `k`: the wave's vector in the pad's x and y [rad/m].
//
// A unit of n points at the spacing p along k sums to D = sin(n k p/2)/(n sin(k p/2)); the mean
// over a face of the length n p would be sinc(n k p/2), which differs from it by the factor (k
// p/2)/sin(k p/2). The sum vanishes where n p is a whole number of wavelengths and p is not: the
// harmonics that are left have the wavelength p. From k p = pi on, half a wavelength, the points do
// not resolve the wave: at p of a whole wavelength they are all in phase, where the mean over a
// face is 0.
UnitSampling sampling_of(const PadLayout& layout, const UnitRange& unit, const Eigen::Vector2d& k);

}  // namespace slipbench
