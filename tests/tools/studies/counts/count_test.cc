// Counting and `slipbench bench`, with a valgrind that hands out a prepared profile: the real one takes a minute and is what
// the test instruction_counts runs.
#include "tools/studies/counts/count.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/program/commands/child_process.h"
#include "tests/tools/studies/counts/sample.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/studies/counts/results.h"

namespace slipbench::counts {
namespace {

// A folder with a program `valgrind`, first on PATH while this lives.
class FakeValgrind {
 public:
  explicit FakeValgrind(const std::string& body = "cp \"${0%/*}/sample\" profile") : path_(std::getenv("PATH")) {
    std::ofstream(folder_ / "sample") << sample_profile;
    std::ofstream(folder_ / "valgrind") << "#!/bin/sh\n[ \"$1\" = --version ] && echo valgrind-3.19.0 && exit\n" << body << '\n';
    std::filesystem::permissions(folder_ / "valgrind", std::filesystem::perms::owner_all);
    setenv("PATH", ((folder_ / ":") + path_).c_str(), 1);
  }
  ~FakeValgrind() { setenv("PATH", path_.c_str(), 1); }
  FakeValgrind(const FakeValgrind&) = delete;
  FakeValgrind& operator=(const FakeValgrind&) = delete;

  // Results of this build in which each scene cost `instructions` before, all of them in StageSimulation::step.
  [[nodiscard]] std::string stored(std::uint64_t instructions) const {
    Results results{.build = build_facts(), .context = context_facts(), .scenes = {}};
    for (const std::string_view scene : reference_scenes()) {
      results.scenes.push_back({.scene = std::string(scene),
                                .simulated = 4.0,
                                .steps = 40,
                                .instructions = instructions,
                                .cpu_time = 1.0,
                                .functions = {{"slipbench::StageSimulation::step", instructions}}});
    }
    std::ofstream(folder_ / "stored.json") << results_json(results);
    return folder_ / "stored.json";
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
  std::string path_;
};

std::string count_refusal() {
  return refusal_of([&] { static_cast<void>(count_reference_scenes({}, program_catalogues())); });
}

TEST(BenchCount, EverySceneInOrderWhateverTheJobs) {
  const FakeValgrind valgrind;
  for (const std::size_t jobs : {1, 2}) {
    std::size_t told = 0;
    const auto results =
        count_reference_scenes({.jobs = jobs, .on_counted = [&told](const SceneCount&) { ++told; }}, program_catalogues());
    ASSERT_TRUE(results.has_value());
    EXPECT_EQ(told, 6U);
    ASSERT_EQ(results->scenes.size(), 6U);
    EXPECT_EQ(results->scenes[0].scene, "scenes/papillarray/stage.yaml");
    EXPECT_EQ(results->scenes[0].simulated, 4.0);  // as the scene says
    EXPECT_EQ(results->scenes[0].instructions, 100U);
    EXPECT_EQ(results->scenes[0].steps, 40U);
    EXPECT_EQ(results->scenes[0].functions.front().name, "slipbench::StageSimulation::step");
    EXPECT_EQ(results->build, build_facts());
  }
}

// The first trial of the scene alone, and nothing of the user's environment that valgrind or the C library listens to.
TEST(BenchCount, RunsTheTrialAloneAndUndisturbed) {
  const FakeValgrind strict(
      "case \"$*\" in *--toggle-collect=slipbench::run_trial*' run /'*'.yaml --trial 0 --jobs 1 --quiet') ;; *) exit 4;; esac\n"
      "[ -z \"$VALGRIND_OPTS$GLIBC_TUNABLES$HOME\" ] && [ \"$LD_BIND_NOW\" = 1 ] || exit 5\n"
      "cp \"${0%/*}/sample\" profile");
  setenv("VALGRIND_OPTS", "--trace-children=yes", 1);
  setenv("GLIBC_TUNABLES", "glibc.malloc.check=1", 1);
  EXPECT_EQ(count_refusal(), "accepted");
  unsetenv("VALGRIND_OPTS");
  unsetenv("GLIBC_TUNABLES");
}

TEST(BenchCount, ARunThatFailsIsTheResultOfNone) {
  const FakeValgrind broken("echo first >&2; echo last >&2; exit 3");
  EXPECT_THAT(count_refusal(), AllOf(StartsWith("bench: scenes/papillarray/stage.yaml under "), HasSubstr("ended with 3: last")));
}

TEST(BenchCount, RefusesAProfileOfNothing) {
  const FakeValgrind stripped("sed -e '/^fn/,/^totals/d' \"${0%/*}/sample\" > profile; echo 'totals: 0' >> profile");
  EXPECT_THAT(count_refusal(),
              HasSubstr("0 instructions in 0 steps were counted inside run_trial; allowed: a program with its symbols"));
  const FakeValgrind silent("true");
  EXPECT_THAT(count_refusal(), HasSubstr("profile: it cannot be read"));
}

TEST(BenchCount, SaysWhenItsValgrindIsNone) {
  const FakeValgrind none;
  std::ofstream(none / "valgrind") << "#!/bin/sh\necho hello\n";
  EXPECT_THAT(count_refusal(), HasSubstr("--version ended with 0 and said 'hello'"));
}

TEST(BenchCommand, NoValgrindSaysHowToGetIt) {
  const TemporaryFolder folder;
  const ChildResult result = run_shell("PATH=/nonexistent; slipbench bench", folder / "");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("valgrind is not on PATH; it counts instructions, and is there after: apt-get install"));
}

// Ctrl-C on a terminal reaches valgrind as well, which may end by it: that is no failure.
TEST(BenchCommand, CtrlCEndsItWithoutResults) {
  for (const char* const end : {"cp \"${0%/*}/sample\" profile", "exit 130"}) {
    const FakeValgrind slow(std::string("touch \"${0%/*}/begun\"; sleep 1; ") + end);
    const ChildResult result = run_program_interrupted({"bench", "-o", slow / "new.json"}, slow / "begun", SIGINT);
    EXPECT_EQ(result.status, 130) << result.err;
    EXPECT_THAT(result.err, HasSubstr("interrupted: nothing is kept"));
    EXPECT_FALSE(std::filesystem::exists(slow / "new.json"));
  }
}

// 100 instructions now, of which StageSimulation::step has 60.
TEST(BenchCommand, FailsWhereASceneGrewAndNamesTheFunction) {
  const FakeValgrind valgrind;
  const ChildResult grew = run_program_file({"bench", "--compare", valgrind.stored(50), "--quiet"});
  EXPECT_EQ(grew.status, 1);
  EXPECT_THAT(grew.out, AllOf(HasSubstr("papillarray/stage                   50  100  +100.00 %  GREW"),
                              HasSubstr("slipbench::StageSimulation::step"), HasSubstr("6 of 6 scenes grew by more than 2 %"),
                              HasSubstr("slipbench bench -o ")));
  const ChildResult json = run_program_file({"bench", "--compare", valgrind.stored(50), "--json"});
  EXPECT_EQ(json.status, 1);
  EXPECT_EQ(json.err, "");
  const auto parsed = nlohmann::json::parse(json.out);
  EXPECT_EQ(parsed["passed"], false);
  EXPECT_EQ(parsed["scenes"][5]["scene"], "scenes/grasp/lift.yaml");
  EXPECT_EQ(parsed["scenes"][5]["growth"], 1.0);
  EXPECT_EQ(parsed["scenes"][5]["functions"][0]["name"], "slipbench::StageSimulation::step");
}

TEST(BenchCommand, PassesWhereNoneGrewAndAsksForAnUpdateWhereOneShrank) {
  const FakeValgrind valgrind;
  const ChildResult same = run_program_file({"bench", "--compare", valgrind.stored(100)});
  EXPECT_EQ(same.status, 0);
  EXPECT_THAT(same.out, AllOf(HasSubstr("No scene grew by more than 2 %"), Not(HasSubstr("update"))));
  EXPECT_THAT(same.err, StartsWith("counted papillarray/stage\n"));
  const ChildResult shrank = run_program_file({"bench", "--compare", valgrind.stored(200), "--jobs", "2"});
  EXPECT_EQ(shrank.status, 0);
  EXPECT_THAT(shrank.out, HasSubstr("update the results, so that it stays so: slipbench bench -o "));
}

TEST(BenchCommand, Refusals) {
  const FakeValgrind valgrind;
  const auto refused = [](const std::vector<std::string>& words) {
    std::vector<std::string> arguments{"bench"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const ChildResult result = run_program_file(arguments);
    EXPECT_EQ(result.status, 2) << result.out;
    EXPECT_EQ(result.out, "");
    return result.err;
  };
  EXPECT_THAT(refused({"--compare", "nowhere.json"}), HasSubstr("nowhere.json: there is no such file"));
  EXPECT_THAT(refused({"some.json"}), HasSubstr("unexpected argument 'some.json'; allowed: --compare some.json"));
  EXPECT_THAT(refused({"--compare", "-o", "ci.json"}), HasSubstr("--compare and -o exclude each other"));
  EXPECT_THAT(refused({"-o", "ci.txt"}), HasSubstr("-o is 'ci.txt'; allowed: a name that ends in .json"));
  EXPECT_THAT(refused({"-o", "/nonexistent/ci.json"}), HasSubstr("there is no folder /nonexistent"));
  EXPECT_THAT(refused({"--jobs", "0"}), HasSubstr("--jobs is '0'"));
  const std::string stored = valgrind.stored(100);
  std::string text = file_text(stored);
  text.replace(text.find("\"valgrind\": \"3.19.0\""), 20, "\"valgrind\": \"3.18.0\"");
  std::ofstream(valgrind / "older.json") << text;
  EXPECT_THAT(refused({"--compare", valgrind / "older.json"}),
              HasSubstr("it is of another valgrind ('3.18.0' there, '3.19.0' here)"));
  std::ofstream(valgrind / "note.json") << "a note";
  EXPECT_THAT(refused({"-o", valgrind / "note.json"}), HasSubstr("exists and is no file of results"));
  EXPECT_EQ(file_text(valgrind / "note.json"), "a note");
}

#ifdef NDEBUG  // it times each scene ten times, which takes minutes in a build that is not optimised
TEST(BenchCommand, WritesResultsAndTheirDrawing) {
  const FakeValgrind valgrind;
  const ChildResult result = run_program_file({"bench", "-o", valgrind / "new.json", "--json"});
  EXPECT_EQ(result.status, 0) << result.err;
  const auto printed = nlohmann::json::parse(result.out);
  EXPECT_EQ(printed["scenes"][0]["instructions_per_simulated_s"], 25.0);
  EXPECT_EQ(printed["scenes"][0]["instructions_per_step"], 2.5);
  const Results written = read_results(valgrind / "new.json");
  EXPECT_EQ(written.build, build_facts());
  EXPECT_EQ(drawing(written), file_text(valgrind / "new.svg"));
  for (const SceneCount& scene : written.scenes) EXPECT_GT(scene.times_real_time(), 0.0);
  EXPECT_EQ(run_program_file({"bench", "--compare", valgrind / "new.json"}).status, 0);
}
#endif

}  // namespace
}  // namespace slipbench::counts
