#include "tools/program/import/import.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "detectors/hd/words.h"
#include "sim/core/process/interrupted.h"
#include "tools/base/dataset/writer.h"
#include "tools/base/files/reject.h"
#include "tools/program/import/resample.h"
#include "tools/program/import/source_table.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {
namespace {

// All formats in the order of the help, a line each.
constexpr std::array<ImportFormat, 5> import_catalogue{{
    {"bts3v2", "grasps with three BioTac SP, a row a grasp: object, whether it slipped, 72 electrodes before the lift", "object",
     &read_bts3v2},
    {"biotacsp-dos", "a BioTac SP that slides, turns or rests, CLASS/OBJECT<number>.csv: 24 electrodes, 100 rows a second",
     "object", &read_biotacsp_dos},
    {"papillarray-csv", "the PapillArray vendor's logs of one or two sensors, a file a recording", "trial",
     &read_papillarray_csv},
    {"training-csv", "the PapillArray's published training files: 73 columns, no header, a file a recording", "trial",
     &read_training_csv},
    {"csv", "tables of your own with a header, a file a recording; --map says what their columns are", "trial", &read_mapped_csv},
}};

// A link to a folder is not followed.
void add_folder(const std::string& folder, std::vector<SourceFile>& files) {
  namespace fs = std::filesystem;
  std::vector<SourceFile> found;
  try {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && entry.path().extension() == ".csv")
        found.push_back({entry.path().string(), entry.path().lexically_relative(folder).string()});
    }
  } catch (const fs::filesystem_error& error) {
    reject("{}: cannot be read: {}", folder, error.code().message());
  }
  if (found.empty()) reject("{}: holds no file .csv; allowed: a source file, or a folder with some", folder);
  std::ranges::sort(found, {}, &SourceFile::name);
  files.insert(files.end(), found.begin(), found.end());
}

std::vector<SourceFile> source_files(const std::vector<std::string>& sources) {
  namespace fs = std::filesystem;
  std::vector<SourceFile> files;
  for (const std::string& source : sources) {
    std::error_code error;
    if (!fs::exists(source, error)) reject("{}: no such file or folder", source);
    if (fs::is_directory(source, error)) {
      add_folder(source, files);
    } else {
      files.push_back({source, fs::path(source).filename().string()});
    }
  }
  std::set<fs::path> seen;
  for (const SourceFile& file : files) {
    if (!is_plain_name(file.path))
      reject("{}: is no name that a dataset can hold; allowed: UTF-8 without control characters", file.path);
    std::error_code error;
    if (!seen.insert(fs::canonical(file.path, error)).second) reject("{}: is named twice; allowed: each source once", file.path);
  }
  return files;
}

std::string canonical_import(const ImportOptions& options) {
  std::string command = "slipbench import";
  for (const std::string& source : options.sources) command += " " + shell_word(source);
  if (!options.map.empty()) command += " --map " + shell_word(options.map);
  if (options.rate) command += fmt::format(" --rate '{} Hz'", *options.rate);
  return command + fmt::format(" --format {} --seed {}", options.format->name, options.seed);
}

DatasetHeader header_of(const ImportOptions& options) {
  const SplitRule split{options.format->split_by, {0.70, 0.15, 0.15}, "as import does"};
  return {.version = SLIPBENCH_VERSION,
          .scene = "",
          .seed = options.seed,
          .command = canonical_import(options),
          .split = split,
          .truth = fmt::format("none: imported from {}", options.format->name)};
}

// "; times in ms would give 100 Hz" for a rate that no tactile sensor has; else empty. `mapped`: the user can say the unit.
std::string unit_hint(double rate, bool mapped) {
  constexpr double slowest = 5.0;  // Hz
  struct Unit {
    const char* name;
    const char* scale;
    double length;  // s
  };
  constexpr std::array<Unit, 3> units{{{"ms", "1e-3", 1e-3}, {"us", "1e-6", 1e-6}, {"ns", "1e-9", 1e-9}}};
  if (rate >= slowest) return "";
  const auto* unit = std::ranges::find_if(units, [&](const Unit& one) { return rate / one.length >= slowest; });
  if (unit == units.end()) return "";
  return fmt::format("; times in {} would give {}{}", unit->name, format_quantity(rate / unit->length, Quantity::frequency),
                     mapped ? fmt::format(" (time: {{scale: {}}} in the column map)", unit->scale) : "");
}

