// Table III's figures, of a result made by hand.
#include "tools/studies/hd_papillarray/hd_tables.h"

#include <cmath>

#include "tests/expect.h"
#include "tools/studies/study_catalogue.h"

namespace slipbench::reproduce::hd_table3_test {
namespace {

Json figure(const Json& value) { return {{"value", value}, {"low", nullptr}, {"high", nullptr}}; }

// Ten trials: eight slip, of which five are seen, two early and one is missed; one of the two others has a false alarm.
TEST(GruFigures, ArePlainCountsOfTheTrials) {
  const Json result{{"all",
                     {{"trials", 10},
                      {"slipping", 8},
                      {"seen", 5},
                      {"early", 2},
                      {"missed", 1},
                      {"false_alarms", 1},
                      {"figures",
                       {{"balanced_slip_accuracy", figure(0.9)},
                        {"auc", figure(0.95)},
                        {"delay_median_s", figure(0.05)},
                        {"delay_p10_s", figure(nullptr)},
                        {"delay_p90_s", figure(0.1)},
                        {"false_alarms_per_minute", figure(3.0)}}}}}};
  const GruFigures figures = gru_figures(result);
  EXPECT_EQ(figures.right(false), 0.6) << "five seen, and one that is rightly quiet";
  EXPECT_EQ(figures.right(true), 0.8);
  EXPECT_EQ(figures.balanced, 0.9);
  EXPECT_EQ(figures.delay_90, 0.1);
  EXPECT_TRUE(std::isnan(figures.delay_10));
}

TEST(HdTable3, UnknownRowsGetTheNearest) {
  ReproduceOptions options;
  options.only = {"gru_latch"};
  EXPECT_THAT(refusal_of([&] { hd_table3(options); }), HasSubstr("did you mean 'gru_latched'"));
}

}  // namespace
}  // namespace slipbench::reproduce::hd_table3_test
