// Grids of trials: which trials run, in which order their results come, and how they end early. No trial is simulated here.
#include "tools/studies/grid.h"

#include <csignal>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"

namespace slipbench::reproduce::grid_test {
namespace {

constexpr const char* scene = "scenes/papillarray/hexapod.yaml";  // 200 trials, whose friction is drawn

const std::vector<GridCell> cells{
    {.name = "as it is", .scene = scene, .draws = 2},
    {.name = "rubber", .scene = scene, .overrides = {{"surface.material", "rubber"}}, .draws = 1},
    {.name = "other", .scene = scene, .change = [](Scene& one) { one.material = "felt"; }, .draws = 2}};

ReproduceOptions with_jobs(std::size_t jobs) {
  ReproduceOptions options;
  options.jobs = jobs;
  return options;
}

TEST(Grid, HasTheTrialsOfEachCellInOrderOnAnyNumberOfThreads) {
  const auto text = [](const GridTrial& trial) {
    return fmt::format("{} {} {} {}", trial.cell, trial.number, trial.scene.material, trial.params);
  };
  const auto found = run_grid<std::string>(cells, with_jobs(1), text);
  ASSERT_THAT(found, SizeIs(3));
  ASSERT_EQ(found[0].size(), 2 * found[1].size());
  ASSERT_EQ(found[0].size(), found[2].size());
  EXPECT_THAT(found[0].back(), StartsWith(fmt::format("0 {} acrylic {{\"", found[0].size() - 1)));
  EXPECT_THAT(found[1].front(), StartsWith("1 0 rubber {\""));
  for (std::size_t k = 0; k < found[0].size(); ++k) {
    EXPECT_EQ(found[0][k].substr(found[0][k].find('{')), found[2][k].substr(found[2][k].find('{'))) << "the draws of trial " << k;
  }
  EXPECT_EQ(run_grid<std::string>(cells, with_jobs(3), text), found);
}

TEST(Grid, AnErrorSaysWhichTrialItIs) {
  const auto fail_at_3 = [](const GridTrial& trial) -> int {
    if (trial.number == 3) throw InputError("no");
    return 0;
  };
  EXPECT_THAT(refusal_of([&] { run_grid<int>({cells[1]}, with_jobs(2), fail_at_3); }),
              StartsWith("rubber, trial 3: no; the same: slipbench run scenes/papillarray/hexapod.yaml --set "
                         "'surface.material=rubber' --seed 1 --trials 200 --trial 3"));
  EXPECT_THAT(refusal_of([&] { run_grid<int>({cells[2]}, with_jobs(2), fail_at_3); }),
              HasSubstr("other, trial 3: no; the same, but for what the name says: slipbench run"));
}

TEST(Grid, SaysWhatIsBeingDoneAndEndsAtAnInterrupt) {
  std::vector<std::string> said;
  ReproduceOptions options = with_jobs(1);
  options.say = [&](const std::string& what) {
    said.push_back(what);
    if (said.size() == 3) std::raise(SIGINT);
  };
  EXPECT_THROW(run_in_order<int>(
                   100000, options, [](std::size_t k) { return k < 20 ? "first" : "second"; }, [](std::size_t) { return 0; }),
               Interrupted);
  EXPECT_THAT(said, ElementsAre("first (0 of 100000 done)", "second (20 of 100000 done)", "second (50 of 100000 done)"));
}

TEST(Processes, EachWorkHasOneOfItsOwnAndResultsKeepTheirOrder) {
  static int done = 0;  // of this process: what a child adds stays in the child
  const auto work = [](std::size_t k) {
    ++done;
    return std::vector<std::int64_t>(k, static_cast<std::int64_t>(10 * k) + done);
  };
  std::vector<std::string> said;
  ReproduceOptions options;
  options.say = [&](const std::string& what) { said.push_back(what); };
  for (const std::size_t jobs : {1U, 3U}) {
    options.jobs = jobs;
    said.clear();
    EXPECT_THAT(run_in_processes<std::int64_t>(
                    4, options, [](std::size_t k) { return k < 2 ? "first" : "second"; }, work),
                ElementsAre(SizeIs(0), ElementsAre(11), ElementsAre(21, 21), ElementsAre(31, 31, 31)));
    EXPECT_THAT(said, ElementsAre("first (0 of 4 begun)", "second (2 of 4 begun)"));
  }
  EXPECT_EQ(done, 0);
  EXPECT_THROW(
      run_in_processes<char>(
          1, options, [](std::size_t) { return "one"; }, [](std::size_t) -> std::vector<char> { throw InputError("no"); }),
      InputError);
}

TEST(Only, KeepsWhatIsNamedAndRefusesWhatIsNot) {
  EXPECT_THAT(names_of(chosen(cells, {"other"})), ElementsAre("other"));
  EXPECT_THAT(names_of(chosen(cells, {})), ElementsAre("as it is", "rubber", "other"));
  EXPECT_THAT(refusal_of([] { check_only({"ruber"}, names_of(cells)); }),
              HasSubstr("--only: unknown name 'ruber'; did you mean 'rubber'?"));
}

}  // namespace
}  // namespace slipbench::reproduce::grid_test
