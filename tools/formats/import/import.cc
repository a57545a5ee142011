#include "tools/formats/import/import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/writer.h"
#include "tools/files/reject.h"
#include "tools/formats/import/resample.h"
#include "tools/formats/import/source_table.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {
namespace {

// All formats in the order of the help.
constexpr std::array<ImportFormat, 4> import_catalogue{{
    {"bts3v2", "grasps with three BioTac SP, one row per grasp: object, whether it slipped, 72 electrodes before the lift",
     "object", &read_bts3v2},
    {"biotacsp-dos", "a BioTac SP that slides, turns or rests, CLASS/OBJECT<number>.csv: 24 electrodes, 100 rows per second",
     "object", &read_biotacsp_dos},
    {"papillarray-csv", "logs of the PapillArray vendor's software with one or two sensors, one file per recording", "trial",
     &read_papillarray_csv},
    {"training-csv", "published training files of the PapillArray: 73 columns, no header, one file per recording", "trial",
     &read_training_csv},
}};

bool is_bag(const std::filesystem::path& folder) {
  std::error_code error;
  return std::filesystem::is_regular_file(folder / "metadata.yaml", error);
}

// Finds sources below a folder, without following links to folders.
class FolderScan {
 public:
  FolderScan(std::string folder, const std::vector<std::string>& endings, bool bags)
      : folder_(std::move(folder)), endings_(endings), bags_(bags) {}

  std::vector<std::string> paths() {
    namespace fs = std::filesystem;
    try {
      for (auto entry = fs::recursive_directory_iterator(folder_); entry != fs::recursive_directory_iterator(); ++entry)
        if (is_source(*entry, entry)) found_.push_back(entry->path().string());
    } catch (const fs::filesystem_error& error) {
      reject("{}: cannot be read: {}", folder_, error.code().message());
    }
    if (found_.empty())
      reject("{}: the folder contains no file {}; give a file, or a folder with such files", folder_, fmt::join(endings_, ", "));
    std::ranges::sort(found_);
    return std::move(found_);
  }

 private:
  bool is_source(const std::filesystem::directory_entry& entry, std::filesystem::recursive_directory_iterator& at) const {
    if (bags_ && entry.is_directory() && is_bag(entry.path())) {
      at.disable_recursion_pending();
      return true;
    }
    return entry.is_regular_file() && std::ranges::find(endings_, entry.path().extension().string()) != endings_.end();
  }

