// Bindings for training: frames, examples with their split, operating points and inference engines.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "detectors/network/description.h"
#include "detectors/network/engine.h"
#include "detectors/network/frames.h"
#include "python/arrays.h"
#include "python/library_call.h"
#include "python/module.h"
#include "sim/api/pad_state_names.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/statistics/confusion.h"
#include "tools/train/network/examples.h"
#include "tools/train/network/operating_point.h"
#include "tools/train/network/split.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using Rows = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Described = nb::typed<nb::dict, nb::str, nb::any>;

// Value of an option's word. Errors name `option`.
template <class Words>
auto value_of(const Words& words, const std::string& word, const char* option) {
  const auto found = choice_value(words, word);
  if (!found) reject("{}: unknown {}{}", option, quote(word), allowed_names(word, choice_names(words)));
  return *found;
}

network::Input input_of(const std::string& description) {
  return network::parse_description(description, "the description").input;
}

// Binds network::Frames for samples [T, values].
class FrameReader {
 public:
  using Channels = std::vector<std::tuple<std::string, std::vector<std::size_t>>>;

  FrameReader(const std::string& description, const std::string& type, double rate, const Channels& channels)
      : frames_(make(input_of(description), type, rate, channels)) {
    for (const auto& [name, shape] : channels) values_ += Channel{name, "", shape, {}}.size();
  }

  [[nodiscard]] std::size_t size() const { return frames_.size(); }
  [[nodiscard]] nb::ndarray<nb::numpy, float> latest() const {
    const std::span<const float> frame = frames_.latest();
    return array_of(std::vector<float>(frame.begin(), frame.end()));
  }
  void reset() { frames_.reset(); }
  bool push(const nb::ndarray<const float, nb::ndim<1>, nb::c_contig, nb::device::cpu>& sample) {
    check(sample.shape(0));
    return frames_.push({sample.data(), values_});
  }
  nb::typed<nb::tuple, nb::ndarray<nb::numpy, float>, nb::ndarray<nb::numpy, std::uint64_t>> all(const Rows& samples) {
    check(samples.shape(1));
    std::vector<float> features;
    std::vector<std::uint64_t> ends;
    frames_.reset();
    for (std::size_t row = 0; row < samples.shape(0); ++row) {
      if (!frames_.push({samples.data() + row * values_, values_})) continue;
      ends.push_back(row);
      features.insert(features.end(), frames_.latest().begin(), frames_.latest().end());
    }
    const std::size_t count = ends.size();
    return nb::make_tuple(array_of(std::move(features), {count, frames_.size()}), array_of(std::move(ends)));
  }

 private:
  static network::Frames make(const network::Input& input, const std::string& type, double rate, const Channels& channels) {
    std::vector<Channel> all;
    for (const auto& [name, shape] : channels) all.push_back({name, "", shape, {}});
    return {input, type, rate, all};
  }
  void check(std::size_t values) const {
    if (values != values_) reject("a sample of {}; expected {}, the values of all channels", counted(values, "value"), values_);
  }

  network::Frames frames_;
  std::size_t values_ = 0;
};

// Binds network::Engine for inputs [T, inputs].
class EngineOfFile {
 public:
  explicit EngineOfFile(const std::string& path) : engine_(network::load_engine(path)) {}

  [[nodiscard]] std::string description() const { return network::description_text(engine_->description()); }
  [[nodiscard]] std::size_t inputs() const { return engine_->inputs(); }
  void reset() { engine_->reset(); }
  nb::ndarray<nb::numpy, float> run(const Rows& inputs) {
    if (inputs.shape(1) != engine_->inputs())
      reject("inputs of {} per step; expected {}", counted(inputs.shape(1), "value"), engine_->inputs());
    std::vector<float> outputs;
    const std::size_t classes = engine_->description().classes.size();
    for (std::size_t step = 0; step < inputs.shape(0); ++step) {
      const std::span<const float> output = engine_->run({inputs.data() + step * inputs.shape(1), inputs.shape(1)});
      outputs.insert(outputs.end(), output.begin(), output.end());
    }
    return array_of(std::move(outputs), {inputs.shape(0), classes});
  }

