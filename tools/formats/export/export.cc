#include "tools/formats/export/export.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/json.h"
#include "tools/files/reject.h"
#include "tools/formats/export/formats.h"
#include "tools/learning_data/label_rules.h"
#include "tools/learning_data/myrmex_images.h"

namespace slipbench {
namespace {

double label_speed(const ExportOptions& options) { return options.label_speed.value_or(default_label_speed); }
LabelRule slip_rule(const ExportOptions& options) { return options.slip_rule.value_or(LabelRule::strict); }

bool is_pillar_log(ExportFormat format) { return format == ExportFormat::vendor_csv || format == ExportFormat::training_csv; }
// Returns true if the rule derives a pillar's slip from the speed of its tip.
bool is_of_the_tip(const ExportOptions& options) {
  return options.slip_rule == LabelRule::paper || options.slip_rule == LabelRule::has_slipped;
}

// Reads a sensor, at the requested rate.
SensorRecord sensor_of(const DatasetReader& reader, std::size_t trial, const std::string& name, const ExportOptions& options) {
  SensorRecord sensor = reader.read_sensor(trial, name);
  return options.rate ? at_rate(std::move(sensor), *options.rate, trial) : sensor;
}

// Names of the files written for a trial.
using Files = std::vector<std::string>;

Files export_vendor(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  const std::vector<std::string> names = papillarrays_of(reader, trial);
  for (const std::string& asked : options.sensors) {
    if (std::ranges::find(names, asked) == names.end()) {
      reject("trial {}: no papillarray '{}'; allowed: {}", trial, asked, fmt::join(names, ", "));
    }
  }
  std::vector<SensorRecord> records;
  for (const std::string& name : names) {
    if (options.sensors.empty() || std::ranges::find(options.sensors, name) != options.sensors.end())
      records.push_back(sensor_of(reader, trial, name, options));
  }
  std::vector<PapillarraySamples> sensors;
  for (const SensorRecord& record : records) sensors.emplace_back(record, slip_rule(options), label_speed(options));
  return {out.write(fmt::format("LOG_demo_{}.csv", trial), {"log of the vendor's software", &begins_as_vendor_csv},
                    vendor_csv(sensors))};
}

Files export_training(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  const std::vector<std::string> names = papillarrays_of(reader, trial);
  const std::vector<std::string>& asked = options.sensors.empty() ? names : options.sensors;
  if (asked.size() != 1 || std::ranges::find(names, asked.front()) == names.end()) {
    reject("trial {}: training-csv contains one papillarray; choose one with --sensor: {}", trial, fmt::join(names, ", "));
  }
  const TrialRecord record = reader.read_trial(trial);
  const auto sensor = std::ranges::find(record.sensors, asked.front(), &SensorRecord::name);
  const PapillarraySamples samples(*sensor, slip_rule(options), label_speed(options));
  const std::string name = training_file_name(trial, commanded_motion(reader, trial), record.body("pad"), record.body_time);
  return {out.write(name, {"file of 73 columns", &begins_as_training_csv}, training_csv(samples, sensor->rate))};
}

Files export_tables(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  Files files;
  for (const std::string& sensor : chosen_sensors(reader, trial, options.sensors)) {
    for (const CsvTable& table : table_csv(sensor_of(reader, trial, sensor, options), options.slip_rule)) {
      const std::string channel = table.channel.empty() ? "" : "-" + table.channel;
      files.push_back(out.write(fmt::format("demo_{}-{}{}.csv", trial, sensor, channel),
                                {"table of a sensor", &begins_as_table_csv}, table.text));
    }
  }
  return files;
}

Files export_slip(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  const std::vector<std::string> names = chosen_sensors(reader, trial, options.sensors);
  if (names.size() != 1)
    reject("trial {}: slip-csv contains one biotac_sp; choose one with --sensor: {}", trial, fmt::join(names, ", "));
  const SlipRecording recording = slip_csv(reader, trial, names.front());
  return {out.write(recording.name, {"recording of 24 electrodes", &begins_as_slip_csv}, recording.text)};
}

// Metadata of a trial that its arrays do not contain.
std::string about_trial(const DatasetReader& reader, const TrialRecord& record) {
  const DemoInfo info = reader.info(record.trial);
  Json about{
      {"slipbench", reader.header().version}, {"trial", record.trial}, {"seed", info.seed}, {"params", Json::parse(info.params)},
      {"outcome", Json::parse(info.outcome)}, {"split", nullptr}};
  for (const char* part : {"train", "valid", "test"}) {
    const std::vector<std::size_t> members = reader.mask(part);
    if (std::find(members.begin(), members.end(), record.trial) != members.end()) about["split"] = part;
  }
  for (const SensorRecord& sensor : record.sensors) {
    about["sensors"][sensor.name] = {
        {"type", sensor.type}, {"rate_hz", sensor.rate}, {"frame", sensor.frame}, {"channel_names", sensor.channel_names}};
  }
  for (const ArrayView& array : arrays_of(record)) {
    const std::string path = archive_path(record, array.path);
    about["units"][path] = array.unit;
    if (!array.codes.empty()) about["codes"][path] = Json::parse(array.codes);
  }
  return about.dump();
}

// Writes one file per Myrmex.
Files export_images(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  Files files;
  for (const std::string& sensor : chosen_sensors(reader, trial, options.sensors)) {
    if (options.sensors.empty() && reader.sensor_type(trial, sensor) != "myrmex") continue;
    files.push_back(out.write(fmt::format("demo_{}-{}.csv", trial, sensor), {"file of images", &begins_as_myrmex_csv},
                              myrmex_csv(reader.read_sensor(trial, sensor))));
  }
  if (files.empty()) reject("trial {}: no myrmex", trial);
  return files;
}

Files export_archive(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  const std::vector<std::string> chosen = chosen_sensors(reader, trial, options.sensors);
  TrialRecord record = reader.read_trial(trial);
  std::erase_if(record.sensors, [&](const SensorRecord& one) { return std::ranges::find(chosen, one.name) == chosen.end(); });
  for (SensorRecord& sensor : record.sensors) {
    if (options.rate) sensor = at_rate(std::move(sensor), *options.rate, trial);
  }
  if (options.format == ExportFormat::myrmex_rotated) record = turned_images(std::move(record));
  for (SensorRecord& sensor : record.sensors) {
    for (const LabelRuleInfo& rule : stored_rules()) {
      if (options.slip_rule && *options.slip_rule != rule.value) (sensor.labels.*rule.stored).clear();
    }
  }
  return {out.write(fmt::format("demo_{}.npz", trial), {"numpy archive of a trial", &begins_as_npz},
                    npz(record, about_trial(reader, record)))};
}

// Throws Interrupted if the innermost InterruptScope is interrupted.
void end_if_interrupted_after(const Files& files) {
  try {
    end_if_interrupted();
  } catch (const Interrupted&) {
    throw Interrupted(fmt::format("{} {} kept", counted(files.size(), "file"), files.size() == 1 ? "is" : "are"));
  }
}

std::string export_robomimic(const DatasetReader& reader, const std::vector<std::size_t>& trials, OutputFolder& out,
                             const ExportOptions& options, const ExportProgress& progress) {
  static_cast<void>(chosen_sensors(reader, trials.front(), options.sensors));
  const std::string path = out.prepare("robomimic.hdf5");
  check_robomimic_target(path, reader.files());
  out.remove_card();
  const auto report_progress = [&](std::size_t done, std::uintmax_t bytes) {
    end_if_interrupted();
    if (progress) progress(done, trials.size(), bytes);
  };
  write_robomimic(reader, trials, path, {options.sensors, options.rate, options.slip_rule, options.compress, report_progress});
  return path;
}

// A format and its options.
struct FormatKind {
  ExportFormat format;
  std::string_view name;
  bool of_readings = false;  // needs no truth
  bool every_rule = false;   // holds the state by every rule
  bool to_compress = false;  // compression is optional; other formats are always compressed or never
  std::string_view one_rate =
      {};  // reason why --rate does not apply: the layout has its own rate, or no rows in time; empty: it applies
  Files (*of_trial)(const DatasetReader&, std::size_t, OutputFolder&,
                    const ExportOptions&) = nullptr;  // null: not written per trial, or written by Python
};
constexpr std::array formats{
    FormatKind{ExportFormat::csv, "csv", true, true, true, "", &export_tables},
    FormatKind{ExportFormat::npz, "npz", true, true, false, "", &export_archive},
    FormatKind{ExportFormat::robomimic, "robomimic", false, true, true},
    FormatKind{ExportFormat::lerobot, "lerobot", true, true},
    FormatKind{ExportFormat::parquet, "parquet", true, true},
    FormatKind{ExportFormat::mcap, "mcap", true, true},
    FormatKind{ExportFormat::rosbag2, "rosbag2", true, true},
    FormatKind{ExportFormat::vendor_csv, "vendor-csv", false, false, true, "", &export_vendor},
    FormatKind{ExportFormat::training_csv, "training-csv", false, false, true, "has 1000 rows per second", &export_training},
    FormatKind{ExportFormat::grasp_csv, "grasp-csv", false, false, true, "has one row per grasp"},
    FormatKind{ExportFormat::myrmex_csv, "myrmex-csv", true, false, true, "has every image of the sensor, without times",
               &export_images},
    FormatKind{ExportFormat::myrmex_rotated, "myrmex-rotated", true, true, false, "", &export_archive},
    FormatKind{ExportFormat::slip_csv, "slip-csv", false, false, true, "has 100 rows per second", &export_slip}};

const FormatKind& kind_of(ExportFormat format) { return *std::ranges::find(formats, format, &FormatKind::format); }

// Names of the formats with a trait.
std::string names_with(bool FormatKind::*trait) {
  std::vector<std::string_view> names;
  for (const FormatKind& kind : formats) {
    if (kind.*trait) names.push_back(kind.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

// Throws InputError if the dataset has no labels by the requested rule.
void check_labels(const DatasetReader& reader, const ExportOptions& options) {
  if (options.slip_rule) {
    reader.check_truth(fmt::format("--labels {}", label_rule_name(*options.slip_rule)),
                       "--labels recorded, the labels of the recordings");
  } else if (options.recorded && reader.header().truth.empty()) {
    reject("{}: is simulated, so it has no recorded labels; allowed: --labels {}", reader.files().front(),
           fmt::join(label_rule_names(LabelUse::pillars), ", "));
  }
}

// The trials that the options ask for, ascending. Throws InputError if there are none, if one has
// no recording, or if the format needs the truth and the dataset has none.
std::vector<std::size_t> trials_to_export(const DatasetReader& reader, const ExportOptions& options) {
  const std::string path = reader.files().front();
  if (reader.trials().empty()) reject("{}: contains no trial", path);
  if (!kind_of(options.format).of_readings) {
    reader.check_truth(fmt::format("--format {}", export_format_name(options.format)),
                       fmt::format("a simulated dataset, or --format {}", names_with(&FormatKind::of_readings)));
  }
  std::vector<std::size_t> trials = options.trial ? std::vector<std::size_t>{*options.trial} : reader.trials();
  if (!options.split.empty()) {
    const std::vector<std::size_t> members = reader.mask(options.split);
    std::erase_if(trials, [&](std::size_t trial) { return std::ranges::find(members, trial) == members.end(); });
    if (trials.empty()) {
      reject("{}: the split '{}' contains {}; choose another --split", path, options.split,
             options.trial ? fmt::format("no trial {}", *options.trial) : "no trial");
    }
  }
  check_labels(reader, options);
  for (const std::size_t trial : trials) reader.check_recorded(trial);
  return trials;
}

Files export_trials(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                    const ExportProgress& progress) {
  const DatasetReader reader = checked_dataset(dataset_path);
  const std::vector<std::size_t> trials = trials_to_export(reader, options);
  OutputFolder out(out_dir, reader.files(), options.compress);
  if (options.format == ExportFormat::robomimic) return {export_robomimic(reader, trials, out, options, progress)};
  if (options.format == ExportFormat::grasp_csv) {
    if (progress) progress(1, trials.size(), grasp_csv(reader, {trials.front()}).size());
    const std::string table = grasp_csv(reader, trials);
    end_if_interrupted();
    return {out.write("grasps.csv", {"table of grasps", &begins_as_grasp_csv}, table)};
  }
  Files files;
  std::uintmax_t bytes = 0;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    for (std::string& file : kind_of(options.format).of_trial(reader, trials[k], out, options)) {
      bytes += std::filesystem::file_size(file);
      files.push_back(std::move(file));
    }
    end_if_interrupted_after(files);
    if (progress) progress(k + 1, trials.size(), bytes);
  }
  return files;
}

bool is_gzip(std::string_view beginning) { return beginning.starts_with("\x1f\x8b"); }

// Throws InputError if a gzip file at `path` holds another kind of text.
void check_packed(const std::string& path, const TextKind& kind) {
  std::ifstream file(path, std::ios::binary);
  std::string beginning(1 << 12, '\0');
  file.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  beginning.resize(static_cast<std::size_t>(file.gcount()));
  if (beginning.empty() || kind.begins(beginning_of_gzip(beginning))) return;
  reject("cannot write {0}: {0} exists and is not a {1}; choose a new name, or a {1} to replace", path, kind.name);
}

constexpr int level = 4;               // as in datasets
constexpr int container = 16;          // for gzip, added to the window bits
constexpr int memory = 8;              // zlib's default
constexpr std::size_t most = 1 << 30;  // maximum number of bytes per call of zlib: its counters have 32 bits
constexpr std::size_t beginning = 1 << 16;

// zlib takes its input as a non-const pointer but does not change it.
Bytef* input_of(std::string_view bytes) { return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data())); }

constexpr std::array python_formats{ExportFormat::lerobot, ExportFormat::parquet, ExportFormat::mcap, ExportFormat::rosbag2};

constexpr std::string_view card_beginning = "---\n# Written by slipbench export.\n";  // as card.py writes it
constexpr std::string_view croissant_beginning = "{\n \"@context\": {\n  \"@language\": \"en\",";
constexpr std::array cards{std::pair{"/README.md", card_beginning}, std::pair{"/croissant.json", croissant_beginning}};

// The exported sensors. Formats written by Python require the same sensors in all trials; other
// formats may omit those that a trial lacks.
std::vector<std::string> sensors_of(const DatasetReader& reader, const std::vector<std::size_t>& trials,
                                    const ExportOptions& options) {
  std::vector<std::string> sensors = chosen_sensors(reader, trials.front(), options.sensors);
  for (const std::size_t trial : trials) {
    const std::vector<std::string> found = chosen_sensors(reader, trial, options.sensors);
    if (found != sensors && is_python_format(options.format)) {
      reject(
          "trial {} has the sensors {}, but trial {} has {}; choose the sensors that all trials have with --sensors, or one trial with --trial",
          trial, fmt::join(found, ", "), trials.front(), fmt::join(sensors, ", "));
    }
    for (const std::string& name : found) {
      if (std::ranges::find(sensors, name) == sensors.end()) sensors.push_back(name);
    }
  }
  return sensors;
}

void check_licence(const ExportOptions& options) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '+';
  };
  if (!std::ranges::all_of(options.licence, is_plain))
    reject("--licence: expected a name such as cc-by-4.0, of letters, digits, '-', '.' and '+', found {}",
           quote(options.licence));
}

}  // namespace

