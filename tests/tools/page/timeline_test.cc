#include "tools/page/timeline.h"

#include <limits>

#include "tests/expect.h"

namespace slipbench::page {
namespace {

// Two channels, 1 s apart from 0 s to 10 s: the first has nine values, of which value k rises by k
// N; the second has one value.
SensorRecord sensor_from(double start) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "own";
  sensor.rate = 1.0;
  SensorColumn force{"force", "N", {9}, {}}, level{"level", "1", {}, {}};
  for (int row = 0; row <= 10; ++row) {
    sensor.time.push_back(start + row);
    for (int k = 0; k < 9; ++k) force.values.push_back(0.1F * static_cast<float>(k * row));
    level.values.push_back(static_cast<float>(row % 2));
  }
  for (int k = 0; k < 9; ++k) sensor.channel_names.push_back("f" + std::to_string(k));
  sensor.channel_names.emplace_back("level");
  sensor.channels = {force, level};
  return sensor;
}

constexpr std::size_t all = std::numeric_limits<std::size_t>::max();

TEST(Timeline, NamesAxesWithUnitsAndValuesInAKey) {
  const std::string html = timeline_html(sensor_from(0.0), {}, all);
  for (const char* text : {">time [s]</text>", ">force [N]</text>", ">level</text>",
                           "force: the 8 of 9 values that change the most", ">f8</text>", ">f1</text>"})
    EXPECT_THAT(html, HasSubstr(text));
  EXPECT_THAT(html, Not(HasSubstr(">f0</text>"))) << "it does not change";
  EXPECT_THAT(html, Not(AnyOf(HasSubstr("States"), HasSubstr("Probability"), HasSubstr("bar alarm"))));
  EXPECT_THAT(timeline_html(sensor_from(0.0), {}, 1), HasSubstr("Other channels: level"));
}

// 16 letters of two bytes each: 14 are kept, and none is split.
TEST(Timeline, CutsNamesBetweenLetters) {
  SensorRecord sensor = sensor_from(0.0);
  sensor.channel_names[8] = "ääääääääääääääää";
  sensor.channel_names[7] = "ööööööööö";
  const std::string html = timeline_html(sensor, {}, 1);
  EXPECT_THAT(html, AllOf(HasSubstr(">ääääääääääääää…</text>"), HasSubstr(">ööööööööö</text>")));
}

// Value k is component k mod 3 of unit k/3. Over 10 s value k changes by k N.
TEST(Timeline, DrawsVectorsByTheirComponents) {
  SensorRecord sensor = sensor_from(0.0);
  sensor.channels[0].shape = {3, 3};
  const std::string html = timeline_html(sensor, {}, 1);
  for (int component : {1, 2, 3})
    EXPECT_THAT(html, HasSubstr("aria-label=\"force [N], component " + std::to_string(component) + " of 3 over time [s]\""));
  const std::string last = html.substr(html.find("component 3 of 3</text>"));
  EXPECT_THAT(last, AllOf(HasSubstr(">f8</text>"), HasSubstr(">f2</text>"), Not(HasSubstr(">f7</text>"))));
}

// The axis is 828 px long for 10 s and begins at 72 px.
TEST(Timeline, DrawsStatesAlarmsAndProbability) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  TimelineMarks marks{.alarms = {{5.0, 7.5}}, .labels_name = "truth"};
  marks.probability = {none, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0};
  marks.seen.assign(11, PadState::non_slip);
  marks.labels.assign(11, PadState::gross);
  const std::string html = timeline_html(sensor_from(0.0), marks, 1);
  EXPECT_THAT(html, HasSubstr("class=\"bar alarm\" x=\"486\""));  // 72 + 828 * 5/10
  EXPECT_THAT(html, HasSubstr("width=\"207\""));                  // 828 * 2.5/10
  EXPECT_THAT(html, HasSubstr("class=\"bar non_slip\" x=\"72\" y=\"33\" width=\"828\""));
  EXPECT_THAT(html, HasSubstr("class=\"bar gross\" x=\"72\" y=\"53\" width=\"828\""));
  for (const char* text : {">detector</text>", ">truth</text>", ">incipient slip</text>", "Probability of slip over time [s]"})
    EXPECT_THAT(html, HasSubstr(text));
}

// Labels beyond the states of a pad, which recordings use for unknown, leave their time blank: 0 to
// 5 s of 10 s, half of 828 px.
TEST(Timeline, LeavesUnknownLabelsBlank) {
  TimelineMarks marks{.labels_name = "labels"};
  marks.labels.assign(11, PadState::gross);
  std::fill_n(marks.labels.begin(), 5, PadState{4});
  const std::string html = timeline_html(sensor_from(0.0), marks, 1);
  EXPECT_THAT(html, HasSubstr("class=\"bar gross\" x=\"486\" y=\"33\" width=\"414\""));
  EXPECT_THAT(html, Not(HasSubstr("x=\"72\" y=\"33\"")));
}

// 0 s to 5 s, then 15 s to 20 s: 10 median steps are missing between 279 px and 693 px, because the
// axis is 828 px long for 20 s.
TEST(Timeline, BreaksLinesAndStatesAtAGap) {
  SensorRecord sensor = sensor_from(0.0);
  for (std::size_t row = 6; row < sensor.time.size(); ++row) sensor.time[row] += 9.0;
  sensor.time.back() = 20.0;
  TimelineMarks marks;
  marks.seen.assign(11, PadState::non_slip);
  const std::string html = timeline_html(sensor, marks, all);
  EXPECT_THAT(html, HasSubstr("class=\"bar non_slip\" x=\"72\" y=\"33\" width=\"207\""));   // 828 * 5/20
  EXPECT_THAT(html, HasSubstr("class=\"bar non_slip\" x=\"693\" y=\"33\" width=\"207\""));  // 72 + 828 * 15/20
  const auto lines = [](const std::string& text) {
    std::size_t count = 0;
    for (std::size_t at = text.find("<polyline"); at != std::string::npos; at = text.find("<polyline", at + 1)) ++count;
    return count;
  };
  EXPECT_EQ(lines(html), 2 * lines(timeline_html(sensor_from(0.0), {}, all)));
}

TEST(Timeline, CountsTheTimeOfAClockFromTheFirstSample) {
  EXPECT_EQ(time_origin({5.0, 6.0}), 0.0);
  EXPECT_EQ(time_origin({1.5e9, 1.5e9 + 1.0}), 1.5e9);
  EXPECT_THAT(timeline_html(sensor_from(1.5e9), {}, 1),
              AllOf(HasSubstr(">time after the first sample (at 1500000000 s) [s]</text>"), HasSubstr(">10</text>")));
}

TEST(Timeline, ShowsOneSampleAsATable) {
  SensorRecord sensor = sensor_from(0.0);
  sensor.time.resize(1);
  sensor.channels[0].values.resize(9);
  sensor.channels[1].values = {0.5F};
  EXPECT_THAT(timeline_html(sensor, {}, all),
              AllOf(HasSubstr("A single sample"), HasSubstr("<td>0.5</td>"), Not(HasSubstr("<svg"))));
}

}  // namespace
}  // namespace slipbench::page
