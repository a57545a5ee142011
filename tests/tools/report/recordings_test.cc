// The page of recordings without truth.
#include <limits>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/report/report.h"

namespace slipbench::report {
namespace {

struct Recordings : slipbench::testing::FolderTest {
  // Four samples at 10 Hz, then one 0.7 s later, as from an import: 5 samples in 1 s, one value
  // missing.
  static TrialRecord recording(std::size_t trial, const std::vector<std::uint8_t>& labels) {
    SensorRecord sensor;
    sensor.name = "tip";
    sensor.type = "own";
    sensor.rate = 4.0;
    sensor.frame = "x along the finger";
    sensor.time = {0.0, 0.1, 0.2, 0.3, 1.0};
    sensor.timing = timing_of(sensor.time, 1e-3);
    sensor.channels = {{"force", "N", {2}, {1, 2, 3, 4, 5, 6, 7, 8, 9, std::numeric_limits<float>::quiet_NaN()}}};
    sensor.channel_names = {"left", "right"};
    sensor.labels.truth = false;
    sensor.labels.rule = "a button held by hand";
    sensor.labels.state_paper = labels;
    TrialRecord record;
    record.trial = trial;
    record.outcome.max_slip_distance = std::numeric_limits<double>::quiet_NaN();
    record.params = R"({"file": "set/<log>.csv", "object": "cup"})";
    record.body_time = sensor.time;
    record.sensors = {sensor};
    return record;
  }
  std::string page_of(const std::vector<TrialRecord>& records, const ReportOptions& options = {}) {
    const DatasetHeader header{
        .version = "1", .scene = "", .seed = 7, .command = "slipbench import a.csv", .truth = "none: imported by a map"};
    slipbench::testing::write_dataset(path("a.h5"), header, records);
    write_report(path("a.h5"), path("a.html"), options);
    return bytes_of(path("a.html"));
  }
};

TEST_F(Recordings, ShowsWhatThereIsAndSaysWhatThereIsNot) {
  const std::string page = page_of({recording(0, {})});
  EXPECT_TRUE(begins_as_report(page));
  for (const char* text : {"The recordings were imported by a map. They contain no truth", "There are no recorded labels.",
                           "force [N] over time [s]", ">left</text>", "set/&lt;log&gt;.csv", "x along the finger",
                           "<h2>Trial 0, cup</h2>", "id=\"trial-0\""})
    EXPECT_THAT(page, HasSubstr(text));
  // 5 samples in 1 s: 4 steps a second; the longest is 0.7 s and begins at 0.3 s. One value is
  // missing.
  EXPECT_THAT(page, HasSubstr("<td>cup</td><td>tip</td><td>5</td><td>1</td><td>4</td><td>0.7 (0.3 s after the first sample)</td>"
                              "<td>1</td><td>–</td>"));
  EXPECT_THAT(page, Not(AnyOf(HasSubstr("<script"), HasSubstr("States over time"), HasSubstr(">truth</text>"))));
}

TEST_F(Recordings, ShowsRecordedLabels) {
  const std::string page = page_of({recording(0, {1, 1, 1, 3, 3}), recording(1, {1, 1, 1, 1, 1})});
  EXPECT_THAT(page, HasSubstr("Recorded labels: a button held by hand"));
  EXPECT_THAT(page, AllOf(HasSubstr("<td>40.0 %, from 0.3 s</td>"), HasSubstr("<td>none</td>")));  // 2 of 5 samples
  EXPECT_THAT(page, AllOf(HasSubstr(">labels</text>"), HasSubstr("class=\"bar gross\"")));
}

// Two of five labels are unknown: one of the others is slip. Their time is blank in the drawing.
TEST_F(Recordings, LeavesUnknownLabelsOut) {
  const std::string page = page_of({recording(0, {4, 1, 1, 3, 4}), recording(1, {4, 4, 4, 4, 4})});
  EXPECT_THAT(page, AllOf(HasSubstr("<td>33.3 %, from 0.3 s</td>"), HasSubstr("<td>–</td>")));
}

TEST_F(Recordings, DrawsOneRecordingInFullOrAFew) {
  const std::vector<TrialRecord> records{recording(0, {}), recording(1, {}), recording(2, {})};
  const std::string one = page_of(records, {.trial = 1});
  EXPECT_THAT(one, AllOf(HasSubstr("<h2>Trial 1, cup</h2>"), Not(HasSubstr("<h2>Trial 0, cup</h2>")),
                         HasSubstr("<td>trial 2</td>"), HasSubstr("The signals of 1 of the 3 recordings")));
  const std::string few = page_of(records, {.trial = {}, .max_trials = 2, .max_rows = 2});
  EXPECT_THAT(few, AllOf(HasSubstr("The signals of 2 of the 3 recordings"), HasSubstr("The table lists 2 of the 3 recordings")));
}

TEST_F(Recordings, RefusesWhatIsNotThere) {
  EXPECT_THAT(refusal_of([&] { page_of({recording(0, {})}, {.trial = 4}); }), mentions({path("a.h5"), "no trial 4", "0 to 0"}));
  TrialRecord unnamed = recording(2, {}), never = recording(3, {});
  unnamed.sensors[0].channel_names.pop_back();
  never.sensors[0].time[1] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of([&] { page_of({unnamed}); }),
              mentions({"a.h5", "demo_2", "sensors/tip", "names 1 channel,", "2 values"}));
  EXPECT_THAT(refusal_of([&] { page_of({never}); }), mentions({"a.h5", "demo_3", "sensors/tip", "time", "finite"}));
  EXPECT_THAT(refusal_of([&] { page_of({}); }), mentions({path("a.h5"), "contains no trial"}));
}

}  // namespace
}  // namespace slipbench::report
