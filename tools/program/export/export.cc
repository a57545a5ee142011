#include "tools/program/export/export.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/dataset/arrays.h"
#include "tools/base/dataset/content_check.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/reader.h"
#include "tools/program/export/commanded_motion.h"
#include "tools/program/export/grasp_csv.h"
#include "tools/program/export/myrmex_images.h"
#include "tools/program/export/npz.h"
#include "tools/program/export/output_folder.h"
#include "tools/program/export/papillarray_trial.h"
#include "tools/program/export/robomimic.h"
#include "tools/program/export/samples.h"
#include "tools/program/export/slip_csv.h"
#include "tools/program/export/table_csv.h"

namespace slipbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::pair<const char*, ExportFormat>, 9> formats{{{"csv", ExportFormat::csv},
                                                                       {"npz", ExportFormat::npz},
                                                                       {"robomimic", ExportFormat::robomimic},
                                                                       {"vendor-csv", ExportFormat::vendor_csv},
                                                                       {"training-csv", ExportFormat::training_csv},
                                                                       {"grasp-csv", ExportFormat::grasp_csv},
                                                                       {"myrmex-csv", ExportFormat::myrmex_csv},
                                                                       {"myrmex-rotated", ExportFormat::myrmex_rotated},
                                                                       {"slip-csv", ExportFormat::slip_csv}}};
// Those that need no truth.
constexpr std::array of_readings{ExportFormat::csv, ExportFormat::npz, ExportFormat::myrmex_csv, ExportFormat::myrmex_rotated};
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

// What is exported is what was written, or nothing.
void check_files_of(const DatasetReader& reader, const std::vector<std::size_t>& trials) {
  std::set<std::size_t> files;
  for (const std::size_t trial : trials) files.insert(reader.file_of(trial));
  for (const std::size_t file : files) check_content(reader, file);
}

double label_speed(const ExportOptions& options) { return options.label_speed.value_or(default_label_speed); }

std::string export_vendor(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
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
  return out.write(fmt::format("LOG_demo_{}.csv", trial), {"log of the vendor's software", &begins_as_vendor_csv},
                   vendor_csv(sensors));
}

std::string export_training(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  const std::vector<std::string> names = papillarrays_of(reader, trial);
  const std::string wanted = options.sensor.empty() && names.size() == 1 ? names.front() : options.sensor;
  if (std::find(names.begin(), names.end(), wanted) == names.end()) {
    throw InputError(
        fmt::format("trial {}: training-csv holds one papillarray; which? allowed: {}", trial, fmt::join(names, ", ")));
  }
  const TrialRecord record = reader.read_trial(trial);
  const auto sensor = std::find_if(record.sensors.begin(), record.sensors.end(),
                                   [&](const SensorRecord& candidate) { return candidate.name == wanted; });
  const auto pad = std::find_if(record.bodies.begin(), record.bodies.end(),
                                [](const BodyRecord& candidate) { return candidate.name == "pad"; });
  if (pad == record.bodies.end()) throw InputError(fmt::format("trial {}: has no truth/pad, which tells the move", trial));
  const PapillarraySamples samples(*sensor, options.slip_rule, label_speed(options));
  const std::string name = training_file_name(trial, commanded_motion(reader, trial), *pad, record.body_time);
  return out.write(name, {"file of 73 columns", &begins_as_training_csv}, training_csv(samples, sensor->rate));
}

std::vector<std::string> export_tables(const DatasetReader& reader, std::size_t trial, OutputFolder& out,
                                       const ExportOptions& options) {
  std::vector<std::string> files;
  for (const std::string& sensor : chosen_sensors(reader, trial, options.sensor)) {
    for (const CsvTable& table : table_csv(reader.read_sensor(trial, sensor))) {
      const std::string channel = table.channel.empty() ? "" : "-" + table.channel;
      files.push_back(out.write(fmt::format("demo_{}-{}{}.csv", trial, sensor, channel),
                                {"table of a sensor", &begins_as_table_csv}, table.text));
    }
  }
  return files;
}

std::string export_slip(const DatasetReader& reader, std::size_t trial, OutputFolder& out, const ExportOptions& options) {
  const std::vector<std::string> names = chosen_sensors(reader, trial, options.sensor);
  if (names.size() != 1) {
    throw InputError(fmt::format("trial {}: slip-csv holds one biotac_sp; which? allowed: {}", trial, fmt::join(names, ", ")));
  }
  const SlipRecording recording = slip_csv(reader, trial, names.front());
  return out.write(recording.name, {"recording of 24 electrodes", &begins_as_slip_csv}, recording.text);
}

// What the arrays of a trial do not say.
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
  for (const ArrayView& array : arrays_of(record)) about["units"][array.path] = array.unit;
  return about.dump();
}