 private:
  std::unique_ptr<network::Engine> engine_;
};

const char* part_name(train::Part part) {
  switch (part) {
    case train::Part::learns: return "learns";
    case train::Part::validates: return "validates";
    case train::Part::judges: return "judges";
    case train::Part::left_out: return "left_out";
  }
  return "";
}

nb::dict dict_of(train::Example& example, std::size_t inputs) {
  nb::dict all;
  all["trial"] = example.trial;
  all["sha256"] = example.sha256;
  all["own_part"] = example.part;
  all["dataset"] = example.dataset;
  all["twin"] = example.twin;
  all["sensor"] = example.sensor;
  all["material"] = example.material;
  all["object"] = example.object;
  all["speed"] = example.speed;
  all["mass"] = example.mass;
  all["touches"] = example.touches;
  all["holds"] = example.holds;
  all["onset"] = example.onset;
  all["turn"] = example.turn;
  all["time"] = array_of(std::move(example.time));
  std::vector<std::uint8_t> truth;
  for (const PadState state : example.truth) truth.push_back(static_cast<std::uint8_t>(state));
  all["truth"] = array_of(std::move(truth));
  const std::size_t frames = example.frames.label.size();
  all["features"] = array_of(std::move(example.frames.features), {frames, inputs});
  all["labels"] = array_of(std::move(example.frames.label));
  all["scored"] = array_of(std::move(example.scored));
  all["path"] = array_of(std::move(example.path));
  return all;
}

nb::list classes_as_pairs(train::ClassRule classes, LabelRule labels) {
  nb::list all;
  for (const network::Class& one : train::classes_of(classes, labels))
    all.append(nb::make_tuple(one.name, choice_name(pad_states, one.state)));
  return all;
}

inline constexpr std::array class_words{Choice<train::ClassRule>{"slip", train::ClassRule::slip},
                                        Choice<train::ClassRule>{"kind", train::ClassRule::kind},
                                        Choice<train::ClassRule>{"direction", train::ClassRule::direction}};

using ProgressCallback = nb::typed<nb::callable, nb::any(std::size_t, std::size_t)>;

// `split` empty: the examples are not divided, and all are for training.
Described read_examples(const std::vector<std::string>& paths, const std::string& description, const std::string& labels,
                        const std::string& classes, const std::string& sensor, std::size_t turned, std::size_t at_most,
                        std::uint64_t seed, const std::string& split, double held_out, bool divide_anew,
                        const std::optional<ProgressCallback>& progress) {
  if (paths.empty()) throw InputError("dataset: an empty list; expected at least one path");
  train::ExampleOptions options{.input = input_of(description),
                                .labels = parse_label_rule(labels, LabelUse::training),
                                .classes = value_of(class_words, classes, "classes"),
                                .sensor = sensor,
                                .turned = turned,
                                .at_most = at_most,
                                .seed = seed};
  const bool divided = !split.empty();
  const train::Split by = divided ? value_of(train::split_words, split, "split") : train::Split::trial;
  train::Examples read;
  std::vector<train::Part> parts;
  {
    const Hdf5Use alone;
    if (progress) {
      options.read = [&](std::size_t done, std::size_t trials) {
        const nb::gil_scoped_acquire held;
        (*progress)(done, trials);
      };
    }
    read = train::read_examples(paths, options);
    if (divide_anew) {
      for (train::Example& example : read.all) example.part.clear();
    }
    try {
      parts = divided ? train::split_examples(read.all, by, held_out, seed)
                      : std::vector<train::Part>(read.all.size(), train::Part::learns);
    } catch (const InputError& error) {
      reject("{}: {}", fmt::join(paths, ", "), error.what());
    }
  }
  nb::list examples;
  for (std::size_t i = 0; i < read.all.size(); ++i) {
    nb::dict one = dict_of(read.all[i], read.inputs);
    one["part"] = part_name(parts[i]);
    examples.append(one);
  }
  nb::dict all;
  all["command"] = read.command;
  all["sha256"] = read.sha256;
  all["inputs"] = read.inputs;
  nb::dict units;
  for (const network::ChannelPick& pick : read.input.channels) units[pick.name.c_str()] = pick.unit;
  all["units"] = units;
  all["classes"] = classes_as_pairs(options.classes, options.labels);
  all["examples"] = examples;
  return Described(all);
}

