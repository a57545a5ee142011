// Runs `slipbench view` with browsers of the test.
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string stage_scene = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";

struct View : ::testing::Test {
  View() {
    std::filesystem::create_directory(folder_ / "bin");
    std::filesystem::copy(stage_scene, folder_ / "stage.yaml");
  }

  // A program that records what it is asked to open, and ends with `status`.
  void add_opener(const std::string& name, int status) const {
    const std::string path = folder_ / ("bin/" + name);
    std::ofstream(path) << "#!/bin/sh\nprintf '%s' \"$1\" > " << (folder_ / (name + ".opened")) << "\nexit " << status << "\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
  [[nodiscard]] std::string opened_by(const std::string& name) const { return bytes_of(folder_ / (name + ".opened")); }

  // Runs `slipbench view words` with only the screen and the browsers of `environment`.
  [[nodiscard]] ChildResult view(const std::string& words, const std::string& environment = "") const {
    return run_shell("unset DISPLAY WAYLAND_DISPLAY BROWSER; export PATH=$PWD/bin " + environment + "; slipbench view " + words,
                     folder_ / "");
  }
  [[nodiscard]] ChildResult record(const std::string& words = "") const {
    return run_shell("slipbench run stage.yaml --set duration=2.1 " + words + " --quiet", folder_ / "");
  }

  TemporaryFolder folder_;
};

TEST_F(View, OpensTheReportOfADataset) {
  ASSERT_EQ(record("-o a.h5").status, 0);
  add_opener("xdg-open", 0);
  const ChildResult seen = view("a.h5", "DISPLAY=:0");
  EXPECT_EQ(seen.status, 0) << seen.err;
  EXPECT_EQ(opened_by("xdg-open"), std::filesystem::canonical(folder_ / "a.html").string());
  EXPECT_THAT(bytes_of(folder_ / "a.html"), StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(seen.out, HasSubstr("opened by xdg-open"));
}

TEST_F(View, AsksTheBrowsersOfTheUserFirstAndPassesOverThoseThatFail) {
  ASSERT_EQ(record("-o a.h5").status, 0);
  for (const char* name : {"xdg-open", "mine"}) add_opener(name, 0);
  add_opener("broken", 3);
  EXPECT_THAT(view("a.h5", "WAYLAND_DISPLAY=wayland-0 BROWSER=absent:broken:mine").out, HasSubstr("opened by mine"));
  EXPECT_EQ(opened_by("broken"), opened_by("mine"));
  EXPECT_EQ(opened_by("xdg-open"), "");
}

TEST_F(View, SaysWhereThePageLiesWithoutAScreenOrAnOpener) {
  ASSERT_EQ(record("-o a.h5").status, 0);
  const std::string page = std::filesystem::canonical(folder_ / "").string() + "/a.html";
  for (const char* environment : {"BROWSER=xdg-open", "DISPLAY=:0"}) {
    if (std::string(environment) == "BROWSER=xdg-open") {
      add_opener("xdg-open", 0);
    } else {
      std::filesystem::remove(folder_ / "bin/xdg-open");
    }
    const ChildResult seen = view("a.h5", environment);
    EXPECT_EQ(seen.status, 0) << seen.err;
    EXPECT_THAT(seen.out, HasSubstr("open it in a browser: " + page)) << environment;
    EXPECT_EQ(opened_by("xdg-open"), "") << environment;
  }
}

TEST_F(View, RunsASceneFirst) {
  const ChildResult seen = view("stage.yaml --set duration=2.1 --json");
  ASSERT_EQ(seen.status, 0) << seen.err;
  EXPECT_EQ(nlohmann::json::parse(seen.out),
            nlohmann::json::parse(R"({"dataset": "stage.h5", "report": "stage.html", "opened_by": null})"));
  // The recording equals that of `run` with the same words.
  ASSERT_EQ(record("-o b.h5").status, 0);
  EXPECT_EQ(bytes_of(folder_ / "stage.h5"), bytes_of(folder_ / "b.h5"));
  // A second call replaces the files of the first.
  EXPECT_EQ(view("stage.yaml --set duration=2.2").status, 0);
  EXPECT_NE(bytes_of(folder_ / "stage.h5"), bytes_of(folder_ / "b.h5"));
}

TEST_F(View, KeepsWhatItHasNotMade) {
  ASSERT_EQ(run_shell("slipbench sweep stage.yaml --set duration=2.1 -o stage.h5 --quiet", folder_ / "").status, 0);
  const std::string before = bytes_of(folder_ / "stage.h5");
  const ChildResult seen = view("stage.yaml");
  EXPECT_EQ(seen.status, 2);
  EXPECT_THAT(seen.err, HasSubstr("stage.h5 exists, but contains slipbench sweep stage.yaml"));
  EXPECT_THAT(seen.err, mentions({"-o", "slipbench view stage.h5"}));
  EXPECT_EQ(bytes_of(folder_ / "stage.h5"), before);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "stage.html"));
  // Several trials of a run are not replaced either.
  ASSERT_EQ(
      run_shell("rm stage.h5; slipbench run stage.yaml --trials 2 --set duration=2.1 -o stage.h5 --quiet", folder_ / "").status,
      0);
  const std::string two = bytes_of(folder_ / "stage.h5");
  EXPECT_EQ(view("stage.yaml").status, 2);
  EXPECT_EQ(bytes_of(folder_ / "stage.h5"), two);

  // A page that `view` has not written is not replaced, and nothing is simulated.
  std::ofstream(folder_ / "mine.html") << "mine";
  EXPECT_EQ(view("stage.yaml -o mine.html").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "mine.h5"));
  EXPECT_EQ(bytes_of(folder_ / "mine.html"), "mine");
}

}  // namespace
}  // namespace slipbench
