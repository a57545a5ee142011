// Sampling of a surface wave by the points of a unit, whose mean is one reading.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"

namespace slipbench {

// Sampling of a wave exp(i k x) by one unit.
struct UnitSampling {
  double gain = 1.0;         // |sum_j w_j exp(i k x_j)|/sum_j w_j, w_j: normal stiffness; relative amplitude in the reading
  double spacing = 0.0;      // m, distance of neighbouring points; 0: all points coincide
  double phase = 0.0;        // rad, largest |k (x_j - x_i)| of neighbouring points
  std::size_t harmonic = 0;  // least h > 1 with the points in phase: |sum_j w_j exp(i h k x_j)| > 0.9 sum_j w_j; 0: none up to 16
};

// `k`: wave vector in the pad's x and y [rad/m].
//
// A unit of n points at the spacing p along k sums to D = sin(n k p/2)/(n sin(k p/2)). The mean
// over a face of length n p would be sinc(n k p/2), which differs from D by the factor (k
// p/2)/sin(k p/2). The sum vanishes if n p is a whole number of wavelengths and p is not; the
// remaining harmonics have the wavelength p. From k p = pi, half a wavelength, the points do not
// resolve the wave: at p of a whole wavelength they are all in phase, although the mean over a face
// is 0.
UnitSampling sampling_of(const PadLayout& layout, const UnitRange& unit, const Eigen::Vector2d& k);

}  // namespace slipbench
