#include "sim/effects/wave_sum.h"

#include <bit>
#include <numbers>
#include <stdexcept>

#include "sim/core/math.h"

namespace slipbench {

WaveSum::WaveSum(std::size_t points) : turn_(points / 2) {
  if (points < 2 || !std::has_single_bit(points)) throw std::logic_error("WaveSum: the number of points must be a power of two");
  const double step = 2.0 * std::numbers::pi / static_cast<double>(points);
  for (std::size_t k = 0; k < turn_.size(); ++k) {
    const auto [sine, cosine] = math::sincos(step * static_cast<double>(k));
    turn_[k] = {cosine, sine};
  }
}

std::vector<double> WaveSum::at_points(std::span<const std::complex<double>> waves) const {
  const std::size_t points = 2 * turn_.size();
  if (waves.size() > points) throw std::logic_error("WaveSum: more waves than points");
  // Sorted by the bit-reversed index, so that neighbours are combined first.
  std::vector<std::complex<double>> values(points);
  for (std::size_t n = 0, reversed = 0; n < waves.size(); ++n) {
    values[reversed] = waves[n];
    std::size_t bit = points / 2;
    for (; (reversed & bit) != 0; bit /= 2) reversed ^= bit;
    reversed ^= bit;
  }
  for (std::size_t half = 1; half < points; half *= 2) {
    const std::size_t stride = turn_.size() / half;
    for (std::size_t first = 0; first < points; first += 2 * half) {
      for (std::size_t k = 0; k < half; ++k) {
        const std::complex<double>& a = values[first + k];
        const std::complex<double>&b = values[first + half + k], &turn = turn_[k * stride];
        const std::complex<double> turned(b.real() * turn.real() - b.imag() * turn.imag(),
                                          b.real() * turn.imag() + b.imag() * turn.real());
        const std::complex<double> sum = a + turned, difference = a - turned;
        values[first + k] = sum;
        values[first + half + k] = difference;
      }
    }
  }
  std::vector<double> heights;
  heights.reserve(points);
  for (const std::complex<double>& value : values) heights.push_back(value.real());
  return heights;
}

}  // namespace slipbench
