#include "tools/dataset/reader.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/record/content_digest.h"
#include "tools/dataset/run_folder.h"
#include "tools/dataset/stored_trials.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

using hdf5::check;
using hdf5::Handle;
using hdf5::members_of;
using hdf5::open_file;
using hdf5::open_object;
using hdf5::Place;

hid_t memory_type(double) { return H5T_NATIVE_DOUBLE; }
hid_t memory_type(float) { return H5T_NATIVE_FLOAT; }
hid_t memory_type(std::uint64_t) { return H5T_NATIVE_UINT64; }
hid_t memory_type(std::uint32_t) { return H5T_NATIVE_UINT32; }
hid_t memory_type(std::uint8_t) { return H5T_NATIVE_UINT8; }

// Calls `read`; an error that HDF5 finds is reported as damage of the file.
template <class Read>
auto read_safely(const std::string& path, const Read& read) {
  hdf5::initialise();
  try {
    return read();
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {
    reject("{}: is damaged: {}", path, error.what());
  }
}

template <class T>
struct Array {
  std::vector<std::size_t> shape;
  std::vector<T> values;
};

template <class T>
Array<T> read_array(const Place& place, const Handle& object) {
  Array<T> array{hdf5::array_extents(place, object), {}};
  array.values.resize(hdf5::count_of(place, array.shape, 1, hdf5::best_compression));
  if (!array.values.empty()) hdf5::read_values(place, object, memory_type(T{}), array.values.data());
  return array;
}

template <class T>
Array<T> read_array(const Place& place) {
  return read_array<T>(place, open_object(place));
}

// Reads an array that must have `rows` rows of extents `tail`.
template <class T>
std::vector<T> read_column(const Place& place, const Handle& object, std::size_t rows, const Extents& tail) {
  Array<T> array = read_array<T>(place, object);
  Extents expected{rows};
  expected.insert(expected.end(), tail.begin(), tail.end());
  if (array.shape != expected) {
    place.fail(fmt::format("has extents [{}], expected [{}]", fmt::join(array.shape, ", "), fmt::join(expected, ", ")));
  }
  return std::move(array.values);
}

template <class T>
std::vector<T> read_column(const Place& place, std::size_t rows, const Extents& tail) {
  return read_column<T>(place, open_object(place), rows, tail);
}

template <class T>
Array<T> read_numbers(const Place& place, const Handle& object, const std::string& name) {
  const hdf5::Attribute attribute = hdf5::open_attribute(place, object, name);
  Array<T> array{attribute.shape, std::vector<T>(hdf5::count_of(place, attribute.shape, 1, 1))};
  const H5T_class_t kind = H5Tget_class(attribute.type.get());
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) ||
      (!array.values.empty() && H5Aread(attribute.handle.get(), memory_type(T{}), array.values.data()) < 0)) {
    place.fail("attribute '" + name + "' is not a number");
  }
  return array;
}

template <class T>
T read_number(const Place& place, const Handle& object, const std::string& name) {
  const Array<T> array = read_numbers<T>(place, object, name);
  if (array.values.size() != 1) place.fail("attribute '" + name + "' is not a single number");
  return array.values.front();
}

std::vector<std::string> read_texts(const Place& place, const Handle& object, const std::string& name) {
  return hdf5::texts_of(place, hdf5::open_attribute(place, object, name), name);
}

FileAbout read_about(const Place& place) {
  const Handle object = open_object(place);
  if (H5Aexists(object.get(), "schema") <= 0)
    reject("{}: is an HDF5 file, but not a dataset of slipbench; expected a file that slipbench run, sweep or import wrote",
           place.file_name);
  const auto schema = read_number<std::uint64_t>(place, object, "schema");
  if (schema < oldest_dataset_schema || schema > dataset_schema) {
    place.fail(fmt::format("has schema {}; this program reads {} to {}", schema, oldest_dataset_schema, dataset_schema));
  }
  FileAbout about;
  about.schema = schema;
  if (H5Aexists(object.get(), "shards") > 0) {
    about.shards = read_number<std::uint64_t>(place, object, "shards");
    about.complete = read_number<std::uint64_t>(place, object, "complete") != 0;
  }
  about.header = {hdf5::text_of(place, object, "version"), hdf5::text_of(place, object, "scene"),
                  hdf5::text_of(place, object, "overrides"), read_number<std::uint64_t>(place, object, "seed"),
                  hdf5::text_of(place, object, "command")};
  if (H5Aexists(object.get(), "truth") > 0) about.header.truth = hdf5::text_of(place, object, "truth");
  if (H5Aexists(object.get(), "files") > 0) {
    about.header.files = parse_files(place.file_name, hdf5::text_of(place, object, "files"));
  }
  if (H5Aexists(object.get(), "sweep_shard") > 0) {
    about.header.part = parse_shard(place.file_name, hdf5::text_of(place, object, "sweep_shard"),
                                    read_number<std::uint64_t>(place, object, "sweep_trials"));
  }
  about.shard = read_number<std::uint64_t>(place, object, "shard");
  H5G_info_t list;
  check(H5Gget_info_by_name(place.file, "/data", &list, H5P_DEFAULT));
  about.trials = list.nlinks;
  if (H5Aexists(object.get(), "failed") > 0)
    about.failed = parse_failures(place.file_name, hdf5::text_of(place, object, "failed"));
  return about;
}

