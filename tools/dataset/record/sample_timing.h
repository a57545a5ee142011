// Spacing of a recording's time stamps, and the sampling rate.
#pragma once

#include <span>
#include <string>

namespace slipbench {

// Two rates within this relative difference are equal: recorders' clocks are off by some 0.1 %.
inline constexpr double rate_tolerance = 0.01;

// True if `rate` is within rate_tolerance of `wanted` [Hz].
bool same_rate(double rate, double wanted);

struct SampleTiming {
  double resolution = 0.0;      // s, least possible difference of two stamps
  double mean_rate = 0.0;       // Hz, steps over duration
  double median_rate = 0.0;     // Hz, one over the median step
  double largest_gap = 0.0;     // s, the longest step
  double largest_gap_at = 0.0;  // s, stamp at which that step begins
};

// `times`: at least two rising stamps [s]. `resolution` [s]: that of the stamps in the source; the
// spacing of doubles at the largest stamp is added.
SampleTiming timing_of(std::span<const double> times, double resolution);

// Sampling rate [Hz]. With n stamps from t_0 to t_{n-1} of resolution q the rate is within (n -
// 1)/(t_{n-1} - t_0 +- q). Returns the value with the fewest significant digits in this interval,
// or the nearest of them to (n - 1)/(t_{n-1} - t_0): 44,100 Hz from stamps in ns, 444 Hz from
// stamps in ms. Arguments as for timing_of().
double rate_of(std::span<const double> times, double resolution);

// True if mean step, median step and longest step differ by more than rate_tolerance of the mean
// step and the stamps' resolution.
bool steps_vary(const SampleTiming& timing);

// True if sample indices can replace time. With the mean step p and the stamps' resolution q: the
// median step is p within rate_tolerance p + q, and |t_j - t_i - (j - i) p| <= rate_tolerance (j -
// i) p + p/2 + q for all i < j. So no sample is missing and no interval has another rate. Fewer
// than two samples count as even.
bool evenly_spaced(std::span<const double> times, double resolution);

// "92.3 Hz on average, 100 Hz by the median step, longest step 0.51 s, 2.99 s after the first
// sample". `first`: the first stamp [s].
std::string timing_text(const SampleTiming& timing, double first);

}  // namespace slipbench
