#include "detectors/nib/features.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/readable_quantity.h"

namespace slipbench::nib {
namespace {

std::size_t checked_size(std::size_t size) {
  if (size < 4) throw std::invalid_argument("a window of fewer than four samples");
  return size;
}

constexpr double slow_band = 6.0, fast_band = 8.0;  // Hz, upper ends of the paper's two bands

// Returns where the channel `name` of these extents begins in a frame.
std::size_t place_of(const FrameSource& source, const std::string& name, const std::vector<std::size_t>& shape,
                     const std::string& detector, std::size_t& every) {
  std::size_t first = 0;
  for (const Channel& channel : source.channels) {
    if (channel.name == name && channel.shape == shape) {
      if (channel.unit != "counts") {
        throw SceneValueError("detector.sensor",
                              fmt::format("{} reads the channel '{}' in counts, but the {} {} has it in {}", detector, name,
                                          source.type, quote(source.sensor), quote(channel.unit)));
      }
      every = channel.every;
      return first;
    }
    first += channel.size();
  }
  throw SceneValueError("detector.sensor", fmt::format("{} needs the channel '{}' of a nib_pad, which the {} {} does not have",
                                                       detector, name, source.type, quote(source.sensor)));
}

// Converts the parameter `name` [s] to frames: at least `least`, and at most a million, far more than
// a spectrum needs.
std::size_t frames_of(const Parameters& parameters, const char* name, std::size_t least, const FrameSource& source) {
  constexpr double most = 1e6;
  const double length = parameters.number(name), frames = std::round(length * source.rate);
  const bool whole = std::abs(frames - length * source.rate) <= source.rate_rounding * frames;
  if (!whole || frames < static_cast<double>(least) || frames > most) {
    throw SceneValueError(
        fmt::format("detector.{}", name),
        fmt::format("{} must be a whole multiple of the sensor's sampling time, {}, and {} to 1,000,000 times as long",
                    format_quantity(length, Quantity::time), readable_quantity(1.0 / source.rate, Quantity::time), least));
  }
  return static_cast<std::size_t>(frames);
}

SlidingSpectrum spectrum_for(const Parameters& parameters, const FrameSource& source) {
  const std::size_t window = frames_of(parameters, "window", 4, source);
  if (source.rate < 2.0 * fast_band) {
    throw SceneValueError("detector.sensor",
                          fmt::format("the sensor samples at {}; it must sample at least at twice the end of the band, {:g} Hz",
                                      format_quantity(source.rate, Quantity::frequency), fast_band));
  }
  if (source.rate / static_cast<double>(window) > fast_band - slow_band) {
    throw SceneValueError("detector.window",
                          fmt::format("{} makes bins wider than the band of 6 to 8 Hz; allowed: at least 0.5 s",
                                      format_quantity(parameters.number("window"), Quantity::time)));
  }
  return {window, frames_of(parameters, "hop", 1, source), source.rate};
}

}  // namespace

double ShearField::total_normal() const {
  double sum = 0.0;
  for (const double value : normal) sum += value;
  return sum;
}

Eigen::Vector2d ShearField::total_shear() const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& vector : shear) sum += vector;
  return sum;
}

ShearField shear_field(std::span<const double, taxels * electrodes> change) {
  ShearField field;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const std::span<const double> read = change.subspan(electrodes * taxel, electrodes);
    const double west = read[0], north = read[1], east = read[2], south = read[3];
    field.normal[taxel] = west + north + east + south;
    field.shear[taxel] = {east - west, north - south};
  }
  return field;
}

double curl(const ShearField& field) {
  // Over x = -1, 0, 1 in three rows the slope is sum x F / 6.
  double sum = 0.0;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const std::size_t column = taxel % 3, row = taxel / 3;
    const double x = static_cast<double>(column) - 1.0, y = 1.0 - static_cast<double>(row);
    sum += x * field.shear[taxel].y() - y * field.shear[taxel].x();
  }
  return sum / 6.0;
}

double normalised_curl(const ShearField& field) {
  double length = 0.0;
  for (const Eigen::Vector2d& vector : field.shear) length += vector.norm();
  return length > 0.0 ? curl(field) * static_cast<double>(taxels) / length : 0.0;
}