ExportFormat parse_export_format(const std::string& name) {
  const auto found = std::ranges::find(formats, name, &FormatKind::name);
  if (found != formats.end()) return found->format;
  reject("unknown format {}{}", quote(name), allowed_names(name, export_format_names()));
}
std::string export_format_name(ExportFormat format) { return std::string(kind_of(format).name); }
std::vector<std::string> export_format_names() { return choice_names(formats); }

void set_label_rule(ExportOptions& options, const std::string& name) {
  options.recorded = name == "recorded";
  if (!options.recorded) options.slip_rule = parse_label_rule(name, LabelUse::pillars);
}

void check_export_options(const ExportOptions& options) {
  const FormatKind& kind = kind_of(options.format);
  const bool pillars_only = is_pillar_log(options.format);
  if (options.label_speed && !(pillars_only && is_of_the_tip(options))) {
    reject(
        "the label rule '{}' of {} has no label speed; --label-speed needs --labels paper or --labels has_slipped "
        "with vendor-csv or training-csv",
        label_rule_name(slip_rule(options)), kind.name);
  }
  if (options.slip_rule && !pillars_only) {
    if (!kind.every_rule) {
      reject("{} contains no states by a rule; --labels needs vendor-csv, training-csv, {}", kind.name,
             names_with(&FormatKind::every_rule));
    }
    if (const LabelRuleInfo& rule = about_rule(*options.slip_rule); array_of(rule).empty()) {
      reject("{} contains no state by the rule '{}'; allowed: --labels {}", kind.name, rule.name,
             fmt::join(choice_names(stored_rules()), ", "));
    }
  }
  if (options.rate && !kind.one_rate.empty()) {
    reject("--rate cannot be combined with {}, which {}", kind.name, kind.one_rate);
  }
  if (options.compress && !kind.to_compress) {
    reject("{} is always compressed; --compress needs {}", kind.name, names_with(&FormatKind::to_compress));
  }
  if (!options.sensors.empty() && options.format == ExportFormat::grasp_csv) {
    throw InputError("grasp-csv always contains the sensors ff, mf and th; leave --sensors out");
  }
  if (options.points && options.format != ExportFormat::lerobot)
    reject("{} cannot contain points of units; --points needs lerobot", kind.name);
  if (!options.licence.empty()) check_licence(options);
  const std::vector<std::string> splits{"train", "valid", "test"};
  if (!options.split.empty() && std::ranges::find(splits, options.split) == splits.end()) {
    reject("unknown split {}{}", quote(options.split), allowed_names(options.split, splits));
  }
}

