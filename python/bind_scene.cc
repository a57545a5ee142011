// Bindings of scenes: trials in memory, sweeps to datasets, checks, and descriptions of catalogues.
#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>

#include <unistd.h>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "detectors/network/engine.h"
#include "python/library_call.h"
#include "python/module.h"
#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"
#include "sim/core/process/interrupted.h"
#include "tools/check/check.h"
#include "tools/cli/command.h"
#include "tools/cli/commands/command_table.h"
#include "tools/cli/commands/detectors/detector_commands.h"
#include "tools/cli/format/check_text.h"
#include "tools/cli/format/describe.h"
#include "tools/cli/program.h"
#include "tools/dataset/record/sample_timing.h"
#include "tools/eval/detect.h"
#include "tools/eval/evaluate.h"
#include "tools/eval/replay.h"
#include "tools/files/project/project_file.h"
#include "tools/learning_data/label_rules.h"
#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/warnings.h"
#include "tools/trial/trial_run.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

// Time stamps of samples [s].
using Times = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
std::span<const double> span_of(const Times& times) { return {times.data(), times.size()}; }

// Called with the numbers of finished and of all trials.
using Progress = nb::typed<nb::object, nb::typed<nb::callable, void(std::size_t, std::size_t)>>;

// Forks like os.fork(), so that the child can run user classes. Call without Python's lock.
pid_t fork_with_python() {
  const nb::gil_scoped_acquire acquire;
  PyOS_BeforeFork();
  const pid_t child = ::fork();
  child == 0 ? PyOS_AfterFork_Child() : PyOS_AfterFork_Parent();
  return child;
}

Isolation isolation_of(bool isolate, double limit) { return {.on = isolate, .limit = limit, .fork = fork_with_python}; }

// Stop flag for trials in other threads.
struct Stop {
  std::atomic<bool> now = false;
};

// Force and displacement of one pad's units at each sample of its sensor, in the pad frame: [T, N,
// 3] each.
struct PadContact {
  std::size_t units = 0;
  std::vector<float> force;         // N
  std::vector<float> displacement;  // m
};

// A numpy array that owns `values`, of the shape [T, N, 3].
nb::object vectors_of(std::vector<float> values, std::size_t units) {
  auto* const held = new std::vector<float>(std::move(values));
  const nb::capsule owner(held, [](void* all) noexcept { delete static_cast<std::vector<float>*>(all); });
  const std::array<std::size_t, 3> shape{units == 0 ? 0 : held->size() / (3 * units), units, 3};
  return nb::cast(nb::ndarray<nb::numpy, float>(held->data(), shape.size(), shape.data(), owner));
}

// sensor name: (force, displacement).
using Contacts = nb::typed<nb::dict, nb::str, nb::typed<nb::tuple, nb::ndarray<nb::numpy, float>, nb::ndarray<nb::numpy, float>>>;

// A checked scene file with its overrides.
class Scene {
 public:
  // `text`: the scene, unless it is read from the file at `path`; relative paths in the scene begin
  // at the folder of `path`.
  Scene(std::string path, const Pairs& overrides, std::optional<std::string> text)
      : catalogues_(std::make_shared<const Catalogues>(program_catalogues())) {
    options_.scene_path = std::move(path);
    options_.overrides = overrides_of(overrides);
    nb::gil_scoped_release release;
    if (text) {
      file_ = SceneFile::from_text(std::move(*text), options_.scene_path, true);
    } else {
      file_ = SceneFile::load(options_.scene_path);
    }
    for (const Override& change : options_.overrides) file_.apply(change);
    seed_ = parse_scene(file_, *catalogues_).seed;
  }

