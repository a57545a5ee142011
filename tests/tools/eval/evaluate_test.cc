#include "tools/eval/evaluate.h"

#include <filesystem>
#include <fstream>
#include <ranges>

#include "detectors/hd/memory_files.h"
#include "tests/expect.h"
#include "tests/tools/train/small_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/eval/detect.h"
#include "tools/eval/eval_page.h"
#include "tools/eval/replay.h"
#include "tools/eval/yardsticks.h"

namespace slipbench::eval::evaluate_test {
namespace {

using ::slipbench::testing::SmallDatasetTest;
using ::slipbench::testing::write_dataset;

TEST(ChosenDetector, IsANameAFileOrAFolder) {
  EXPECT_EQ(chosen_detector("force_ratio", {{"ratio", "0.3"}}).parameters.number("ratio"), 0.3);
  for (const char* shipped : {"cl_gst_hd", "learn_gst_hd"}) {
    EXPECT_EQ(chosen_detector(shipped, {}).type, "gst_hd");
    EXPECT_EQ(chosen_detector(shipped, {}).parameters.path("memories"), shipped);
  }
  const DetectorScene folder = chosen_detector(SLIPBENCH_SOURCE_DIR "/tests", {{"rate", "50 Hz"}});
  EXPECT_EQ(folder.type, "gst_hd");
  EXPECT_EQ(folder.parameters.path("memories"), SLIPBENCH_SOURCE_DIR "/tests");
  EXPECT_EQ(folder.parameters.number("rate"), 50.0);
}

TEST(LearntLabels, AreThoseOfTheTraining) {
  EXPECT_EQ(learnt_labels("{}"), LabelRule::strict);
  EXPECT_EQ(learnt_labels("not valid JSON"), LabelRule::strict);
  EXPECT_EQ(learnt_labels(R"({"labels": "masked"})"), LabelRule::masked);
  EXPECT_EQ(learnt_labels(R"({"labels": "tightened"})"), LabelRule::masked);
  EXPECT_EQ(learnt_labels(R"({"labels": "moved"})"), LabelRule::masked);
  EXPECT_THAT(refusal_of([] { learnt_labels(R"({"labels": "micra"})"); }), mentions({"trained.labels", "micra", "micro"}));
  EXPECT_THAT(refusal_of([] { learnt_labels(R"({"labels": 1})"); }), mentions({"--labels"}));
}

TEST(ChosenDetector, RefusesAsAScene) {
  const auto refusal = [](const std::string& text, const std::vector<Override>& parameters) {
    return refusal_of([&] { chosen_detector(text, parameters); });
  };
  EXPECT_THAT(refusal("gst_hdd", {}), mentions({"gst_hdd", "gst_hd"}));
  EXPECT_THAT(refusal("force_ratio", {{"ratio", "-1"}}), mentions({"detector.ratio", "-1", "0"}));
  EXPECT_THAT(refusal("force_ratio", {{"rotia", "1"}}), mentions({"rotia", "detector", "ratio"}));
}

struct Evaluated : SmallDatasetTest {
  static Options options(const std::string& dataset) {
    Options result;
    result.detector = chosen_detector("force_ratio", {{"ratio", "0.45"}});
    result.dataset = dataset;
    return result;
  }
  // Returns the page of a result with options().
  [[nodiscard]] std::string page_of(const Json& result) const {
    return eval_page(result, result.at("dataset").get<std::string>(), path("page.html"), options("").detector);
  }
  // Returns the description of a detector trained on these trials.
  static std::string seen(const std::string& dataset, const std::vector<std::size_t>& trials) {
    const DatasetReader reader(dataset);
    Json digests = Json::array();
    for (const std::size_t trial : trials) digests.push_back(reader.trial_sha256(trial));
    return Json{{"sha256_seen", digests}}.dump();
  }
};

// 24 trials, half at 4 mm/s, half at 16; masks of 70, 15 and 15 %.
TEST_F(Evaluated, EveryTrialAndItsGroups) {
  const std::string file = dataset();
  const Json result = evaluate(options(file));
  EXPECT_EQ(result.begin().key(), result_key);
  const Json& all = result.at("all");
  EXPECT_EQ(all.at("trials"), 24);
  EXPECT_EQ(all.at("frames"), 24 * 400);
  EXPECT_EQ(all.at("slipping"), all.at("seen").get<int>() + all.at("early").get<int>() + all.at("missed").get<int>());
  ASSERT_EQ(result.at("by").size(), 2U) << "one material";
  const Json& speed = result.at("by")[0];
  EXPECT_EQ(speed.at("by"), "speed");
  ASSERT_EQ(speed.at("groups").size(), 2U);
  EXPECT_EQ(speed.at("groups")[0].at("name"), "4 to 8 mm/s");
  EXPECT_EQ(speed.at("groups")[0].at("trials"), 12);
  EXPECT_EQ(speed.at("groups")[1].at("name"), "16 to 32 mm/s");
  EXPECT_EQ(result.at("by")[1].at("groups")[2].at("name"), "test");
  EXPECT_FALSE(result.contains("loop")) << "the dataset has no detector";
  EXPECT_FALSE(result.contains("roc")) << "it has no probability";
  // A trial's true first slip comes from its labels.
  const SensorRecord pad = DatasetReader(file).read_sensor(5, "pad");
  EXPECT_EQ(result.at("trials")[5].at("slip_time_s"), std::ranges::min(pad.labels.onset_time));
}

// Imported samples at 10 Hz of one unit under 1 N, with this shear [N].
TrialRecord imported(std::size_t trial, const std::vector<float>& shear) {
  TrialRecord record;
  record.trial = trial;
  record.params = "{}";
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "skin";
  sensor.rate = 10.0;
  sensor.channel_names = {"FX", "FY", "FZ"};
  sensor.labels.truth = false;
  SensorColumn force{"force", "N", {1, 3}, {}};
  for (const float each : shear) {
    sensor.time.push_back(0.1 * static_cast<double>(sensor.time.size()));
    force.values.insert(force.values.end(), {each, 0.0F, 1.0F});
  }
  sensor.channels.push_back(force);
  record.body_time = sensor.time;
  record.sensors.push_back(sensor);
  return record;
}

// Trials without labels, by their alarms per minute: one alarm in 0.3 s, no alarm, and last a single
// sample, which has no such rate.
TEST_F(Evaluated, DetectNamesTheWorstTrials) {
  const DatasetHeader header{.version = "1.2.3", .scene = "", .command = "slipbench import", .truth = "none: imported from csv"};
  write_dataset(path("a.h5"), header,
                {imported(0, {0.9F}), imported(1, {0.1F, 0.1F, 0.1F, 0.1F}), imported(2, {0.1F, 0.9F, 0.9F, 0.1F})});
  DetectOptions chosen;
  chosen.detector = chosen_detector("force_ratio", {{"ratio", "0.5"}});
  chosen.recordings = {path("a.h5")};
  const Json result = detect(chosen);
  EXPECT_TRUE(result.at("trials")[0].at("alarms_per_minute").is_null());
  EXPECT_EQ(result.at("trials")[1].at("alarms_per_minute"), 0.0);
  EXPECT_NEAR(result.at("trials")[2].at("alarms_per_minute").get<double>(), 60.0 / 0.3, 1e-9);
  EXPECT_EQ(result.at("worst"), Json({2, 1, 0}));
}

// The best yardstick stands beside the detector, with the area that it has as a detector of its own,
// in the result and on the page.
TEST_F(Evaluated, TheBestYardstickIsBesideTheDetector) {
  // It slips from about 0.8 s on; yardsticks answer from 0.5 s on.
  const std::string file = dataset({{"duration", "1 s"}, {"motion.start", "0.75 s"}});
  Json result = evaluate(options(file));
  result["command"] = "slipbench eval";
  const Json& yardstick = result.at("yardstick");
  const std::string type = yardstick.at("type");
  EXPECT_EQ(yardstick.at("areas").size(), yardsticks().size());
  EXPECT_EQ(yardstick.at("thresholds").size(), 2U);
  EXPECT_EQ(yardstick.at("by_halves"), true);
  EXPECT_EQ(yardstick.at("all").at("trials"), 24);
  EXPECT_EQ(yardstick.at("all").at("frames"), result.at("all").at("frames"));
  for (const auto& [name, area] : yardstick.at("areas").items()) {
    Options own = options(file);
    own.detector = chosen_detector(name, {});
    EXPECT_EQ(evaluate(own).at("all").at("figures").at("auc").at("value"), area.at("value")) << name;
    EXPECT_LE(area.at("value"), yardstick.at("areas").at(type).at("value"));
  }
  EXPECT_THAT(yardstick_note(result), mentions({"Best yardstick: " + type, "the other half of the trials"}));
  EXPECT_THAT(page_of(result), mentions({"best yardstick, " + type, "Best yardstick: " + type}));
}

// The higher the threshold of the probability, the fewer samples are called slip: all thresholds are
// applied, and the recall falls from one to the next.
TEST_F(Evaluated, RecallFallsWithTheThreshold) {
  Options scored = options(dataset({{"duration", "1 s"}, {"motion.start", "0.75 s"}}));
  scored.detector = chosen_detector("deviation", {{"threshold", "0.05"}});
  const Json alarms = evaluate(scored).at("alarms");
  const auto recall = [&](std::size_t k) { return alarms.at(k).at("recall_of_slip").get<double>(); };
  for (std::size_t k = 1; k < alarms.size(); ++k) EXPECT_LE(recall(k), recall(k - 1)) << k;
  EXPECT_LT(recall(alarms.size() - 1), recall(0));
}

// An octave holds the speeds in its name: 15.9 and 31.99 mm/s are below 16 and 32.
TEST_F(Evaluated, SpeedsAreInTheOctaveOfTheirName) {
  const Json result = evaluate(options(dataset({{"sweep.motion.speed", "[15.9 mm/s, 16 mm/s, 31.99 mm/s]"}})));
  const Json& groups = result.at("by")[0].at("groups");
  ASSERT_EQ(groups.size(), 2U);
  EXPECT_EQ(groups[0].at("name"), "8 to 16 mm/s");
  EXPECT_EQ(groups[0].at("trials"), 12);
  EXPECT_EQ(groups[1].at("name"), "16 to 32 mm/s");
  EXPECT_EQ(groups[1].at("trials"), 24);
}

TEST_F(Evaluated, OnePartOfTheDataset) {
  Options test = options(dataset());
  test.split = "test";
  const Json result = evaluate(test);
  const std::vector<std::size_t> members = DatasetReader(test.dataset).mask("test");
  EXPECT_EQ(result.at("all").at("trials"), members.size());
  EXPECT_EQ(result.at("trials")[0].at("trial"), members[0]);
}

TEST_F(Evaluated, LeavesOutWhatADetectorWasTrainedOn) {
  Options trained = options(dataset());
  trained.trained = seen(trained.dataset, {0, 1, 2, 7});
  const Json result = evaluate(trained);
  EXPECT_EQ(result.at("left_out"), (Json{0, 1, 2, 7}));
  EXPECT_EQ(result.at("all").at("trials"), 20);
  for (const Json& by : result.at("by"))
    EXPECT_NE(by.at("by"), "mask") << "a part of the masks that it has learnt from is not new to it";
  // The same trials in another file have another content digest.
  Options copy = trained;
  copy.dataset = dataset({{"description", "another one"}}, "other.h5");
  EXPECT_NE(DatasetReader(copy.dataset).content_sha256(), DatasetReader(trained.dataset).content_sha256());
  EXPECT_EQ(evaluate(copy).at("left_out"), (Json{0, 1, 2, 7}));
  EXPECT_EQ(result.at("warnings"), Json::array());
  trained.all = true;
  const Json with_all = evaluate(trained);
  EXPECT_EQ(with_all.at("all").at("trials"), 24);
  EXPECT_THAT(with_all.at("warnings")[0].get<std::string>(), HasSubstr("trained on 4 of 24 trials evaluated here"));
  trained.all = false;
  trained.trained = R"({"sha256_seen": ["12"]})";
  EXPECT_THAT(refusal_of([&] { evaluate(trained); }), mentions({"trained.sha256_seen"}));
}

// Memories record their trials in seen.txt. Without it, as for the published ones, training trials
// cannot be identified.
TEST_F(Evaluated, LeavesOutWhatMemoriesWereTrainedOn) {
  const std::string file = dataset();
  const DatasetReader reader(file);
  const hd::SavedModel saved = hd::load(SLIPBENCH_SOURCE_DIR "/detectors/hd/memories/cl_gst_hd");
  hd::save(path("own"), saved, {reader.trial_sha256(3), reader.trial_sha256(9)});
  Options memories = options(file);
  const auto judged_with = [&](const std::string& folder) {
    memories.detector = chosen_detector(folder, {});
    memories.trained = training_of(memories.detector);
    return evaluate(memories);
  };
  const Json result = judged_with(path("own"));
  EXPECT_EQ(result.at("left_out"), (Json{3, 9}));
  EXPECT_EQ(result.at("warnings"), Json::array());
  hd::save(path("old"), saved);
  const Json unknown = judged_with(path("old"));
  EXPECT_EQ(unknown.at("all").at("trials"), 24);
  EXPECT_THAT(unknown.at("warnings")[0].get<std::string>(),
              AllOf(HasSubstr("old does not record the trials of its training"), HasSubstr(saved.trained)));
  std::ofstream(path("own") + "/seen.txt") << "12\n";
  EXPECT_THAT(refusal_of([&] { judged_with(path("own")); }), mentions({"seen.txt:1", "12"}));
}

TEST_F(Evaluated, RefusesWhatItCannotJudge) {
  const std::string file = dataset();
  const auto refusal = [](const Options& options) { return refusal_of([&] { evaluate(options); }); };
  Options wrong = options(file);
  wrong.sensor = "padd";
  EXPECT_THAT(refusal(wrong), mentions({"data.h5", "trial 0", "padd", "pad"}));
  EXPECT_THAT(refusal(options(path("nowhere.h5"))), HasSubstr("nowhere.h5"));
  Options all = options(file);
  all.trained = seen(file, DatasetReader(file).trials());
  EXPECT_THAT(refusal(all), mentions({"no trial", "trained"}));
  // One byte of an array.
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file) / 2));
  bytes.put('\x5a').put('\x5a');
  bytes.close();
  EXPECT_THAT(refusal(options(file)), HasSubstr("data.h5"));
}