std::vector<std::string> export_dataset(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                                        ExportProgress progress) {
  check_export_options(options);
  const ExportProgress report_progress = std::move(progress);  // destroyed before an error is reported
  return export_trials(dataset_path, out_dir, options, report_progress);
}

OutputFolder::~OutputFolder() {
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder)
    ::rmdir(folder->c_str());  // fails unless the folder is empty
}

std::string OutputFolder::write(const std::string& name, const TextKind& kind, const std::string& bytes) {
  const std::string path = prepare(compress_ ? name + ".gz" : name);
  check_text_target(path, inputs_, compress_ ? TextKind{kind.name, &is_gzip} : kind);
  if (compress_) check_packed(path, kind);
  remove_card();
  write_text_file(path, compress_ ? gzip(bytes) : bytes);
  return path;
}

std::string OutputFolder::prepare(const std::string& name) {
  // Sensors, materials and channels name the files, and an untrusted dataset may hold any text.
  const std::filesystem::path parts(name);
  if (printable(name) != name || parts.is_absolute() || std::ranges::find(parts, std::filesystem::path("..")) != parts.end()) {
    reject("cannot write a file called {}; names in the dataset must not have control characters or lead out of {}", quote(name),
           path_);
  }
  make(path_);
  const std::filesystem::path path = std::filesystem::path(path_) / name;
  if (const std::string folder = path.parent_path().string(); name.find('/') != std::string::npos) make(folder);
  return path.string();
}

