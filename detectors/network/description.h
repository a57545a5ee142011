// Description of a network's inputs and outputs, stored in the metadata of its ONNX file, so that
// one file is a whole detector.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/api/pad_state.h"

namespace slipbench::network {

// Key of the ONNX file's metadata_props whose value is the JSON object below.
inline constexpr const char* metadata_key = "slipbench";

// Values picked from a sensor's sample.
struct ChannelPick {
  std::string name;                 // of the channel: "force"
  std::vector<std::size_t> values;  // indices into the channel's values in C order; empty: all
  std::string unit = {};            // in which it was trained: "N"; empty: unit_of_pick() has the usual one
};

// Physical unit in which the network reads a channel. Without a unit in the description it is N of a
// force, m of a displacement, and of other channels the unit `usual` in simulated sensors; empty:
// unknown, any unit fits.
std::string unit_of_pick(const ChannelPick& pick, const std::string& usual);

// Transform of the `window` samples of each value.
enum class Transform {
  samples,    // unchanged, in order: [window, values]
  log_psd,    // log10 of the one-sided power spectral density (SpectralFeatures::density()) plus `floor`: [values, bins]
  amplitude,  // magnitude of the discrete Fourier transform |X_k|, bins from low to high: [values, bins]
  // Variation, independent of the level. For each n of `spans`: ln(s + floor) of all values,
  // sorted, with s the standard deviation (divisor n) of the latest n samples, or of as many as
  // there are. Then for the last n the same value by value, and asinh(d/floor), with d = n times
  // the slope of the least-squares line: [spans + 2, values]
  spreads,
  // Level and change, with signs: asinh(m/floor) of the window's mean m, then for each n of `spans`
  // asinh(d/floor), with d as in spreads: [1 + spans, values]
  levels,
  // Values in threes: x, y, z of a unit's force. For each unit, with means over the latest spans[0]
  // samples: asinh(z/floor) and hypot(x, y)/(|z| + floor). Then for each n of `spans`
  // asinh(c/floor) of the change c in (x, y) as a length, in (x, y) along their mean, and in z. A
  // change is n times the slope of the least-squares line: [units, 2 + 3 spans]
  units,
};

// Steps from a sensor's samples to the network's input, in this order: pick, median, window,
// centre, transform, pixels, offset and scale, history. A window becomes a frame; the network gets
// the last `history` frames, the oldest first.
struct Input {
  std::string sensor;                 // its type: "piezo_skin"
  double rate = 0.0;                  // Hz, of its samples
  std::vector<ChannelPick> channels;  // their values, concatenated
  std::size_t median = 1;             // per value: median of the latest `median` samples, of fewer at the start
  std::size_t window = 1;             // samples per frame
  std::size_t stride = 1;             // samples from one frame to the next; the first is complete after `window`
  bool centre = false;                // subtracts each value's mean over the window
  Transform transform = Transform::samples;
  double low = 0.0, high = 0.0;  // Hz, first and last bin; spectra only
  bool hann = false;             // spectra only: Hann's taper; false: rectangular
  double floor =
      0.0;  // for log_psd in unit^2/Hz, added to a density before its logarithm; for transforms with `spans` in the unit of the sensor; above 0
  std::vector<std::size_t>
      spans;  // samples, 2 or more each; only for spreads, levels and units, whose first frame is complete after `window` samples, at least 2
  // Pixels of an image: pixel p is the mean of the values listed in pixels[p], 0 if the list is
  // empty. One image for each bin of a spectrum or sample of a window. Empty: the values unchanged.
  std::vector<std::vector<std::size_t>> pixels;
  std::vector<double> offset,
      scale;  // a feature x becomes (x - offset) scale; one for all, or one for each feature of a frame; empty: 0, 1
  std::size_t history = 1;  // frames
  // Hz, range of the rates of the sensors for which it was trained; 0: `rate` alone. Slower samples than
  // rate_read() are interpolated, as they were in training.
  double slowest = 0.0, fastest = 0.0;
};

// A recurrent state: an output that is fed to an input with the next frame; zero at the beginning
// of a trial.
struct State {
  std::string input, output;
};

enum class Output { logits, probabilities };

struct Class {
  std::string name;  // "translation"
  PadState state{};  // state that the detector reports for it
};

// Filter of slip reports: slip begins at the `on`-th consecutive frame whose probability reaches
// the threshold, and lasts until `off` consecutive frames do not reach it and `least` frames have
// passed since it began.
struct Alarm {
  std::size_t on = 1, off = 1, least = 1;
};

// Applies an Alarm frame by frame.
class AlarmGate {
 public:
  explicit AlarmGate(const Alarm& alarm) : alarm_(alarm) {}

  // `reached`: the next frame's probability reaches the threshold. Returns true if slip is
  // reported.
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
  std::size_t same_ = 0, since_ = 0;  // consecutive equal frames; frames since slip was first reported
};

struct Description {
  Input input;
  std::vector<State> states;
  Output output = Output::logits;
  std::vector<Class> classes;  // at least two, in the order of the network's output; at least one slips, at least one does not
  double threshold = 0.5;      // slip if the probabilities of incipient and gross classes sum to at least this
  Alarm alarm;
  std::string trained = "{}";  // JSON object: training data, for people and for `eval`
};

// Rate at which the network reads its sensor [Hz]: `rate` over `stride` if each frame is one sample,
// otherwise `rate`, because windows, medians and spectra need every sample.
double rate_read(const Input& input);
// The same input for samples at rate_read().
Input at_rate_read(const Input& input);
// Lowest rate of a sensor that the network reads [Hz]: rate_read(), or the lower one for which it was
// trained.
double least_rate(const Input& input);

// Number of values in a frame made by Frames, if a sample has `values` picked ones.
std::size_t frame_size(const Input& input, std::size_t values);

// Parses the JSON object. `subject` names the file in errors. Throws InputError with what was found
// and what is allowed; an unknown key is an error.
Description parse_description(std::string_view text, const std::string& subject);
std::string description_text(const Description& description);

// Returns an example of the JSON object for error messages and documents; parse_description()
// accepts it.
std::string example_description();

}  // namespace slipbench::network
