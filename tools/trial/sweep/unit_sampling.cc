#include "tools/trial/sweep/unit_sampling.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <span>

#include "sim/core/math.h"

namespace slipbench {
namespace {

constexpr double same_place = 1e-9;  // m
constexpr std::size_t most_harmonics = 16;

Eigen::Vector2d place_of(const Element& element) { return element.tip.head<2>(); }

double gain_of(std::span<const Element> points, const Eigen::Vector2d& k) {
  std::complex<double> sum;
  double weight = 0.0;
  for (const Element& point : points) {
    const auto [sine, cosine] = math::sincos(k.dot(place_of(point)));
    sum += point.k_normal * std::complex<double>(cosine, sine);
    weight += point.k_normal;
  }
  return math::hypot(sum.real(), sum.imag()) / weight;
}

}  // namespace

UnitSampling sampling_of(const PadLayout& layout, const UnitRange& unit, const Eigen::Vector2d& k) {
  const std::span<const Element> points = std::span(layout.elements).subspan(unit.first, unit.count);
  UnitSampling sampling{.gain = gain_of(points, k)};
  for (const Element& point : points) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Element& other : points) {
      const double distance = (place_of(other) - place_of(point)).norm();
      if (distance > same_place) nearest = std::min(nearest, distance);
    }
    for (const Element& other : points) {
      const Eigen::Vector2d apart = place_of(other) - place_of(point);
      if (apart.norm() > same_place && apart.norm() < 1.001 * nearest)
        sampling.phase = std::max(sampling.phase, std::abs(k.dot(apart)));
    }
    if (std::isfinite(nearest)) sampling.spacing = std::max(sampling.spacing, nearest);
  }
  for (std::size_t h = 2; h <= most_harmonics && sampling.harmonic == 0; ++h) {
    if (gain_of(points, static_cast<double>(h) * k) > 0.9) sampling.harmonic = h;
  }
  return sampling;
}

}  // namespace slipbench
