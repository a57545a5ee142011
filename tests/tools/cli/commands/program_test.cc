// Runs the built program as scripts do: exit status, output by stream, and the words of messages.
#include <sys/stat.h>

#include <csignal>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"

namespace slipbench {
namespace {

const std::string stage = SLIPBENCH_SOURCE_DIR "/scenes/papillarray/stage.yaml";
const std::string three_speeds = "sweep={motion.speed: [1 mm/s, 4 mm/s, 16 mm/s]}";

// A refusal has status 2, one line on stderr, and no output on stdout.
void expect_refusal(const std::vector<std::string>& arguments, const MessageMatcher& message) {
  for (const bool json : {false, true}) {
    std::vector<std::string> words = arguments;
    if (json) words.emplace_back("--json");
    const ChildResult result = run_program_file(words);
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, AllOf(StartsWith("slipbench: "), message, EndsWith("\n")));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
}

nlohmann::json json_of(const ChildResult& result) {
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return nlohmann::json::parse(result.out);  // throws if there is anything else
}

TEST(Program, HelpAndVersion) {
  const ChildResult help = run_program_file({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, AllOf(HasSubstr("Usage: slipbench"), HasSubstr("sweep"), HasSubstr("Exit status")));
  EXPECT_EQ(run_program_file({}).out, help.out);
  EXPECT_EQ(run_program_file({"help"}).out, help.out);
  EXPECT_EQ(run_program_file({"help", "run"}).out, run_program_file({"run", "--help"}).out);
  const ChildResult version = run_program_file({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, StartsWith("slipbench "));
  EXPECT_THAT(version.out, HasSubstr(json_of(run_program_file({"--version", "--json"}))["version"].get<std::string>()));
}

TEST(Program, WhatIsWrongIsRefused) {
  expect_refusal({"swep"}, mentions({"swep", "sweep"}));
  expect_refusal({"help", "swep"}, mentions({"swep", "sweep"}));
  expect_refusal({"run", stage, "--sead", "1"}, mentions({"--sead", "--seed"}));
  expect_refusal({"run", "nowhere.yaml"}, HasSubstr("nowhere.yaml"));
  expect_refusal({"run", stage, "--set", "motion.sped=1"}, mentions({"--set motion.sped=1", "speed"}));
  expect_refusal({"run", stage, "--set", "motion.speed=4 kg"}, mentions({"--set motion.speed=4 kg", "mm/s"}));
  expect_refusal({"run", stage, "--set", "duration.length=4"}, HasSubstr("duration"));
  expect_refusal({"describe", "papilarray"}, mentions({"papilarray", "papillarray"}));
  expect_refusal({"list", "effect"}, mentions({"effect", "effects"}));
  expect_refusal({"export", "a.h5", "--format", "vendor-cvs", "-o", "dir"}, HasSubstr("vendor-csv"));
  expect_refusal({"train-hd", "nowhere.h5", "-o", "memories"}, HasSubstr("nowhere.h5"));
  expect_refusal({"eval", "force_ratio", "nowhere.h5"}, HasSubstr("nowhere.h5"));
  expect_refusal({"report", "nowhere.h5"}, HasSubstr("nowhere.h5"));
  expect_refusal({"export", "nowhere.h5", "--format", "vendor-csv", "-o", "dir"}, HasSubstr("nowhere.h5"));
  expect_refusal({"report", stage}, HasSubstr("stage.yaml"));
  const TemporaryFolder folder;
  expect_refusal({"run", stage, "-o", folder / "none/out.h5"}, HasSubstr("none"));
}

TEST(Program, NumbersAtTheEndOfTheRange) {
  for (const char* speed : {"motion.speed=1e308", "motion.speed=5e-324"}) {
    const ChildResult result = run_program_file({"run", stage, "--set", speed, "motion.acceleration=inf"});
    EXPECT_THAT(result.status, AnyOf(0, 2)) << speed;
    EXPECT_THAT(result.err, Not(HasSubstr("internal error"))) << speed;
  }
}

TEST(Program, WhatIsNotFiniteIsRefused) {
  const TemporaryFolder folder;
  // 1e50 times an offset of some millinewton is beyond a float.
  const std::string offset = "sensors.pad.electronics=[{offset: {scale: 1e50}}]";
  const std::string where = "trial 0: .*stage.yaml:[0-9]+: sensors.pad: force is not finite at ";
  expect_refusal({"run", stage, "--set", offset}, testing::ContainsRegex(where + "3.999 s"));
  expect_refusal({"run", stage, "--set", offset, "-o", folder / "out.h5"}, testing::ContainsRegex(where + "0 s"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
}

TEST(Program, CallsItselfAsItWasCalled) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink(SLIPBENCH_PROGRAM, folder / "slip bench");
  const auto next = [&](const std::string& name) {
    return run_shell(name + " run " + stage + " --set duration='2.5 s'", folder / "").out;
  };
  EXPECT_THAT(next("'./slip bench'"), HasSubstr("next: './slip bench' run "));
  EXPECT_THAT(next("PATH=\"$PWD:$PATH\" 'slip bench'"), HasSubstr("next: 'slip bench' run "));
  EXPECT_THAT(next("SLIPBENCH_CALLED_AS=./slipbench './slip bench'"), HasSubstr("next: ./slipbench run "));
}

TEST(Program, DescribesAKeyOfAScene) {
  EXPECT_THAT(run_program_file({"describe", "split"}).out, StartsWith("split  key of a scene\n"));
  EXPECT_EQ(json_of(run_program_file({"describe", "split", "--json"}))["entries"].at(0)["kind"], "key of a scene");
  expect_refusal({"describe", "splt"}, mentions({"splt", "split"}));
}

TEST(Program, ExportIsQuietOrNamesEveryFile) {
  const TemporaryFolder folder;
  const std::string file = folder / "out.h5";
  ASSERT_EQ(run_program_file({"run", stage, "--set", "duration=2.5 s", "--trials", "2", "-o", file, "-q"}).out, "");
  const auto exported = [&](const char* option) {
    return run_program_file({"export", file, "--format", "csv", "-o", folder / "tables", option});
  };
  const ChildResult quiet = exported("-q");
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out, "");
  const std::string named = exported("-v").out;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "tables")) {
    if (entry.path().extension() == ".csv") {
      EXPECT_THAT(named, HasSubstr(entry.path().string()));
    }
  }
}

TEST(Program, RemovesAKeyByNull) {
  EXPECT_EQ(run_program_file({"run", stage, "--set", "duration=null", "-q"}).status, 0);
  expect_refusal({"run", stage, "--set", "motion.sped=null"}, mentions({"--set motion.sped=null", "sped", "speed"}));
}

TEST(Program, FindsShippedScenesByName) {
  const TemporaryFolder folder;
  for (const std::string command : {"run papillarray/stage.yaml", "sweep scenes/papillarray/stage.yaml",
                                    "check grasp/check_ptfe.yaml --trials 1 --junit j.xml"})
    EXPECT_EQ(run_shell("slipbench " + command + " -q", folder / "").status, 0) << command;
  const std::string other = "papillarray/stage.yaml";  // a file of the user takes precedence
  EXPECT_EQ(run_shell("mkdir papillarray; echo x > " + other + "; slipbench run " + other, folder / "").status, 2);
}

// Scenes from a pipe, and results to a pipe.
class Pipes : public testing::Test {
 protected:
  // Runs a shell script in a folder with s.yaml, a copy of the stage, and named.h5, its trial.
  ChildResult shell(const std::string& script) { return run_shell(script, folder_ / ""); }
  std::string bytes(const std::string& name) { return bytes_of(folder_ / name); }

