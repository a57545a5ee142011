#include "tools/eval/detect_page.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "sim/api/pad_state_names.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "tools/dataset/reader.h"
#include "tools/eval/detect.h"
#include "tools/page/timeline.h"

namespace slipbench::eval {
namespace {

constexpr std::size_t most_rows = 500;

std::vector<PadState> states_of(const Json& words) {
  std::vector<PadState> states;
  for (const Json& word : words) {
    states.push_back(word.is_null() ? unknown_state : choice_value(pad_states, word.get<std::string>()).value());
  }
  return states;
}

// `trial`: an element of `trials` of detect().
page::TimelineMarks marks_of(const Json& trial) {
  const Json& samples = trial.at("samples");
  page::TimelineMarks marks{.seen = states_of(samples.at("state"))};
  for (const Json& alarm : trial.at("alarms"))
    marks.alarms.push_back({alarm.at("begin_s").get<double>(), alarm.at("end_s").get<double>()});
  for (const Json& value : samples.at("probability"))
    marks.probability.push_back(value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>());
  if (!samples.at("label").is_null()) {
    marks.labels = states_of(samples.at("label"));
    marks.labels_name = labels_title(parse_label_rule(trial.at("labels").get<std::string>()));
  }
  return marks;
}

bool several_recordings(const Json& result) {
  const Json& trials = result.at("trials");
  return std::ranges::any_of(trials, [&](const Json& trial) { return trial.at("recording") != trials.front().at("recording"); });
}

std::string alarms_text(std::size_t count) { return fmt::format("{} {}", count, count == 1 ? "alarm" : "alarms"); }

std::string share_text(const Json& share) { return share.is_null() ? "–" : fmt::format("{:.1f} %", 100.0 * share.get<double>()); }

std::string rate_text(const Json& rate) { return rate.is_null() ? "–" : fmt::format("{:.1f}", rate.get<double>()); }

std::string trial_name(const Json& trial, bool several) {
  const std::string object = trial.at("object").get<std::string>();
  return (several ? trial.at("recording").get<std::string>() + ", " : "") +
         fmt::format("trial {}", trial.at("trial").get<std::size_t>()) + (object.empty() ? "" : ", " + object);
}

// Start of the first alarm [s], in the time of the drawings; empty if there is none.
std::optional<double> first_alarm(const Json& trial) {
  if (trial.at("alarms").empty()) return std::nullopt;
  const double origin = page::time_origin(trial.at("samples").at("time_s").get<std::vector<double>>());
  return trial.at("alarms")[0].at("begin_s").get<double>() - origin;
}

std::string about(const Json& trial) {
  std::string text = fmt::format("{} in {:.4g} s", alarms_text(trial.at("alarms").size()), trial.at("duration_s").get<double>());
  if (const std::optional<double> first = first_alarm(trial)) text += fmt::format(", first at {:.4g} s", *first);
  if (!trial.at("wrong_share").is_null())
    text += fmt::format("; {} of the samples wrong according to the labels ({})", share_text(trial.at("wrong_share")),
                        trial.at("labels").get<std::string>());
  return text;
}

}  // namespace

page::TextTable detections_table(const Json& result, std::size_t most) {
  const bool several = several_recordings(result);
  page::TextTable table{{"trial", "duration [s]", "alarms", "alarms per minute", "first alarm [s]", "wrong samples"}, {}};
  const Json& worst = result.at("worst");
  for (std::size_t place = 0; place < std::min(worst.size(), most); ++place) {
    const Json& trial = result.at("trials")[worst[place].get<std::size_t>()];
    const std::optional<double> first = first_alarm(trial);
    table.rows.push_back({trial_name(trial, several), fmt::format("{:.4g}", trial.at("duration_s").get<double>()),
                          fmt::format("{}", trial.at("alarms").size()), rate_text(trial.at("alarms_per_minute")),
                          first ? fmt::format("{:.6g}", *first) : "–", share_text(trial.at("wrong_share"))});
  }
  return table;
}

std::string detect_page(const Json& result) {
  const Json& trials = result.at("trials");
  const std::string detector = detector_name(result.at("detector"));
  const bool several = several_recordings(result);
  const bool labelled = std::ranges::any_of(trials, [](const Json& trial) { return !trial.at("labels").is_null(); });
  std::size_t alarms = 0;
  for (const Json& trial : trials) alarms += trial.at("alarms").size();
  const Json& sensor = result.at("sensor");
  std::vector<std::string> notes{fmt::format("sensor {} ({}), {}, {}", sensor.at("name").get<std::string>(),
                                             sensor.at("type").get<std::string>(), counted(trials.size(), "trial"),
                                             alarms_text(alarms))};
  std::ranges::move(frame_notes(result), std::back_inserter(notes));
  notes.emplace_back(labelled
                         ? "Alarms are shaded."
                         : "Alarms are shaded. The recordings have no labels, so alarms cannot be classified as right or wrong.");
  std::string body = page::head_html(detect_page_kind.generator, "Alarms of " + detector, notes, result.value("command", ""));
  const Json& worst = result.at("worst");
  for (std::size_t place = 0; place < std::min(worst.size(), drawn_trials); ++place) {
    const Json& trial = trials[worst[place].get<std::size_t>()];
    const DatasetReader reader(trial.at("recording").get<std::string>());
    const SensorRecord read = reader.read_sensor(trial.at("trial").get<std::size_t>(), trial.at("sensor").get<std::string>());
    body +=
        page::section_html(trial_name(trial, several), about(trial), page::timeline_html(read, marks_of(trial), drawn_channels));
  }
  body += page::section_html("All trials",
                             worst.size() > most_rows
                                 ? fmt::format("The first {} of {}; FILE.json contains all.", most_rows, worst.size())
                                 : "Worst first.",
                             page::table_html(detections_table(result, most_rows)));
  return page::compose_page({detect_page_kind.generator, "Alarms of " + detector + " · slipbench detect"}, body);
}

}  // namespace slipbench::eval
