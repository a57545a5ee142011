// Figures of answers by hand, and who learns from whom.
#include "tools/studies/biotac_stability_slip/biotac_learning.h"

#include <cmath>
#include <numeric>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tests/tools/program/import/sources.h"

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
    EXPECT_THAT(refusal_of([&] { table.run(both); }), mentions({"--data"})) << name;
    EXPECT_THAT(refusal_of([&] { table.run(nowhere); }), HasSubstr("nowhere.h5")) << name;
  }
}

using namespace biotac;
using slipbench::testing::slide_header;
using slipbench::testing::slide_row;
using train::masked;

// Row r of finger f reads 1000 f + 100 r + e.
TrialRecord three_fingers(const char* params, std::size_t rows) {
  TrialRecord record;
  record.params = params;
  std::size_t finger = 0;
  for (const char* name : {"ff", "mf", "th"}) {
    SensorRecord& sensor = record.sensors.emplace_back();
    sensor.name = name;
    sensor.type = "biotac_sp";
    SensorColumn& column = sensor.channels.emplace_back();
    column.name = "electrodes";
    column.shape = {electrodes};
    for (std::size_t row = 0; row < rows; ++row) {
      sensor.time.push_back(0.01 * static_cast<double>(row));
      for (std::size_t e = 0; e < electrodes; ++e) column.values.push_back(static_cast<float>(1000 * finger + 100 * row + e));
    }
    ++finger;
  }
  return record;
}

TEST(Grasps, OfAnImportAreWhatItSays) {
  const Grasp grasp = grasp_of(three_fingers(R"({"object": "can", "palm": "side", "slipped": true})", 1));
  EXPECT_THAT(grasp.object, HasSubstr("can"));
  EXPECT_STREQ(palms.at(grasp.palm).text, "90");
  EXPECT_TRUE(grasp.slipped);
  ASSERT_EQ(grasp.counts.size(), fingers * electrodes);
  EXPECT_EQ(grasp.counts[electrodes + 3], 1003.0F);  // E4 of mf
}

// Three rows, 0 to 20 ms; the lift begins at 15 ms, so the second is the snapshot.
TEST(Grasps, OfTheSceneAreTheLastRowBeforeTheLift) {
  TrialRecord record = three_fingers(R"({"model": "hand_45.xml", "bodies.object.shape": "box"})", 3);
  record.outcome.hold = HoldOutcome{.held = true, .from = 0.015};
  const Grasp grasp = grasp_of(record);
  EXPECT_STREQ(palms.at(grasp.palm).text, "45");
  EXPECT_FALSE(grasp.slipped);
  EXPECT_EQ(grasp.counts.front(), 100.0F);
  EXPECT_EQ(grasp.counts.back(), 2123.0F);
}

TEST(Grasps, ThatAreNoneAreRefused) {
  const auto refused = [](const TrialRecord& record) { return refusal_of([&] { grasp_of(record); }); };
  EXPECT_THAT(refused(three_fingers(R"({"object": "can", "palm": "up", "slipped": true})", 1)), mentions({"palm", "up"}));
  EXPECT_THAT(refused(three_fingers(R"({"model": "hand_45.xml", "bodies.object.shape": "box"})", 1)), mentions({"held"}));
  EXPECT_THAT(refused(three_fingers(R"({"palm": "45", "slipped": true})", 1)), mentions({"no object"}));
  TrialRecord two = three_fingers(R"({"object": "can", "palm": "45", "slipped": true})", 1);
  two.sensors.pop_back();
  EXPECT_THAT(refused(two), mentions({"biotac_sp", "th"}));
}

// Two counts 40 apart stand sqrt(1/2) from their mean, over their deviation 40 sqrt(1/2); equal ones, and one alone, at 0.
TEST(Grasps, AreLevelledByPalm) {
  Grasp low, high, alone;
  for (Grasp* grasp : {&low, &high, &alone}) grasp->counts.resize(fingers * electrodes, 100.0F);
  high.counts.back() = 140.0F;
  alone.palm = 1;
  const std::vector<Grasp> found = levelled({low, high, alone});
  EXPECT_FLOAT_EQ(found[0].counts.back(), -std::sqrt(0.5F));
  EXPECT_FLOAT_EQ(found[1].counts.back(), std::sqrt(0.5F));
  EXPECT_EQ(found[1].counts.front(), 0.0F);
  EXPECT_THAT(found[2].counts, Each(0.0F));
}

