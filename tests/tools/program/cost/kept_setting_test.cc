#include "tools/program/cost/kept_setting.h"

#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench::testing {
namespace {

const std::string dragged =
    "slipbench: 1\nduration: 1.2 s\nmotion: {kind: stage, start: 0.7 s, speed: 8 mm/s}\n"
    "sensors: {pad: {type: papillarray, rate: 100 Hz}}\n";

struct KeptSettingTest : FolderTest {
  KeptSettingTest() { write("s.yaml", dragged + "accuracy: {onset: 1 %}\n"); }

  void write(const std::string& name, const std::string& bytes) const { std::ofstream(path(name), std::ios::binary) << bytes; }
  [[nodiscard]] std::string read(const std::string& name) const { return bytes_of(path(name)); }
  // Counts in `searches_` whether it was looked for.
  std::optional<KeptSetting> settle_for(SweepOptions sweep) {
    if (sweep.scene_path.empty()) sweep.scene_path = path("s.yaml");
    return setting_for(sweep, program_catalogues(), [this] { ++searches_; });
  }
  std::optional<KeptSetting> settle(const std::vector<Override>& overrides = {}, std::optional<std::uint64_t> seed = {}) {
    SweepOptions sweep;
    sweep.overrides = overrides;
    sweep.seed = seed;
    return settle_for(sweep);
  }
  std::string refusal(const std::string& name = "s.yaml") {
    SweepOptions sweep;
    sweep.scene_path = path(name);
    return refusal_of([&] { settle_for(sweep); });
  }

  int searches_ = 0;
};

TEST_F(KeptSettingTest, IsLookedForOnce) {
  const KeptSetting first = settle().value();
  EXPECT_EQ(first.file, path("s.yaml.accuracy.json"));
  EXPECT_EQ(first.overrides.front().path, "accuracy");
  EXPECT_EQ(first.overrides.front().value, "none");
  EXPECT_EQ(first.overrides.back().path, "time_step");
  EXPECT_THAT(first.text, HasSubstr("slip onset off by "));
  const std::string bytes = read("s.yaml.accuracy.json");
  const KeptSetting again = settle().value();
  EXPECT_EQ(searches_, 1);
  EXPECT_EQ(again.overrides.back().value, first.overrides.back().value);
  EXPECT_EQ(again.text, first.text);
  EXPECT_EQ(read("s.yaml.accuracy.json"), bytes);
  EXPECT_THAT(names(), ElementsAre("s.yaml", "s.yaml.accuracy.json"));
}

TEST_F(KeptSettingTest, HoldsItsEvidence) {
  settle();
  const auto json = nlohmann::json::parse(read("s.yaml.accuracy.json"));
  const auto& entry = json.at("settings").at(0);
  EXPECT_EQ(entry.at("subject").at("scene_sha256").get<std::string>().size(), 64U);
  EXPECT_EQ(entry.at("wish").at("onset"), 0.01);
  EXPECT_EQ(entry.at("reference").at("is"), "closed form");
  EXPECT_EQ(entry.at("trials"), nlohmann::json::array({0}));
  EXPECT_LE(entry.at("looks").back().at("errors").at("onset").at("worst").get<double>(), 0.005);
  EXPECT_EQ(entry.at("looks").back().at("met"), true);
}

TEST_F(KeptSettingTest, IsOfThisSceneAlone) {
  settle();
  settle({{"motion.speed", "4 mm/s"}});
  settle({}, 3);
  EXPECT_EQ(searches_, 3);
  settle({{"motion.speed", "4 mm/s"}});
  settle({}, 3);
  settle();
  EXPECT_EQ(searches_, 3);
  write("s.yaml", dragged + "accuracy: {onset: 2 %}\n");
  settle();
  EXPECT_EQ(searches_, 4);
  // What was for the old text is gone.
  EXPECT_EQ(nlohmann::json::parse(read("s.yaml.accuracy.json")).at("settings").size(), 1U);
}

TEST_F(KeptSettingTest, IsOfTheseTrialsAlone) {
  write("s.yaml", dragged + "accuracy: {onset: 1 %}\nsweep: {motion.direction: {draw: uniform, min: 0 deg, max: 90 deg}}\n");
  SweepOptions run;
  run.limit = 1;
  SweepOptions sweep;
  sweep.trials = 6;
  settle_for(run);
  settle_for(sweep);
  EXPECT_EQ(searches_, 2);
  settle_for(run);
  settle_for(sweep);
  SweepOptions first;  // the sweep as the scene has it: its one trial
  settle_for(first);
  SweepOptions one = sweep;  // has the bytes that it has among them
  one.only = 4;
  settle_for(one);
  EXPECT_EQ(searches_, 2);
  one.only = 6;
  EXPECT_THAT(refusal_of([&] { settle_for(one); }), HasSubstr("there is no trial 6; allowed: 0 to 5"));
  EXPECT_EQ(searches_, 2);
  const auto entries = nlohmann::json::parse(read("s.yaml.accuracy.json")).at("settings");
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries.at(0).at("trials"), nlohmann::json::array({0}));
  EXPECT_EQ(entries.at(1).at("trials"), nlohmann::json::array({0, 1, 2, 3, 5}));
  EXPECT_EQ(entries.at(1).at("subject").at("trials").at("asked"), 6);
}