  void SetUp() override {
    std::filesystem::copy_file(stage, folder_ / "s.yaml");
    ASSERT_EQ(shell("slipbench run s.yaml --set duration='2.5 s' -q -o named.h5").status, 0);
  }

  const std::string short_run_ = " --set duration='2.5 s'";
  TemporaryFolder folder_;
};

TEST_F(Pipes, GiveAScene) {
  const ChildResult piped = shell("cat s.yaml | slipbench run -" + short_run_ + " -o piped.h5");
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_THAT(piped.out, HasSubstr("slipbench report piped.h5\n"));
  EXPECT_THAT(shell("slipbench run - < s.yaml" + short_run_).out, HasSubstr("run - -o FILE.h5 < SCENE.yaml stores"));
  EXPECT_EQ(shell("slipbench sweep - -q < s.yaml" + short_run_).status, 0);
  const ChildResult wrong = shell("printf 'slipbench: 1\\nmotion: {sped: 1}\\n' | slipbench run -");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, StartsWith("slipbench: <stdin>:2: unknown key 'sped'"));
  EXPECT_THAT(shell(": | slipbench run -").err, StartsWith("slipbench: <stdin>:1: "));
}

// The bytes equal those of a named file, and every message goes to stderr.
TEST_F(Pipes, TakeADataset) {
  const ChildResult streamed = shell("slipbench run s.yaml" + short_run_ + " -o -");
  EXPECT_EQ(streamed.status, 0);
  EXPECT_EQ(streamed.out, bytes("named.h5"));
  EXPECT_THAT(streamed.err, AllOf(HasSubstr("times real time"), Not(HasSubstr("written")), Not(HasSubstr("/slipbench-"))));
  EXPECT_EQ(shell("slipbench run s.yaml" + short_run_ + " -o - -q").err, "");
  for (const char* more : {"--json", "--resume"}) {
    const ChildResult refused = shell("slipbench run s.yaml -o - " + std::string(more));
    EXPECT_EQ(refused.status, 2) << more;
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, HasSubstr(more));
  }
  const ChildResult failed = shell("slipbench run s.yaml --set motion.speed=fast -o -");
  EXPECT_EQ(failed.out, "");
  EXPECT_NE(failed.status, 0);
  EXPECT_EQ(shell("slipbench run s.yaml" + short_run_ + " -q -o - | head -c 10 | wc -c").out, "10\n");
  EXPECT_THAT(run_program_terminal({"run", stage, "-o", "-"}).out, HasSubstr("terminal"));
}

