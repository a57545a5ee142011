// Bindings for tools/studies: result pages, replay of recorded trials by detectors, figures of
// answers, timing of the hyperdimensional engines, cross-validation and training of hyperdimensional
// detectors, boards of detectors, positions of electrodes.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "detectors/hd/engine.h"
#include "detectors/hd/features.h"
#include "detectors/hd/memories.h"
#include "detectors/hd/model.h"
#include "detectors/hd/words.h"
#include "python/arrays.h"
#include "python/library_call.h"
#include "python/module.h"
#include "sensors/biotac_sp/skin.h"
#include "sim/api/detector.h"
#include "sim/core/choice.h"
#include "sim/core/error.h"
#include "tools/benchmark/benchmark.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/doctor/doctor.h"
#include "tools/eval/metrics.h"
#include "tools/eval/replay.h"
#include "tools/files/reject.h"
#include "tools/learning_data/label_rules.h"
#include "tools/learning_data/samples.h"
#include "tools/page/page.h"
#include "tools/registry/program_catalogues.h"
#include "tools/statistics/descriptive.h"
#include "tools/train/train_hd.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

constexpr page::PageKind result_kind{
    "a result", "slipbench reproduce", "result page", "result of a reproduction", {"reproduction"}};

// Output of a detector for each sample of a recorded sensor: states, feature values and the names
// of the features.
using Estimates =
    nb::typed<nb::tuple, nb::ndarray<nb::numpy, std::uint8_t>, nb::ndarray<nb::numpy, double>, std::vector<std::string>>;
Estimates estimates(const TrialRecord& record, const std::string& name, const std::string& type, const Pairs& parameters) {
  std::vector<std::uint8_t> states;
  std::vector<double> values;
  std::vector<std::string> names;
  {
    const nb::gil_scoped_release release;
    const auto sensor = std::ranges::find(record.sensors, name, &SensorRecord::name);
    if (sensor == record.sensors.end()) throw InputError("trial " + std::to_string(record.trial) + ": no sensor '" + name + "'");
    RecordedSamples samples(*sensor);
    const std::unique_ptr<Detector> detector =
        make_detector(eval::chosen_detector(type, overrides_of(parameters)), {sensor->name,
                                                                              sensor->type,
                                                                              sensor->rate,
                                                                              samples.channels(),
                                                                              record.trial,
                                                                              sensor->time.back(),
                                                                              record.seed,
                                                                              {samples.source()}});
    if (detector->listener() != nullptr) throw InputError("detector '" + type + "' reads other sensors too");
    while (!samples.ended()) {
      const SlipEstimate& now = detector->update(samples.take());
      states.push_back(static_cast<std::uint8_t>(now.state));
      values.insert(values.end(), now.features.begin(), now.features.end());
    }
    detector->finish();
    for (const Feature& feature : detector->features()) names.push_back(feature.name);
  }
  const std::size_t rows = states.size(), columns = rows == 0 ? 0 : values.size() / rows;
  return nb::make_tuple(array_of(std::move(states), {rows}), array_of(std::move(values), {rows, columns}), names);
}

// Names of the reference and of the kernel's paths, in the order of hd::KernelPath.
constexpr const char* reference_name = "plain C++";
constexpr std::array path_names{"portable", "AVX2", "AVX-512"};

std::string name_of(hd::KernelPath path) { return path_names.at(static_cast<std::size_t>(path)); }

// Engines that this machine can run, slowest first.
std::vector<std::string> hd_engines() {
  std::vector<std::string> names{reference_name};
  for (const hd::KernelPath path : hd::kernel_paths()) names.push_back(name_of(path));
  return names;
}

std::unique_ptr<hd::Engine> hd_engine(const std::string& name) {
  const hd::Model model;
  hd::Memories memories = hd::generate(model, 1);
  memories.associative = {memories.item[0], memories.item[1], memories.item[2]};
  if (name == reference_name) return hd::make_reference(model, memories);
  for (const hd::KernelPath path : hd::kernel_paths()) {
    if (name == name_of(path)) return hd::make_kernel(model, memories, path);
  }
  reject("engine: unknown {}{}", quote(name), allowed_names(name, hd_engines()));
}

// Keeps the compiler from removing a computation whose result is not read.
volatile std::uint64_t sink = 0;

// Median over the passes of the time per frame [s]; `update` classifies frame number i.
template <class Update>
double time_of_frame(std::size_t frames, std::size_t passes, const Update& update) {
  if (frames == 0 || passes == 0) reject("hd_time: {} frames, {} passes; allowed: 1 or more of each", frames, passes);
  const nb::gil_scoped_release release;
  const double pass = median_time(passes, [&] {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < frames; ++i) sum += update(i).distance[0];
    sink = sum;
  });
  return pass / static_cast<double>(frames);
}

using LevelRows = nb::ndarray<const std::uint8_t, nb::shape<-1, hd::pillar_count + 1>, nb::c_contig, nb::device::cpu>;
using DisplacementRows = nb::ndarray<const float, nb::shape<-1, 3 * hd::pillar_count>, nb::c_contig, nb::device::cpu>;