// Electrode e of finger f is 24 f + e. A node has the three fingers' values; in D3 E1 stands at the end of the first row of 7, E11 at its beginning.
TEST(Grasps, AreShownAsListImageAndGraph) {
  Grasp grasp;
  grasp.counts.resize(fingers * electrodes);
  std::iota(grasp.counts.begin(), grasp.counts.end(), 0.0F);
  grasp.slipped = true;
  EXPECT_EQ(as_list(grasp).frames.features, grasp.counts);
  EXPECT_THAT(as_list(grasp).frames.label, ElementsAre(1));
  const train::FoldExample graph = as_graph(grasp);
  EXPECT_EQ(graph.frames.features[3 * 5 + 0], 5.0F);
  EXPECT_EQ(graph.frames.features[3 * 5 + 2], 48.0F + 5.0F);
  const train::FoldExample image = as_image(grasp, train::biotac::image_layouts().back());
  ASSERT_EQ(image.frames.features.size(), 3U * 4U * 7U);
  EXPECT_EQ(image.frames.features[6], 0.0F);
  EXPECT_EQ(image.frames.features[0], 10.0F);
  EXPECT_EQ(image.frames.features[2 * 28 + 6], 48.0F);
}

// E11 to E20 are E1 to E10 on the other side of the finger, E23 is E22; E21 and E24 lie in the middle.
TEST(Images, AreSymmetric) {
  for (const train::biotac::ImageLayout& layout : train::biotac::image_layouts()) {
    const auto mirrored = [&](std::size_t e) {
      return std::pair(layout.places[e].first, layout.columns - 1 - layout.places[e].second);
    };
    for (std::size_t e = 0; e < 10; ++e) EXPECT_EQ(mirrored(e), layout.places[e + 10]) << layout.name << " E" << e + 1;
    EXPECT_EQ(mirrored(21), layout.places[22]) << layout.name;
    EXPECT_EQ(mirrored(20), layout.places[20]) << layout.name;
    EXPECT_EQ(mirrored(23), layout.places[23]) << layout.name;
    std::size_t alone = 0;
    for (const auto& pixel : pixels_of(layout)) alone += pixel.size() == 1 ? 1 : 0;
    EXPECT_EQ(alone, electrodes) << layout.name;  // no two electrodes on a pixel, none outside
  }
}

// E2 is 3.1 mm from E1, E22 6.2, E3 8.3.
TEST(Graphs, AreOfTheNearestElectrodes) {
  const std::vector<double> one = nearest_graph(1);
  EXPECT_EQ(one[0], 0.5);
  EXPECT_EQ(one[1], 0.5);
  for (const std::size_t k : {1, 4, 23}) {
    const std::vector<double> graph = nearest_graph(k);
    for (std::size_t node = 0; node < electrodes; ++node)
      EXPECT_NEAR(std::accumulate(graph.begin() + static_cast<std::ptrdiff_t>(node * electrodes),
                                  graph.begin() + static_cast<std::ptrdiff_t>((node + 1) * electrodes), 0.0),
                  1.0, 1e-12);
  }
  EXPECT_THAT(nearest_graph(23), Each(1.0 / 24.0));
  EXPECT_EQ(nearest_graph(0), train::biotac::drawn_graph());
}

// Six rows; in the first nothing touches. Every electrode climbs by 2 a row.
Touch climbing() {
  Touch touch;
  touch.label = {masked, 3, 3, 3, 3, 3};
  for (std::size_t row = 0; row < 6; ++row) touch.counts.insert(touch.counts.end(), electrodes, static_cast<float>(10 + 2 * row));
  return touch;
}

