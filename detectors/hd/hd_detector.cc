#include "detectors/hd/hd_detector.h"

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "detectors/channel.h"
#include "detectors/detector_kinds.h"
#include "detectors/hd/engine.h"
#include "detectors/hd/words.h"
#include "sim/core/choice.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace hd {
namespace {

constexpr const char* as_saved = "model";

ChannelPlace displacement_of(const FrameSource& source) {
  const ChannelPlace place = vector_channel(source, "displacement", "m", "the hyperdimensional classifier");
  if (source.type != "papillarray" || place.units != pillar_count) {
    throw SceneValueError("detector.sensor", "the hyperdimensional classifier needs the nine pillars of a papillarray, but " +
                                                 quote(source.sensor) + " is a " + source.type);
  }
  return place;
}

class HdDetector final : public Detector {
 public:
  HdDetector(Classify classify, double rate, const network::Alarm& alarm, const FrameSource& source)
      : classify_(std::move(classify)), displacement_(displacement_of(source)), stride_(stride_of(rate, source)), gate_(alarm) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    if (frames_++ % stride_ != 0) return estimate_;
    const Classified classified = classify_(frame.values.subspan(displacement_.first, 3 * pillar_count));
    estimate_ = {frame.time, classified.latency, reported(classified.state)};
    return estimate_;
  }

 private:
  PadState reported(PadState state) {
    if (state == PadState::no_contact) return state;
    if (slips(state)) slip_ = state;
    return gate_.push(slips(state)) ? slip_ : PadState::non_slip;
  }

  Classify classify_;
  ChannelPlace displacement_;
  std::size_t stride_;
  network::AlarmGate gate_;
  PadState slip_ = PadState::gross;  // the last class of slip
  std::size_t frames_ = 0;
  SlipEstimate estimate_;
};

SavedModel load_memories(const std::string& path) {
  try {
    return load(memories_folder(path), Model{});
  } catch (const InputError& error) {
    std::error_code ignored;
    const std::string shipped = std::string("; included classifiers: ") + default_memories + ", " + learnt_memories;
    throw SceneValueError("detector.memories",
                          error.what() + (std::filesystem::exists(memories_folder(path), ignored) ? "" : shipped));
  }
}

// Replaces `value` by the one that `word` names; a word outside the table ("as saved") keeps it.
template <class Words, class Value>
void take(const Words& words, const std::string& word, Value& value) {
  value = choice_value(words, word).value_or(value);
}

std::vector<std::string> or_as_saved(std::vector<std::string> words) {
  words.insert(words.begin(), as_saved);
  return words;
}

}  // namespace

std::size_t stride_of(double rate, const FrameSource& source) {
  const double frames = std::round(source.rate / rate);
  if (frames < 1.0 || std::abs(frames * rate - source.rate) > source.rate_rounding * source.rate) {
    throw SceneValueError("detector.rate", format_quantity(rate, Quantity::frequency) + " does not divide the " +
                                               format_quantity(source.rate, Quantity::frequency) + " of sensors." +
                                               source.sensor + "; allowed: the sensor's rate divided by a whole number");
  }
  return static_cast<std::size_t>(frames);
}

std::vector<ParameterSpec> detector_parameters() {
  return {
      path_spec("memories", default_memories,
                "Folder of the trained classifier with AM.hex, CIM.hex, CM.hex, IM.hex and model.txt.",
                "the folder included in the program", {learnt_memories}),
      number_spec("rate", Quantity::frequency, "100 Hz", positive,
                  "Rate of the classified frames, every k-th of the sensor's; the sensor's rate must be a multiple.",
                  "paper, section III-A"),
      choice_spec("quantiser", as_saved, or_as_saved(choice_names(quantiser_words)),
                  "How displacements are quantised to levels; model: as in model.txt.",
                  "without model.txt: fixed_point, as the published hardware"),
      choice_spec(
          "compat", as_saved, or_as_saved(choice_names(compat_words)),
          "Bundling - paper: as in the paper; published_core: as in the published core, which keeps its counts between the frames of a window; model: as in model.txt.",
          "without model.txt: paper"),
      choice_spec("ties", as_saved, or_as_saved(choice_names(ties_words)),
                  "Bit of a bundle that sums to zero; model: as in model.txt.", "without model.txt: one")};
}

SavedModel detector_model(const Parameters& parameters) {
  SavedModel saved = load_memories(parameters.path("memories"));
  take(quantiser_words, parameters.choice("quantiser"), saved.quantiser);
  take(compat_words, parameters.choice("compat"), saved.model.compat);
  take(ties_words, parameters.choice("ties"), saved.model.ties);
  return saved;
}

std::unique_ptr<Detector> make_detector(Classify classify, double rate, const network::Alarm& alarm, const FrameSource& source) {
  return std::make_unique<HdDetector>(std::move(classify), rate, alarm, source);
}

}  // namespace hd

namespace {

std::unique_ptr<Detector> make_gst_hd(const Parameters& parameters, const FrameSource& source) {
  const hd::SavedModel saved = hd::detector_model(parameters);
  const std::shared_ptr<hd::Engine> engine = hd::make_kernel(saved.model, saved.memories);
  const auto classify = [engine, quantiser = saved.quantiser](std::span<const float> displacement) {
    return hd::Classified{engine->update(hd::quantise(displacement, quantiser)).state, 0.0};
  };
  return hd::make_detector(classify, parameters.number("rate"), saved.alarm, source);
}

}  // namespace

DetectorKind gst_hd_detector() {
  return {
      {.name = "gst_hd",
       .summary = "Hyperdimensional classifier of the PapillArray's displacements, in software and without latency.",
       .law = "level of a pillar: |(d_x, d_y)| / |d| in 21 steps; GST_t = prod_k rho^k GS_{t-k} over N frames\n"
              "class: the prototype nearest to GST_t once bound with the context, which is the compression of the centre pillar\n"
              "slip is reported after `on` consecutive frames of slip, a number in model.txt (default: 1)\n"
              "no contact: only the first N - 1 frames; later a pad without contact gets one of the other three classes",
       .source =
           "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile Sensor, section III",
       .parameters = hd::detector_parameters()},
      make_gst_hd,
      nullptr,
      FrameSpacing::even,
      {},
      false,
      false,
      DetectorFile{"memories", DetectorFile::Content::memories}};
}

}  // namespace slipbench
