// The curve of slip against hold from end to end, with few recordings.
#include <string>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::piezo_slip_against_hold_test {
namespace {

TEST(SlipAgainstHold, PrintsACurveWhosePartsAddUp) {
  ReproduceOptions options;
  options.trials = 4;
  options.jobs = 2;
  const Result result = find_reproduction("piezo-fft-gru/slip_against_hold").run(options);
  ASSERT_THAT(result.tables, SizeIs(5));
  for (const ResultTable& table : result.tables) {
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.head.size()) << table.title;
  }
  ASSERT_THAT(result.charts, SizeIs(1));
  for (const ResultCurve& curve : result.charts[0].curves) EXPECT_EQ(curve.points.size(), result.charts[0].places.size());

  const Json& levels = result.figures.at("curve").at("paper");
  ASSERT_THAT(levels, SizeIs(6));
  for (const auto& [level, areas] : levels.items()) {
    const Json &all = areas.at("pooled"), &contact = areas.at("contact"), &air = areas.at("air");
    // Slip is in each of the three, and a hold is in contact or in the air: the pooled area is the mean of both by their frames.
    EXPECT_EQ(all.at("slip_frames"), contact.at("slip_frames"));
    const double n = contact.at("hold_frames").get<double>(), m = air.at("hold_frames").get<double>();
    EXPECT_EQ(all.at("hold_frames").get<double>(), n + m);
    EXPECT_NEAR(all.at("auc").get<double>(), (n * contact.at("auc").get<double>() + m * air.at("auc").get<double>()) / (n + m),
                1e-12);
  }
  for (const char* causes : {"hold_causes", "slip_causes"}) {
    double frames = 0.0, share = 0.0, missing = 0.0, missing_hann = 0.0;
    for (const auto& [name, cause] : result.figures.at(causes).items()) {
      frames += cause.at("frames").get<double>();
      share += cause.at("share").get<double>();
      missing += cause.at("paper").at("share_of_missing").get<double>();
      missing_hann += cause.at("hann").at("share_of_missing").get<double>();
    }
    const char* counted = std::string(causes) == "hold_causes" ? "hold_frames" : "slip_frames";
    EXPECT_EQ(frames, levels.at("0").at("contact").at(counted).get<double>()) << causes;
    EXPECT_NEAR(share, 1.0, 1e-9) << causes;
    EXPECT_NEAR(missing, 1.0, 1e-9) << causes;
    EXPECT_NEAR(missing_hann, 1.0, 1e-9) << causes;
  }
}

TEST(SlipAgainstHold, NeedsTwoRecordingsOfEachKindAndAsManyOfBoth) {
  ReproduceOptions options;
  for (const std::size_t trials : {2U, 5U}) {  // of five, four would be run
    options.trials = trials;
    EXPECT_THAT(refusal_of([&] { find_reproduction("piezo-fft-gru/slip_against_hold").run(options); }),
                EndsWith("allowed: even numbers, 4 or more"))
        << trials;
  }
}

}  // namespace
}  // namespace slipbench::reproduce::piezo_slip_against_hold_test
