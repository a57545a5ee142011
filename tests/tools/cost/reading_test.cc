// Fronts, the cheapest settings and sentences of an exploration with made-up values.
#include <vector>

#include "tests/expect.h"
#include "tests/tools/cost/example.h"
#include "tools/cost/reading.h"

namespace slipbench::cost {
namespace {

// By cost: 10 ms (0.05), 5 ms (0.005); 2 ms costs more than 5 ms and is not better; the scene
// (0.0005) is better. The rest costs more and is worse. Settings compared with another reference
// are on no front.
TEST(CostReading, TheFrontIsWhatNothingCheaperMatches) {
  std::vector<std::string> front;
  for (const Row& row : example().rows) {
    if (!row.front.empty()) front.push_back(row.setting.label);
  }
  EXPECT_THAT(front, ElementsAre("1 ms", "10 ms", "5 ms"));
}

TEST(CostReading, ARunInWhichOtherThingsHappenMeetsNoWish) {
  Exploration exploration = example();
  exploration.rows.push_back(timed("field", "20 ms", 1e-4, onset_error(0.0, true)));
  EXPECT_EQ(cheapest(exploration, Measure::onset, 1e-2)->setting.label, "5 ms");
  EXPECT_EQ(cheapest(exploration, Measure::onset, 1e-9), nullptr);
  EXPECT_EQ(cheapest(exploration, Measure::onset, 1e-2, "contact")->setting.label, "noslip 3");
}

// 5 ms: 0.004 s for 2 s, 500 times real time. noslip 3: 1.6 s for 2 s, 1.25 times, 400 times
// slower. 0.1 %: the scene itself, 0.02 s, 100 times. One of the three settings of MuJoCo's contact
// ended in a warning.
TEST(CostReading, SentencesSayWhatAnErrorCostsAndWhatMujocoPays) {
  EXPECT_THAT(
      sentences(example()),
      ElementsAre(
          "slip onset, error up to 1 %: 500 times real time (element field, 5 ms); MuJoCo's own contact: 1.25 times real time (noslip 3), 400 times slower.",
          "slip onset, error up to 0.1 %: 100 times real time (the scene as it is, 1 ms); MuJoCo's own contact: not reached by its 2 settings, 0.8 % at best (noslip 3, 1.25 times real time).",
          "1 of 3 settings of MuJoCo's own contact is not counted: 1 diverged."));
}

TEST(CostReading, AReferenceThatHasNotConvergedIsNoSecret) {
  Exploration exploration = example();
  exploration.reference.converged = false;
  exploration.reference.own_error = onset_error(0.02);
  EXPECT_THAT(sentences(exploration), Contains(HasSubstr("has not converged: slip onset (2 %)")));
  EXPECT_THAT(sentences(exploration), Contains(HasSubstr("slip onset, error up to 1 %: the reference itself is less accurate")));
}

// A row with fewer outputs is cheaper because it computes less.
TEST(CostReading, OnlyWhatPutsOutAsOftenIsCompared) {
  Exploration exploration = example();
  for (Row& row : exploration.rows) row.rate = 1000.0;
  exploration.rows[2].rate = 200.0;  // 5 ms
  mark_fronts(exploration);
  EXPECT_EQ(cheapest(exploration, Measure::onset, 1e-2)->setting.label, "2 ms");
}

// An untried setting has not failed.
TEST(CostReading, ContactThatWasNotTriedHasNotFailed) {
  Exploration exploration = example();
  for (Row& row : exploration.rows) {
    if (row.setting.series != "contact") continue;
    row.status = Status::refused;
    row.why = "no such thing";
  }
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("MuJoCo's own contact: not possible (no such thing)"));
  for (Row& row : exploration.rows) {
    if (row.setting.series == "contact") row.status = Status::over_budget;
  }
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("MuJoCo's own contact: not tried, because the budget was used up"));
}

