#include "detectors/detector_kinds.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "detectors/network/engine.h"
#include "detectors/network/frames.h"
#include "detectors/resampling.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"

namespace slipbench {
namespace {

class NetworkDetector final : public Detector {
 public:
  NetworkDetector(std::unique_ptr<network::Engine> engine, network::Frames frames, const FrameSource& source, double threshold,
                  double latency)
      : engine_(std::move(engine)),
        frames_(std::move(frames)),
        about_(engine_->description()),
        gate_(about_.alarm),
        fed_(engine_->inputs()) {
    if (threshold > 0.0) about_.threshold = threshold;
    const std::size_t history = about_.input.history, made = history * frames_.size();
    if (fed_.size() != made) {
      refuse_other_size(source, frames_.size(), history);
      const std::string open =
          fed_.size() < made
              ? " (an extent that the file leaves open, also that of time, is taken as 1; export the network with fixed extents)"
              : "";
      throw InputError("the network takes " + counted(fed_.size(), "value") + ", but its description gives " +
                       counted(history, "frame") + " of " + std::to_string(frames_.size()) + open);
    }
    estimate_.latency = latency;
    estimate_.features.assign(features().size(), std::numeric_limits<double>::quiet_NaN());
  }

  const SlipEstimate& update(const SensorFrame& frame) override {
    if (!frames_.push(frame.values)) return estimate_;
    const std::span<const float> latest = frames_.latest();
    // Shifts the oldest frame out.
    std::shift_left(fed_.begin(), fed_.end(), static_cast<std::ptrdiff_t>(latest.size()));
    std::ranges::copy(latest, fed_.end() - static_cast<std::ptrdiff_t>(latest.size()));
    if (++complete_ < about_.input.history) return estimate_;
    const std::span<const float> output = run();
    estimate_.time = frame.time;
    const double probability = network::slip_probability(about_, output);
    estimate_.state = network::state_of(about_, output, gate_.push(probability >= about_.threshold));
    estimate_.features.front() = probability;
    if (estimate_.features.size() > 1)
      estimate_.features.back() = static_cast<double>(std::ranges::max_element(output) - output.begin());
    return estimate_;
  }

  [[nodiscard]] const std::vector<Feature>& features() const override {
    static const std::vector<Feature> probability{{"slip_probability", ""}}, with_class{{"slip_probability", ""}, {"class", ""}};
    return about_.classes.size() > 2 ? with_class : probability;
  }

 private:
  std::span<const float> run() {
    try {
      return engine_->run(fed_);
    } catch (const InputError& error) {
      throw SceneValueError("detector.model", error.what());
    }
  }

  // Compares the values of a sample, where the network's size follows from them: the sensor may be
  // of another variant than the one for which the network was trained.
  void refuse_other_size(const FrameSource& source, std::size_t frame, std::size_t history) const {
    const std::vector<network::ChannelPick>& picks = about_.input.channels;
    // With listed values the sensor's size does not matter.
    const auto lists = [](const network::ChannelPick& pick) { return !pick.values.empty(); };
    if (!about_.input.pixels.empty() || std::ranges::any_of(picks, lists)) return;
    std::size_t read = 0, row = 1;
    std::string names;
    for (const network::ChannelPick& pick : picks) {
      const auto channel = std::ranges::find(source.channels, pick.name, &Channel::name);
      read += channel->size();
      names += (names.empty() ? "" : " and ") + pick.name;
      if (picks.size() == 1) row = channel->size() / channel->shape.front();
    }
    // Features of a frame, for each value of a sample.
    if (read == 0 || frame % read != 0) return;
    const std::size_t features = history * (frame / read);
    if (fed_.size() % features != 0) return;
    const std::size_t expected = fed_.size() / features;
    const bool units = row > 1 && expected % row == 0 && read % row == 0;
    throw InputError("the network expects " + counted(units ? expected / row : expected, units ? "unit" : "value") + " of " +
                     names + ", but sensor " + quote(source.sensor) + " has " + std::to_string(units ? read / row : read) +
                     "; the detector deviation reads any number");
  }

  std::unique_ptr<network::Engine> engine_;
  network::Frames frames_;
  network::Description about_;
  network::AlarmGate gate_;
  std::vector<float> fed_;  // [history, frame], the oldest first
  std::size_t complete_ = 0;
  SlipEstimate estimate_;
};

std::unique_ptr<Detector> make_network(const Parameters& parameters, const FrameSource& source) {
  const std::string& model = parameters.path("model");
  if (model == no_network) throw SceneValueError("detector.model", "no network is given; expected the path of an ONNX file");
  try {
    std::unique_ptr<network::Engine> engine = network::load_engine(model);
    network::Input input = engine->description().input;
    network::check_channels(input, source.type, source.channels);  // before the rate, which users can change
    Resampling resampling;
    // Frames reports another type of sensor.
    if (source.type == input.sensor && (!network::rate_fits(input, source.rate) || !source.uneven_times.empty())) {
      resampling = resampling_of(source, network::rate_read(input), "the network", network::least_rate(input));
      input = network::at_rate_read(input);
    }
    network::Frames frames(input, source.type, resampling.needed() ? resampling.rate : source.rate, source.channels);
    return resampled(std::make_unique<NetworkDetector>(std::move(engine), std::move(frames), source,
                                                       parameters.number("threshold"), parameters.number("latency")),
                     resampling, source, resampling_text(resampling, source, std::filesystem::path(model).filename().string()));
  } catch (const InputError& error) {
    const std::string what = error.what();
    throw SceneValueError("detector.model", what.starts_with(model) ? what : model + ": " + what);
  }
}

}  // namespace

DetectorKind network_detector() {
  return {
      {.name = "network",
       .summary =
           "A neural network from an ONNX file, whose metadata describe inputs and classes; recurrent states are kept from step to step.",
       .law =
           "frame: values of the sensor, processed as the file specifies: median, window, mean subtracted, spectrum, spreads, levels or units, image, (x - offset) scale\n"
           "p: sum of the probabilities of the classes that slip, of the last `history` frames\n"
           "slip is reported from the on-th consecutive frame with p >= threshold, for at least `least` frames and until `off` consecutive frames have p < threshold;\n"
           "the class is the most probable class that slips, otherwise the most probable that does not\n"
           "feature class: number of the most probable class, for networks with more than two classes\n"
           "no contact: until the first frames are complete; later if the network has such a class",
       .source = "the file; how to make one: detectors/network/README.md",
       .parameters = {path_spec("model", no_network, "The ONNX file.", "set for each scene"),
                      number_spec("latency", Quantity::time, "0 s", non_negative,
                                  "Time of a step of the network on the robot, by which the estimate is delayed in the loop.",
                                  "set for each scene"),
                      number_spec("threshold", Quantity::none, "0", fraction,
                                  "Probability p above which the pad slips; 0: the threshold in the file.",
                                  "set for each scene")}},
      make_network,
      nullptr,
      FrameSpacing::own,
      {"FFTW", "network"},
      false,
      false,
      DetectorFile{"model", DetectorFile::Content::network, true}};
}

}  // namespace slipbench