std::vector<ParameterSpec> feature_specs() {
  return {
      number_spec("window", Quantity::time, "500 ms", positive, "Length of the signal for one spectrum.", "paper, section IV-B"),
      number_spec("hop", Quantity::time, "100 ms", positive, "Time from one spectrum to the next.",
                  "paper, section IV-B: windows of 500 ms overlap by 400 ms; its \"close to 8 Hz\" would be 125 ms"),
      number_spec("tare", Quantity::time, "300 ms", positive,
                  "Time over which the counts of the unloaded pad are averaged; nothing may touch the pad in that time.",
                  "assumed: ten images of 30 ms"),
      number_spec("touch", Quantity::none, "30", positive,
                  "Sum of the changes of all 36 electrodes above which the pad touches [counts].",
                  "assumed: three times its noise, half a newton of normal force"),
      number_spec(
          "capacitance", Quantity::none, "153", positive,
          "Counts of a taxel's electrode of four nibs at rest. They set the non-linearity of the reading under load (1/gap).",
          "assumed: 4 C0, C0 0.045 pF at 850 counts/pF. The paper fits a polynomial of second order instead"),
      number_spec(
          "normal_gain", Quantity::none, "57.9", positive,
          "Counts of all 36 electrodes together per newton of normal force: 4 C0/(g0 k_post), C0: counts of a nib's electrode.",
          "assumed: small loads, C0 0.045 pF at 850 counts/pF, gap 0.254 mm, post 10.4 N/mm"),
      number_spec("shear_gain", Quantity::none, "454", positive,
                  "Counts of N - S (E - W) of all taxels together per newton of shear: 2 C0 r/(L g0 k_t).",
                  "assumed: small loads, r 1.1 mm, L 3.65 mm, k_t 0.2 N/mm, the rest as normal_gain"),
      number_spec("pitch", Quantity::length, "7.6 mm", positive, "Distance between taxels.",
                  "paper, section II: two nibs 3.8 mm apart"),
  };
}

const std::vector<Feature>& handed_on() {
  static const std::vector<Feature> all{{"fl_0_6", "counts"}, {"fl_6_8", "counts"}, {"fr_0_6", "counts"}, {"fr_6_8", "counts"},
                                        {"curl", ""},         {"normal", "N"},      {"shear", "N"},       {"moment", "N m"}};
  return all;
}

FeatureReader::FeatureReader(const Parameters& parameters, const FrameSource& source, const std::string& detector)
    : touch_(parameters.number("touch")),
      capacitance_(parameters.number("capacitance")),
      normal_gain_(parameters.number("normal_gain")),
      shear_gain_(parameters.number("shear_gain")),
      pitch_(parameters.number("pitch")),
      linear_spectrum_(spectrum_for(parameters, source)),
      rotational_spectrum_(spectrum_for(parameters, source)) {
  std::size_t every = 1, image_every = 1;
  image_ = place_of(source, "si", {taxels, electrodes}, detector, image_every);
  linear_ = place_of(source, "fl", {2}, detector, every);
  rotational_ = place_of(source, "fr", {2}, detector, every);
  skipped_ = image_every - 1;
  tare_end_ = skipped_ + frames_of(parameters, "tare", 1, source);
}

bool FeatureReader::update(const SensorFrame& frame) {
  ++frames_;
  read_image(frame);
  const auto difference = [&](std::size_t place) { return double{frame.values[place]} - double{frame.values[place + 1]}; };
  const bool due = linear_spectrum_.push(difference(linear_));
  rotational_spectrum_.push(difference(rotational_));
  if (!due) return false;
  transformed_ = true;
  features_.fl = linear_spectrum_.band_mean(0.0, slow_band);
  features_.fl_fast = linear_spectrum_.band_mean(slow_band, fast_band);
  features_.fr = rotational_spectrum_.band_mean(0.0, slow_band);
  features_.fr_fast = rotational_spectrum_.band_mean(slow_band, fast_band);
  return true;
}

