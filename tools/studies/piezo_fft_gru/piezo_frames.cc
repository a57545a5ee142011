#include "tools/studies/piezo_fft_gru/piezo_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "detectors/spectral/spectral_features.h"
#include "sim/core/pad_state.h"
#include "tools/base/statistics/descriptive.h"

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

namespace {

constexpr double light_press = 4.0;   // N, below a quarter of the published 2 to 10
constexpr double slow_slide = 10e-3;  // m/s, below a fifth of the published 3.3 to 33 mm/s

// Which frames a question is about.
using FrameChoice = std::function<bool(const SkinRecording&, const SkinFrame&)>;

// Loudness of the chosen frames, and the number of the recording of each.
struct Loudness {
  std::vector<double> power;
  std::vector<std::size_t> recording;
};

Loudness loudness_of(const SkinRecordings& recordings, const FrameReading& reading, const FrameChoice& chosen) {
  Loudness found;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    for (const SkinFrame& frame : recordings[r].frames) {
      if (!reading.counts(frame) || !chosen(recordings[r], frame)) continue;
      found.power.push_back(frame.power.at(static_cast<std::size_t>(reading.spectrum)));
      found.recording.push_back(r);
    }
  }
  return found;
}

std::optional<Auc> separation(const Loudness& slip, const Loudness& hold) {
  if (slip.power.empty() || hold.power.empty()) return std::nullopt;
  return auc(slip.power, slip.recording, hold.power, hold.recording);
}

}  // namespace

const std::vector<FrameReading>& frame_readings() {
  static const std::vector<FrameReading> all{
      {"paper", "as the paper: mean off, no taper named; true label"},
      {"detrended", "straight line of each frame off", FrameSpectrum::detrended},
      {"hann", "Hann's taper", FrameSpectrum::hann},
      {"one_label", "mean off; frames of one label only", FrameSpectrum::plain, false, true},
      {"hann_one_label", "Hann's taper; frames of one label only", FrameSpectrum::hann, false, true},
      {"position", "as the paper, label by the 100 Hz position", FrameSpectrum::plain, true},
      {"detrended_position", "straight line off, label by the 100 Hz position", FrameSpectrum::detrended, true},
      {"hann_position", "Hann's taper, label by the 100 Hz position", FrameSpectrum::hann, true},
  };
  return all;
}

Separations separations(const SkinRecordings& recordings, const FrameReading& reading) {
  const auto hold = [&](const SkinFrame& frame) { return !reading.slips(frame); };
  const Loudness slip =
      loudness_of(recordings, reading, [&](const auto&, const SkinFrame& frame) { return reading.slips(frame); });
  const auto against = [&](const FrameChoice& chosen) { return separation(slip, loudness_of(recordings, reading, chosen)); };
  return {against([&](const auto&, const SkinFrame& frame) { return hold(frame); }),
          against([&](const auto&, const SkinFrame& frame) { return hold(frame) && frame.contact; }),
          against([&](const auto&, const SkinFrame& frame) { return hold(frame) && !frame.contact; })};
}

const std::vector<FrameCause>& hold_causes() {
  static const std::vector<FrameCause> causes{
      {"stick_between_slips", "a part slipped within the frame, at its end all sticks",
       [](const auto&, const SkinFrame& frame) { return frame.slipped; }},
      {"press", "the tip is pressed on", [](const auto&, const SkinFrame& frame) { return frame.pressed; }},
      {"shear", "the bench moves, shear is built up before the slip",
       [](const auto&, const SkinFrame& frame) { return frame.slid; }},
      {"settling", "at rest for less than 159 ms, the amplifier settles",
       [](const auto&, const SkinFrame& frame) { return frame.still < settling_time; }},
      {"rest", "at rest for longer", [](const auto&, const SkinFrame&) { return true; }},
  };
  return causes;
}

const std::vector<FrameCause>& slip_causes() {
  static const std::vector<FrameCause> causes{
      {"starts_or_stops", "the bench speeds up, brakes or stands (below 0.9 of its speed)",
       [](const auto&, const SkinFrame& frame) { return !frame.at_speed; }},
      {"slow_and_light", "slower than 10 mm/s and below 4 N",
       [](const SkinRecording& of, const SkinFrame&) { return of.speed < slow_slide && of.force < light_press; }},
      {"slow", "slower than 10 mm/s", [](const SkinRecording& of, const SkinFrame&) { return of.speed < slow_slide; }},
      {"light", "below 4 N", [](const SkinRecording& of, const SkinFrame&) { return of.force < light_press; }},
      {"other", "faster and heavier", [](const SkinRecording&, const SkinFrame&) { return true; }},
  };
  return causes;
}

std::vector<CauseFigures> figures_of(const SkinRecordings& recordings, const std::vector<FrameCause>& causes, bool of_slip) {
  const auto is = [](bool slip, const SkinFrame& frame) { return frame.contact && frame.slips == slip; };
  const auto cause_of = [&](const SkinRecording& recording, const SkinFrame& frame) {
    return std::ranges::find_if(causes, [&](const FrameCause& cause) { return cause.fits(recording, frame); }) - causes.begin();
  };
  std::vector<CauseFigures> figures(causes.size());
  for (std::size_t k = 0; k < frame_spectra; ++k) {
    const FrameReading& reading = frame_readings()[k];
    const Loudness other =
        loudness_of(recordings, reading, [&](const auto&, const SkinFrame& frame) { return is(!of_slip, frame); });
    const auto area = [&](const Loudness& own) { return of_slip ? separation(own, other) : separation(other, own); };
    const Loudness all =
        loudness_of(recordings, reading, [&](const auto&, const SkinFrame& frame) { return is(of_slip, frame); });
    const std::optional<Auc> whole = area(all);
    const double missing = whole ? 1.0 - whole->value : 0.0;
    for (std::size_t c = 0; c < causes.size(); ++c) {
      const Loudness own = loudness_of(recordings, reading, [&](const SkinRecording& recording, const SkinFrame& frame) {
        return is(of_slip, frame) && cause_of(recording, frame) == static_cast<std::ptrdiff_t>(c);
      });
      CauseFigures& cause = figures[c];
      cause.frames = own.power.size();
      cause.share = static_cast<double>(own.power.size()) / static_cast<double>(all.power.size());
      if (reading.spectrum == FrameSpectrum::plain) cause.rms = std::sqrt(quantile(own.power, 0.5));
      cause.area.at(k) = area(own);
      cause.share_of_missing.at(k) =
          cause.area.at(k) && missing > 0.0 ? cause.share * (1.0 - cause.area.at(k)->value) / missing : 0.0;
    }
  }
  return figures;
}

}  // namespace slipbench::reproduce