  [[nodiscard]] const std::string& text() const { return file_.text(); }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }
  // Number of trials of the sweep with `draws` draws per cell; 0: as in the scene.
  [[nodiscard]] std::size_t trials(std::size_t draws) const { return TrialPlan(file_, *catalogues_, draws, seed_).size(); }

  // Warnings that `slipbench sweep` gives before it runs these trials. `build`: includes those
  // about sensors and steps. A non-empty `output`: includes those about the split.
  [[nodiscard]] Texts warnings(std::size_t draws, std::size_t limit, std::optional<std::uint64_t> seed, bool build,
                               const std::string& output, bool isolate, double limit_s) const {
    SweepOptions options = options_;
    options.trials = draws;
    options.limit = limit;
    options.output = output;
    options.isolation = isolation_of(isolate, limit_s);
    const std::uint64_t chosen = seed.value_or(seed_);
    const nb::gil_scoped_release release;
    const ReadSweep read{file_, chosen, plan_trials(file_, *catalogues_, options, chosen)};
    if (build) return texts_of(scene_warnings(read, options));
    std::vector<std::size_t> trials(read.planned.requested);
    std::iota(trials.begin(), trials.end(), std::size_t{0});
    return texts_of(scene_warnings(read.planned.plan, trials, false));
  }

  // Runs trial `trial` of the first `limit` ones. `stop`: ends it from another thread; null: Ctrl-C
  // ends it.
  [[nodiscard]] std::shared_ptr<TrialRecord> run(std::size_t trial, std::size_t draws, std::size_t limit, std::uint64_t seed,
                                                 bool full, const Stop* stop) const {
    std::optional<SharedInterrupt> guard;
    if (stop == nullptr) guard.emplace();
    const std::atomic<bool>* const interrupt = stop == nullptr ? &InterruptGuard::flag() : &stop->now;
    const nb::gil_scoped_release release;
    return simulate(trial, draws, limit, seed, [&](const TrialPlan::Trial& chosen) {
      TrialResult result =
          run_trial(chosen.scene, trial, full ? Recording::full : Recording::outcome, max_record_bytes, interrupt);
      if (!full) keep_outcome(result.record);
      return std::move(result.record);
    });
  }

  // Runs it with a full record, and returns the contact of each pad's units too.
  [[nodiscard]] nb::typed<nb::tuple, TrialRecord, Contacts> run_with_contact(std::size_t trial, std::size_t draws,
                                                                             std::size_t limit, std::uint64_t seed,
                                                                             const Stop* stop) const {
    std::optional<SharedInterrupt> guard;
    if (stop == nullptr) guard.emplace();
    const std::atomic<bool>* const interrupt = stop == nullptr ? &InterruptGuard::flag() : &stop->now;
    std::shared_ptr<TrialRecord> record;
    std::vector<PadContact> contacts;
    {
      const nb::gil_scoped_release release;
      record = simulate(trial, draws, limit, seed, [&](const TrialPlan::Trial& chosen) {
        const InterruptScope scope(interrupt);
        TrialRun run(chosen.scene, trial, Recording::full, max_record_bytes, interrupt);
        contacts.resize(run.sensors().size());
        while (!run.finished()) {
          for (const Tick& tick : run.step()) {
            if (tick.sample == nullptr) continue;
            const ContactFrame& felt = run.simulation().contact_part(tick.pad, FramePart::felt);
            PadContact& contact = contacts[tick.pad];
            contact.units = static_cast<std::size_t>(felt.force.cols());
            for (const double value : felt.force.reshaped()) contact.force.push_back(static_cast<float>(value));
            for (const double value : felt.displacement.reshaped()) contact.displacement.push_back(static_cast<float>(value));
          }
        }
        return run.finish().record;
      });
    }
    Contacts all;
    for (std::size_t pad = 0; pad < contacts.size(); ++pad) {
      PadContact& contact = contacts[pad];
      all[nb::str(record->sensors[pad].name.c_str())] = nb::make_tuple(
          vectors_of(std::move(contact.force), contact.units), vectors_of(std::move(contact.displacement), contact.units));
    }
    return nb::make_tuple(record, all);
  }

  // Runs the sweep into a dataset; returns the summary of run_sweep() as JSON.
  [[nodiscard]] std::string write(const std::string& output, std::size_t draws, std::size_t limit,
                                  std::optional<std::uint64_t> seed, std::size_t jobs, bool full, bool resume,
                                  const Progress& progress, bool isolate, double limit_s) const {
    SweepOptions options = options_;
    options.verb = limit == 0 ? "sweep" : "run";
    options.output = output;
    options.trials = draws;
    options.limit = limit;
    options.seed = seed;
    options.jobs = jobs;
    options.recording = full ? Recording::full : Recording::outcome;
    options.resume = resume;
    options.isolation = isolation_of(isolate, limit_s);
    const SharedInterrupt guard;
    options.interrupt = &InterruptGuard::flag();
    const auto report_progress = [&](const SweepProgress& at) {
      if (progress.is_none()) return;
      const nb::gil_scoped_acquire acquire;
      progress(at.done, at.total);
    };
    const Hdf5Use alone;
    const std::uint64_t chosen = seed.value_or(seed_);
    const ReadSweep read{file_, chosen, plan_trials(file_, *catalogues_, options, chosen)};
    const SweepSummary summary = run_sweep(read, options, *catalogues_, report_progress);
    Json json = Json::parse(summary_json(summary));
    json["warnings"] = warnings_json(trial_warnings(summary.trials));
    return json.dump();
  }

  [[nodiscard]] nb::typed<nb::dict, nb::str, nb::any> check(std::size_t draws, std::optional<std::uint64_t> seed,
                                                            std::size_t jobs, const std::string& folder, bool isolate,
                                                            double limit_s) const {
    CheckOptions options{.scene_path = options_.scene_path,
                         .overrides = options_.overrides,
                         .seed = seed,
                         .trials = draws,
                         .jobs = jobs,
                         .isolation = isolation_of(isolate, limit_s),
                         .folder = folder};
    SceneCheck result;
    {
      const SharedInterrupt guard;
      options.interrupt = &InterruptGuard::flag();
      const Hdf5Use alone;
      result = check_scene(options, *catalogues_);
    }
    nb::dict all;
    all["verdict"] = verdict_text(result.verdict);
    nb::list expectations;
    for (const ExpectationResult& one : result.expectations) {
      nb::dict entry;
      entry["name"] = one.name;
      entry["limit"] = one.limit;
      entry["kept"] = one.kept;
      entry["trials"] = one.trials;
      entry["needed"] = one.needed;
      entry["passed"] = one.passed();
      entry["worst"] = one.worst.value;
      entry["worst_trial"] = one.worst.trial;
      entry["replay"] = one.replay;
      expectations.append(entry);
    }
    all["expectations"] = expectations;
    all["table"] = check_text(result, Style(false));
    all["failures"] = nb::cast(result.failures);
    all["files"] = nb::cast(result.files);
    all["warnings"] = nb::cast(texts_of(result.warnings));
    return all;
  }

 private:
  // Runs `simulated` for trial `trial`, and adds its draws to the record. Call without Python's
  // lock.
  template <class Simulated>
  std::shared_ptr<TrialRecord> simulate(std::size_t trial, std::size_t draws, std::size_t limit, std::uint64_t seed,
                                        const Simulated& simulated) const {
    const std::shared_ptr<const PlannedTrials> planned = plan(trial, draws, limit, seed);
    TrialPlan::Trial chosen = planned->plan.trial(trial);
    chosen.scene.seed = seed;
    try {
      auto record = std::make_shared<TrialRecord>(simulated(chosen));
      record->params = params_json(chosen.drawn);
      return record;
    } catch (const SceneValueError& error) {
      throw InputError(planned->plan.where(trial, error.path()) + ": " + error.what());
    }
  }

  // The plan with the trial. The last plan is cached: a sweep requests it once per trial.
  [[nodiscard]] std::shared_ptr<const PlannedTrials> plan(std::size_t trial, std::size_t draws, std::size_t limit,
                                                          std::uint64_t seed) const {
    const std::lock_guard lock(plan_->mutex);
    const std::array<std::uint64_t, 3> wanted{draws, limit, seed};
    if (!plan_->kept || plan_->key != wanted || trial >= plan_->kept->requested) {
      SweepOptions options = options_;
      options.trials = draws;
      options.limit = limit;
      options.only = trial;
      plan_->kept = std::make_shared<const PlannedTrials>(plan_trials(file_, *catalogues_, options, seed));
      plan_->key = wanted;
    }
    return plan_->kept;
  }

  struct KeptPlan {
    std::mutex mutex;
    std::array<std::uint64_t, 3> key{};
    std::shared_ptr<const PlannedTrials> kept;
  };

  std::shared_ptr<const Catalogues> catalogues_;
  std::unique_ptr<KeptPlan> plan_ = std::make_unique<KeptPlan>();
  SweepOptions options_;
  SceneFile file_;
  std::uint64_t seed_ = 0;
};

