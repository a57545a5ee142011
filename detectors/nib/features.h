// The nib pad's static image: what the 36 electrodes of its nine taxels say of normal and shear load.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "detectors/spectral/spectral_features.h"
#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench::nib {

// Short-time spectra of a sampled signal, as the nib pad's slip detection takes them.

// Spectrum of one stretch of N samples d_n:
//   X_k = sum_n w_n (d_n - l_n) exp(-2 pi i k n/N),  k = 0 to N/2
// l: the straight line of least squares through d; w_n = 0.54 - 0.46 cos(2 pi n/N), Hamming's window with period N, whose sum is 0.54 N exactly.
// Nothing is divided by: |X_k| is in the samples' own unit, and a sine of amplitude A at the middle of a bin has |X_k| = 0.54 N A/2, less
// what the line takes from it.
class WindowSpectrum {
 public:
  // `size`: N, at least 4; `rate` [Hz] of the samples.
  WindowSpectrum(std::size_t size, double rate);

  [[nodiscard]] std::size_t size() const { return window_.size(); }
  [[nodiscard]] double bin_width() const { return rate_ / static_cast<double>(size()); }  // Hz, rate/N

  // |X_k| of `samples`, which must be N: [N/2 + 1]. Valid until the next call.
  std::span<const double> magnitudes(std::span<const double> samples);

 private:
  double rate_;  // Hz
  RealFft fft_;
  std::vector<double> window_, magnitudes_;
};

// Spectra of a signal as it comes in: one of the last `window`, a `hop` after the other.
class SlidingSpectrum {
 public:
  // Both lengths in samples; `hop` at least 1.
  SlidingSpectrum(std::size_t window, std::size_t hop, double rate);

  // Takes the next sample. Whether it completed a window whose spectrum is due: the first when `window` samples are there, then
  // every `hop`.
  bool push(double sample);

  // Mean of the magnitudes of the spectrum made last over the bins from `low` to `high` [Hz], both included; 0 before the first.
  // Throws std::invalid_argument where no bin is between them.
  [[nodiscard]] double band_mean(double low, double high) const;
  // The spectrum made last; empty before the first.
  [[nodiscard]] std::span<const double> magnitudes() const { return magnitudes_; }

 private:
  WindowSpectrum spectrum_;
  std::size_t hop_;
  std::vector<double> ring_, ordered_, magnitudes_;
  std::size_t next_ = 0;  // place in the ring
  std::size_t missing_;   // samples until the next spectrum
};

// A taxel has index 3*row + column, rows from north (+y) to south, columns from west (-x) to east, and its electrodes the order W, N, E, S.
inline constexpr std::size_t taxels = 9;
inline constexpr std::size_t electrodes = 4;

// Changes of capacitance against the unloaded pad, in counts.
struct ShearField {
  std::array<double, taxels> normal{};          // W + N + E + S: grows with compression
  std::array<Eigen::Vector2d, taxels> shear{};  // (E - W, N - S): points where the surface drags the nibs

  [[nodiscard]] double total_normal() const;
  [[nodiscard]] Eigen::Vector2d total_shear() const;
};

// Equations (1) and (2) of the paper. `change`: [9,4] counts.
ShearField shear_field(std::span<const double, taxels * electrodes> change);

// Curl of the shear about the centre taxel with the distance of taxels as unit length [counts]: the slopes dFy/dx - dFx/dy of the straight
// lines of least squares over all nine taxels. A rigid rotation F = w (-y, x) has 2 w, a translation 0.
double curl(const ShearField& field);

// The same of the field divided by the mean length of its nine vectors; without shear 0. A rigid rotation about the centre taxel has
// +-9/(2 + 2 sqrt 2) = 1.864, a translation 0; no field has more than 1.5 sqrt 2, which takes shear at the corners alone. Dimensionless.
double normalised_curl(const ShearField& field);

// What the nib pad's slip detection looks at: spectra of its two fast modes, and normal load, shear and curl of its image.

// Magnitudes are means over the bins of a band, of D = C_1 - C_2 of a mode (SlidingSpectrum) [counts]; 0 until the first window is full. The rest is 0
// until the pad is tared.
struct Features {
  double fl = 0.0, fl_fast = 0.0;   // linear mode: 0 to 6 Hz, 6 to 8 Hz
  double fr = 0.0, fr_fast = 0.0;   // rotational mode: likewise
  double curl = 0.0;                // normalised_curl(), of the image at hand
  double normal = 0.0;              // counts, sum of all taxels' W + N + E + S
  Eigen::Vector2d shear{0.0, 0.0};  // counts, sum of all taxels' (E - W, N - S)
};

// The declarations that every detector of the nib pad has: window, hop, tare, touch, capacitance, normal_gain, shear_gain, pitch.
std::vector<ParameterSpec> feature_specs();

// What every detector of the nib pad hands on (SlipEstimate::features), in this order: fl_0_6, fl_6_8, fr_0_6, fr_6_8 [counts], curl, normal and
// shear [N], moment [N m].
const std::vector<Feature>& handed_on();

// Makes features of frames, one after the other.
class FeatureReader {
 public:
  // `source` must have the channels si {9,4}, fl {2} and fr {2} [counts]. `detector` names who asks. Throws SceneValueError where it has
  // not, where window or hop are no whole number of its frames, or where `window` has fewer than four of them, or its bins end below 8 Hz.
  FeatureReader(const Parameters& parameters, const FrameSource& source, const std::string& detector);

  // Takes the next frame. Whether there are new spectra.
  bool update(const SensorFrame& frame);

  [[nodiscard]] const Features& features() const { return features_; }
  // Whether the pad has been tared and feels more than `touch`.
  [[nodiscard]] bool touching() const { return tared_ && features_.normal >= touch_; }

  // The calibrated loads. A plate capacitor of C counts at rest whose gap has closed by the share x counts C x/(1 - x) more, so that a
  // change c says C x = c/(1 + c/C): of that the loads are linear, of c they are not. Where a nib leans its four electrodes' changes have a
  // sum, their shares have none. What is left is what a taxel's four nibs differ by, and the lean that the fabric's mask ends.
  [[nodiscard]] double normal_force() const { return closed_.total_normal() / normal_gain_; }        // N
  [[nodiscard]] Eigen::Vector2d shear_force() const { return closed_.total_shear() / shear_gain_; }  // N
  // N m, about the pad's normal through the centre taxel, of the taxels' shear at their middles. What the nibs of a taxel turn about its
  // middle is not in it: 3 in 35 of what a rigid rotation does.
  [[nodiscard]] double moment() const { return 6.0 * pitch_ * curl(closed_) / shear_gain_; }

  // Writes the values of handed_on(); NaN where they are not known yet.
  void hand_on(std::vector<double>& values) const;

 private:
  static constexpr std::size_t values = taxels * electrodes;
  void read_image(const SensorFrame& frame);

  std::size_t image_, linear_, rotational_;  // places in a frame
  double touch_, capacitance_, normal_gain_, shear_gain_, pitch_;
  SlidingSpectrum linear_spectrum_, rotational_spectrum_;
  std::size_t frames_ = 0, skipped_, tare_end_;  // frames seen; those before the first whole image; the last that the tare takes
  bool tared_ = false, transformed_ = false;
  std::array<double, values> tare_{};  // counts; while it is being taken, their sum
  Features features_;
  ShearField closed_;  // of the image at hand, C x [counts]
};

}  // namespace slipbench::nib