// Example of one sensor of a trial in memory, as in read_examples().
Described example_of(const TrialRecord& record, const std::string& sensor, const std::string& description,
                     const std::string& labels, const std::string& classes, std::size_t turn) {
  train::ExampleOptions options;
  options.input = input_of(description);
  options.labels = parse_label_rule(labels, LabelUse::training);
  options.classes = value_of(class_words, classes, "classes");
  const auto found = std::ranges::find(record.sensors, sensor, &SensorRecord::name);
  if (found == record.sensors.end()) reject("trial {}: has no sensor {}", record.trial, quote(sensor));
  train::Example example;
  {
    const nb::gil_scoped_release released;
    example = train::example_of(record, *found, options, turn);
  }
  const std::size_t inputs = example.frames.features.size() / example.frames.label.size();
  return Described(dict_of(example, inputs));
}

using Doubles = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
// Members of train::SlipSeries in their order; an empty path is unknown.
using Series = std::vector<
    std::tuple<Doubles, nb::ndarray<const std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>, Doubles, std::size_t, bool>>;

std::vector<train::SlipSeries> series_of(const Series& given) {
  std::vector<train::SlipSeries> all;
  for (const auto& [probability, truth, path, dataset, holds] : given) {
    if (probability.shape(0) != truth.shape(0))
      reject("series {}: {} for {}; expected one for each", all.size(), counted(probability.shape(0), "probability"),
             counted(truth.shape(0), "frame"));
    if (path.shape(0) != 0 && path.shape(0) != truth.shape(0))
      reject("series {}: {} of the path for {}; expected one for each, or none", all.size(), counted(path.shape(0), "value"),
             counted(truth.shape(0), "frame"));
    all.push_back({.probability = {probability.data(), probability.data() + probability.shape(0)},
                   .truth = {truth.data(), truth.data() + truth.shape(0)},
                   .path = {path.data(), path.data() + path.shape(0)},
                   .dataset = dataset,
                   .holds = holds});
  }
  return all;
}

// `choice`: "accuracy" (single frames), "alarms" (at most `limit` false ones per minute), "score"
// (`limit`: least specificity).
Described best_point(const Series& series, double period, const std::string& choice, double limit) {
  const std::vector<train::SlipSeries> all = series_of(series);
  const train::OperatingPoint point = [&] {
    if (choice == "accuracy") return train::most_accurate_point(all, period);
    if (choice == "alarms") return train::best_point(all, period, limit);
    if (choice == "score") return train::best_scoring_point(all, period, limit);
    reject("choice: unknown {}{}", quote(choice), allowed_names(choice, std::vector<std::string>{"accuracy", "alarms", "score"}));
  }();
  nb::dict found;
  found["threshold"] = point.threshold;
  found["on"] = point.alarm.on;
  found["off"] = point.alarm.off;
  found["least"] = point.alarm.least;
  found["alarms_per_minute"] = point.alarms_per_minute;
  return Described(found);
}

Described counts_at(const Series& series, double period, double threshold, std::size_t on, std::size_t off, std::size_t least) {
  const train::AlarmCounts counts = train::counts_at(series_of(series), threshold, {on, off, least});
  constexpr PadState slip = PadState::gross, hold = PadState::non_slip;
  nb::dict all;
  all["slip_called_slip"] = samples_in(counts.frames, slip, slip);
  all["slip_called_hold"] = samples_in(counts.frames, slip, hold);
  all["hold_called_slip"] = samples_in(counts.frames, hold, slip);
  all["hold_called_hold"] = samples_in(counts.frames, hold, hold);
  all["balanced_accuracy"] = balanced_slip_accuracy(counts.frames);
  all["f1"] = f1_of_slip(counts.frames);
  all["false_alarms"] = counts.false_alarms;
  all["slips"] = counts.slips;
  all["credit"] = counts.credit;
  all["alarms_per_minute"] = counts.alarms_per_minute(period);
  all["score"] = counts.score();
  all["specificity"] = counts.specificity();
  return Described(all);
}