// What is wrong with a scene that wishes for nothing is found once, where it runs.
TEST_F(KeptSettingTest, ReadsNoMoreThanTheKeyOfASceneWithoutAWish) {
  write("s.yaml", dragged + "surface: {material: no such material}\n");
  EXPECT_FALSE(settle().has_value());
  write("s.yaml", dragged + "surface: {material: no such material}\naccuracy: {onset: 1 %}\n");
  EXPECT_THAT(refusal(), HasSubstr("no such material"));
}

TEST_F(KeptSettingTest, IsNoneWithoutAWish) {
  EXPECT_FALSE(settle({{"accuracy", "none"}}).has_value());
  EXPECT_TRUE(settle({{"accuracy", "none"}, {"accuracy", "{micro_onset: 1 %}"}}).has_value());
}

TEST_F(KeptSettingTest, RefusesADamagedFile) {
  write("s.yaml.accuracy.json", "{");
  EXPECT_THAT(refusal(), HasSubstr(path("s.yaml.accuracy.json") + ": is no record of settings for a scene's accuracy: "));
  EXPECT_THAT(refusal(), HasSubstr("; allowed: to remove it, and the setting is looked for anew"));
  std::filesystem::remove(path("s.yaml.accuracy.json"));
  settle();
  // A setting that someone has touched no longer goes with its evidence.
  std::string bytes = read("s.yaml.accuracy.json");
  bytes.replace(bytes.find("10 ms"), 5, "20 ms");
  write("s.yaml.accuracy.json", bytes);
  EXPECT_THAT(refusal(), HasSubstr("an entry is not as it was written"));
}

TEST_F(KeptSettingTest, NamesTheFileThatCannotBeWrittenBeforeItLooks) {
  const std::string how =
      "; the setting that meets the scene's wish for accuracy is kept there; allowed: a file that can be written, or no wish: --set accuracy=none runs without";
  std::filesystem::create_directory(path("s.yaml.accuracy.json"));
  EXPECT_EQ(refusal(), path("s.yaml.accuracy.json") + ": is no file" + how);
  std::filesystem::remove(path("s.yaml.accuracy.json"));
  std::filesystem::create_directory(path("s.yaml.accuracy.json.partial"));
  EXPECT_THAT(refusal(), AllOf(HasSubstr(path("s.yaml.accuracy.json.partial") + ": it is a folder"), HasSubstr(how)));
  // A folder that takes no file of this name, whoever asks: with .accuracy.json it is longer than the 255 bytes of a name.
  const std::string name = std::string(245, 's') + ".yaml";
  std::filesystem::rename(path("s.yaml"), path(name));
  EXPECT_EQ(refusal(name), "cannot write " + path(name) + ".accuracy.json: File name too long" + how);
  EXPECT_EQ(searches_, 0);
  EXPECT_THAT(names(), ElementsAre("s.yaml.accuracy.json.partial", name));
  SweepOptions without;
  without.scene_path = path(name);
  without.overrides = {{"accuracy", "none"}};
  EXPECT_FALSE(settle_for(without).has_value());
}

TEST_F(KeptSettingTest, MakesTheSceneOneThatItsCommandRepeats) {
  const auto options = [&](const std::vector<Override>& overrides, const std::string& output) {
    SweepOptions sweep;
    sweep.scene_path = path("s.yaml");
    sweep.overrides = overrides;
    sweep.output = path(output);
    return sweep;
  };
  EXPECT_THROW(run_sweep(options({}, "wish.h5"), program_catalogues()), std::logic_error);
  const KeptSetting setting = settle().value();
  const std::string command = run_sweep(options(setting.overrides, "first.h5"), program_catalogues()).command;
  EXPECT_THAT(command, HasSubstr("s.yaml --set accuracy=none --set 'time_step="));
  std::filesystem::remove(path("s.yaml.accuracy.json"));
  run_sweep(options(settle()->overrides, "second.h5"), program_catalogues());
  EXPECT_EQ(read("first.h5"), read("second.h5"));
}

}  // namespace
}  // namespace slipbench::testing