void OutputFolder::remove_card() const {
  for (const auto& [name, beginning] : cards) {
    const std::string path = path_ + name;
    std::string found(beginning.size(), '\0');
    std::ifstream file(path, std::ios::binary);
    if (file.read(found.data(), static_cast<std::streamsize>(found.size())) && found == beginning) ::unlink(path.c_str());
  }
}

void OutputFolder::make(const std::string& folder) {
  if (::mkdir(folder.c_str(), 0777) == 0) {
    made_.push_back(folder);
    return;
  }
  const int reason = errno;
  if (reason == EEXIST && std::filesystem::is_directory(folder)) return;
  reject("cannot create the folder {}: {}", folder, std::strerror(reason));
}

std::string gzip(std::string_view text) {
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS + container, memory, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string bytes;
  std::string part(beginning, '\0');
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0 && !text.empty()) {
      stream.next_in = input_of(text);
      stream.avail_in = static_cast<uInt>(std::min(text.size(), most));
      text.remove_prefix(stream.avail_in);
    }
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    status = deflate(&stream, text.empty() ? Z_FINISH : Z_NO_FLUSH);
    bytes.append(part, 0, part.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return bytes;
}

std::string beginning_of_gzip(std::string_view bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, MAX_WBITS + container) != Z_OK) throw std::bad_alloc();
  std::string text(beginning, '\0');
  stream.next_in = input_of(bytes);
  stream.avail_in = static_cast<uInt>(std::min(bytes.size(), most));
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  inflate(&stream, Z_SYNC_FLUSH);  // the status does not matter: partial output suffices
  text.resize(text.size() - stream.avail_out);
  inflateEnd(&stream);
  return text;
}