// True if a group or array exists at `place`, with all of its parent groups.
bool exists(const Place& place) {
  for (std::size_t end = 0; end != std::string::npos;) {
    end = place.object.find('/', end + 1);
    if (H5Lexists(place.file, place.object.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
  }
  return true;
}

StateCounts count_states(const Place& place, const std::vector<std::uint8_t>& states) {
  StateCounts counts{};
  for (const std::uint8_t state : states) {
    if (state >= counts.size()) place.fail(fmt::format("contains {}, which is not a state of a pad", state));
    ++counts[state];
  }
  return counts;
}

// Reads the counts of a demo without recording.
Confusion read_confusion(const Place& place, const Handle& group) {
  const Array<std::uint64_t> counts = read_numbers<std::uint64_t>(place, group, "confusion");
  Confusion confusion{};
  if (counts.shape != Extents{confusion.size(), confusion.size()}) place.fail("attribute 'confusion' does not fit 4 states");
  for (std::size_t i = 0; i < counts.values.size(); ++i) confusion[i / confusion.size()][i % confusion.size()] = counts.values[i];
  return confusion;
}

// Extents of a channel: the axes of a sensor's array after the first.
Extents tail_of(const std::vector<std::size_t>& shape) {
  return shape.empty() ? Extents{} : Extents(shape.begin() + 1, shape.end());
}

// Settles the outcome of a version before `detection`: the trial has slip if it has a delay or,
// without a delay, any slip in the samples.
void settle_old_detection(TrialOutcome& outcome, const Confusion& confusion) {
  outcome.judged_slip_time = outcome.detection_time - outcome.detection_delay;
  const bool in_samples = samples_in(confusion, PadState::incipient) + samples_in(confusion, PadState::gross) > 0;
  settle_detection(outcome, in_samples || !std::isnan(outcome.judged_slip_time));
}

// Returns a record with the demo's own attributes.
TrialRecord record_of(const Place& place, std::size_t trial, DemoInfo demo) {
  TrialRecord record;
  record.trial = trial;
  record.seed = demo.seed;
  record.params = std::move(demo.params);
  try {
    record.outcome = parse_outcome(demo.outcome);
  } catch (const InputError& error) {
    place.fail(error.what());
  }
  return record;
}

// The name of a run's folder is easily taken for that of a dataset.
void refuse_run_folder(std::string path) {
  constexpr std::string_view ending = ".h5.partial";
  while (path.size() > 1 && path.ends_with('/')) path.pop_back();
  std::error_code error;
  if (!path.ends_with(ending) || !std::filesystem::is_directory(path, error)) return;
  const std::string target = path.substr(0, path.size() - std::string_view(".partial").size());
  const std::string batch = first_batch_path(target);
  reject("{}: is the folder of the unfinished dataset {}; the same command with --resume finishes it{}", path, target,
         std::filesystem::exists(batch, error)
             ? fmt::format(", and {} has its finished trials, which verify and report read", batch)
             : ", but it has no finished trials yet");
}

}  // namespace

struct DatasetReader::State {
  DatasetHeader header;
  std::vector<std::string> files;
  static constexpr std::size_t most_open = 64;  // a killed sweep may leave thousands of files
  mutable std::map<std::size_t, Handle> open;   // by index into files
  std::vector<std::string> digests;
  std::vector<std::uint64_t> schemas;
  bool complete = false;
  std::vector<FailedTrial> failed;
  std::vector<std::size_t> trials;
  std::map<std::size_t, std::size_t> file_of;  // trial -> index into files

  // Opens the file if it is closed. Handles of other files may be closed by this call.
  [[nodiscard]] hid_t handle(std::size_t file) const {
    if (const auto found = open.find(file); found != open.end()) return found->second.get();
    if (open.size() == most_open) open.clear();
    const Handle& opened = open[file] = open_file(files[file]);
    if (file > 0) hdf5::keep_little(opened);
    return opened.get();
  }
  [[nodiscard]] Place root(std::size_t file) const { return {handle(file), files[file], "/"}; }
  [[nodiscard]] std::size_t index_of(std::size_t trial) const {
    const auto found = file_of.find(trial);
    if (found == file_of.end()) {
      reject("{}: no trial {}; {}", files.front(), trial,
             trials.empty() ? "the file contains no trials" : fmt::format("allowed: {} to {}", trials.front(), trials.back()));
    }
    return found->second;
  }
  [[nodiscard]] Place demo(std::size_t trial) const {
    const std::size_t file = index_of(trial);
    return {handle(file), files[file], demo_path(trial)};
  }

  // Reads one file's header; returns the number of files of the dataset, which a killed run did not
  // record.
  std::size_t add_file(const std::string& path, bool alone = false) {
    const std::size_t index = files.size();
    std::error_code error;  // opening the file reports it
    if (index > 0 && !std::filesystem::exists(path, error))
      reject("{}: no such file; expected file {} of the dataset that begins with {}", path, index, files.front());
    files.push_back(path);
    const Place place = root(index);
    FileAbout about = read_about(place);
    if (about.shard != index && !alone) {
      place.fail(fmt::format("is file {} of its dataset, but file {} was expected; open the first", about.shard, index));
    }
    if (index > 0 && !same_dataset(about.header, header)) {
      place.fail(fmt::format("belongs to another dataset than {}", files.front()));
    }
    schemas.push_back(about.schema);
    header = std::move(about.header);
    if (index == 0) failed = std::move(about.failed);
    for (const std::string& name : members_of({place.file, place.file_name, "/data"})) {
      const std::size_t trial = trial_number({place.file, place.file_name, "/data"}, name);
      trials.push_back(trial);
      if (!file_of.emplace(trial, index).second)
        place.fail(fmt::format("contains trial {}, as does another file of the dataset", trial));
    }
    const Handle root = open_object(place);
    const bool has_digest = about.shards || H5Aexists(root.get(), file_sha256_name) > 0;
    digests.push_back(has_digest ? hdf5::text_of(place, root, file_sha256_name) : "");
    // Batches do not record their number.
    if (!about.shards) return index + (std::filesystem::exists(shard_path(files.front(), index + 1), error) ? 2 : 1);
    complete = about.complete && (index == 0 || complete);
    return *about.shards;
  }

  // Reads the labels of an imported recording.
  [[nodiscard]] static LabelRecord read_rule(const Place& place, std::size_t rows) {
    LabelRecord labels;
    labels.truth = false;
    if (!exists(place)) return labels;
    labels.rule = hdf5::text_of(place, open_object(place), "rule");
    labels.state_paper = read_column<std::uint8_t>(place.below("state_paper"), rows, {});
    std::vector<std::uint8_t> known = labels.state_paper;
    std::erase(known, static_cast<std::uint8_t>(unknown_state));
    static_cast<void>(count_states(place.below("state_paper"), known));
    return labels;
  }

  [[nodiscard]] LabelRecord read_labels(const Place& place, const std::vector<double>& time) const {
    if (!header.truth.empty()) return read_rule(place, time.size());
    LabelRecord labels;
    const Handle group = open_object(place);
    const std::size_t units = read_numbers<double>(place, group, "k_normal").values.size();
    for_each_unit_attribute(labels, [&](const char* name, const char*, const Extents& tail, std::vector<double>& values) {
      values = read_numbers<double>(place, group, name).values;
      std::size_t expected = units;
      for (const std::size_t extent : tail) expected *= extent;
      if (values.size() != expected) place.fail(fmt::format("attribute '{}' does not fit {}", name, counted(units, "unit")));
    });
    for_each_label(labels, units, [&]<class T>(const char* name, const char*, const Extents& tail, std::vector<T>& column) {
      const Place at = place.below(name);
      column = read_column<T>(at, hdf5::open_below(at, group, name), time.size(), tail);
    });
    const std::size_t events = read_array<double>(place.below("events/t")).values.size();
    for_each_event_column(labels, [&]<class T>(const char* name, const char*, const Extents& tail, std::vector<T>& column) {
      column = read_column<T>(place.below(name), events, tail);
    });
    labels.state_count = count_states(place.below("state"), labels.state);
    labels.state_micro_count = count_states(place.below("state_micro"), labels.state_micro);
    return labels;
  }

  // Reads the control loop of a demo; empty if it has none. `sensors`: those of the demo. `grasp`:
  // set for a grasp, which has the gripper's columns and, with a guided arm, the arm's.
  [[nodiscard]] static std::optional<ControlRecord> read_control(const Place& demo, const std::vector<SensorRecord>& sensors,
                                                                 const std::optional<GraspOutcome>& grasp) {
    const Place place = demo.below(control_group);
    if (!exists(place)) return std::nullopt;
    if (!sensors.empty() && !sensors.front().labels.truth)
      place.fail("must not be in an imported recording, which has no control loop");
    const Handle group = open_object(place);
    ControlRecord control;
    control.detector = hdf5::text_of(place, group, "detector");
    // Datasets of versions without controllers lack the attribute.
    if (H5Aexists(group.get(), "controller") > 0) control.controller = hdf5::text_of(place, group, "controller");
    control.sensor = hdf5::text_of(place, group, "sensor");
    control.rate = read_number<double>(place, group, "rate_hz");
    if (sensors.empty()) {
      control.confusion = read_confusion(place, group);
      return control;
    }
    control.time = read_array<double>(place.below("t")).values;
    const auto read = [&]<class T>(const char* name, const char*, const Extents& tail, std::vector<T>& column) {
      column = read_column<T>(place.below(name), control.time.size(), tail);
    };
    for_each_control_column(control, read);
    if (grasp) for_each_grip_column(control.grip, read);
    if (grasp && grasp->turn) for_each_arm_column(control.grip, read);
    static_cast<void>(count_states(place.below("detector_class"), control.detector_class));
    const auto sensor = std::ranges::find(sensors, control.sensor, &SensorRecord::name);
    if (sensor == sensors.end()) place.fail(fmt::format("reads the sensor '{}', which the trial does not have", control.sensor));
    if (sensor->time != control.time) place.fail("does not have the times of its sensor");
    for (std::size_t row = 0; row < control.time.size(); ++row) {
      ++control.confusion[sensor->labels.state[row]][control.detector_class[row]];
    }
    return control;
  }
};

std::optional<FileAbout> file_about(const std::string& path) {
  refuse_run_folder(path);
  return read_safely(path, [&]() -> std::optional<FileAbout> {
    const Handle file = open_file(path);
    const Place place{file.get(), path, "/"};
    const Handle root = open_object(place);
    if (H5Aexists(root.get(), "schema") > 0) return read_about(place);
    if (H5Aget_num_attrs(root.get()) == 0 && members_of(place).empty()) place.fail("is empty");
    return std::nullopt;
  });
}

DatasetReader::DatasetReader(const std::string& path) : state_(std::make_unique<State>()) {
  refuse_run_folder(path);
  std::error_code error;  // opening the file reports it
  if (!std::filesystem::exists(path, error) && std::filesystem::exists(first_batch_path(path), error)) {
    reject("{}: no such file; {} contains finished trials of its unfinished sweep, which --resume continues", path,
           first_batch_path(path));
  }
  read_safely(path, [&] {
    std::size_t shards = state_->add_file(path);
    for (std::size_t k = 1; k < shards; ++k) shards = state_->add_file(shard_path(path, k));
  });
  std::sort(state_->trials.begin(), state_->trials.end());
}

DatasetReader::DatasetReader() : state_(std::make_unique<State>()) {}

DatasetReader DatasetReader::of_file(const std::string& path) {
  DatasetReader reader;
  read_safely(path, [&] { reader.state_->add_file(path, true); });
  std::ranges::sort(reader.state_->trials);
  return reader;
}

DatasetReader::~DatasetReader() = default;
DatasetReader::DatasetReader(DatasetReader&&) noexcept = default;
DatasetReader& DatasetReader::operator=(DatasetReader&&) noexcept = default;

const DatasetHeader& DatasetReader::header() const { return state_->header; }
std::vector<std::string> DatasetReader::files() const { return state_->files; }
const std::vector<std::string>& DatasetReader::content_sha256() const { return state_->digests; }
std::uint64_t DatasetReader::schema(std::size_t file) const { return state_->schemas[file]; }
bool DatasetReader::complete() const { return state_->complete; }
const std::vector<std::size_t>& DatasetReader::trials() const { return state_->trials; }
const std::vector<FailedTrial>& DatasetReader::failed() const { return state_->failed; }

std::size_t DatasetReader::file_of(std::size_t trial) const { return state_->index_of(trial); }

std::vector<std::size_t> DatasetReader::mask(const std::string& split) const {
  std::vector<std::size_t> trials;
  for (std::size_t k = 0; k < state_->files.size(); ++k) {
    const Place root = state_->root(k);
    if (H5Lexists(root.file, "/mask", H5P_DEFAULT) <= 0) continue;
    const Place place{root.file, root.file_name, "/mask/" + split};
    const Handle object = open_object(place);
    if (H5Iget_type(object.get()) != H5I_DATASET) place.fail("is not an array");
    for (const std::string& name : hdf5::texts_of(place, object)) trials.push_back(trial_number(place, name));
  }
  return trials;
}

std::map<std::size_t, std::string> DatasetReader::split() const {
  std::map<std::size_t, std::string> part_of;
  for (const char* part : {"train", "valid", "test"}) {
    for (const std::size_t trial : mask(part)) part_of[trial] = part;
  }
  if (part_of.empty()) return part_of;
  for (const std::size_t trial : trials()) part_of.try_emplace(trial, "none");
  return part_of;
}

DemoInfo DatasetReader::info(std::size_t trial) const {
  const Place place = state_->demo(trial);
  const Handle object = open_object(place);
  return {read_number<std::uint64_t>(place, object, "num_samples"), read_number<std::uint64_t>(place, object, "seed"),
          hdf5::text_of(place, object, "params"), hdf5::text_of(place, object, "outcome")};
}

std::vector<std::string> DatasetReader::sensors(std::size_t trial) const {
  if (info(trial).num_samples == 0) return {};
  return members_of(state_->demo(trial).below("sensors"));
}

std::vector<std::string> DatasetReader::bodies(std::size_t trial) const {
  if (info(trial).num_samples == 0 || !header().truth.empty()) return {};
  return members_of(state_->demo(trial).below("truth"));
}

void DatasetReader::check_recorded(std::size_t trial) const {
  if (info(trial).num_samples > 0) return;
  state_->demo(trial).fail("has only its outcome, no recording; expected a dataset written without --record outcome");
}

void DatasetReader::check_truth(const std::string& what, const std::string& allowed) const {
  if (header().truth.empty()) return;
  reject("{}: {} needs the truth, which it does not contain ({}); use {}", state_->files.front(), what, printable(header().truth),
         allowed);
}

std::string DatasetReader::sensor_type(std::size_t trial, const std::string& sensor) const {
  const Place place = state_->demo(trial).below(sensor_group(sensor));
  return hdf5::text_of(place, open_object(place), "type");
}

SensorRecord DatasetReader::read_sensor(std::size_t trial, const std::string& sensor) const {
  const Place demo = state_->demo(trial);
  const Place place = demo.below(sensor_group(sensor));
  const Handle group = open_object(place);
  SensorRecord record;
  record.name = sensor;
  record.type = hdf5::text_of(place, group, "type");
  record.rate = read_number<double>(place, group, "rate_hz");
  record.frame = hdf5::text_of(place, group, "frame");
  if (H5Aexists(group.get(), "follows") > 0) record.follows = hdf5::text_of(place, group, "follows");
  if (H5Aexists(group.get(), "mean_rate_hz") > 0) {
    record.timing.emplace();
    for_each_timing_attribute(*record.timing,
                              [&](const char* name, double& value) { value = read_number<double>(place, group, name); });
  }
  record.channel_names = read_texts(place, group, "channel_names");
  record.time = read_array<double>(place.below("t")).values;
  for (const std::string& name : read_texts(place, group, "channels")) {
    if (printable(name) != name)
      place.fail("attribute 'channels' contains " + quote(name) + "; allowed: names without control characters");
    const Place channel = place.below(name);
    Array<float> array = read_array<float>(channel);
    const std::string own_time = own_time_path(name);
    std::optional<std::vector<double>> time;
    if (H5Lexists(group.get(), own_time.c_str(), H5P_DEFAULT) > 0) time = read_array<double>(place.below(own_time)).values;
    const std::size_t rows = time ? time->size() : record.time.size();
    if (array.shape.empty() || array.shape[0] != rows) channel.fail("does not have one row for each sample");
    record.channels.push_back({name, hdf5::text_of(channel, open_object(channel), "unit"), tail_of(array.shape),
                               std::move(array.values), std::move(time)});
  }
  record.labels = state_->read_labels(demo.below(label_group(sensor)), record.time);
  return record;
}

Digest DatasetReader::stored_digest(std::size_t trial, const TrialRecord* read) const {
  const Place demo = state_->demo(trial);
  if (schema(file_of(trial)) == 1) return stored_arrays_digest(demo);
  std::map<std::string, ArrayView> arrays;
  std::map<const std::uint8_t*, std::size_t> shared;  // columns that the record stores once and the file several times
  for (const ArrayView& view : read == nullptr ? std::vector<ArrayView>() : arrays_of(*read)) {
    ++shared[view.bytes];
    arrays.emplace(view.path, view);
  }
  std::erase_if(arrays, [&](const auto& array) { return shared[array.second.bytes] > 1; });
  return stored_trial_digest(demo, arrays);
}

std::string DatasetReader::trial_sha256(std::size_t trial) const {
  const Place demo = state_->demo(trial);
  return schema(file_of(trial)) == 1 ? "" : hdf5::text_of(demo, open_object(demo), trial_sha256_name);
}

std::string DatasetReader::stored_sha256(std::size_t file, const std::vector<std::pair<std::size_t, Digest>>& trials) const {
  if (schema(file) > 1) return hexadecimal(stored_file_digest(state_->root(file), trials));
  std::vector<Digest> digests;
  for (const auto& [number, digest] : trials) digests.push_back(digest);
  return content_digest(digests);
}

TrialRecord DatasetReader::read_trial(std::size_t trial) const {
  const Place demo_place = state_->demo(trial);
  TrialRecord record = record_of(demo_place, trial, info(trial));
  const Handle demo_object = open_object(demo_place);
  if (H5Aexists(demo_object.get(), "model_sha256") > 0)
    record.model_sha256 = hdf5::text_of(demo_place, demo_object, "model_sha256");
  if (H5Aexists(demo_object.get(), libraries_name) > 0) record.libraries = hdf5::text_of(demo_place, demo_object, libraries_name);
  for (const std::string& sensor : sensors(trial)) record.sensors.push_back(read_sensor(trial, sensor));
  for (const std::string& body : bodies(trial)) {
    const Place place = state_->demo(trial).below(body_group(body));
    const std::vector<double> time = read_array<double>(place.below("t")).values;
    if (!record.bodies.empty() && time != record.body_time) place.fail("does not have the times of the other bodies");
    record.body_time = time;
    BodyRecord columns{body, {}, {}};
    for_each_body_column(columns, [&](const char* name, const char*, const Extents& tail, std::vector<float>& column) {
      column = read_column<float>(place.below(name), record.body_time.size(), tail);
    });
    const Handle group = open_object(place);
    if (H5Aexists(group.get(), "size") > 0) {
      columns.size = read_numbers<double>(place, group, "size").values;
      if (columns.size.size() != 3) place.fail("attribute 'size' is not three numbers");
    }
    record.bodies.push_back(std::move(columns));
  }
  if (!header().truth.empty() && !record.sensors.empty()) record.body_time = record.sensors.front().time;
  record.control = state_->read_control(state_->demo(trial), record.sensors, record.outcome.grasp);
  if (record.control && !record.control->detector.empty() && !record.outcome.detection) {
    settle_old_detection(record.outcome, record.control->confusion);
  }
  return record;
}

template <class T>
std::vector<T> DatasetReader::read(std::size_t trial, const std::string& path) const {
  return read_array<T>(state_->demo(trial).below(path)).values;
}

template std::vector<float> DatasetReader::read<float>(std::size_t, const std::string&) const;
template std::vector<double> DatasetReader::read<double>(std::size_t, const std::string&) const;
template std::vector<std::uint8_t> DatasetReader::read<std::uint8_t>(std::size_t, const std::string&) const;
template std::vector<std::uint32_t> DatasetReader::read<std::uint32_t>(std::size_t, const std::string&) const;

std::vector<std::size_t> DatasetReader::shape(std::size_t trial, const std::string& path) const {
  const Place place = state_->demo(trial).below(path);
  return hdf5::array_extents(place, open_object(place));
}

}  // namespace slipbench