std::string evaluate(const std::string& type, const Pairs& parameters, const std::string& dataset, const std::string& labels,
                     const std::string& sensor, const std::string& split, bool all, bool resample) {
  eval::Options options;
  options.detector = eval::chosen_detector(type, overrides_of(parameters));
  options.dataset = dataset;
  options.sensor = sensor;
  options.split = split;
  options.all = all;
  options.resample = resample;
  options.trained = eval::training_of(options.detector);
  if (!labels.empty()) options.labels = parse_label_rule(labels, LabelUse::evaluation);
  const Hdf5Use alone;
  return eval::evaluate(options).dump();
}

// Returns the result and the written files. `output` empty: no files.
std::pair<std::string, std::vector<std::string>> detect(const std::string& type, const Pairs& parameters,
                                                        const std::vector<std::string>& recordings, const std::string& sensor,
                                                        const std::string& output, bool resample) {
  eval::DetectOptions options;
  options.detector = eval::chosen_detector(type, overrides_of(parameters));
  options.recordings = recordings;
  options.sensor = sensor;
  options.resample = resample;
  const Hdf5Use alone;
  if (!output.empty()) eval::check_detect_output(output);
  const Json result = eval::detect(options);
  std::vector<std::string> files;
  if (!output.empty()) files = eval::write_detection(output, result);
  return {result.dump(), files};
}

