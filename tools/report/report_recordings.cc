#include "tools/report/report_recordings.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/api/pad_state.h"
#include "sim/core/counted.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/reader.h"
#include "tools/files/reject.h"
#include "tools/page/page.h"
#include "tools/page/timeline.h"
#include "tools/statistics/descriptive.h"

namespace slipbench::report {
namespace {

constexpr std::size_t drawn_recordings = 12, first_channels = 4;
constexpr const char* no_value = "–";

// Properties that the import recorded: file, object and more.
Json notes_of(const TrialRecord& record) {
  Json notes = Json::parse(record.params, nullptr, false);
  return notes.is_object() ? notes : Json::object();
}

std::string note_text(const Json& notes, const char* key) {
  const Json note = notes.value(key, Json());
  return note.is_string() ? note.get<std::string>() : note.is_null() ? "" : note.dump();
}

std::vector<PadState> labels_of(const SensorRecord& sensor) {
  std::vector<PadState> states;
  for (const std::uint8_t state : sensor.labels.state_paper) states.push_back(static_cast<PadState>(state));
  return states;
}

bool slips(PadState state) { return state == PadState::incipient || state == PadState::gross; }

double duration_of(const SensorRecord& sensor) { return sensor.time.size() < 2 ? 0.0 : sensor.time.back() - sensor.time.front(); }

// "0.51 (2.99 s after the first sample)" if steps vary, else the step.
std::string longest_step(const SensorRecord& sensor) {
  if (sensor.time.size() < 2) return no_value;
  if (sensor.timing) {
    const SampleTiming& timing = *sensor.timing;
    const std::string step = fmt::format("{:.4g}", timing.largest_gap);
    return steps_vary(timing)
               ? fmt::format("{} ({:.4g} s after the first sample)", step, timing.largest_gap_at - sensor.time.front())
               : step;
  }
  return fmt::format("{:.4g}", 1.0 / sensor.rate);
}

// "12.5 %, from 1.1 s": share and start of the samples with slip by the recorded labels, of the
// samples whose state is known.
std::string labelled_slip(const SensorRecord& sensor) {
  const std::vector<PadState> states = labels_of(sensor);
  const auto known = static_cast<double>(states.size()) - static_cast<double>(std::ranges::count(states, unknown_state));
  if (known == 0.0) return no_value;
  const auto first = std::ranges::find_if(states, slips);
  if (first == states.end()) return "none";
  const double share = static_cast<double>(std::ranges::count_if(states, slips)) / known;
  if (states.size() < 2) return "slip";
  const double from = sensor.time[static_cast<std::size_t>(first - states.begin())] - page::time_origin(sensor.time);
  return fmt::format("{:.1f} %, from {:.4g} s", 100.0 * share, from);
}

std::size_t missing_values(const SensorRecord& sensor) {
  std::size_t missing = 0;
  for (const SensorColumn& channel : sensor.channels)
    missing += static_cast<std::size_t>(std::ranges::count_if(channel.values, [](float value) { return std::isnan(value); }));
  return missing;
}

void add_rows(page::TextTable& table, const TrialRecord& record) {
  const Json notes = notes_of(record);
  for (const SensorRecord& sensor : record.sensors) {
    const bool one = sensor.time.size() < 2;
    table.rows.push_back({fmt::format("trial {}", record.trial), note_text(notes, "file"), note_text(notes, "object"),
                          sensor.name, fmt::format("{}", sensor.time.size()),
                          one ? no_value : fmt::format("{:.4g}", duration_of(sensor)),
                          one ? no_value : fmt::format("{:.4g}", sensor.timing ? sensor.timing->mean_rate : sensor.rate),
                          longest_step(sensor), fmt::format("{}", missing_values(sensor)), labelled_slip(sensor)});
  }
}

page::TextTable sensors_table(const TrialRecord& record) {
  page::TextTable table{{"sensor", "type", "channel", "unit", "values per sample"}, {}};
  for (const SensorRecord& sensor : record.sensors) {
    for (const SensorColumn& channel : sensor.channels)
      table.rows.push_back({sensor.name, sensor.type, channel.name, channel.unit, fmt::format("{}", channel.row_size())});
  }
  return table;
}

// Below the table: a column of sentences would make it wider than the page.
std::string axes_html(const TrialRecord& record) {
  std::vector<std::string> lines;
  for (const SensorRecord& sensor : record.sensors) {
    if (!sensor.frame.empty()) lines.push_back(fmt::format("Axes of {}: {}", sensor.name, sensor.frame));
  }
  return lines.empty() ? "" : page::list_html(lines);
}

// "imported from bts3v2", of the attribute "none: imported from bts3v2".
std::string_view origin_of(std::string_view truth) {
  constexpr std::string_view before = "none: ";
  return truth.starts_with(before) ? truth.substr(before.size()) : truth;
}

// Properties that the import recorded, except the object, which is in the title.
std::string about(const TrialRecord& record) {
  std::vector<std::string> texts;
  const Json notes = notes_of(record);
  for (const auto& [key, value] : notes.items()) {
    if (key != "object") texts.push_back(fmt::format("{} {}", key, note_text(notes, key.c_str())));
  }
  return fmt::format("{}", fmt::join(texts, " · "));
}

std::string drawn(const TrialRecord& record, const std::string& file, std::size_t most_channels) {
  const std::string object = note_text(notes_of(record), "object");
  std::string html;
  for (const SensorRecord& sensor : record.sensors) {
    if (record.sensors.size() > 1) html += "<h3>Sensor " + page::escape_html(sensor.name) + "</h3>\n";
    try {
      html += page::timeline_html(sensor, {.labels = labels_of(sensor)}, most_channels);
    } catch (const InputError& error) {
      reject("{}: /data/demo_{}: {}", file, record.trial, error.what());
    }
  }
  return fmt::format(
      "<div id=\"trial-{}\">\n{}</div>\n", record.trial,
      page::section_html(fmt::format("Trial {}", record.trial) + (object.empty() ? "" : ", " + object), about(record), html));
}

std::vector<std::size_t> chosen(const std::vector<std::size_t>& trials, std::size_t most) {
  std::vector<std::size_t> some;
  for (const std::size_t k : evenly_spaced(trials.size(), std::min(most, trials.size()))) some.push_back(trials[k]);
  return some;
}

}  // namespace

std::string recordings_body(const DatasetReader& dataset, const std::string& file, const ReportOptions& options) {
  const DatasetHeader& header = dataset.header();
  const std::vector<std::size_t>& trials = dataset.trials();
  const std::vector<std::size_t> shown =
      options.trial ? std::vector{*options.trial} : chosen(trials, options.max_trials.value_or(drawn_recordings));
  std::vector<std::size_t> listed = chosen(trials, options.max_rows), read;
  std::ranges::set_union(listed, shown, std::back_inserter(read));
  page::TextTable table{{"trial", "file", "object", "sensor", "samples", "duration [s]", "mean rate [Hz]", "longest step [s]",
                         "missing values", "labelled slip"},
                        {}};
  std::set<std::string> rules;
  std::string drawings, sensors;
  for (const std::size_t number : read) {
    end_if_interrupted();
    const TrialRecord record = dataset.read_trial(number);
    if (sensors.empty()) sensors = page::table_html(sensors_table(record)) + axes_html(record);
    add_rows(table, record);
    for (const SensorRecord& sensor : record.sensors) {
      if (!sensor.labels.state_paper.empty()) rules.insert(sensor.labels.rule);
    }
    if (std::ranges::binary_search(shown, number))
      drawings += drawn(record, file, options.trial ? std::numeric_limits<std::size_t>::max() : first_channels);
  }
  std::vector<std::string> notes{
      fmt::format("{}, written by slipbench {}", counted(trials.size(), "recording"), header.version),
      fmt::format(
          "The recordings were {}. They contain no truth, so the page shows signals, times and recorded labels. Contact, forces and slip of the units are not known.",
          origin_of(header.truth)),
      rules.empty() ? "There are no recorded labels." : fmt::format("Recorded labels: {}", fmt::join(rules, "; "))};
  if (shown.size() < trials.size())
    notes.push_back(fmt::format("The signals of {} of the {} recordings are drawn; --trial K draws recording K.", shown.size(),
                                trials.size()));
  if (read.size() < trials.size())
    notes.push_back(fmt::format("The table lists {} of the {} recordings, evenly spread.", read.size(), trials.size()));
  return page::head_html("slipbench report", file, notes, header.command) +
         page::section_html("Sensors", fmt::format("As in trial {}.", read.front()), sensors) +
         page::section_html("Recordings", "A step is the time from one sample to the next.",
                            "<div class=\"scroll tall\">\n" + page::table_html(table) + "</div>\n") +
         drawings;
}

}  // namespace slipbench::report