// Each row holds the levels of the pillars and the context.
double hd_time_of_levels(const std::string& name, const LevelRows& rows, std::size_t passes) {
  const std::unique_ptr<hd::Engine> engine = hd_engine(name);
  std::vector<hd::Frame> frames(rows.shape(0));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::span row(rows.data() + i * (hd::pillar_count + 1), hd::pillar_count + 1);
    std::ranges::copy(row.first(hd::pillar_count), frames[i].level.begin());
    frames[i].context = row.back();
  }
  return time_of_frame(frames.size(), passes, [&](std::size_t i) { return engine->update(frames[i]); });
}

// Each row holds the displacements of the pillars [m].
double hd_time_of_displacements(const std::string& name, const DisplacementRows& rows, std::size_t passes) {
  const std::unique_ptr<hd::Engine> engine = hd_engine(name);
  const auto row = [&](std::size_t i) { return std::span(rows.data() + i * 3 * hd::pillar_count, 3 * hd::pillar_count); };
  return time_of_frame(rows.shape(0), passes,
                       [&](std::size_t i) { return engine->update(hd::quantise(row(i), hd::Quantiser::fixed_point)); });
}

// Positions of a BioTac SP's electrodes on its core [electrodes, 3], m.
nb::ndarray<nb::numpy, double> electrode_places() {
  std::vector<double> values;
  for (const Eigen::Vector3d& place : biotac_sp::electrode_places()) values.insert(values.end(), place.begin(), place.end());
  return array_of(std::move(values), {biotac_sp::electrodes, 3});
}

// Value of a word. Throws InputError, naming `key`, for an unknown word.
template <class Words>
auto value_of_word(const Words& words, const char* key, const std::string& name) {
  if (const auto value = choice_value(words, name)) return *value;
  reject("{}: unknown {}{}", key, quote(name), allowed_names(name, choice_names(words)));
}

// The trials of a dataset, on which hyperdimensional detectors are cross-validated.
class HdSequences {
 public:
  HdSequences(const std::string& path, const std::string& labels) {
    const Hdf5Use alone;
    data_ = read_sequences(path, {parse_label_rule(labels, LabelUse::pillars), {}});
  }

  [[nodiscard]] const std::string& command() const { return data_.command; }
  [[nodiscard]] std::size_t size() const { return data_.sequences.size(); }

  // Removes the frames after the pad's last motion, and with `before` those before its first, by
  // the label no contact: such frames are used for neither training nor test.
  void leave_out_motionless(bool before) {
    for (Sequence& sequence : data_.sequences) {
      const auto first = std::ranges::find(sequence.moving, 1) - sequence.moving.begin();
      const auto end = sequence.moving.rend() - std::find(sequence.moving.rbegin(), sequence.moving.rend(), 1);
      if (before) std::fill_n(sequence.label.begin(), first, PadState::no_contact);
      std::fill(sequence.label.begin() + end, sequence.label.end(), PadState::no_contact);
    }
  }

  // Returns draws_json() by sequence, and with `by_frame` also by frame.
  std::vector<std::string> cross_validate(const std::string& encoding, bool context_driven, std::size_t window,
                                          std::size_t dimension, const std::string& compat, const std::string& ties,
                                          const std::string& quantiser, std::size_t epochs, std::uint64_t memories_seed,
                                          std::uint64_t seed, bool by_frame, std::size_t jobs) const {
    const nb::gil_scoped_release release;
    const hd::Model model{.dimension = dimension,
                          .window = window,
                          .encoding = value_of_word(hd::encoding_words, "encoding", encoding),
                          .context_driven = context_driven,
                          .ties = value_of_word(hd::ties_words, "ties", ties),
                          .compat = value_of_word(hd::compat_words, "compat", compat)};
    const hd::Memories memories = hd::generate(model, memories_seed);
    const std::vector<Sample> samples =
        encode(model, memories, value_of_word(hd::quantiser_words, "quantiser", quantiser), data_.sequences, jobs);
    std::vector<std::string> draws;
    for (const Split split : {Split::by_sequence, Split::by_frame}) {
      if (split == Split::by_sequence || by_frame)
        draws.push_back(
            draws_json(slipbench::cross_validate(model, memories, data_.sequences, samples, split, epochs, seed, jobs)).dump());
    }
    return draws;
  }

 private:
  TrainingData data_;
};

// The board of `slipbench benchmark` for one detector and the sensors of one type, as JSON.
std::string benchmark_detector(const std::string& detector, const std::string& sensor, std::size_t jobs) {
  benchmark::Options options;
  options.request.detectors = {detector};
  options.request.sensor = sensor;
  options.jobs = jobs;
  options.interrupt = &InterruptGuard::flag();
  return call_library([&] { return benchmark::benchmark(options).dump(); });
}

// Trains a hyperdimensional detector on all trials of a dataset, and writes its memories to the
// folder `output`.
void train_hd_on(const std::string& dataset, const std::string& output, const std::string& labels, std::size_t window,
                 std::uint64_t seed, std::size_t jobs) {
  HdTraining options;
  options.dataset = dataset;
  options.all = true;
  options.seed = seed;
  options.jobs = jobs;
  options.output = output;
  options.sequences.labels = parse_label_rule(labels, LabelUse::pillars);
  options.model.window = window;
  call_library([&] { return train_hd(options).trials; });
}