TEST_F(Pipes, TakePagesAndTables) {
  const std::string page = shell("slipbench report named.h5 -o -").out;
  EXPECT_EQ(shell("slipbench report named.h5 -o named.html").status, 0);
  EXPECT_EQ(page, bytes("named.html"));
  const ChildResult evaluated = shell("slipbench eval force_ratio named.h5 -o -");
  EXPECT_THAT(evaluated.out, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(evaluated.err, HasSubstr("recall of slip"));
  EXPECT_EQ(shell("slipbench detect force_ratio named.h5 -o alarms.csv").status, 0);
  EXPECT_EQ(shell("slipbench detect force_ratio named.h5 -o -").out, bytes("alarms.csv"));
  for (const char* command :
       {"export named.h5 --format csv -o -", "train-hd named.h5 -o -", "import named.csv --format csv --map m -o -"}) {
    EXPECT_THAT(shell(std::string("slipbench ") + command).err, HasSubstr("standard output")) << command;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "-"));
}

// Opening a pipe would block until another process opens it for writing.
TEST(Program, APipeIsNoScene) {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_refusal({"run", pipe}, mentions({"a pipe"}));
}

#ifdef SLIPBENCH_WITH_PYTHON
TEST(Program, Reproductions) {
  const ChildResult list = run_program_file({"reproduce", "--json"});
  EXPECT_EQ(list.status, 0);
  EXPECT_EQ(nlohmann::json::parse(list.out)["reproductions"][0]["name"], "biotac-stability-slip/table1");
  EXPECT_THAT(run_program_file({"reproduce", "list"}).out, HasSubstr("hd-papillarray/latency"));
  expect_refusal({"reproduce", "hd-papillarray/latence"}, mentions({"hd-papillarray/latence", "hd-papillarray/latency"}));
  expect_refusal({"reproduce", "hd-papillarray/latency", "--data", "a.h5"}, mentions({"hd-papillarray/latency", "--data"}));
  expect_refusal({"reproduce", "hd-papillarray/latency", "-o", "page.txt"}, mentions({".html"}));
}

TEST(Program, DescribesARecipe) {
  const nlohmann::json recipe = json_of(run_program_file({"describe", "piezo_fft_gru", "--json"}))["entries"].at(0);
  EXPECT_EQ(recipe["kind"], "recipe");
  EXPECT_THAT(recipe["network"], HasSubstr("GRU"));
  EXPECT_EQ(recipe["labels"], "paper");
  EXPECT_THAT(run_program_file({"describe", "piezo_fft_gru"}).out,
              AllOf(StartsWith("piezo_fft_gru  recipe\n"), HasSubstr("slipbench train DATA.h5 --recipe piezo_fft_gru")));
}
#endif