TEST(Windows, AreThoseInContact) {
  const std::vector<train::FoldExample> windows = windows_of(climbing(), {.rows = 2, .stride = 1});
  ASSERT_EQ(windows.size(), 4U);
  EXPECT_EQ(windows[0].frames.features.front(), 12.0F);
  EXPECT_EQ(windows[3].frames.features.back(), 20.0F);
  EXPECT_THAT(windows[0].frames.label, ElementsAre(masked, 3));
  EXPECT_EQ(windows_of(climbing(), {.rows = 2, .stride = 3}).size(), 1U);  // the other begins without contact
}

TEST(Windows, WithoutTheSiteHaveNoMean) {
  const std::vector<train::FoldExample> windows = windows_of(climbing(), {.rows = 3, .stride = 2, .site = false});
  ASSERT_EQ(windows.size(), 1U);  // of rows 2 to 4: -2, 0, 2
  EXPECT_EQ(windows[0].frames.features.front(), -2.0F);
  EXPECT_EQ(windows[0].frames.features[electrodes], 0.0F);
  EXPECT_EQ(windows[0].frames.features.back(), 2.0F);
}

// 12, 14, 16, 18, 20: the squares about 16 sum to 40, over 4 that is 10.
TEST(Windows, ComeToDeviationsAndSlopes) {
  Touch touch = climbing();
  touch.label.erase(touch.label.begin());
  touch.counts.erase(touch.counts.begin(), touch.counts.begin() + electrodes);
  for (std::size_t row = 0; row < 5; ++row) touch.counts[row * electrodes] = 7.0F;  // E1 is still
  Window window{.rows = 5, .stride = 5, .figures = Window::Figures::by_electrode};
  const std::vector<float> figures = windows_of(touch, window).at(0).frames.features;
  ASSERT_EQ(figures.size(), 2 * electrodes);
  EXPECT_EQ(figures[0], 0.0F);
  EXPECT_FLOAT_EQ(figures[1], std::sqrt(10.0F));
  EXPECT_EQ(figures[electrodes], 0.0F);
  EXPECT_FLOAT_EQ(figures[electrodes + 1], 2.0F);
  touch.counts[2 * electrodes + 4] += 1.0F;  // 17 in the middle: mean 16.2, squares sum to 40 + .8^2 + 4 x .2^2 = 40.8
  window.figures = Window::Figures::sorted;
  const std::vector<float> sorted = windows_of(touch, window).at(0).frames.features;
  ASSERT_EQ(sorted.size(), electrodes);
  EXPECT_EQ(sorted.front(), 0.0F);
  EXPECT_FLOAT_EQ(sorted.back(), std::sqrt(10.2F));
}

TEST(Folds, KeepAnObjectTogether) {
  const std::vector<std::string> objects{"a", "b", "a", "c", "b"};
  const std::vector<std::size_t> folds = folds_by_object(objects, 3, 1);
  EXPECT_EQ(folds[0], folds[2]);
  EXPECT_EQ(folds[1], folds[4]);
  EXPECT_EQ(folds[0] + folds[1] + folds[3], 0U + 1U + 2U);  // one each
  EXPECT_THAT(refusal_of([&] { folds_by_object(objects, 4, 1); }), mentions({"3 objects", "4 folds"}));
}

class ImportedTouches : public slipbench::testing::ImportTest {};

// Two files of three rows: what they are is their set's word, and they are never what was simulated.
TEST_F(ImportedTouches, AreByTheirOwnLabelsAndNoSyntheticOnes) {
  for (const char* name : {"set/n/case1.csv", "set/t/pen2.csv"})
    source(name, slide_header() + slide_row(0) + slide_row(1) + slide_row(2));
  run({path("set")}, "biotacsp-dos");
  const std::vector<Touch> touches = read_touches(path("out.h5"), {});
  ASSERT_EQ(touches.size(), 2U);
  EXPECT_THAT(touches[0].label, ElementsAre(1, 1, 1));
  EXPECT_THAT(touches[1].label, ElementsAre(0, 0, 0));
  EXPECT_THAT(refusal_of([&] { check_simulated(path("out.h5")); }), mentions({"out.h5", "--data", "biotacsp-dos", "--real"}));
}

}  // namespace
}  // namespace slipbench::reproduce::biotac_learning_test
