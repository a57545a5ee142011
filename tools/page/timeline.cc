#include "tools/page/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/api/pad_state_names.h"
#include "sim/core/choice.h"
#include "sim/core/counted.h"
#include "tools/files/reject.h"
#include "tools/page/page.h"
#include "tools/page/svg.h"

namespace slipbench::page {
namespace {

constexpr std::size_t most_buckets = 400;
constexpr double time_left = 72.0, time_right = 900.0, time_top = 30.0, time_foot = 140.0, time_width = 920.0;
constexpr double key_place = 50.0, strip_height = 14.0;  // px: key below the axis; height of a row of states
// Maximum number of letters between two marks of the key, and along the vertical axis.
constexpr std::size_t most_key_letters = 15, most_upright_letters = 18;

// Maps times of a recording to the horizontal axis.
struct TimeAxis {
  Axis shown;     // for times after `origin`
  double origin;  // s

  [[nodiscard]] double at(double time) const { return shown.at(time - origin); }
  [[nodiscard]] std::string name() const {
    return origin == 0.0 ? "time [s]" : fmt::format("time after the first sample (at {:.15g} s) [s]", origin);
  }
};

TimeAxis time_axis(const std::vector<double>& time) {
  const double origin = time_origin(time);
  const std::array<double, 2> ends{time.front() - origin, time.back() - origin};
  return {round_axis(ends, 10.0, time_left, time_right), origin};
}

// Truncates a text that is too long for the key.
std::string shortened(const std::string& text) {
  std::size_t letters = 0, end = 0;  // `end`: end of the kept letters
  for (std::size_t at = 0; at < text.size(); ++at) {
    const bool begins = (static_cast<unsigned char>(text[at]) & 0xC0U) != 0x80U;  // the first byte of a letter in UTF-8
    if (begins && letters++ == most_key_letters - 1) end = at;
  }
  return letters <= most_key_letters ? text : text.substr(0, end) + "…";
}

// Draws the key: a mark and a name for each drawn item, equally spaced.
void draw_key(Svg& svg, double y, std::span<const std::pair<std::string, std::string>> kinds_and_names) {
  constexpr double distance = (time_right - time_left) / static_cast<double>(series_count);
  double x = time_left;
  for (const auto& [kind, name] : kinds_and_names) {
    svg.bar(kind, x, y - 8.0, 8.0, 8.0);
    svg.text("small", x + 12.0, y, shortened(name));
    x += distance;
  }
}

// A chart over time with the alarms shaded over its full height.
Svg time_chart(const Frame& frame, const std::string& title, const TimeAxis& across, const Axis& up, const std::string& up_name,
               const TimelineMarks& marks) {
  Svg svg = chart(frame, title, across.shown, across.name(), up, up_name);
  for (const TimeSpan& alarm : marks.alarms) {
    const double begin = across.at(alarm.begin);
    svg.bar("alarm", begin, frame.top, std::max(across.at(alarm.end) - begin, 1.0), frame.foot - frame.top);
  }
  return svg;
}

// Samples from `begin` to `end`, exclusive.
struct Run {
  std::size_t begin = 0, end = 0;
};

// The samples between gaps of the recording. A gap is longer than gap_steps median steps and wide
// enough to be visible.
std::vector<Run> runs_of(const TimeAxis& across, std::span<const double> times) {
  constexpr double gap_steps = 5.0, least_width = 3.0;  // px
  std::vector<double> steps;
  for (std::size_t row = 1; row < times.size(); ++row) steps.push_back(times[row] - times[row - 1]);
  std::vector<Run> runs{{0, times.size()}};
  if (steps.empty()) return runs;
  std::vector<double> ordered = steps;
  const auto middle = ordered.begin() + static_cast<std::ptrdiff_t>(ordered.size() / 2);
  std::ranges::nth_element(ordered, middle);
  for (std::size_t row = 1; row < times.size(); ++row) {
    if (steps[row - 1] <= gap_steps * *middle || across.at(times[row]) - across.at(times[row - 1]) < least_width) continue;
    runs.back().end = row;
    runs.push_back({row, times.size()});
  }
  return runs;
}

// A state lasts until the next sample; the last one before a gap ends at its own time. Labels of
// recordings may be of no state (unknown), which leaves the row blank.
void draw_states(Svg& svg, const TimeAxis& across, double top, const std::vector<double>& time,
                 const std::vector<PadState>& states) {
  for (const Run& run : runs_of(across, time)) {
    for (std::size_t begin = run.begin; begin < run.end;) {
      std::size_t end = begin + 1;
      while (end < run.end && states[end] == states[begin]) ++end;
      const double from = across.at(time[begin]), to = across.at(time[std::min(end, run.end - 1)]);
      const std::string kind = choice_name(pad_states, states[begin]);
      if (!kind.empty()) svg.bar(kind, from, top, std::max(to - from, 0.5), strip_height);
      begin = end;
    }
  }
}

std::string states_drawing(const std::vector<double>& time, const TimeAxis& across, const TimelineMarks& marks) {
  std::vector<std::pair<std::string, const std::vector<PadState>*>> rows;
  if (!marks.seen.empty()) rows.emplace_back("detector", &marks.seen);
  if (!marks.labels.empty()) rows.emplace_back(marks.labels_name, &marks.labels);
  if (rows.empty()) return "";
  const double pitch = strip_height + 6.0, foot = time_top + pitch * static_cast<double>(rows.size());
  Svg svg = time_chart({time_width, foot + key_place + 8.0, time_left, time_right, time_top, foot}, "states", across, Axis{}, "",
                       marks);
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double top = time_top + 3.0 + pitch * static_cast<double>(row);
    svg.text("small end", time_left - 6.0, top + strip_height - 3.0, rows[row].first);
    draw_states(svg, across, top, time, *rows[row].second);
  }
  std::vector<std::pair<std::string, std::string>> key;
  for (const PadStateName& state : pad_states)
    key.emplace_back(state.name, fmt::format("{}{}", state.title, slips(state.value) ? " slip" : ""));
  if (!marks.alarms.empty()) key.emplace_back("alarm", "alarm");
  draw_key(svg, foot + key_place, key);
  return svg.element("States over time [s]");
}

// Draws a line through the values, interrupted at missing values and gaps. Draws the least and the
// largest value of each bucket of samples, so that no peak is lost.
void draw_values(Svg& svg, const std::string& kind, const TimeAxis& across, const Axis& up, std::span<const double> times,
                 std::span<const double> values) {
  const std::size_t bucket = std::max<std::size_t>(1, times.size() / most_buckets);
  std::vector<std::array<double, 2>> line;
  const auto end_line = [&] {
    if (line.size() == 1) svg.dot(kind, line[0][0], line[0][1], 1.5);
    if (line.size() > 1) svg.polyline(kind, line);
    line.clear();
  };
  for (const Run& run : runs_of(across, times)) {
    for (std::size_t begin = run.begin; begin < run.end; begin += bucket) {
      std::optional<std::size_t> least, most;
      for (std::size_t row = begin; row < std::min(begin + bucket, run.end); ++row) {
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
}

// One value of a channel over time.
struct Signal {
  std::string name;
  std::vector<double> values;
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();

  [[nodiscard]] double range() const { return most - least; }
};

// Number of vector components of each unit of a channel, such as 3 for force [units, 3]; else 1.
std::size_t components_of(const SensorColumn& channel) {
  const bool vectors =
      channel.shape.size() > 1 && channel.shape.front() > 1 && (channel.shape.back() == 2 || channel.shape.back() == 3);
  return vectors ? channel.shape.back() : 1;
}

// The values of a component that are finite at least once, those that change the most first.
// `names`: names of the channel's values.
std::vector<Signal> signals_of(const SensorColumn& channel, std::span<const std::string> names, std::size_t component) {
  const std::size_t width = channel.row_size();
  std::vector<Signal> signals;
  for (std::size_t column = component; column < width; column += components_of(channel)) {
    Signal signal{names[column], {}};
    for (std::size_t at = column; at < channel.values.size(); at += width) {
      const double value = channel.values[at];
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

std::string with_unit(const SensorColumn& channel) {
  return channel.unit.empty() || channel.unit == "1" ? channel.name : fmt::format("{} [{}]", channel.name, channel.unit);
}

// Name with unit, or the unit alone if both are too long; the title has the name.
std::string upright_name(const SensorColumn& channel) {
  const std::string name = with_unit(channel);
  return name.size() <= most_upright_letters ? name : name.substr(std::min(channel.name.size() + 1, name.size()));
}

std::string component_drawing(const SensorRecord& sensor, const SensorColumn& channel, std::span<const std::string> names,
                              std::size_t component, const TimeAxis& across, const TimelineMarks& marks) {
  const std::size_t components = components_of(channel), all = channel.row_size() / components;
  std::string title = channel.name;
  if (components > 1) title += fmt::format(", component {} of {}", component + 1, components);
  std::vector<Signal> signals = signals_of(channel, names, component);
  if (signals.empty()) return fmt::format("<p class=\"note\">{}: no values</p>\n", escape_html(title));
  if (signals.size() > series_count) signals.resize(series_count);
  const std::string subject = with_unit(channel) + title.substr(channel.name.size()) + " over time [s]";
  if (signals.size() < all) title += fmt::format(": the {} of {} values that change the most", signals.size(), all);
  std::vector<double> ends;
  for (const Signal& signal : signals) ends.insert(ends.end(), {signal.least, signal.most});
  const Axis up = round_axis(ends, 4.0, time_foot, time_top);
  const bool keyed = signals.size() > 1;  // a single value has the channel's name
  const Frame frame{time_width, time_foot + (keyed ? key_place + 8.0 : 42.0), time_left, time_right, time_top, time_foot};
  Svg svg = time_chart(frame, title, across, up, upright_name(channel), marks);
  std::vector<std::pair<std::string, std::string>> key;
  for (std::size_t k = 0; k < signals.size(); ++k) {
    key.emplace_back(fmt::format("s{}", k), signals[k].name);
    draw_values(svg, key.back().first, across, up, sensor.times_of(channel), signals[k].values);
  }
  if (keyed) draw_key(svg, time_foot + key_place, key);
  return svg.element(subject);
}

std::string probability_drawing(const std::vector<double>& time, const TimeAxis& across, const TimelineMarks& marks) {
  std::vector<double> at, values;
  for (std::size_t row = 0; row < marks.probability.size(); ++row) {
    if (std::isnan(marks.probability[row])) continue;
    at.push_back(time[row]);
    values.push_back(marks.probability[row]);
  }
  if (values.empty()) return "";
  const Axis up{.low = 0.0, .high = 1.0, .begin = time_foot, .end = time_top, .ticks = {0.0, 0.5, 1.0}};
  Svg svg = time_chart({time_width, time_foot + 42.0, time_left, time_right, time_top, time_foot}, "probability of slip", across,
                       up, "probability", marks);
  draw_values(svg, "s0", across, up, at, values);
  return svg.element("Probability of slip over time [s]");
}

// The values of a recording of one sample, one row per channel.
std::string values_html(const SensorRecord& sensor) {
  TextTable table{{"channel", "values"}, {}};
  for (const SensorColumn& channel : sensor.channels)
    table.rows.push_back({with_unit(channel), fmt::format("{:.6g}", fmt::join(channel.values, ", "))});
  return "<p class=\"note\">A single sample; there is nothing to draw over time.</p>\n" + table_html(table);
}

// Throws InputError for times and names that cannot be drawn; files from elsewhere may hold
// anything.
void check_drawable(const SensorRecord& sensor) {
  std::size_t values = 0;
  for (const SensorColumn& channel : sensor.channels) {
    values += channel.row_size();
    const std::vector<double>& time = sensor.times_of(channel);
    if (!std::ranges::all_of(time, [](double at) { return std::isfinite(at); }))
      reject("sensors/{}: channel {} has a time that is not finite", sensor.name, channel.name);
  }
  if (sensor.channel_names.size() != values)
    reject("sensors/{} names {}, but its samples have {}", sensor.name, counted(sensor.channel_names.size(), "channel"),
           counted(values, "value"));
}

}  // namespace

double time_origin(const std::vector<double>& time) {
  constexpr double longest_offset = 100.0;  // in durations; a larger offset would hide the digits in which times differ
  return std::abs(time.front()) > longest_offset * (time.back() - time.front()) ? time.front() : 0.0;
}

std::string timeline_html(const SensorRecord& sensor, const TimelineMarks& marks, std::size_t most_channels) {
  check_drawable(sensor);
  if (sensor.time.size() < 2) return values_html(sensor);
  const TimeAxis across = time_axis(sensor.time);
  std::string html =
      "<div class=\"scroll\">\n" + states_drawing(sensor.time, across, marks) + probability_drawing(sensor.time, across, marks);
  std::vector<std::string> others;
  std::span<const std::string> names(sensor.channel_names);
  for (std::size_t k = 0; k < sensor.channels.size(); ++k) {
    const SensorColumn& channel = sensor.channels[k];
    if (k < most_channels) {
      for (std::size_t component = 0; component < components_of(channel); ++component)
        html += component_drawing(sensor, channel, names.first(channel.row_size()), component, across, marks);
    } else {
      others.push_back(channel.name);
    }
    names = names.subspan(channel.row_size());
  }
  html += "</div>\n";
  if (!others.empty())
    html += fmt::format("<p class=\"note\">Other channels: {}</p>\n", escape_html(fmt::format("{}", fmt::join(others, ", "))));
  return html;
}

}  // namespace slipbench::page