// About the time stamps of a recording as it was read. All its sensors have the same ones.
void add_timing_warnings(const TrialRecord& record, const SourceFile& file, bool mapped, std::vector<Warning>& warnings) {
  const SensorRecord& sensor = record.sensors.front();
  if (!sensor.timing) return;
  const auto warn = [&](const std::string& text) { warnings.push_back({file.path, file.path + ": " + text}); };
  if (const std::string hint = unit_hint(sensor.rate, mapped); !hint.empty())
    warn(fmt::format("has one sample every {:.4g} s{}", 1.0 / sensor.rate, hint));
  if (!steps_vary(*sensor.timing)) return;
  const std::string timing = timing_text(*sensor.timing, sensor.time.front());
  if (evenly_spaced(sensor.time, sensor.timing->resolution)) {
    warn("the steps between its samples vary: " + timing);
  } else {
    warn("its samples are not evenly spaced: " + timing +
         "; detectors that count samples refuse it unless it is imported with --rate RATE");
  }
}

// Resamples a recording and notes it in its params.
void resample_and_note(TrialRecord& record, double rate, const SourceFile& file, std::vector<Warning>& warnings) {
  const std::size_t in_gaps = resample(record, rate, file.path);
  Json params = Json::parse(record.params);
  params["resampled"] = {{"rate_hz", rate}, {"samples_in_gaps", in_gaps}};
  record.params = params.dump();
  if (in_gaps > 0)
    warnings.push_back(
        {file.path, fmt::format("{}: {} of {} samples at {} lie in gaps of the recording and are on straight lines "
                                "across them",
                                file.path, in_gaps, record.num_samples(), format_quantity(rate, Quantity::frequency))});
}

// A dataset of which nothing is left unless it was finished.
class Target {
 public:
  explicit Target(const ImportOptions& options) : writer_(options.output, header_of(options)) {}

  void add(const TrialRecord& record) { writer_.append(encoder_.encode(record)); }
  std::vector<std::string> finish() { return writer_.commit(); }

 private:
  DatasetWriter writer_;
  TrialEncoder encoder_;
};

}  // namespace

std::vector<std::string> import_format_names() { return hd::names_of(import_catalogue); }

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
  for (const SourceFile& file : source_files(sources)) {
    format.read(file, [&](TrialRecord record, std::size_t /*repeated_rows*/) {
      end_if_interrupted();
      take(std::move(record), file.path);
    });
  }
}

ImportSummary import_recordings(const ImportOptions& options) {
  std::vector<SourceFile> sources = source_files(options.sources);
  if (!options.map.empty() && options.format->read != &read_mapped_csv)
    reject("--map {}: the format {} has no column map; allowed: --format csv", options.map, options.format->name);
  for (SourceFile& file : sources) file.map = options.map;
  ImportSummary summary;
  summary.sources = sources.size();
  std::optional<Target> target;
  if (!options.output.empty()) target.emplace(options);
  for (const SourceFile& file : sources) {
    options.format->read(file, [&](TrialRecord record, std::size_t repeated_rows) {
      record.trial = summary.trials++;
      record.seed = options.seed;
      add_timing_warnings(record, file, options.format->read == &read_mapped_csv, summary.warnings);
      if (options.rate) resample_and_note(record, *options.rate, file, summary.warnings);
      summary.samples += record.num_samples();
      summary.repeated_rows += repeated_rows;
      if (!record.material.empty()) ++summary.objects[record.material];
      end_if_interrupted();
      if (target) target->add(record);
    });
  }
  if (target) summary.files = target->finish();
  return summary;
}

}  // namespace slipbench
