#include "tools/export/export.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <set>
#include <utility>

#include <sys/stat.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/guarded.h"
#include "tools/dataset/output_file.h"
#include "tools/dataset/reader.h"
#include "tools/export/commanded_motion.h"
#include "tools/export/papillarray_trial.h"

namespace slipbench {
namespace {

constexpr std::array<std::pair<const char*, ExportFormat>, 2> formats{
    {{"vendor-csv", ExportFormat::vendor_csv}, {"training-csv", ExportFormat::training_csv}}};
constexpr std::array<std::pair<const char*, SlipRule>, 4> rules{{{"strict", SlipRule::strict},
                                                                 {"micro", SlipRule::micro},
                                                                 {"paper", SlipRule::paper},
                                                                 {"has_slipped", SlipRule::has_slipped}}};

template <class Table>
std::vector<std::string> words_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& [name, value] : table) names.emplace_back(name);
  return names;
}

template <class Table>
auto parse_name(const Table& table, const std::string& name, const char* what) {
  for (const auto& [known, value] : table) {
    if (name == known) return value;
  }
  throw InputError(fmt::format("unknown {} '{}'{}", what, name, allowed_names(name, words_of(table))));
}

void make_folder(const std::string& path) {
  if (::mkdir(path.c_str(), 0777) == 0) return;
  const int reason = errno;
  if (reason == EEXIST && std::filesystem::is_directory(path)) return;
  throw InputError(fmt::format("cannot make folder {}: {}", path, std::strerror(reason)));
}

// What is exported is what was written, or nothing.
void check_files_of(const DatasetReader& reader, const std::vector<std::size_t>& trials) {
  std::set<std::size_t> files;
  for (const std::size_t trial : trials) files.insert(reader.file_of(trial));
  for (const std::size_t file : files) check_content(reader, file);
}

void write_file(const DatasetReader& reader, const std::string& path, const TextKind& kind, const std::string& text) {
  check_text_target(path, reader.files(), kind);
  write_text_file(path, text);
}

double label_speed(const ExportOptions& options) { return options.label_speed.value_or(default_label_speed); }

std::string export_vendor(const DatasetReader& reader, std::size_t trial, const std::string& out_dir,
                          const ExportOptions& options) {
  std::vector<SensorRecord> records;
  for (const std::string& name : papillarrays_of(reader, trial)) {
    if (options.sensor.empty() || options.sensor == name) records.push_back(reader.read_sensor(trial, name));
  }
  if (records.empty()) {
    throw InputError(fmt::format("trial {}: no papillarray '{}'; allowed: {}", trial, options.sensor,
                                 fmt::join(papillarrays_of(reader, trial), ", ")));
  }
  std::vector<PapillarraySamples> sensors;
  for (const SensorRecord& record : records) sensors.emplace_back(record, options.slip_rule, label_speed(options));
  const std::string path = fmt::format("{}/LOG_demo_{}.csv", out_dir, trial);
  write_file(reader, path, {"log of the vendor's software", &begins_as_vendor_csv}, vendor_csv(sensors));
  return path;
}

std::string export_training(const DatasetReader& reader, std::size_t trial, const std::string& out_dir,
                            const ExportOptions& options) {
  const std::vector<std::string> names = papillarrays_of(reader, trial);
  const std::string name = options.sensor.empty() && names.size() == 1 ? names.front() : options.sensor;
  if (std::find(names.begin(), names.end(), name) == names.end()) {
    throw InputError(
        fmt::format("trial {}: training-csv holds one papillarray; which? allowed: {}", trial, fmt::join(names, ", ")));
  }
  const TrialRecord record = reader.read_trial(trial);
  const auto sensor = std::find_if(record.sensors.begin(), record.sensors.end(),
                                   [&](const SensorRecord& candidate) { return candidate.name == name; });
  const auto pad = std::find_if(record.bodies.begin(), record.bodies.end(),
                                [](const BodyRecord& candidate) { return candidate.name == "pad"; });
  if (pad == record.bodies.end()) throw InputError(fmt::format("trial {}: has no truth/pad, which tells the move", trial));
  const PapillarraySamples samples(*sensor, options.slip_rule, label_speed(options));
  const std::filesystem::path path =
      std::filesystem::path(out_dir) / training_file_name(trial, commanded_motion(reader, trial), *pad, record.body_time);
  const std::string text = training_csv(samples, sensor->rate);
  make_folder(path.parent_path().string());
  write_file(reader, path.string(), {"file of 73 columns", &begins_as_training_csv}, text);
  return path.string();
}

std::vector<std::string> export_trials(const std::string& dataset_path, const std::string& out_dir,
                                       const ExportOptions& options) {
  const DatasetReader reader(dataset_path);
  if (reader.trials().empty()) throw InputError(fmt::format("{}: holds no trial", dataset_path));
  const std::vector<std::size_t> trials = options.trial ? std::vector<std::size_t>{*options.trial} : reader.trials();
  check_files_of(reader, trials);
  make_folder(out_dir);
  std::vector<std::string> files;
  for (const std::size_t trial : trials) {
    switch (options.format) {
      case ExportFormat::vendor_csv: files.push_back(export_vendor(reader, trial, out_dir, options)); break;
      case ExportFormat::training_csv: files.push_back(export_training(reader, trial, out_dir, options)); break;
    }
  }
  return files;
}

}  // namespace

ExportFormat parse_export_format(const std::string& name) { return parse_name(formats, name, "format"); }
SlipRule parse_slip_rule(const std::string& name) { return parse_name(rules, name, "slip rule"); }
std::vector<std::string> export_format_names() { return words_of(formats); }
std::vector<std::string> slip_rule_names() { return words_of(rules); }
std::string slip_rule_name(SlipRule rule) {
  return std::find_if(rules.begin(), rules.end(), [&](const auto& known) { return known.second == rule; })->first;
}

std::vector<std::string> export_dataset(const std::string& dataset_path, const std::string& out_dir,
                                        const ExportOptions& options) {
  if (options.label_speed && options.slip_rule != SlipRule::paper && options.slip_rule != SlipRule::has_slipped) {
    throw InputError(
        fmt::format("a label speed was given, which the slip rule '{}' does not have; allowed: --label-speed with "
                    "--slip paper or --slip has_slipped",
                    slip_rule_name(options.slip_rule)));
  }
  // A path holds no zero byte, which therefore ends each in what the child process hands back.
  const std::string names = guarded(dataset_path, [&] {
    std::string text;
    for (const std::string& file : export_trials(dataset_path, out_dir, options)) text += file + '\0';
    return text;
  });
  std::vector<std::string> files;
  for (std::size_t first = 0; first < names.size(); first += files.back().size() + 1) files.emplace_back(names.c_str() + first);
  return files;
}

}  // namespace slipbench
