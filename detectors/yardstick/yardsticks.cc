#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "detectors/detector_kinds.h"
#include "detectors/yardstick/moving_statistics.h"
#include "sim/core/error.h"
#include "sim/core/math.h"

namespace slipbench {
namespace {

constexpr double window = 0.5;  // s
constexpr const char* read_channel =
    "v: the values of the sensor's first channel, x, y and z of each unit if it is a vector\n"
    "window: the latest 0.5 s, at least two samples; no_contact before it is full\n";
constexpr const char* decision =
    "gross: s >= threshold; else non-slip, also without contact\n"
    "slip_probability = s/(s + threshold), a score from 0 to 1 that is 0.5 at the threshold";

// Shape of the signal of a yardstick: the first channel of its sensor.
struct Signal {
  std::size_t units = 0, components = 1;

  [[nodiscard]] std::size_t size() const { return units * components; }
  [[nodiscard]] bool is_vector() const { return components == 3; }
};

Signal first_signal(const FrameSource& source) {
  if (source.channels.empty() || source.channels.front().size() == 0)
    throw SceneValueError("detector.sensor", "sensor " + quote(source.sensor) + " has no values to read");
  const Channel& channel = source.channels.front();
  if (channel.shape.size() == 2 && channel.shape[1] == 3) return {channel.shape[0], 3};
  return {channel.size(), 1};
}

std::size_t window_frames(const FrameSource& source) {
  constexpr double most = 1e6;  // frames kept, far more than needed
  const double frames = std::max(2.0, std::round(window * source.rate));
  if (!(frames <= most)) {
    throw SceneValueError("detector.sensor", "a yardstick keeps " + format_quantity(window, Quantity::time) + " of sensors." +
                                                 source.sensor + ", whose rate is " +
                                                 format_quantity(source.rate, Quantity::frequency) + "; allowed: up to 2 MHz");
  }
  return static_cast<std::size_t>(frames);
}

// Mean standard deviation.
double deviation(const MovingStatistics& past, const Signal& signal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < signal.size(); ++i) sum += past.deviation(i);
  return sum / static_cast<double>(signal.size());
}

// Mean standard deviation of the shear over the mean normal level; of all values over their level
// if they are not vectors.
double relative_deviation(const MovingStatistics& past, const Signal& signal) {
  if (!signal.is_vector()) {
    double level = 0.0;
    for (std::size_t i = 0; i < signal.size(); ++i) level += std::abs(past.mean(i));
    return deviation(past, signal) * static_cast<double>(signal.size()) / level;
  }
  double shear = 0.0, level = 0.0;
  for (std::size_t unit = 0; unit < signal.units; ++unit) {
    shear += 0.5 * (past.deviation(3 * unit) + past.deviation(3 * unit + 1));
    level += std::abs(past.mean(3 * unit + 2));
  }
  return shear / level;
}

// Length of the change of the sum.
double sum_change(const MovingStatistics& past, const Signal& signal) {
  double change[3] = {0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < signal.size(); ++i) change[i % signal.components] += past.change(i);
  return math::hypot(math::hypot(change[0], change[1]), change[2]);
}

// Length of the summed shear over the summed normal level, of the means over the window.
double shear_ratio(const MovingStatistics& past, const Signal& signal) {
  double sum[3] = {0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < signal.size(); ++i) sum[i % 3] += past.mean(i);
  return math::hypot(sum[0], sum[1]) / std::abs(sum[2]);
}

using Law = double (*)(const MovingStatistics&, const Signal&);

// A default threshold, and the type of sensor on which it was measured; empty: it is assumed.
struct DefaultThreshold {
  double value;
  const char* measured_on;
};

template <Law law>
constexpr DefaultThreshold default_threshold() {
  if constexpr (law == deviation) return {6.0, "biotac_sp"};
  if constexpr (law == relative_deviation) return {0.1, ""};
  if constexpr (law == shear_ratio) return {0.4, ""};
  return {1.0, ""};
}

template <Law law>
class Yardstick final : public Detector {
 public:
  Yardstick(const Parameters& parameters, const FrameSource& source)
      : signal_(first_signal(source)), past_(window_frames(source), signal_.size()), threshold_(parameters.number("threshold")) {
    if constexpr (law == shear_ratio) {
      if (!signal_.is_vector()) {
        throw SceneValueError("detector.sensor", "shear_ratio reads three axes of each unit, but the first channel of the " +
                                                     source.type + " " + quote(source.sensor) + ", " +
                                                     quote(source.channels.front().name) + ", has one");
      }
    }
    constexpr DefaultThreshold known = default_threshold<law>();
    if (threshold_ == known.value && source.type != known.measured_on) {
      const std::string origin = *known.measured_on == 0 ? "is assumed" : "was measured on a " + std::string(known.measured_on);
      notice_ = "the default threshold of " + format_number(known.value) + " " + origin +
                "; choose one for this sensor, with --set threshold= or in the scene";
    }
    estimate_.features = {std::numeric_limits<double>::quiet_NaN()};
  }