TEST(Program, WhatEvalCannotJudge) {
  const TemporaryFolder folder;
  const std::string file = folder / "out.h5", bare = folder / "bare.h5";
  ASSERT_EQ(run_program_file({"run", stage, "--set", "duration=2.5 s", "-o", file, "--quiet"}).status, 0);
  ASSERT_EQ(run_program_file({"run", stage, "--record", "outcome", "-o", bare, "--quiet"}).status, 0);
  expect_refusal({"eval", "fore_ratio", file}, mentions({"fore_ratio", "force_ratio"}));
  expect_refusal({"eval", "truth", file}, mentions({"truth", "oracle"}));
  expect_refusal({"eval", "force_ratio", file, "--set", "ratoi=0.3"}, mentions({"ratoi", "ratio"}));
  expect_refusal({"eval", "band_energy", file}, mentions({"trial 0", "detector.sensor", "band_energy"}));
  expect_refusal({"eval", "gst_hd", file, "--set", "memories=nowhere"}, mentions({"cl_gst_hd", "learn_gst_hd"}));
  expect_refusal({"eval", "force_ratio", file, "--sensor", "padd"}, mentions({"padd", "pad"}));
  EXPECT_THAT(run_program_file({"eval", "learn_gst_hd", file}).out, StartsWith("gst_hd with the memories learn_gst_hd on pad"));
  expect_refusal({"eval", "force_ratio", bare}, mentions({"recording", "outcome"}));
  expect_refusal({"eval", "force_ratio", file, "-o", folder / "page.txt"}, mentions({".html"}));
  // Half of the file is missing.
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  expect_refusal({"eval", "force_ratio", file}, HasSubstr("out.h5"));
}

TEST(Program, EvalPrintsOneObject) {
  const TemporaryFolder folder;
  const std::string file = folder / "out.h5", page = folder / "page.html";
  ASSERT_EQ(run_program_file({"run", stage, "-o", file, "--quiet"}).status, 0);
  const ChildResult result = run_program_file({"eval", "force_ratio", file, "--set", "ratio=0.45", "-o", page, "--json"});
  EXPECT_EQ(result.status, 0);
  const nlohmann::json json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["slipbench_eval"], 1);
  EXPECT_EQ(json["detector"]["parameters"]["ratio"], 0.45);
  EXPECT_EQ(json["all"]["trials"], 1);
  EXPECT_TRUE(std::filesystem::exists(page));
  EXPECT_TRUE(std::filesystem::exists(folder / "page.json"));
  // A slipping pillar has f_t = 0.5 f_n, which is below this ratio: no slip is detected.
  const ChildResult text = run_program_file({"eval", "force_ratio", file, "--set", "ratio=0.6"});
  EXPECT_THAT(text.out, HasSubstr("recall of slip"));
  EXPECT_THAT(text.out, HasSubstr("slipping trials: 1, detected 0, early 0, missed 1"));
}

TEST(Program, FullStandardOutputIsAnError) {
  const ChildResult result = run_program_file({"list"}, "/dev/full");
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("cannot write to standard output: No space left on device"));
}

// The output is longer than the buffer of stdout, so the failure occurs while printing, not at the
// end.
TEST(Program, FullStandardOutputIsAnErrorOfLongTextToo) {
  const ChildResult result = run_program_file({"run", stage, "--trials", "20", "--json"}, "/dev/full");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err, "slipbench: cannot write to standard output: No space left on device\n");
}

TEST(Program, ClosedStandardStreams) {
  const TemporaryFolder folder;
  const auto status = [&](const std::string& script) { return run_shell(script, folder / "").status; };
  EXPECT_EQ(status("slipbench list >&- 2>&-"), 2) << "the list could not be written";
  EXPECT_EQ(status("slipbench swep 2>&-"), 2);
  EXPECT_EQ(status("slipbench run nowhere.yaml <&- >&- 2>&-"), 2);
  EXPECT_EQ(status("slipbench run " + stage + " --quiet -o out.h5 <&- >&- 2>&-"), 0);
  EXPECT_EQ(status("slipbench report out.h5 --trial 7 >&- 2>&-"), 2);
  EXPECT_EQ(status("slipbench report out.h5"), 0);
}