// One of three has failed; then noslip 3 has fewer outputs; then the last, impratio 100, is out of
// time.
TEST(CostReading, OfHowManySettingsAFailureIsSaid) {
  Exploration exploration = example();
  for (Row& row : exploration.rows) row.rate = 1000.0;
  exploration.rows[5].rate = 250.0;
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("not reached by its 1 setting, 3 % at best (impratio 100"));
  EXPECT_THAT(
      sentences(exploration),
      Contains("2 of 3 settings of MuJoCo's own contact are not counted: 1 diverged, 1 had a lower output rate than the scene."));
  exploration.rows[4].status = Status::over_budget;
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("MuJoCo's own contact: no run can be compared"));
  EXPECT_THAT(
      sentences(exploration),
      Contains(
          "3 of 3 settings of MuJoCo's own contact are not counted: 1 diverged, 1 had a lower output rate than the scene, 1 not run, because the budget was used up."));
}

// In both remaining rows the outcome differs.
TEST(CostReading, OtherThingsHappenOnlyWhereSomethingWasCompared) {
  Exploration exploration = example();
  for (const std::size_t contact : {4U, 5U}) exploration.rows[contact].errors = onset_error(0.0, true);
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("not reached by its 2 settings, in which other events occur"));
  for (const std::size_t contact : {4U, 5U}) exploration.rows[contact].status = Status::diverged;
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("no run can be compared"));
}

// Three digits without exponent: 1 420 % is easier to read than 1.42e+03 %.
TEST(CostReading, LargeErrorsAreWrittenOut) {
  Exploration exploration = example();
  for (const std::size_t contact : {4U, 5U}) exploration.rows[contact].errors = onset_error(14.2);
  EXPECT_THAT(sentences(exploration).front(), HasSubstr("1420 % at best"));
}

TEST(CostReading, AnInterruptedExplorationSaysSo) {
  Exploration exploration = example();
  exploration.interrupted = true;
  EXPECT_THAT(sentences(exploration).back(), HasSubstr("Interrupted"));
  EXPECT_EQ(cost_json(exploration, nlohmann::ordered_json::object())["interrupted"], true);
}

TEST(CostReading, AnEffectThatCostsAndChangesNothingIsPointedOut) {
  Exploration exploration = example();
  exploration.prices = {{.name = "ageing", .without = CpuTime{0.015, 0.014, 0.016, 9}, .share = 0.25, .low = 0.2, .high = 0.3},
                        {.name = "stribeck",
                         .without = CpuTime{0.015, 0.014, 0.016, 9},
                         .share = 0.25,
                         .low = 0.2,
                         .high = 0.3,
                         .changes = onset_error(1e-3)},
                        {.name = "texture", .without = CpuTime{0.02, 0.014, 0.03, 9}, .share = 0.0, .low = -0.2, .high = 0.3}};
  EXPECT_TRUE(exploration.prices[0].idle());
  EXPECT_FALSE(exploration.prices[1].idle());
  EXPECT_FALSE(exploration.prices[2].idle()) << "what it costs is within the scatter";
  EXPECT_THAT(sentences(exploration), Contains("ageing costs 25 % of the time and changes no measured quantity."));
}

// A share of 0.25 is 25 %, a change of 1e-3 is 0.1 %.
TEST(CostReading, AVerdictNamesTheLargestChange) {
  Price price{.name = "stribeck", .share = 0.25, .low = 0.2, .high = 0.3, .changes = onset_error(1e-3)};
  EXPECT_EQ(verdict(price), "costs 25 %; changes slip onset most, by 0.1 %");
  price.low = -0.1;
  EXPECT_EQ(verdict(price), "costs less than the scatter of the CPU time; changes slip onset most, by 0.1 %");
  price.why = "no such law";
  EXPECT_EQ(verdict(price), "does not run: no such law");
}

TEST(CostReading, TheObjectHasFailuresAsFailures) {
  const auto json = cost_json(example(), nlohmann::ordered_json::object());
  EXPECT_EQ(json["slipbench_cost"], 1);
  const auto& failed = json["rows"].back();
  EXPECT_EQ(failed["status"], "warning");
  EXPECT_TRUE(failed["cpu_s"].is_null());
  EXPECT_THAT(failed["errors"], IsEmpty());
  EXPECT_EQ(json["rows"][2]["cost"], 0.002);
  EXPECT_EQ(json["rows"][2]["pareto"][0], "onset");
}

}  // namespace
}  // namespace slipbench::cost
