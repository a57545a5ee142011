#include "tools/studies/piezo_fft_gru/piezo_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "detectors/spectral/spectral_features.h"
#include "sim/core/pad_state.h"

namespace slipbench::reproduce {
namespace {

constexpr double still_speed = 1e-9;  // m/s, below which the bench stands

// The straight line of least squares through `values` taken off.
std::vector<float> without_trend(std::span<const float> values) {
  const double middle = 0.5 * static_cast<double>(values.size() - 1);
  double mean = 0.0, slope = 0.0, square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double t = static_cast<double>(i) - middle;
    mean += static_cast<double>(values[i]) / static_cast<double>(values.size());
    slope += t * static_cast<double>(values[i]);
    square += t * t;
  }
  slope /= square;
  std::vector<float> left;
  for (std::size_t i = 0; i < values.size(); ++i) {
    left.push_back(static_cast<float>(static_cast<double>(values[i]) - mean - slope * (static_cast<double>(i) - middle)));
  }
  return left;
}

// Power in the band of one frame at a time.
class BandPower {
 public:
  explicit BandPower(bool hann) : features_(layout(hann)) {}

  double operator()(std::span<const float> frame) {
    for (const float value : frame) features_.push(value);
    double power = 0.0;
    for (const double density : features_.density()) power += density * features_.bin_width();
    return power;
  }

 private:
  static SpectralLayout layout(bool hann) {
    SpectralLayout one;
    one.hop = one.window;  // no sample is in two frames
    one.hann = hann;
    return one;
  }
  SpectralFeatures features_;
};

// Speed of whatever moves at a sample: along the normal, and along the surface.
struct BenchSpeed {
  double normal = 0.0, sideways = 0.0;
};
BenchSpeed speed_at(const TrialRecord& record, std::size_t sample) {
  BenchSpeed speed;
  for (const BodyRecord& body : record.bodies) {
    const float* v = &body.velocity[6 * sample];
    speed.normal = std::max(speed.normal, std::abs(double{v[2]}));
    speed.sideways = std::max(speed.sideways, std::hypot(double{v[0]}, double{v[1]}));
  }
  return speed;
}

bool slip_state(std::uint8_t state) { return static_cast<PadState>(state) >= PadState::incipient; }

}  // namespace

SkinRecording skin_recording(const Scene& scene, const TrialRecord& record) {
  SkinRecording recording{scene.sensors.front().parameters.number("k_normal") * scene.motion.parameters.number("compression"),
                          scene.motion.parameters.number("speed"),
                          {}};
  const SensorRecord& sensor = record.sensors.front();
  const std::vector<std::uint8_t>& states = sensor.labels.state_micro;
  const std::vector<float>& signal = sensor.channels.front().values;
  std::vector<BenchSpeed> speeds;
  for (std::size_t i = 0; i < signal.size(); ++i) speeds.push_back(speed_at(record, i));

  const SpectralLayout layout;
  BandPower plain(false), hann(true);
  double moved = -std::numeric_limits<double>::infinity();
  std::size_t looked_at = 0;  // samples whose motion `moved` knows
  for (std::size_t end = layout.window; end <= signal.size(); end += layout.hop) {
    const std::size_t first = end - layout.window, last = end - 1;
    const std::span<const float> values = std::span(signal).subspan(first, layout.window);
    SkinFrame frame;
    frame.power = {plain(values), plain(without_trend(values)), hann(values)};
    frame.contact = static_cast<PadState>(states[last]) != PadState::no_contact;
    frame.slips = slip_state(states[last]);
    frame.slips_by_position = slip_state(sensor.labels.state_paper[last]);
    frame.at_speed = speeds[last].sideways >= 0.9 * recording.speed;
    frame.one_label = true;
    for (std::size_t i = first; i <= last; ++i) {
      const bool touches = static_cast<PadState>(states[i]) != PadState::no_contact;
      frame.one_label = frame.one_label && touches == frame.contact && slip_state(states[i]) == frame.slips;
      frame.slipped = frame.slipped || slip_state(states[i]);
      frame.pressed = frame.pressed || speeds[i].normal > still_speed;
      frame.slid = frame.slid || speeds[i].sideways > still_speed;
    }
    for (; looked_at < end; ++looked_at) {
      if (std::max(speeds[looked_at].normal, speeds[looked_at].sideways) > still_speed) moved = sensor.time[looked_at];
    }
    frame.still = sensor.time[last] - moved;
    recording.frames.push_back(frame);
  }
  return recording;
}

}  // namespace slipbench::reproduce