// If a standard stream is closed, the dataset must not get its number: the notice of an interrupt
// is written to number 2.
TEST(Program, DatasetsDoNotTakeThePlaceOfAStandardStream) {
  const TemporaryFolder folder;
  const ChildResult result = run_shell(SLIPBENCH_PROGRAM " sweep " + stage +
                                           " --trials 100000 -o long.h5 <&- >&- 2>&- &\n"
                                           "sweep=$!\n"
                                           "until [ -e long.h5.partial ]; do sleep 0.05; done\n"
                                           "readlink /proc/$sweep/fd/0 /proc/$sweep/fd/1 /proc/$sweep/fd/2\n"
                                           "kill -TERM $sweep\n"
                                           "wait $sweep",
                                       folder / "");
  EXPECT_EQ(result.status, 130);
  EXPECT_EQ(result.out, "/dev/null\n/dev/null\n/dev/null\n");
}

TEST(Program, Check) {
  // The pad does not move before 2 s.
  const nlohmann::json good =
      json_of(run_program_file({"check", stage, stage, "--set", "expect={gross_slip_by: 3 s}", "--json"}));
  EXPECT_TRUE(good["passed"]);
  EXPECT_EQ(good["scenes"].size(), 2U);
  const TemporaryFolder folder;
  const ChildResult failed = run_program_file(
      {"check", stage, "--set", "expect={gross_slip_by: 1.0 s}", "-o", folder / "left", "--junit", folder / "j.xml"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.out,
              AllOf(HasSubstr("replay: "), HasSubstr("slipbench run " + stage), HasSubstr("0 of 1 scene passed, 1 failed")));
  EXPECT_TRUE(std::filesystem::exists(folder / "left/stage/trial_0.html"));
  EXPECT_TRUE(std::filesystem::exists(folder / "j.xml"));
  expect_refusal({"check", stage}, mentions({"expectations"}));
  expect_refusal({"check", stage, "--set", "expect={dropped: false}"}, mentions({"dropped", "gripper"}));
  expect_refusal({"check", stage, "--junit", stage}, HasSubstr("stage.yaml"));
}

TEST(Program, OneTrialOfASweepIsWhatItIsAmongAll) {
  const TemporaryFolder folder;
  const std::vector<std::string> sweep{stage, "--set",
                                       "sweep={motion.speed: {draw: uniform, min: 1 mm/s, max: 9 mm/s}, trials: 4}", "--json"};
  std::vector<std::string> all{"sweep"}, one{"run", "--trial", "2"};
  all.insert(all.end(), sweep.begin(), sweep.end());
  one.insert(one.end(), sweep.begin(), sweep.end());
  const nlohmann::json alone = json_of(run_program_file(one));
  EXPECT_EQ(alone["planned"], 1);
  EXPECT_EQ(alone["trials"][0], json_of(run_program_file(all))["trials"][2]);
  one[2] = "4";
  expect_refusal({one.begin(), one.end() - 1}, mentions({"trial 4", "0", "3"}));
}

TEST(Program, ListAndDescribe) {
  const nlohmann::json list = json_of(run_program_file({"list", "--json"}));
  for (const char* kind :
       {"effects", "sensors", "surfaces", "materials", "motions", "electronics", "grasp", "contact", "detectors", "recipes"}) {
    EXPECT_FALSE(list.at(kind).empty()) << kind;
  }
  EXPECT_EQ(json_of(run_program_file({"list", "recipes", "--json"}))["recipes"].at(0)["name"], "piezo_mlp");
  EXPECT_EQ(json_of(run_program_file({"list", "sensors", "--json"})).size(), 1U);
  const nlohmann::json entry = json_of(run_program_file({"describe", "papillarray", "--json"}))["entries"].at(0);
  EXPECT_EQ(entry["kind"], "sensor");
  EXPECT_EQ(json_of(run_program_file({"describe", "truth", "--json"}))["entries"].at(0)["kind"], "oracle");
  EXPECT_EQ(json_of(run_program_file({"describe", "contact", "--json"}))["entries"].at(0)["parameters"].at(0)["name"],
            "integrator");
  // A detector and a controller with the same name.
  const nlohmann::json both = json_of(run_program_file({"describe", "force_ratio", "--json"}))["entries"];
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0]["kind"], "detector");
  EXPECT_EQ(both[1]["kind"], "controller");
  EXPECT_EQ(both[0]["parameters"].back()["name"], "flip");
  EXPECT_THAT(run_program_file({"describe", "nib_slip"}).out, HasSubstr("over 90, 30"));
  EXPECT_THAT(run_program_file({"describe", "piezo_grasp"}).out, HasSubstr("20, 100, 300, 1000 samples, with their signs"));
  const ChildResult page = run_program_file({"describe", "papillarray"});
  EXPECT_EQ(page.status, 0);
  for (const nlohmann::json& parameter : entry["parameters"]) {
    EXPECT_THAT(page.out, HasSubstr("default: " + parameter["default"].get<std::string>()));
  }
}