bool is_python_format(ExportFormat format) { return std::ranges::find(python_formats, format) != python_formats.end(); }

void check_card_target(const std::string& out_dir) {
  if (std::error_code error; !std::filesystem::is_directory(out_dir, error)) return;
  const auto begins_with = [](std::string_view beginning) {
    return [beginning](std::string_view text) { return text.starts_with(beginning); };
  };
  check_text_target(out_dir + "/README.md", {}, {"dataset card of an export", begins_with(card_beginning)});
  check_text_target(out_dir + "/croissant.json", {}, {"description of an export", begins_with(croissant_beginning)});
}

Json export_request(const std::string& dataset_path, const std::string& out_dir, const ExportOptions& options,
                    const std::vector<std::string>& files) {
  const DatasetReader reader = checked_dataset(dataset_path);
  const std::vector<std::size_t> trials = trials_to_export(reader, options);
  const bool is_log = is_pillar_log(options.format);
  return {{"format", export_format_name(options.format)},
          {"dataset", dataset_path},
          {"out", out_dir},
          {"trials", trials},
          {"sensors", sensors_of(reader, trials, options)},
          {"rate", or_null(options.rate)},
          {"labels", is_log || options.slip_rule ? Json(label_rule_name(slip_rule(options))) : Json()},
          {"label_speed", is_log && is_of_the_tip(options) ? Json(label_speed(options)) : Json()},
          {"points", options.points},
          {"licence", options.licence},
          {"files", files}};
}

}  // namespace slipbench