std::vector<std::string> dataset_files(const std::string& path, bool content) {
  const SharedInterrupt guard;
  const nb::gil_scoped_release release;
  const InterruptScope scope(&InterruptGuard::flag());
  const std::string names = check_readable(content ? FileKind::dataset : FileKind::dataset_header, path);
  std::vector<std::string> files;
  for (std::size_t first = 0; first < names.size(); first += files.back().size() + 1) files.emplace_back(names.c_str() + first);
  return files;
}

std::string describe(const std::string& name) {
  const Catalogues catalogues = program_catalogues();
  Json entries = Json::array();
  for (const CatalogueItem& item : find_items(catalogue_items(catalogues), name))
    entries.push_back(describe_json(item, catalogues));
  return entries.dump();
}

// True if viewers show this channel of a sensor of this type as a picture.
bool is_image(const std::string& type, const std::string& channel) { return sensor_kind(type).view.channel_view(channel).image; }

std::string list_names() { return list_json(catalogue_items(program_catalogues()), catalogue_kinds()).dump(); }

// Number of samples in which the converters of recorded trials were at a limit of their range.
struct Converters {
  std::map<std::string, ConverterUse> sensors;

  void add(const TrialRecord& record) { count_converters(record, sensors); }
  [[nodiscard]] Texts warnings() const { return texts_of(converter_warnings(sensors)); }
};

}  // namespace

Texts texts_of(const std::vector<Warning>& warnings) {
  Texts texts;
  for (const Warning& warning : warnings) texts.emplace_back(warning.about, warning.text);
  return texts;
}

void bind_scene(nb::module_& module) {
  nb::class_<Stop>(module, "Stop").def(nb::init<>()).def("set", [](Stop& stop) { stop.now = true; });
  nb::class_<Converters>(module, "Converters")
      .def(nb::init<>())
      .def("add", &Converters::add)
      .def("warnings", &Converters::warnings);
  nb::class_<Scene>(module, "Scene")
      .def(nb::init<std::string, const Pairs&, std::optional<std::string>>(), nb::arg("path"), nb::arg("overrides"),
           nb::arg("text").none())
      .def_prop_ro("text", &Scene::text)
      .def_prop_ro("seed", &Scene::seed)
      .def("trials", &Scene::trials)
      .def("warnings", &Scene::warnings, nb::arg("draws"), nb::arg("limit"), nb::arg("seed").none(), nb::arg("build"),
           nb::arg("output"), nb::arg("isolate"), nb::arg("limit_s"))
      .def("run", &Scene::run, nb::arg("trial"), nb::arg("draws"), nb::arg("limit"), nb::arg("seed"), nb::arg("full"),
           nb::arg("stop").none())
      .def("run_with_contact", &Scene::run_with_contact, nb::arg("trial"), nb::arg("draws"), nb::arg("limit"), nb::arg("seed"),
           nb::arg("stop").none())
      .def("write", &Scene::write, nb::arg("output"), nb::arg("draws"), nb::arg("limit"), nb::arg("seed").none(), nb::arg("jobs"),
           nb::arg("full"), nb::arg("resume"), nb::arg("progress").none(), nb::arg("isolate"), nb::arg("limit_s"))
      .def("check", &Scene::check, nb::arg("draws"), nb::arg("seed").none(), nb::arg("jobs"), nb::arg("folder"),
           nb::arg("isolate"), nb::arg("limit_s"));
  module.def("evaluate", &evaluate);
  module.def("detect", &detect);
  module.def("print_detection", [](const std::string& result, const std::vector<std::string>& files, bool json) {
    print_whole([&] { print_detection(Json::parse(result), files, json); });
  });
  module.def("evenly_spaced", [](const Times& times, double resolution) { return evenly_spaced(span_of(times), resolution); });
  module.def("timing_text", [](const Times& times, double resolution) {
    return timing_text(timing_of(span_of(times), resolution), span_of(times).front());
  });
  module.def("dataset_files", &dataset_files, nb::arg("path"), nb::arg("content"));
  module.def("describe", &describe);
  module.def("is_image", &is_image);
  module.def("list_names", &list_names);
  module.def("project_file", [](const std::string& path) { return project_file(path); });
  module.def("main", [](const std::vector<std::string>& words) { return run_program(command_table(), words); });
}

}  // namespace slipbench::python