// A file for each myrmex.
std::vector<std::string> export_images(const DatasetReader& reader, std::size_t trial, OutputFolder& out,
                                       const ExportOptions& options) {
  std::vector<std::string> files;
  for (const std::string& sensor : chosen_sensors(reader, trial, options.sensor)) {
    if (options.sensor.empty() && reader.sensor_type(trial, sensor) != "myrmex") continue;
    files.push_back(out.write(fmt::format("demo_{}-{}.csv", trial, sensor), {"file of images", &begins_as_myrmex_csv},
                              myrmex_csv(reader.read_sensor(trial, sensor))));
  }
  if (files.empty()) throw InputError(fmt::format("trial {}: no myrmex", trial));
  return files;
}

std::string export_archive(const DatasetReader& reader, std::size_t trial, OutputFolder& out, bool rotated) {
  const TrialRecord record = rotated ? turned_images(reader.read_trial(trial)) : reader.read_trial(trial);
  return out.write(fmt::format("demo_{}.npz", trial), {"numpy archive of a trial", &begins_as_npz},
                   npz(record, about_trial(reader, record)));
}

std::string export_robomimic(const DatasetReader& reader, const std::vector<std::size_t>& trials, OutputFolder& out,
                             const ExportOptions& options) {
  static_cast<void>(chosen_sensors(reader, trials.front(), options.sensor));
  const std::string path = out.prepare("robomimic.hdf5");
  check_robomimic_target(path, reader.files());
  write_robomimic(reader, trials, path, {options.sensor, options.rate});
  return path;
}

std::vector<std::string> export_trials(const std::string& dataset_path, const std::string& out_dir,
                                       const ExportOptions& options) {
  const DatasetReader reader(dataset_path);
  if (reader.trials().empty()) throw InputError(fmt::format("{}: holds no trial", dataset_path));
  const auto is_of_readings = [&](ExportFormat format) { return format == options.format; };
  if (std::ranges::none_of(of_readings, is_of_readings)) {
    const auto format = std::ranges::find(formats, options.format, [](const auto& known) { return known.second; });
    reader.check_truth(fmt::format("--format {}", format->first),
                       "a dataset that slipbench has simulated, or --format csv, npz, myrmex-csv or myrmex-rotated");
  }
  const std::vector<std::size_t> trials = options.trial ? std::vector<std::size_t>{*options.trial} : reader.trials();
  check_files_of(reader, trials);
  for (const std::size_t trial : trials) reader.check_recorded(trial);
  OutputFolder out(out_dir, reader.files());
  if (options.format == ExportFormat::robomimic) return {export_robomimic(reader, trials, out, options)};
  if (options.format == ExportFormat::grasp_csv) {
    return {out.write("grasps.csv", {"table of grasps", &begins_as_grasp_csv}, grasp_csv(reader, trials))};
  }
  std::vector<std::string> files;
  for (const std::size_t trial : trials) {
    switch (options.format) {
      case ExportFormat::csv: std::ranges::move(export_tables(reader, trial, out, options), std::back_inserter(files)); break;
      case ExportFormat::npz: files.push_back(export_archive(reader, trial, out, false)); break;
      case ExportFormat::vendor_csv: files.push_back(export_vendor(reader, trial, out, options)); break;
      case ExportFormat::training_csv: files.push_back(export_training(reader, trial, out, options)); break;
      case ExportFormat::slip_csv: files.push_back(export_slip(reader, trial, out, options)); break;
      case ExportFormat::myrmex_csv:
        std::ranges::move(export_images(reader, trial, out, options), std::back_inserter(files));
        break;
      case ExportFormat::myrmex_rotated: files.push_back(export_archive(reader, trial, out, true)); break;
      case ExportFormat::robomimic:
      case ExportFormat::grasp_csv: break;  // are one file
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
    throw InputError(fmt::format(
        "a label speed was given, which the slip rule '{}' does not have; allowed: --label-speed with --slip paper or --slip has_slipped",
        slip_rule_name(options.slip_rule)));
  }
  const bool pillars_only = options.format == ExportFormat::vendor_csv || options.format == ExportFormat::training_csv;
  if (!pillars_only && options.slip_rule != SlipRule::strict) {
    throw InputError("this format holds the state by every rule; allowed: --slip with vendor-csv and training-csv");
  }
  if (options.rate && options.format != ExportFormat::robomimic) {
    throw InputError("a rate was given, at which only robomimic is sampled; allowed: --rate with --format robomimic");
  }
  const bool all_sensors = options.format == ExportFormat::npz || options.format == ExportFormat::myrmex_rotated ||
                           options.format == ExportFormat::grasp_csv;
  if (!options.sensor.empty() && all_sensors) {
    throw InputError(
        fmt::format("{} holds all sensors of a trial; allowed: --sensor with the other formats",
                    std::ranges::find(formats, options.format, [](const auto& known) { return known.second; })->first));
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