  std::string folder_;
  const std::vector<std::string>& endings_;
  bool bags_;
  std::vector<std::string> found_;
};

// True if `path` is `folder` or lies in it; both are canonical.
bool is_in(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

// Refuses links in the folders of the command that lead to files of other folders: a folder from
// others must not make the program read other files of the user.
class LinkCheck {
 public:
  explicit LinkCheck(const std::vector<std::string>& sources) {
    namespace fs = std::filesystem;
    std::error_code error;
    allowed_.push_back(fs::current_path(error));
    for (const std::string& source : sources) {
      const bool is_folder = fs::is_directory(source, error);
      allowed_.push_back(fs::canonical(is_folder ? fs::path(source) : fs::absolute(source).parent_path(), error));
    }
    // An empty path would contain every file.
    std::erase_if(allowed_, [](const fs::path& folder) { return folder.empty(); });
  }

  // Checks a file, or a bag with all files in it.
  void check(const std::string& path) const {
    namespace fs = std::filesystem;
    check_file(path);
    std::error_code error;
    if (!fs::is_directory(path, error)) return;
    for (auto entry = fs::recursive_directory_iterator(path, error); !error && entry != fs::recursive_directory_iterator();
         entry.increment(error))
      check_file(entry->path());
  }

 private:
  void check_file(const std::filesystem::path& path) const {
    std::error_code error;
    const std::filesystem::path target = std::filesystem::canonical(path, error);
    if (error) return;  // leads nowhere: reading the file fails
    if (std::ranges::any_of(allowed_, [&](const std::filesystem::path& folder) { return is_in(target, folder); })) return;
    reject(
        "{}: is a link to a file outside of the folders of the command; to read it, name the file or folder itself on the command line",
        path.string());
  }

  std::vector<std::filesystem::path> allowed_;
};

// The common parent folder of these paths.
std::filesystem::path common_folder(const std::vector<std::filesystem::path>& folders) {
  std::filesystem::path common = folders.front();
  for (const std::filesystem::path& folder : folders) {
    std::filesystem::path shared;
    for (auto one = common.begin(), other = folder.begin(); one != common.end() && other != folder.end() && *one == *other;
         ++one, ++other)
      shared /= *one;
    common = shared;
  }
  return common;
}

std::string canonical_import(const ImportOptions& options) {
  std::string command = "slipbench import";
  for (const std::string& source : options.sources) command += " " + shell_word(source);
  if (!options.map.empty()) command += " --map " + shell_word(options.map);
  if (options.rate) command += fmt::format(" --rate '{} Hz'", *options.rate);
  if (options.format != nullptr) command += fmt::format(" --format {}", options.format->name);
  return command + fmt::format(" --seed {}", options.seed);
}

DatasetHeader header_of(const ImportOptions& options, const std::string& split_by) {
  const SplitRule split{split_by, {0.70, 0.15, 0.15}, "as import does"};
  return {.version = SLIPBENCH_VERSION,
          .scene = "",
          .seed = options.seed,
          .command = canonical_import(options),
          .split = split,
          .truth = options.format == nullptr ? "none: imported by a map"
                                             : fmt::format("none: imported from {}", options.format->name)};
}

// Returns "; times in ms would give 100 Hz" for a rate that no tactile sensor has; else empty.
// `unit`: in which the times were read [s]; 0: dates, whose unit is known. `mapped`: true if the
// user can set the unit in a map.
std::string unit_hint(double rate, double unit, bool mapped) {
  constexpr double slowest = 5.0;  // Hz
  struct Unit {
    const char* name;
    double seconds;
  };
  constexpr std::array<Unit, 3> units{{{"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};
  if (rate >= slowest) return "";
  const auto* finer =
      std::ranges::find_if(units, [&](const Unit& one) { return one.seconds < unit && rate * unit / one.seconds >= slowest; });
  if (finer == units.end()) return "";
  const double other = std::round(1e6 * rate * unit / finer->seconds) / 1e6;  // Hz, without the rounding of the factors
  return fmt::format("; times in {} would give {}{}", finer->name, format_quantity(other, Quantity::frequency),
                     mapped ? fmt::format(" (time: {{unit: {}}} in the map)", finer->name) : "");
}

}  // namespace

struct RecordingWriter::Target {
  Target(const ImportOptions& options, const std::string& split_by) : writer(options.output, header_of(options, split_by)) {}

  DatasetWriter writer;
  TrialEncoder encoder;
};

RecordingWriter::RecordingWriter(const ImportOptions& options, const std::string& split_by) : options_(options) {
  if (!options.output.empty()) target_ = std::make_unique<Target>(options, split_by);
}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::warn(const std::string& path, const std::string& text) {
  summary_.warnings.push_back({path, path + ": " + text});
}

// Warns about the time stamps of a sensor in the source. `unit`: as for unit_hint().
void RecordingWriter::warn_of_timing(const SensorRecord& sensor, double unit, const std::string& path,
                                     const std::string& subject) {
  if (!sensor.timing) return;
  if (const std::string hint = unit_hint(sensor.rate, unit, options_.format == nullptr); !hint.empty())
    warn(path, fmt::format("{}has one sample every {:.4g} s{}", subject, 1.0 / sensor.rate, hint));
  if (!steps_vary(*sensor.timing)) return;
  const std::string timing = timing_text(*sensor.timing, sensor.time.front());
  if (evenly_spaced(sensor.time, sensor.timing->resolution)) {
    warn(path, fmt::format("{}the time between samples varies: {}", subject, timing));
  } else {
    warn(path, fmt::format("{}its samples are not evenly spaced: {}; `detect` and `eval` bridge steps of up to 0.1 s, "
                           "--rate RATE resamples it for all detectors",
                           subject, timing));
  }
}

// Resamples a recording and states it in its params.
void RecordingWriter::resample_and_note(TrialRecord& record, const std::string& path) {
  const double rate = *options_.rate;
  const NewSamples made = resample(record, rate, path);
  Json params = Json::parse(record.params);
  params["resampled"] = {{"rate_hz", rate}, {"samples_in_gaps", made.in_gaps}};
  if (made.made_up > 0) params["resampled"]["samples_made_up"] = made.made_up;
  record.params = params.dump();
  if (made.made_up > 0)
    warn(path, fmt::format("--rate {} is above the {:.6g} Hz of the recording: {} of {} lie between recorded ones, made up by "
                           "linear interpolation, so they show nothing above {:.4g} Hz",
                           format_quantity(rate, Quantity::frequency), made.recorded_rate, made.made_up,
                           counted(record.num_samples(), "sample"), 0.5 * made.recorded_rate));
  if (made.in_gaps > 0)
    warn(path, fmt::format("interpolated linearly in gaps of the recording: {} of {} at {}", made.in_gaps,
                           counted(record.num_samples(), "sample"), format_quantity(rate, Quantity::frequency)));
}

void RecordingWriter::add(TrialRecord record, const std::string& path, std::size_t repeated_rows,
                          const std::vector<double>& time_units) {
  record.trial = summary_.trials++;
  record.seed = options_.seed;
  for (std::size_t k = 0; k < record.sensors.size(); ++k) {
    const SensorRecord& sensor = record.sensors[k];
    for (const SensorColumn& channel : sensor.channels) summary_.channels[sensor.type].insert(channel.name);
    // The sensors of a table share its stamps, which are reported once.
    if (k == 0 || sensor.time != record.sensors.front().time)
      warn_of_timing(sensor, time_units.empty() ? 1.0 : time_units[k], path,
                     k == 0 ? "" : fmt::format("sensor {}: ", sensor.name));
  }
  if (options_.rate) resample_and_note(record, path);
  summary_.samples += record.num_samples();
  summary_.repeated_rows += repeated_rows;
  if (!record.material.empty()) ++summary_.objects[record.material];
  end_if_interrupted();
  if (target_) target_->writer.append(target_->encoder.encode(record));
}

ImportSummary RecordingWriter::finish(std::size_t sources) {
  summary_.sources = sources;
  if (target_) summary_.files = target_->writer.commit();
  return std::move(summary_);
}

std::vector<SourceFile> list_sources(const std::vector<std::string>& sources, const std::vector<std::string>& endings,
                                     bool bags) {
  namespace fs = std::filesystem;
  std::vector<std::string> paths;
  std::vector<fs::path> folders;
  for (const std::string& source : sources) {
    std::error_code error;
    if (source.empty()) reject("import: the name of a source is empty; expected a file or a folder");
    if (!fs::exists(source, error)) reject("{}: no such file or folder", source);
  }
  const LinkCheck links(sources);
  for (const std::string& source : sources) {
    std::error_code error;
    const fs::path full = fs::absolute(source).lexically_normal();
    if (fs::is_directory(source, error) && !(bags && is_bag(source))) {
      folders.push_back(full.has_filename() ? full : full.parent_path());
      const std::vector<std::string> found = FolderScan(source, endings, bags).paths();
      for (const std::string& path : found) links.check(path);
      paths.insert(paths.end(), found.begin(), found.end());
    } else {
      folders.push_back(full.parent_path());
      if (fs::is_directory(source, error)) links.check(source);
      paths.push_back(source);
    }
  }
  std::vector<SourceFile> files;
  std::set<fs::path> seen;
  for (const std::string& path : paths) {
    if (!is_plain_name(path)) reject("{}: is not a valid name in a dataset; allowed: UTF-8 without control characters", path);
    std::error_code error;
    if (!seen.insert(fs::canonical(path, error)).second) reject("{}: is given twice", path);
    files.push_back({path, fs::absolute(path).lexically_normal().lexically_relative(common_folder(folders)).string()});
  }
  return files;
}

std::vector<std::string> import_format_names() { return choice_names(import_catalogue); }

const ImportFormat& import_format(const std::string& name) {
  const auto found =
      std::ranges::find(import_catalogue, name, [](const ImportFormat& format) { return std::string(format.name); });
  if (found == import_catalogue.end()) reject("unknown format {}{}", quote(name), allowed_names(name, import_format_names()));
  return *found;
}

std::string format_name(const ImportFormat& format) { return format.name; }

std::string import_formats_text() {
  std::string text;
  for (const ImportFormat& format : import_catalogue) text += fmt::format("  {:<16}{}\n", format.name, format.summary);
  return text;
}

void for_each_recording(const std::vector<std::string>& sources, const ImportFormat& format,
                        const std::function<void(TrialRecord record, const std::string& source)>& take) {
  for (const SourceFile& file : list_sources(sources, {".csv"}, false)) {
    format.read(file, [&](TrialRecord record, std::size_t /*repeated_rows*/) {
      end_if_interrupted();
      take(std::move(record), file.path);
    });
  }
}

ImportSummary import_recordings(const ImportOptions& options) {
  const std::vector<SourceFile> sources = list_sources(options.sources, {".csv"}, false);
  RecordingWriter writer(options, options.format->split_by);
  for (const SourceFile& file : sources) {
    options.format->read(
        file, [&](TrialRecord record, std::size_t repeated_rows) { writer.add(std::move(record), file.path, repeated_rows); });
  }
  return writer.finish(sources.size());
}

const ImportFormat* chosen_import_format(const std::string& name) { return name == "csv" ? nullptr : &import_format(name); }

void check_import_options(const ImportOptions& options) {
  if (options.format == nullptr && options.map.empty())
    reject(
        "import: give --map MAP, a description of the recordings, or --format NAME; names: {}; --draft TYPE writes a map of a "
        "table, where TYPE is the type of the sensor, such as papillarray",
        fmt::join(import_format_names(), ", "));
  if (options.format != nullptr && !options.map.empty())
    reject("import: --map {}: the format {} has no map; give either --map or --format", options.map,
           format_name(*options.format));
}

Json import_json(const ImportSummary& summary) {
  return {{"sources", summary.sources}, {"trials", summary.trials},
          {"samples", summary.samples}, {"repeated_rows", summary.repeated_rows},
          {"objects", summary.objects}, {"warnings", warnings_json(summary.warnings)},
          {"files", summary.files}};
}

}  // namespace slipbench