  const SlipEstimate& update(const SensorFrame& frame) override {
    estimate_.time = frame.time;
    past_.push(frame.values.first(signal_.size()));
    if (!past_.full()) return estimate_;
    const double score = law(past_, signal_);
    const double odds = std::isnan(score) ? 0.0 : score / threshold_;  // 0/0: nothing changes at level 0
    estimate_.state = odds >= 1.0 ? PadState::gross : PadState::non_slip;
    estimate_.features[0] = std::isinf(odds) ? 1.0 : odds / (odds + 1.0);
    return estimate_;
  }

  [[nodiscard]] const std::vector<Feature>& features() const override {
    static const std::vector<Feature> one{{"slip_probability", ""}};
    return one;
  }

  [[nodiscard]] std::string notice() const override { return notice_; }

 private:
  Signal signal_;
  MovingStatistics past_;
  double threshold_;  // in the unit of the law
  std::string notice_;
  SlipEstimate estimate_;
};

// `formula`: that of the law. `unit`, `source`: of its threshold.
template <Law law>
DetectorKind yardstick(const std::string& name, const std::string& summary, const std::string& formula, const std::string& unit,
                       const std::string& source) {
  return {{.name = name,
           .summary = summary,
           .law = read_channel + formula + "\n" + decision,
           .source = "a yardstick for trained detectors, whose value must be above that of one number",
           .parameters = {number_spec("threshold", Quantity::none, format_number(default_threshold<law>().value), positive,
                                      "Value of s from which the pad slips, " + unit + ".", source)}},
          created<Yardstick<law>>,
          nullptr,
          FrameSpacing::evened,
          {},
          false,
          true};
}

}  // namespace

DetectorKind deviation_detector() {
  return yardstick<deviation>(
      "deviation", "Yardstick: the mean standard deviation of the sensor's values over half a second; no training.",
      "s = mean over all values of their standard deviation in the window", "in the unit of the channel",
      "between the medians of a still and of a sliding BioTac SP in 0.64 s, 4.4 and 7.9 counts (BioTacSP-DoS); other sensors need their own");
}

DetectorKind relative_deviation_detector() {
  return yardstick<relative_deviation>(
      "relative_deviation",
      "Yardstick: the standard deviation of the shear over half a second, divided by the normal level; no training.",
      "s = mean over units of the standard deviations of x and y in the window / mean over units of |mean of z|\n"
      "values without axes: s = mean standard deviation / mean of |mean|",
      "a share", "assumed");
}

DetectorKind shear_ratio_detector() {
  return yardstick<shear_ratio>(
      "shear_ratio", "Yardstick: the shear of the whole pad divided by its normal level; no training.",
      "s = |sum over units of the means of (x, y)| / |sum over units of the means of z|, means over the window", "a share",
      "assumed: 0.8 of a friction coefficient of 0.5");
}

DetectorKind sum_change_detector() {
  return yardstick<sum_change>("sum_change",
                               "Yardstick: how much the sum of the sensor's values changes in half a second; no training.",
                               "s = |sum over units now - sum over units at the window's first sample|, of vectors its length",
                               "in the unit of the channel", "assumed: 1 N of a sensor of forces");
}

}  // namespace slipbench