// Imported recordings have no truth, whatever the names of the figures suggest.
TEST_F(Evaluated, SaysThatThereIsNoTruth) {
  Json result = evaluate(options(dataset()));
  result["command"] = "slipbench eval";
  EXPECT_EQ(truth_note(result), "");
  EXPECT_THAT(page_of(result), AllOf(Not(HasSubstr("imported")), HasSubstr("slipbench report ")));
  result["truth"] = "none: imported from bts3v2";
  EXPECT_EQ(truth_note(result), "truth none: imported from bts3v2: 'true' below means the recorded label");
  EXPECT_THAT(page_of(result), HasSubstr("<p class=\"note\">truth none: imported from bts3v2"));
}

TEST_F(Evaluated, PageDrawsTheWorstTrialsOverTime) {
  Json result = evaluate(options(dataset()));
  result["command"] = "slipbench eval";
  const std::size_t drawn = std::min(result.at("worst").size(), drawn_trials);
  ASSERT_GT(drawn, 0U);
  const std::string page = page_of(result);
  const auto count = [&page](const std::string& text) {
    std::size_t found = 0;
    for (std::size_t at = page.find(text); at != std::string::npos; at = page.find(text, at + 1)) ++found;
    return found;
  };
  // Each with its states, of the detector and the truth, and the PapillArray's forces in N.
  for (const char* text : {"aria-label=\"States over time [s]\"", ">detector</text>", ">truth</text>",
                           "aria-label=\"force [N], component 3 of 3 over time [s]\""})
    EXPECT_EQ(count(text), drawn) << text;
  for (const Json& worst : result.at("worst") | std::views::take(drawn))
    EXPECT_EQ(count("<h2>Trial " + worst.at("trial").dump() + "</h2>"), 1U);
  // A trial with an alarm is among the worst, unless all are missed.
  const bool alarms =
      std::ranges::any_of(result.at("trials"), [](const Json& trial) { return !trial.at("alarm_time_s").is_null(); });
  EXPECT_EQ(count("class=\"bar alarm\"") > 0, alarms);
  EXPECT_GT(count("class=\"bar gross\""), 0U);
}

