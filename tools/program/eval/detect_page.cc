#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/base/dataset/reader.h"
#include "tools/base/files/counted.h"
#include "tools/base/page/svg.h"
#include "tools/program/eval/detect.h"

namespace slipbench::eval {
namespace {

using page::Axis;
using page::Svg;

constexpr std::size_t drawn_trials = 12, most_channels = 4, most_rows = 500, most_buckets = 400;
constexpr double time_left = 72.0, time_right = 900.0, time_top = 30.0, time_foot = 130.0;
constexpr page::Frame time_frame{920.0, 170.0, time_left, time_right, time_top, time_foot};

// A part of the time axis, which is shaded.
struct Span {
  double begin, end;
};

// What all drawings of a trial share.
struct Times {
  Axis across;
  std::vector<Span> alarms, slips;  // slips: by the labels
};

std::vector<Span> slips_of(const Json& samples) {
  std::vector<Span> spans;
  if (samples.at("label").is_null()) return spans;
  bool before = false;
  for (std::size_t row = 0; row < samples.at("label").size(); ++row) {
    const std::string label = samples.at("label")[row].get<std::string>();
    const bool slips = label == "incipient" || label == "gross";
    const double time = samples.at("time_s")[row].get<double>();
    if (slips && !before) spans.push_back({time, samples.at("time_s").back().get<double>()});
    if (!slips && before) spans.back().end = time;
    before = slips;
  }
  return spans;
}

Times times_of(const Json& trial) {
  const std::array<double, 2> ends{trial.at("samples").at("time_s").front().get<double>(),
                                   trial.at("samples").at("time_s").back().get<double>()};
  Times times{page::round_axis(ends, 10.0, time_left, time_right), {}, slips_of(trial.at("samples"))};
  for (const Json& alarm : trial.at("alarms"))
    times.alarms.push_back({alarm.at("begin_s").get<double>(), alarm.at("end_s").get<double>()});
  return times;
}

// Alarms are shaded from top to foot, slips by the labels are a bar at the foot.
Svg chart_of(const Times& times, const std::string& title, const Axis& up, const std::string& unit) {
  Svg svg = page::chart(time_frame, title, times.across, "", up, unit);
  const auto shade = [&](const char* kind, const Span& span, double upper) {
    const double begin = times.across.at(span.begin);
    svg.bar(kind, begin, upper, std::max(times.across.at(span.end) - begin, 1.0), time_foot - upper);
  };
  for (const Span& alarm : times.alarms) shade("alarm", alarm, time_top);
  for (const Span& slip : times.slips) shade("s2", slip, time_foot - 5.0);
  return svg;
}

// A line from value to value, which begins anew after missing ones. Of a bucket of samples the least and the largest value are
// drawn, so that no peak is lost.
void draw_values(Svg& svg, const std::string& kind, const Axis& across, const Axis& up, std::span<const double> times,
                 std::span<const double> values) {
  const std::size_t bucket = std::max<std::size_t>(1, times.size() / most_buckets);
  std::vector<std::array<double, 2>> line;
  const auto end_line = [&] {
    if (line.size() == 1) svg.dot(kind, line[0][0], line[0][1], 1.5);
    if (line.size() > 1) svg.polyline(kind, line);
    line.clear();
  };
  for (std::size_t begin = 0; begin < times.size(); begin += bucket) {
    std::optional<std::size_t> least, most;
    for (std::size_t row = begin; row < std::min(begin + bucket, times.size()); ++row) {
      if (!std::isfinite(values[row])) continue;
      if (!least || values[row] < values[*least]) least = row;
      if (!most || values[row] > values[*most]) most = row;
    }
    if (!least) {
      end_line();
      continue;
    }
    for (const std::size_t row : {std::min(*least, *most), std::max(*least, *most)}) {
      line.push_back({across.at(times[row]), up.at(values[row])});
      if (*least == *most) break;
    }
  }
  end_line();
}

// One value of a channel over time.
struct Signal {
  std::vector<double> values;
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();

