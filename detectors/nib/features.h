// Features of the nib pad: spectra of its fast modes, and normal load and shear from its static
// image of 36 electrodes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "detectors/spectral/spectral_features.h"
#include "sim/api/detector.h"
#include "sim/core/parameters.h"

namespace slipbench::nib {

// Short-time spectra of a sampled signal, as the nib pad's slip detection uses them.

// Spectrum of N samples d_n:
//   X_k = sum_n w_n (d_n - l_n) exp(-2 pi i k n/N),  k = 0 to N/2
// l: least-squares line through d; w_n = 0.54 - 0.46 cos(2 pi n/N), Hamming's window with period N,
// whose sum is exactly 0.54 N. The spectrum is not normalised: |X_k| is in the samples' unit, and a
// sine of amplitude A at the middle of a bin has |X_k| = 0.54 N A/2, less the part that the line
// removes.
class WindowSpectrum {
 public:
  // `size`: N, at least 4; `rate` [Hz] of the samples.
  WindowSpectrum(std::size_t size, double rate);

  [[nodiscard]] std::size_t size() const { return window_.size(); }
  [[nodiscard]] double bin_width() const { return rate_ / static_cast<double>(size()); }  // Hz, rate/N

  // Returns |X_k| of `samples`, which must be N: [N/2 + 1]. Valid until the next call.
  std::span<const double> magnitudes(std::span<const double> samples);

 private:
  double rate_;  // Hz
  RealFft fft_;
  std::vector<double> window_, magnitudes_;
};

// Running spectra of a signal: one of the last `window` samples every `hop` samples.
class SlidingSpectrum {
 public:
  // Both lengths in samples; `hop` at least 1.
  SlidingSpectrum(std::size_t window, std::size_t hop, double rate);

  // Takes the next sample. Returns true if a new spectrum is made: the first after `window`
  // samples, then one every `hop`.
  bool push(double sample);

  // Mean magnitude of the latest spectrum over the bins from `low` to `high` [Hz], both included; 0
  // before the first spectrum. Throws std::invalid_argument if there is no bin between them.
  [[nodiscard]] double band_mean(double low, double high) const;
  // The latest spectrum; empty before the first.
  [[nodiscard]] std::span<const double> magnitudes() const { return magnitudes_; }

 private:
  WindowSpectrum spectrum_;
  std::size_t hop_;
  std::vector<double> ring_, ordered_, magnitudes_;
  std::size_t next_ = 0;  // index into the ring
  std::size_t missing_;   // samples until the next spectrum
};

// A taxel has index 3*row + column, rows from north (+y) to south, columns from west (-x) to
// east; its electrodes are in the order W, N, E, S.
inline constexpr std::size_t taxels = 9;
inline constexpr std::size_t electrodes = 4;

// Changes of capacitance relative to the unloaded pad, in counts.
struct ShearField {
  std::array<double, taxels> normal{};          // W + N + E + S: grows with compression
  std::array<Eigen::Vector2d, taxels> shear{};  // (E - W, N - S): the direction in which the surface drags the nibs

  [[nodiscard]] double total_normal() const;
  [[nodiscard]] Eigen::Vector2d total_shear() const;
};

// Equations (1) and (2) of the paper. `change`: [9,4] counts.
ShearField shear_field(std::span<const double, taxels * electrodes> change);

// Curl of the shear about the centre taxel, with the taxel pitch as unit length [counts]: the
// slopes dFy/dx - dFx/dy of the least-squares lines over all nine taxels. A rigid rotation F = w
// (-y, x) gives 2 w, a translation 0.
double curl(const ShearField& field);

// Curl of the field divided by the mean length of its nine vectors, dimensionless; 0 without shear.
// A rigid rotation about the centre taxel gives +-9/(2 + 2 sqrt 2) = 1.864, a translation 0. The
// maximum of any field is 1.5 sqrt 2, for shear at the corners alone.
double normalised_curl(const ShearField& field);

// Input of the nib pad's slip detection: spectra of its two fast modes, and normal load, shear and
// curl of its image.

// Magnitudes are means over the bins of a band, of D = C_1 - C_2 of a mode (SlidingSpectrum)
// [counts]; 0 until the first window is full. All other values are 0 until the pad is tared.
struct Features {
  double fl = 0.0, fl_fast = 0.0;   // linear mode: 0 to 6 Hz, 6 to 8 Hz
  double fr = 0.0, fr_fast = 0.0;   // rotational mode: likewise
  double curl = 0.0;                // normalised_curl() of the current image
  double normal = 0.0;              // counts, sum of all taxels' W + N + E + S
  Eigen::Vector2d shear{0.0, 0.0};  // counts, sum of all taxels' (E - W, N - S)
};

// Parameters common to the nib pad's detectors: window, hop, tare, touch, capacitance, normal_gain,
// shear_gain, pitch.
std::vector<ParameterSpec> feature_specs();

// Features that every nib pad detector reports (SlipEstimate::features), in this order: fl_0_6,
// fl_6_8, fr_0_6, fr_6_8 [counts], curl, normal and shear [N], moment [N m].
const std::vector<Feature>& handed_on();

// Computes the features of successive frames.
class FeatureReader {
 public:
  // `source` must have the channels si {9,4}, fl {2} and fr {2} [counts]. `detector`: name of the
  // detector, for errors. Throws SceneValueError if a channel is missing, if window or hop is not a
  // whole number of frames, or if `window` has fewer than four frames or bins that end below 8 Hz.
  FeatureReader(const Parameters& parameters, const FrameSource& source, const std::string& detector);

  // Takes the next frame. Returns true if there are new spectra.
  bool update(const SensorFrame& frame);

  [[nodiscard]] const Features& features() const { return features_; }
  // True if the pad has been tared and feels at least `touch`.
  [[nodiscard]] bool touching() const { return tared_ && features_.normal >= touch_; }

  // Calibrated loads. If a plate capacitor of C counts closes its gap by the share x, its reading
  // grows by c = C x/(1 - x), so C x = c/(1 + c/C). The loads are linear in C x but not in c: when
  // a nib leans, the shares of its four electrodes sum to zero while their changes do not. The
  // remaining errors are the differences between a taxel's four nibs, and the fabric's mask, which
  // limits the lean.
  [[nodiscard]] double normal_force() const { return closed_.total_normal() / normal_gain_; }        // N
  [[nodiscard]] Eigen::Vector2d shear_force() const { return closed_.total_shear() / shear_gain_; }  // N
  // N m, about the pad's normal through the centre taxel, from the taxels' shear at their middles.
  // It leaves out the moment of a taxel's nibs about the taxel's middle: 3/35 of that of a rigid
  // rotation.
  [[nodiscard]] double moment() const { return 6.0 * pitch_ * curl(closed_) / shear_gain_; }

  // Writes the values of handed_on(); NaN where they are not known yet.
  void hand_on(std::vector<double>& values) const;

 private:
  static constexpr std::size_t values = taxels * electrodes;
  void read_image(const SensorFrame& frame);

  std::size_t image_, linear_, rotational_;  // indices into a frame
  double touch_, capacitance_, normal_gain_, shear_gain_, pitch_;
  SlidingSpectrum linear_spectrum_, rotational_spectrum_;
  std::size_t frames_ = 0, skipped_, tare_end_;  // frames seen; frames before the first whole image; last frame of the tare
  bool tared_ = false, transformed_ = false;
  std::array<double, values> tare_{};  // counts; during the tare, their sum
  Features features_;
  ShearField closed_;  // of the current image, C x [counts]
};

}  // namespace slipbench::nib