template <class T>
using Row = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// Answers of a detector in labelled recordings, judged as `slipbench eval` judges them.
class Judgements {
 public:
  // One recording. `labels`: PadState or unknown_state of each sample. `rate` [Hz]. `seen`: PadState
  // by the detector. `since` [s]: time at which its estimate was available. `probability`: NaN
  // without a new estimate.
  void add(const Row<double>& time, const Row<std::uint8_t>& labels, double rate, const Row<std::uint8_t>& seen,
           const Row<double>& since, const Row<double>& probability) {
    const std::size_t rows = time.size();
    if (labels.size() != rows || seen.size() != rows || since.size() != rows || probability.size() != rows)
      reject("recording {}: its arrays differ in length", all_.size());
    SensorRecord sensor;
    sensor.rate = rate;
    sensor.time.assign(time.data(), time.data() + rows);
    sensor.labels.truth = false;
    sensor.labels.state_paper.assign(labels.data(), labels.data() + rows);
    eval::Replayed replayed;
    for (std::size_t row = 0; row < rows; ++row) replayed.seen.push_back(static_cast<PadState>(seen.data()[row]));
    replayed.seen_since.assign(since.data(), since.data() + rows);
    replayed.probability.assign(probability.data(), probability.data() + rows);
    const eval::Truth truth = eval::truth_of(nullptr, TrialRecord{}, sensor, LabelRule::recorded);
    all_.push_back(eval::judged(all_.size(), truth, replayed));
  }

  // eval::summary_json() of the recordings, whose intervals treat recordings of one group as one
  // experiment. `groups`: one per recording; an empty one is a group of its own.
  [[nodiscard]] std::string summary(const std::vector<std::string>& groups) const {
    if (groups.size() != all_.size()) reject("{} groups for {} recordings", groups.size(), all_.size());
    std::vector<eval::Judgement> grouped = all_;
    for (std::size_t k = 0; k < grouped.size(); ++k) grouped[k].twin = groups[k];
    return eval::summary_json(eval::summarised(grouped)).dump();
  }

 private:
  std::vector<eval::Judgement> all_;
};

}  // namespace

void bind_studies(nb::module_& module) {
  module.def(
      "compose_page",
      [](const std::string& generator, const std::string& title, const std::string& body) {
        return page::compose_page({generator, title}, body);
      },
      nb::arg("generator"), nb::arg("title"), nb::arg("body"));
  module.def(
      "write_result",
      [](const std::string& path, const std::string& page, const std::string& object) {
        return page::write_page_files(path, result_kind, page, Json::parse(object));
      },
      nb::arg("path"), nb::arg("page"), nb::arg("object"));
  module.def("estimates", &estimates, nb::arg("record"), nb::arg("sensor"), nb::arg("detector"), nb::arg("parameters"));
  module.def("biotac_electrode_places", &electrode_places);
  module.def("machine", [] { return environment_json().dump(); });
  module.def("hd_size", [] { return std::pair(hd::Model{}.dimension, hd::Model{}.window); });
  module.def("hd_engines", &hd_engines);
  module.def("benchmark", &benchmark_detector, nb::arg("detector"), nb::arg("sensor"), nb::arg("jobs"));
  module.def("train_hd", &train_hd_on, nb::arg("dataset"), nb::arg("output"), nb::arg("labels"), nb::arg("window"),
             nb::arg("seed"), nb::arg("jobs"));
  module.def("hd_time", &hd_time_of_levels, nb::arg("engine"), nb::arg("levels"), nb::arg("passes"));
  module.def("hd_time_from_displacements", &hd_time_of_displacements, nb::arg("engine"), nb::arg("displacements"),
             nb::arg("passes"));
  nb::class_<Judgements>(module, "Judgements")
      .def(nb::init<>())
      .def("add", &Judgements::add, nb::arg("time"), nb::arg("labels"), nb::arg("rate"), nb::arg("seen"), nb::arg("since"),
           nb::arg("probability"))
      .def("summary", &Judgements::summary, nb::arg("groups"));
  nb::class_<HdSequences>(module, "HdSequences")
      .def(nb::init<const std::string&, const std::string&>(), nb::arg("path"), nb::arg("labels"))
      .def_prop_ro("command", &HdSequences::command)
      .def("__len__", &HdSequences::size)
      .def("leave_out_motionless", &HdSequences::leave_out_motionless, nb::arg("before"))
      .def("cross_validate", &HdSequences::cross_validate, nb::arg("encoding"), nb::arg("context_driven"), nb::arg("window"),
           nb::arg("dimension"), nb::arg("compat"), nb::arg("ties"), nb::arg("quantiser"), nb::arg("epochs"),
           nb::arg("memories_seed"), nb::arg("seed"), nb::arg("by_frame"), nb::arg("jobs"));
}

}  // namespace slipbench::python