TEST(Program, DoctorJsonIsOneObjectAlone) {
  const ChildResult result = run_program_file({"doctor", "--json"});
  EXPECT_LE(result.status, 1);  // 1 if a required part is missing on this machine
  EXPECT_TRUE(nlohmann::json::parse(result.out).is_object());
  EXPECT_EQ(result.err, "");
}

TEST(Program, RunShowsThePhysicsAtOnce) {
  const ChildResult result = run_program_file({"run", stage});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("acrylic"), HasSubstr("P0"), HasSubstr("P8"), HasSubstr("times real time"),
                                HasSubstr("gross slip at"), HasSubstr("next:"), Not(HasSubstr("\033"))));
  // The centre pillar, pressed by d = 1 mm, slips when its tip has been dragged by mu k_n d / k_t =
  // 0.5 * 7.1/3.9 * 1 mm = 0.91026 mm. The stage starts at 2 s and covers v^2/(2a) = 0.16 mm in v/a
  // = 0.08 s, then moves at 4 mm/s: 2.08 s + 0.75026 mm / (4 mm/s) = 2.2676 s. The centre pillar
  // has the largest load, so it is the last of the nine, and its slip is the gross slip.
  EXPECT_THAT(result.out, HasSubstr("gross slip at 2.2676 s"));
}

TEST(Program, RunJsonIsOneObjectAlone) {
  const nlohmann::json json = json_of(run_program_file({"run", stage, "--json"}));
  EXPECT_TRUE(json.is_object());
  EXPECT_EQ(json["trials"].size(), 1U);
  EXPECT_GT(json["times_real_time"].get<double>(), 1.0);
}

TEST(Program, RunTakesTheFirstTrialsOfASweep) {
  EXPECT_EQ(json_of(run_program_file({"run", stage, "--set", three_speeds, "--json"}))["trials"].size(), 1U);
  EXPECT_EQ(json_of(run_program_file({"run", stage, "--set", three_speeds, "--trials", "2", "--json"}))["trials"].size(), 2U);
  // More trials than the sweep has: the grid is repeated.
  EXPECT_EQ(json_of(run_program_file({"run", stage, "--set", three_speeds, "--trials", "5", "--json"}))["trials"].size(), 5U);
}

TEST(Program, SweepRunsTheGridTimesTheDraws) {
  EXPECT_EQ(json_of(run_program_file({"sweep", stage, "--set", three_speeds, "--json"}))["trials"].size(), 3U);
  EXPECT_EQ(json_of(run_program_file({"sweep", stage, "--set", three_speeds, "--trials", "2", "--json"}))["trials"].size(), 6U);
}

TEST(Program, SweepPrintsPlainLinesAndATable) {
  const ChildResult result = run_program_file({"sweep", stage, "--set", three_speeds});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, AllOf(HasSubstr("3/3 trials (100 %)"), Not(HasSubstr("\r")), Not(HasSubstr("\033"))));
  EXPECT_THAT(result.out, AllOf(HasSubstr("3 trials"), HasSubstr("gross slip"), HasSubstr("share of time")));
}

