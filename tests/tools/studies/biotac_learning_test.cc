// Figures of answers by hand, and who learns from whom.
#include "tools/studies/biotac/biotac_learning.h"

#include <cmath>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"

namespace slipbench::reproduce::biotac_learning_test {
namespace {

using namespace biotac;

// Three classes with the odds 1 : 2 : 1; the first frame is masked, the second example is not judged.
TEST(Answers, AreOfJudgedFrames) {
  const std::vector<train::FoldExample> examples{{{{}, {train::masked, 2}}}, {{{}, {0, 0}}}};
  const auto two = static_cast<float>(std::log(2.0));
  const std::vector<Answer> answers = answers_of(examples, {{0.0F, 0.0F, 0.0F, 0.0F, two, 0.0F}, {}}, 1);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_EQ(answers[0].example, 0U);
  EXPECT_EQ(answers[0].label, 2);
  EXPECT_EQ(answers[0].called, 1);
  EXPECT_NEAR(answers[0].slip, 0.75, 1e-6);
  const std::vector<Answer> windows = answers_of(examples, {{0.0F, 0.0F, two}, {}}, 2);  // two frames make one answer
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].called, 2);
}

// Hold, hold, slip as 1, slip as 1, slip as 2; called 0, 1, 1, 0, 1.
std::vector<Answer> five() { return {{0, 0, 0, 0.1}, {1, 0, 1, 0.6}, {2, 1, 1, 0.9}, {3, 1, 0, 0.4}, {4, 2, 1, 0.7}}; }

TEST(Figures, AreOfClassesAndOfSlip) {
  const Figures figures = figures_of(five());
  EXPECT_NEAR(figures.accuracy, 2.0 / 5.0, 1e-12);
  EXPECT_NEAR(figures.balanced, (1.0 / 2.0 + 1.0 / 2.0 + 0.0) / 3.0, 1e-12);
  EXPECT_NEAR(figures.precision, 2.0 / 3.0, 1e-12);  // of three called slip one holds; which slip does not matter
  EXPECT_NEAR(figures.recall, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(figures.f1, 4.0 / 6.0, 1e-12);
  EXPECT_NEAR(figures.auc, 5.0 / 6.0, 1e-12);  // of six pairs .4 against .6 alone is wrong
  EXPECT_TRUE(std::isnan(figures_of({}).accuracy));
  const std::vector<Answer> hold{{0, 0, 0, 0.1}};
  EXPECT_TRUE(std::isnan(figures_of(hold).auc));
}

// Examples 0 and 1 are fold 0: accuracy 1/2, no slip. The others: 1/3. With 0 and 2 alone: 1 and 1.
TEST(Scores, AreMeansOfFolds) {
  const std::vector<std::size_t> fold_of{0, 0, 1, 1, 1};
  const Scores scores = scores_of(five(), fold_of);
  EXPECT_NEAR(scores.accuracy.mean, 0.5 * (1.0 / 2.0 + 1.0 / 3.0), 1e-12);
  EXPECT_NEAR(scores.recall.mean, 2.0 / 3.0, 1e-12);  // of the second fold alone
  EXPECT_TRUE(std::isnan(scores.recall.sd));
  const Scores some = scores_of(five(), fold_of, [](std::size_t example) { return example % 2 == 0 && example < 4; });
  EXPECT_EQ(some.accuracy.mean, 1.0);
  EXPECT_EQ(cell(some.accuracy), "100.0 +- 0.0");
  EXPECT_EQ(cell(scores.recall), "66.7");
  EXPECT_EQ(cell(MeanSd{std::nan(""), std::nan("")}), "-");
  EXPECT_TRUE(json_of(scores).at("recall_sd").is_null());
}

// Two sets of +-1 that name the sign by opposite classes: who learns from the other alone is wrong throughout. Of both, there are five times as many of
// the other.
TEST(Lessons, LearnFromWhomTheyAreTold) {
  if (!train::networks_available()) GTEST_SKIP() << "no libtorch";
  const auto signs = [](std::size_t count, bool turned) {
    Set set;
    set.folds = 2;
    for (std::size_t i = 0; i < count; ++i) {
      const bool positive = i % 2 == 0;
      set.examples.push_back({{{positive ? 1.0F : -1.0F}, {static_cast<std::uint8_t>(positive != turned ? 1 : 0)}}});
      set.fold_of.push_back(i / 2 % 2);
    }
    return set;
  };
  const Set set = signs(8, false), other = signs(40, true);
  ReproduceOptions options;
  options.jobs = 2;
  Lessons lessons(options);
  const Network network{"lr", "lr", {1, {train::Linear{2}}}, 2000};
  const std::size_t own = lessons.queue(set, nullptr, Learns::own, network),
                    from_other = lessons.queue(set, &other, Learns::other, network),
                    both = lessons.queue(set, &other, Learns::both, network);
  lessons.run();
  EXPECT_EQ(figures_of(lessons.answers(own)).accuracy, 1.0);
  EXPECT_EQ(figures_of(lessons.answers(from_other)).accuracy, 0.0);
  EXPECT_EQ(figures_of(lessons.answers(both)).accuracy, 0.0);
  ASSERT_EQ(lessons.answers(own).size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(lessons.answers(both)[i].example, i);
}

TEST(BiotacTables, RefuseWhatCannotBe) {
  if (!train::networks_available()) GTEST_SKIP() << "no libtorch";
  ReproduceOptions both, nowhere;
  both.data = "a.h5";
  both.trials = 3;
  nowhere.real = "nowhere.h5";
  for (const char* name : {"table1", "fig12", "table2", "table3"}) {
    const Reproduction& table = find_reproduction(std::string("biotac-stability-slip/") + name);
    EXPECT_THAT(refusal_of([&] { table.run(both); }), HasSubstr("allowed: --data alone")) << name;
    EXPECT_THAT(refusal_of([&] { table.run(nowhere); }), HasSubstr("nowhere.h5")) << name;
  }
}

}  // namespace
}  // namespace slipbench::reproduce::biotac_learning_test