  [[nodiscard]] double range() const { return most - least; }
};

// The values of a channel that are finite somewhere, those that change the most first.
std::vector<Signal> signals_of(const SensorColumn& channel, std::size_t rows) {
  const std::size_t width = channel.row_size();
  std::vector<Signal> signals;
  for (std::size_t column = 0; column < width; ++column) {
    Signal signal;
    for (std::size_t row = 0; row < rows; ++row) {
      const double value = channel.values[row * width + column];
      signal.values.push_back(value);
      if (!std::isfinite(value)) continue;
      signal.least = std::min(signal.least, value);
      signal.most = std::max(signal.most, value);
    }
    if (signal.least <= signal.most) signals.push_back(std::move(signal));
  }
  std::ranges::stable_sort(signals, std::greater{}, &Signal::range);
  return signals;
}

std::string channel_drawing(const SensorRecord& sensor, const SensorColumn& channel, const Times& times) {
  const std::vector<double>& time = channel.time ? *channel.time : sensor.time;
  std::vector<Signal> signals = signals_of(channel, time.size());
  if (signals.empty()) return fmt::format("<p class=\"note\">{}: has no value</p>\n", page::escape_html(channel.name));
  const std::size_t all = channel.row_size();
  if (signals.size() > page::series_count) signals.resize(page::series_count);
  std::string title = channel.name;
  if (signals.size() < all) title += fmt::format(": {} of {} values, those that change the most", signals.size(), all);
  std::vector<double> ends;
  for (const Signal& signal : signals) ends.insert(ends.end(), {signal.least, signal.most});
  const Axis up = page::round_axis(ends, 4.0, time_foot, time_top);
  Svg svg = chart_of(times, title, up, channel.unit);
  for (std::size_t k = 0; k < signals.size(); ++k)
    draw_values(svg, fmt::format("s{}", k), times.across, up, time, signals[k].values);
  return svg.element(channel.name + " over time [s]");
}

std::string probability_drawing(const Json& samples, const Times& times) {
  std::vector<double> at, values;
  for (std::size_t row = 0; row < samples.at("time_s").size(); ++row) {
    if (samples.at("probability")[row].is_null()) continue;
    at.push_back(samples.at("time_s")[row].get<double>());
    values.push_back(samples.at("probability")[row].get<double>());
  }
  const Axis up{.low = 0.0, .high = 1.0, .begin = time_foot, .end = time_top, .ticks = {0.0, 0.5, 1.0}};
  Svg svg = chart_of(times, values.empty() ? "slip (the detector has no probability)" : "probability of slip", up, "");
  if (!values.empty()) draw_values(svg, "s0", times.across, up, at, values);
  return svg.element("Probability of slip over time [s]");
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

std::string about(const Json& trial) {
  std::string text = fmt::format("{} in {:.4g} s", alarms_text(trial.at("alarms").size()), trial.at("duration_s").get<double>());
  if (!trial.at("alarms").empty())
    text += fmt::format(", the first at {:.4g} s", trial.at("alarms")[0].at("begin_s").get<double>());
  if (!trial.at("wrong_share").is_null())
    text += fmt::format("; {} of the samples wrong by the labels ({})", share_text(trial.at("wrong_share")),
                        trial.at("labels").get<std::string>());
  return text;
}

// The signals, the probability and the alarms of a trial over time. `trial`: an element of `trials` of detect().
std::string timeline_html(const SensorRecord& sensor, const Json& trial) {
  if (trial.at("samples").at("time_s").size() < 2) return "<p class=\"note\">One sample, which has no course over time.</p>\n";
  const Times times = times_of(trial);
  std::string html = "<div>" + probability_drawing(trial.at("samples"), times);
  std::vector<std::string> others;
  for (const SensorColumn& channel : sensor.channels) {
    if (static_cast<std::size_t>(&channel - sensor.channels.data()) < most_channels) {
      html += channel_drawing(sensor, channel, times);
    } else {
      others.push_back(channel.name);
    }
  }
  html += "</div>\n";
  if (!others.empty())
    html += fmt::format("<p class=\"note\">Further channels: {}</p>\n",
                        page::escape_html(fmt::format("{}", fmt::join(others, ", "))));
  return html;
}

}  // namespace

page::TextTable detections_table(const Json& result, std::size_t most) {
  const bool several = several_recordings(result);
  page::TextTable table{{"trial", "duration [s]", "alarms", "alarms a minute", "first alarm [s]", "wrong samples"}, {}};
  const Json& worst = result.at("worst");
  for (std::size_t place = 0; place < std::min(worst.size(), most); ++place) {
    const Json& trial = result.at("trials")[worst[place].get<std::size_t>()];
    const Json& alarms = trial.at("alarms");
    table.rows.push_back({trial_name(trial, several), fmt::format("{:.4g}", trial.at("duration_s").get<double>()),
                          fmt::format("{}", alarms.size()), rate_text(trial.at("alarms_per_minute")),
                          alarms.empty() ? "–" : fmt::format("{:.6g}", alarms[0].at("begin_s").get<double>()),
                          share_text(trial.at("wrong_share"))});
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
  notes.push_back(
      std::string("Shaded: alarms, in s from the beginning of the recording.") +
      (labelled ? " Bars at the foot: slip by the labels." : " There are no labels, so nothing is right or wrong here."));
  std::string body = page::head_html(detect_page_kind.generator, "Alarms of " + detector, notes, result.value("command", ""));
  const Json& worst = result.at("worst");
  for (std::size_t place = 0; place < std::min(worst.size(), drawn_trials); ++place) {
    const Json& trial = trials[worst[place].get<std::size_t>()];
    const DatasetReader reader(trial.at("recording").get<std::string>());
    const SensorRecord read = reader.read_sensor(trial.at("trial").get<std::size_t>(), trial.at("sensor").get<std::string>());
    body += page::section_html(trial_name(trial, several), about(trial), timeline_html(read, trial));
  }
  body +=
      page::section_html("All trials",
                         worst.size() > most_rows ? fmt::format("The first {} of {}; FILE.json has all.", most_rows, worst.size())
                                                  : "The worst first.",
                         page::table_html(detections_table(result, most_rows)));
  return page::compose_page({detect_page_kind.generator, "Alarms of " + detector + " · slipbench detect"}, body);
}

}  // namespace slipbench::eval
