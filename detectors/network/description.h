// What a network eats and says, as it stands in the metadata of its ONNX file: one file is a whole detector.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/core/pad_state.h"

namespace slipbench::network {

// The key of the ONNX file's metadata_props whose value is the JSON object below.
inline constexpr const char* metadata_key = "slipbench";

// Values of a sensor's sample.
struct ChannelPick {
  std::string name;                 // of the channel: "force"
  std::vector<std::size_t> values;  // which of its values, by their place in C order; empty: all
};

// What becomes of the `window` samples of each value.
enum class Transform {
  samples,  // they themselves, in order: [window, values]
  log_psd,  // log10 of their power spectral density, one-sided as SpectralFeatures::density(), plus `floor`, bins from low to high: [values, bins]
  amplitude,  // magnitude of their discrete Fourier transform |X_k|, bins from low to high: [values, bins]
  // How much they move, whatever they stand at: for each n of `spans` ln(s + floor) of all values, rising, s being the standard deviation (divisor
  // n) of the latest n samples, of those there are; then of the last n the same value by value, and asinh(d/floor), d being n times the slope of
  // the straight line that fits best: [spans + 2, values]
  spreads,
  // What they stand at and how they change, with their signs: asinh(m/floor) of the mean m of the window, then for each n of `spans` asinh(d/floor), d
  // as of spreads: [1 + spans, values]
  levels,
  // Values in threes, x, y, z of a unit's force. Of each unit, the means being of the latest spans[0] samples: asinh(z/floor) and
  // hypot(x, y)/(|z| + floor); then for each n of `spans` asinh(c/floor) of the change c of (x, y) as a length, of (x, y) along their mean, and of
  // z, where a change is n times the slope of the straight line that fits best: [units, 2 + 3 spans]
  units,
};

// From a sensor's samples to what the network is fed. In this order: pick, median, window, centre, transform, pixels, offset and scale, history.
// A frame is what a window becomes; the network is fed the last `history` frames, the oldest first.
struct Input {
  std::string sensor;                 // its type: "piezo_skin"
  double rate = 0.0;                  // Hz, of its samples
  std::vector<ChannelPick> channels;  // their values, one after the other
  std::size_t median = 1;  // of each value: the median of so many of its latest samples, of those there are at the beginning
  std::size_t window = 1;  // samples a frame
  std::size_t stride = 1;  // samples from one frame to the next; the first is complete after `window`
  bool centre = false;     // each value less its mean over the window
  Transform transform = Transform::samples;
  double low = 0.0, high = 0.0;  // Hz, first and last bin; of spectra alone
  bool hann = false;             // of spectra alone: Hann's taper; else rectangular
  double floor =
      0.0;  // of log_psd: unit^2/Hz, added to a density before its logarithm; of those with `spans`: the sensor's unit; more than 0
  std::vector<std::size_t>
      spans;  // samples, 2 or more each; of spreads, levels and units alone, whose first frame is complete after `window` samples, 2 at least
  // An image out of the values, for each of the last axis' entries of a spectrum and each sample of a window: pixel p is the mean of the values
  // listed in pixels[p], 0 where none is. Empty: the values as they are.
  std::vector<std::vector<std::size_t>> pixels;
  std::vector<double> offset,
      scale;  // a feature x becomes (x - offset) scale; one for all, or one for each feature of a frame; empty: 0, 1
  std::size_t history = 1;  // frames
};

// A recurrent state: what an output says is fed to an input with the next frame; zeros at a trial's beginning.
struct State {
  std::string input, output;
};

enum class Output { logits, probabilities };

struct Class {
  std::string name;  // "translation"
  PadState state{};  // what the detector says then
};

// When slip is said: from the `on`-th frame in a row on whose probability reaches the threshold, until `off` frames in a row do not reach it and
// `least` frames have passed since it began.
struct Alarm {
  std::size_t on = 1, off = 1, least = 1;
};

// Whether slip is said, frame by frame.
class AlarmGate {
 public:
  explicit AlarmGate(const Alarm& alarm) : alarm_(alarm) {}

  // `reached`: whether the next frame's probability reaches the threshold.
  bool push(bool reached) {
    same_ = reached == latest_ ? same_ + 1 : 1;
    latest_ = reached;
    ++since_;
    if (!said_ && reached && same_ >= alarm_.on) {
      said_ = true;
      since_ = 0;
    } else if (said_ && !reached && same_ >= alarm_.off && since_ >= alarm_.least) {
      said_ = false;
    }
    return said_;
  }

 private:
  Alarm alarm_;
  bool latest_ = false, said_ = false;
  std::size_t same_ = 0, since_ = 0;  // frames alike in a row; frames since it was said
};

struct Description {
  Input input;
  std::vector<State> states;
  Output output = Output::logits;
  std::vector<Class> classes;  // two at least, in the order of the network's output; at least one slips, at least one does not
  double threshold = 0.5;      // slip is said from this sum of the probabilities of incipient and gross classes on
  Alarm alarm;
  std::string trained = "{}";  // JSON object: what the network has seen, for people and for `eval`
};

// Values of a frame when a sample has `values` picked ones: the length of what Frames hands out.
std::size_t frame_size(const Input& input, std::size_t values);

// The JSON object. `subject` names the file in errors. Throws InputError: what was found, what is allowed; an unknown key is an error.
Description parse_description(std::string_view text, const std::string& subject);
std::string description_text(const Description& description);

// Words of the JSON object, for error messages and documents: an example that parse_description() takes.
std::string example_description();

}  // namespace slipbench::network