// Properties of a label rule that Python needs. `array`: that of a sensor's labels with the states of the
// rule; empty: the states are derived. The others: members of LabelRuleInfo, empty for null.
struct RuleOfLabels {
  std::string name, array, evaluated_by, meaning, pillar_meaning;
};

std::vector<RuleOfLabels> rules_of_labels() {
  std::vector<RuleOfLabels> all;
  for (const LabelRuleInfo& rule : label_rules()) {
    all.push_back({rule.name, array_of(rule), label_rule_name(rule.evaluated_by), rule.meaning,
                   rule.pillar_meaning == nullptr ? "" : rule.pillar_meaning});
  }
  return all;
}

}  // namespace

void bind_learning(nb::module_& module) {
  nb::class_<RuleOfLabels>(module, "LabelRule")
      .def_ro("name", &RuleOfLabels::name)
      .def_ro("array", &RuleOfLabels::array)
      .def_ro("evaluated_by", &RuleOfLabels::evaluated_by)
      .def_ro("meaning", &RuleOfLabels::meaning)
      .def_ro("pillar_meaning", &RuleOfLabels::pillar_meaning);
  module.def("label_rules", &rules_of_labels);
  nb::class_<FrameReader>(module, "Frames")
      .def(nb::init<const std::string&, const std::string&, double, const FrameReader::Channels&>(), nb::arg("description"),
           nb::arg("type"), nb::arg("rate"), nb::arg("channels"))
      .def_prop_ro("size", &FrameReader::size)
      .def("push", &FrameReader::push)
      .def("latest", &FrameReader::latest)
      .def("reset", &FrameReader::reset)
      .def("all", &FrameReader::all);
  nb::class_<EngineOfFile>(module, "Engine")
      .def(nb::init<const std::string&>())
      .def_prop_ro("description", &EngineOfFile::description)
      .def_prop_ro("inputs", &EngineOfFile::inputs)
      .def("reset", &EngineOfFile::reset)
      .def("run", &EngineOfFile::run);
  module.def("engine_available", &network::engine_available);
  module.def("normalised_description", [](const std::string& text, const std::string& subject) {
    return network::description_text(network::parse_description(text, subject));
  });
  module.def("units_input", [](const std::string& path, const std::string& sensor, const std::string& description) {
    network::Description whole = network::parse_description(description, "the description");
    const auto [input, units] = train::units_input(path, sensor, whole.input);
    whole.input = input;
    return std::pair(network::description_text(whole), units);
  });
  module.def("read_examples", &read_examples, nb::arg("paths"), nb::arg("description"), nb::arg("labels"), nb::arg("classes"),
             nb::arg("sensor"), nb::arg("turned"), nb::arg("at_most"), nb::arg("seed"), nb::arg("split"), nb::arg("held_out"),
             nb::arg("divide_anew"), nb::arg("progress").none());
  module.def("example_of", &example_of, nb::arg("record"), nb::arg("sensor"), nb::arg("description"), nb::arg("labels"),
             nb::arg("classes"), nb::arg("turn"));
  module.def(
      "swept_object", [](const std::string& params) { return train::swept_facts(params).object; }, nb::arg("params"));
  module.def("best_point", &best_point, nb::arg("series"), nb::arg("period"), nb::arg("choice"), nb::arg("limit"));
  module.def("counts_at", &counts_at, nb::arg("series"), nb::arg("period"), nb::arg("threshold"), nb::arg("on"), nb::arg("off"),
             nb::arg("least"));
}

}  // namespace slipbench::python
