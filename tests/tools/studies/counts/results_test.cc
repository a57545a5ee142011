#include "tools/studies/counts/results.h"

#include <fstream>
#include <string>

#include "tests/expect.h"
#include "tests/tools/program/commands/child_process.h"
#include "tests/tools/studies/counts/sample.h"

namespace slipbench::counts {
namespace {

void write(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string changed_file(const std::string& from, const std::string& to) {
  return replaced(results_json(sample_results()), from, to);
}

std::string file_refusal(const std::string& text) {
  return refusal_of([&] { parse_results(text, "ci.json"); });
}

TEST(BenchResults, ComeBackAsTheyWereWritten) {
  const std::string text = results_json(sample_results());
  const Results back = parse_results(text, "ci.json");
  EXPECT_EQ(results_json(back), text);
  EXPECT_EQ(back.build, sample_results().build);
  EXPECT_EQ(back.scenes[0].instructions, 1000U);
  EXPECT_EQ(back.scenes[0].functions[1].name, "b::step");
  EXPECT_THAT(text, HasSubstr("\n    \"a::step\": 600,\n"));  // a line a function: a change of one is a change of one line
}

TEST(BenchResults, FiguresOfAScene) {
  const SceneCount scene = sample_results().scenes[0];
  EXPECT_EQ(scene.instructions_per_second(), 250.0);
  EXPECT_EQ(scene.instructions_per_step(), 20.0);
  EXPECT_EQ(scene.times_real_time(), 8.0);
  EXPECT_EQ(scene_name(scene.scene), "papillarray/stage");
}

TEST(BenchResults, KeepTheDearestFunctions) {
  Results results = sample_results();
  results.scenes[0].functions.clear();
  for (std::size_t i = 0; i < stored_functions + 5; ++i) {
    results.scenes[0].functions.push_back({"f" + std::to_string(i), 20 - (i > 10 ? 10 : i)});
  }
  const Results back = parse_results(results_json(results), "ci.json");
  EXPECT_EQ(back.scenes[0].functions.size(), stored_functions);
  EXPECT_EQ(back.scenes[0].functions.front().name, "f0");
}

TEST(BenchResults, RefuseWhatTheyDoNotHold) {
  EXPECT_THAT(file_refusal(""), HasSubstr("ci.json: no JSON"));
  EXPECT_THAT(file_refusal("[1]"), HasSubstr("ci.json: the file is [1]; allowed: an object"));
  EXPECT_THAT(file_refusal("{\"a\": 1}"), HasSubstr("allowed: an object with the key 'slipbench_bench'"));
  EXPECT_EQ(file_refusal(changed_file("\"slipbench_bench\": 1", "\"slipbench_bench\": 2")),
            "ci.json: slipbench_bench is 2; allowed: 1");
  EXPECT_EQ(file_refusal(changed_file("\"instructions\": 1000", "\"instructions\": -5")),
            "ci.json: scenes[0].instructions is -5; allowed: a whole number above zero");
  EXPECT_EQ(file_refusal(changed_file("\"instructions\": 1000", "\"instructions\": 899")),
            "ci.json: scenes[0].instructions is 899; allowed: no less than its functions add up to, 900");
  EXPECT_EQ(file_refusal(changed_file("\"simulated_s\": 4.0", "\"simulated_s\": 0")),
            "ci.json: scenes[0].simulated_s is 0; allowed: a number above zero");
  EXPECT_EQ(file_refusal(changed_file("\"a::step\": 600", "\"a::step\": 200")),
            "ci.json: scenes[0].functions is {\"a::step\":200,\"b::step\":300}; allowed: the dearest first");
  EXPECT_EQ(file_refusal(changed_file("\"GNU 12.2.0\"", "12")), "ci.json: build.compiler is 12; allowed: a text");
  EXPECT_THAT(file_refusal(changed_file("\"scenes\"", "\"scene\"")), HasSubstr("allowed: an object with the key 'scenes'"));
}

TEST(BenchResults, RefuseAFileThatIsNotThere) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_results(folder / "nowhere.json"), InputError);
  EXPECT_THROW(read_results(folder / ""), InputError);
}

TEST(BenchResults, DifferencesAreNamedFromBothSides) {
  const Facts here{{"compiler", "GNU 12.2.0"}, {"FFTW", "3.3.10"}};
  EXPECT_EQ(differences(here, here), "");
  EXPECT_EQ(differences({{"FFTW", "3.3.10"}, {"compiler", "GNU 12.2.0"}}, here), "");  // their order says nothing
  EXPECT_EQ(
      differences({{"compiler", "GNU 13.1.0"}, {"MuJoCo", "4.0.1"}}, here),
      "compiler ('GNU 13.1.0' there, 'GNU 12.2.0' here), FFTW (not said there, '3.3.10' here), MuJoCo ('4.0.1' there, not said here)");
}

std::string search(const std::string& folder, const Facts& build) {
  try {
    return find_results(folder, build);
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(BenchResults, AreFoundByTheirBuild) {
  const TemporaryFolder folder;
  const std::string place = folder / "";
  EXPECT_THAT(search(place, sample_results().build), HasSubstr("no results of this build in " + place));
  Results other = sample_results();
  other.build[0].second = "Clang 14";
  write(folder / "clang.json", results_json(other));
  EXPECT_THAT(search(place, sample_results().build),
              AllOf(HasSubstr("no results of this build in"),
                    HasSubstr("; clang.json is of another compiler ('Clang 14' there, 'GNU 12.2.0' here)"),
                    HasSubstr("to add them: slipbench bench -o ")));
  write(folder / "ci.json", results_json(sample_results()));
  EXPECT_THAT(search(place, sample_results().build), EndsWith("ci.json"));
  EXPECT_THAT(search(place, other.build), EndsWith("clang.json"));
  write(folder / "again.json", results_json(sample_results()));
  EXPECT_THAT(search(place, sample_results().build), HasSubstr("again.json and "));
  write(folder / "broken.json", "{");
  EXPECT_THAT(search(place, sample_results().build), HasSubstr("broken.json: no JSON"));
}

}  // namespace
}  // namespace slipbench::counts