TEST(Program, QuietSaysNothing) {
  const ChildResult result = run_program_file({"sweep", stage, "--set", three_speeds, "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.out + result.err, "");
}

TEST(Program, FromSceneToReportAndExports) {
  const TemporaryFolder folder;
  const std::string dataset = folder / "three speeds.h5";
  const ChildResult sweep = run_program_file({"sweep", stage, "--set", three_speeds, "-o", dataset});
  EXPECT_EQ(sweep.status, 0) << sweep.err;
  EXPECT_THAT(sweep.out,
              AllOf(HasSubstr("written: " + dataset), HasSubstr("next: " SLIPBENCH_PROGRAM " report '" + dataset + "'")));
  EXPECT_TRUE(std::filesystem::exists(dataset));

  // Without -o the page is written next to the dataset.
  EXPECT_EQ(json_of(run_program_file({"report", dataset, "--json"}))["report"], folder / "three speeds.html");
  EXPECT_TRUE(std::filesystem::exists(folder / "three speeds.html"));
  expect_refusal({"report", dataset, "--trial", "3"}, HasSubstr("3"));  // trials are 0 to 2

  const nlohmann::json files =
      json_of(run_program_file({"export", dataset, "--format", "training-csv", "-o", folder / "csv", "--json"}))["files"];
  const auto is_table = [](const nlohmann::json& name) { return name.get<std::string>().ends_with(".csv"); };
  EXPECT_EQ(std::ranges::count_if(files, is_table), 3);  // and the files of the dataset card
  std::ifstream file(files.at(0).get<std::string>());
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  EXPECT_EQ(std::count(line.begin(), line.end(), ','), 72);  // 73 columns
}

TEST(Program, WarnsOnStderrAndInTheJson) {
  const std::string start = "motion.start=4 s";  // the trial's end
  const std::string warning =
      "slipbench: warning: --set motion.start=4 s: motion.start: 4 s is not before the end of the trial, 4 s";
  const ChildResult quiet = run_program_file({"run", stage, "--set", start, "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_THAT(quiet.err, StartsWith(warning));
  const ChildResult run = run_program_file({"run", stage, "--set", start, "--json"});
  EXPECT_EQ(run.err, quiet.err);
  const nlohmann::json reported = nlohmann::json::parse(run.out);
  ASSERT_EQ(reported["warnings"].size(), 1U);
  EXPECT_EQ(reported["warnings"][0]["about"], "motion.start");
  const nlohmann::json checked =
      nlohmann::json::parse(run_program_file({"check", stage, "--set", start, "expect={no_slip_before: 3 s}", "--json"}).out);
  EXPECT_EQ(checked["scenes"][0]["warnings"], reported["warnings"]);
  EXPECT_TRUE(json_of(run_program_file({"run", stage, "--json"}))["warnings"].empty());
}

TEST(Program, ControlCKeepsWhatIsFinished) {
  const TemporaryFolder folder;
  const std::string dataset = folder / "long.h5";
  // 100,000 trials take minutes; the signal is sent once the temporary file exists.
  const ChildResult result =
      run_program_interrupted({"sweep", stage, "--trials", "100000", "-o", dataset}, dataset + ".partial", SIGINT);
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.err, StartsWith("slipbench: stopping; interrupt again to stop at once\n"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("interrupted: "), HasSubstr(" of 100000 trials finished")));
  EXPECT_FALSE(std::filesystem::exists(dataset));
}

// A command without its own signal handling ends at once; this one would measure for minutes.
TEST(Program, EndsWithOneStatusByEverySignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    EXPECT_EQ(run_program_interrupted({"cost", "--stability"}, "started", signal).status, 130);
}

// A search with 64 starts takes minutes; the signal is sent once its threads search.
TEST(Program, ControlCOfCalibrateWritesNothing) {
  const TemporaryFolder folder;
  const ChildResult result = run_program_interrupted(
      {"calibrate", SLIPBENCH_SOURCE_DIR "/scenes/papillarray/recordings.yaml", "--synthetic-truth", "--starts", "64", "--jobs",
       "2", "--fit", "motion.tilt.0: {min: -2 deg, max: 2 deg}", "-o", folder / "fitted.yaml"},
      "threads", SIGINT);
  EXPECT_EQ(result.status, 130);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err,
            "slipbench: stopping; nothing is kept; interrupt again to stop at once\nslipbench: interrupted; nothing is kept\n");
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

}  // namespace
}  // namespace slipbench