TEST_F(Evaluated, TitleNamesTheFileOfANetwork) {
  const Json network = {{"type", "network"}, {"parameters", {{"model", "mine/gru.onnx"}}}};
  EXPECT_EQ(detector_name(network), "network mine/gru.onnx");
  Json result = evaluate(options(dataset()));
  result["command"] = "slipbench eval";
  result["detector"] = network;
  EXPECT_THAT(page_of(result),
              AllOf(HasSubstr("<title>network mine/gru.onnx on data.h5"), HasSubstr("<h1>network mine/gru.onnx on ")));
}

TEST_F(Evaluated, PageShowsTextAsText) {
  Json result = evaluate(options(dataset()));
  result["command"] = "slipbench eval <script>";
  EXPECT_THAT(page_of(result), Not(HasSubstr("ROC")));
  result["roc"] = {{nullptr, 0.0, 0.0}, {0.5, 0.25, 0.75}, {0.0, 1.0, 1.0}};
  result["calibration"] = {{{"low", 0.0}, {"high", 0.5}, {"count", 3}, {"mean", 0.25}, {"share", 0.5}}};
  const std::string page = page_of(result);
  // A quarter of 342 px right of 62, three quarters of 218 px above 248.
  EXPECT_THAT(page, HasSubstr("points=\"62,248 147.5,84.5 404,30\""));
  EXPECT_THAT(page, HasSubstr("cx=\"147.5\" cy=\"139\"")) << "a quarter was said, half is true";
  EXPECT_TRUE(page::begins_as_page(page, page_kind.generator));
  EXPECT_THAT(page, HasSubstr("slipbench eval &lt;script&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  const auto trial = std::to_string(result.at("worst")[0].at("trial").get<std::size_t>());
  EXPECT_THAT(page, HasSubstr("href=\"data.html#trial-" + trial + "\"")) << "the report is in the folder of the page";
  const auto write = [&] { return page::write_page_files(path("page.html"), page_kind, page, result); };
  const std::vector<std::string> files = write();
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(Json::parse(std::ifstream(files[1])), result);
  EXPECT_EQ(write(), files) << "its own kind is replaced";
  std::ofstream(path("other.html")) << "years of work";
  EXPECT_THROW(page::check_page_files(path("other.html"), page_kind), InputError);
}

// The result has the path as UTF-8 text, with a replacement character, but the page reads the file.
TEST_F(Evaluated, PageOfADatasetWhoseNameIsNotUtf8) {
  const std::string file = path("b\xe9.h5");
  std::filesystem::rename(dataset(), file);
  Json result = evaluate(options(file));
  result["command"] = "slipbench eval";
  ASSERT_FALSE(result.at("worst").empty());
  EXPECT_THAT(eval_page(result, file, path("page.html"), options("").detector), HasSubstr("href=\"b%E9.html#trial-"));
}

}  // namespace
}  // namespace slipbench::eval::evaluate_test