void FeatureReader::read_image(const SensorFrame& frame) {
  if (frames_ <= skipped_) return;
  const std::span<const float> image = frame.values.subspan(image_, values);
  if (!tared_) {
    for (std::size_t i = 0; i < values; ++i) tare_[i] += image[i];
    tared_ = frames_ == tare_end_;
    if (tared_) {
      for (double& value : tare_) value /= static_cast<double>(tare_end_ - skipped_);
    }
    return;
  }
  std::array<double, values> change, closed;
  for (std::size_t i = 0; i < values; ++i) {
    change[i] = image[i] - tare_[i];
    closed[i] = change[i] / (1.0 + change[i] / capacitance_);
  }
  const ShearField field = shear_field(change);
  features_.normal = field.total_normal();
  features_.shear = field.total_shear();
  features_.curl = normalised_curl(field);
  closed_ = shear_field(closed);
}

void FeatureReader::hand_on(std::vector<double>& out) const {
  const Features& f = features_;
  out = {f.fl, f.fl_fast, f.fr, f.fr_fast, f.curl, normal_force(), shear_force().norm(), moment()};
  constexpr std::size_t magnitudes = 4;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!(i < magnitudes ? transformed_ : tared_)) out[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

WindowSpectrum::WindowSpectrum(std::size_t size, double rate)
    : rate_(rate), fft_(checked_size(size)), window_(size), magnitudes_(size / 2 + 1) {
  for (std::size_t n = 0; n < size; ++n) {
    window_[n] = 0.54 - 0.46 * math::cos(2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(size));
  }
}

std::span<const double> WindowSpectrum::magnitudes(std::span<const double> samples) {
  if (samples.size() != size()) throw std::invalid_argument("a stretch of another length than the window");
  // Least squares about the middle, where mean and slope are independent: sum (n - m)^2 = N (N^2 -
  // 1)/12.
  const auto n = static_cast<double>(size());
  const double middle = 0.5 * (n - 1.0);
  double mean = 0.0, slope = 0.0;
  for (const double sample : samples) mean += sample;
  mean /= n;
  for (std::size_t i = 0; i < size(); ++i) slope += (static_cast<double>(i) - middle) * (samples[i] - mean);
  slope *= 12.0 / (n * (n * n - 1.0));
  const std::span<double> in = fft_.input();
  for (std::size_t i = 0; i < size(); ++i) in[i] = window_[i] * (samples[i] - mean - slope * (static_cast<double>(i) - middle));
  std::ranges::transform(fft_.transform(), magnitudes_.begin(),
                         [](const std::complex<double>& x) { return std::sqrt(std::norm(x)); });
  return magnitudes_;
}

SlidingSpectrum::SlidingSpectrum(std::size_t window, std::size_t hop, double rate)
    : spectrum_(window, rate), hop_(hop), ring_(window), ordered_(window), missing_(window) {
  if (hop == 0) throw std::invalid_argument("a hop of no samples");
}

bool SlidingSpectrum::push(double sample) {
  ring_[next_] = sample;
  next_ = next_ + 1 == ring_.size() ? 0 : next_ + 1;
  if (--missing_ > 0) return false;
  missing_ = hop_;
  std::rotate_copy(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(next_), ring_.end(), ordered_.begin());
  const std::span<const double> found = spectrum_.magnitudes(ordered_);
  magnitudes_.assign(found.begin(), found.end());
  return true;
}

double SlidingSpectrum::band_mean(double low, double high) const {
  // Includes a bin whose frequency equals a bound despite rounding.
  constexpr double rounding = 1e-9;
  const auto first = static_cast<std::size_t>(std::ceil(low / spectrum_.bin_width() - rounding));
  const auto last = static_cast<std::size_t>(std::floor(high / spectrum_.bin_width() + rounding));
  if (!(low >= 0.0) || first > last || last > spectrum_.size() / 2) throw std::invalid_argument("no bin in this band");
  if (magnitudes_.empty()) return 0.0;
  double sum = 0.0;
  for (std::size_t k = first; k <= last; ++k) sum += magnitudes_[k];
  return sum / static_cast<double>(last - first + 1);
}

}  // namespace slipbench::nib
