// Grids of trials: which trials run, in which order their results come, and how they end early. No trial is simulated here.
#include "tools/studies/grid.h"

#include <csignal>
#include <filesystem>
#include <fstream>

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
              mentions({"other, trial 3", "slipbench run"}));
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
  EXPECT_THAT(refusal_of([] { check_only({"ruber"}, names_of(cells)); }), mentions({"--only", "ruber", "rubber"}));
}

struct KeptNetworksTest : slipbench::testing::FolderTest {
  KeptNetworks open(bool resume, const std::string& of = "table1 seed 1") const { return KeptNetworks(path_, of, resume); }
  void keep(std::initializer_list<std::size_t> indices) const {
    KeptNetworks kept = open(true);
    kept.begin_set();
    for (const std::size_t index : indices) kept.keep(index, "network " + std::to_string(index));
  }
  [[nodiscard]] std::size_t kept_now() const { return open(true).size(); }

  void change_byte(std::uintmax_t place) const {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(place));
    file.put('?');
  }

  const std::string path_ = path("study.networks");
};

TEST_F(KeptNetworksTest, AreThereAgainBySetAndNumber) {
  {
    KeptNetworks kept = open(false);
    kept.begin_set();
    kept.keep(3, std::string("\0a", 2));
    kept.begin_set();
    kept.keep(0, "");
  }
  KeptNetworks kept = open(true);
  EXPECT_EQ(kept.size(), 2u);
  kept.begin_set();
  ASSERT_NE(kept.find(3), nullptr);
  EXPECT_EQ(*kept.find(3), std::string("\0a", 2));
  EXPECT_EQ(kept.find(0), nullptr) << "that is of the next set";
  kept.begin_set();
  ASSERT_NE(kept.find(0), nullptr);
  EXPECT_EQ(*kept.find(0), "");
  EXPECT_EQ(kept.find(3), nullptr);
}

TEST_F(KeptNetworksTest, AKilledRunLosesTheUnfinishedRecordAlone) {
  keep({0, 1, 2});
  const std::uintmax_t whole = std::filesystem::file_size(path_);
  for (const std::uintmax_t cut : {1, 20, 40}) {
    std::filesystem::remove(path_);
    keep({0, 1, 2});
    std::filesystem::resize_file(path_, whole - cut);
    EXPECT_EQ(kept_now(), 2u) << cut;
    keep({2});  // where the torn record was
    EXPECT_EQ(kept_now(), 3u) << cut;
    EXPECT_EQ(std::filesystem::file_size(path_), whole) << cut;
  }
  // One byte of the last record is another one: its digest tells.
  change_byte(whole - 33);
  EXPECT_EQ(kept_now(), 2u);
}

TEST_F(KeptNetworksTest, DamageBeforeTheEndIsToldAndNothingIsThrownAway) {
  keep({0, 1, 2});
  const std::uintmax_t whole = std::filesystem::file_size(path_);
  const std::uintmax_t record = 3 * 8 + std::string("network 0").size() + 32;
  change_byte(whole - record - 33);  // the last byte that network 1 has said
  EXPECT_THAT(refusal_of([&] { open(true); }), mentions({"damaged", "delete"}));
  EXPECT_EQ(std::filesystem::file_size(path_), whole);
}

TEST_F(KeptNetworksTest, WorkOfHoursIsNotOverwrittenAndNotTakenForAnother) {
  keep({0});
  EXPECT_THAT(refusal_of([&] { open(false); }), mentions({"1 networks", "--resume"}));
  EXPECT_THAT(refusal_of([&] { open(false, "another"); }), mentions({"1 networks"}));
  EXPECT_THAT(refusal_of([&] { open(true, "another"); }), mentions({"another build"}));
  EXPECT_EQ(kept_now(), 1u);
  std::ofstream(path_) << "a text of the user\n";
  EXPECT_THAT(refusal_of([&] { open(true); }), mentions({"no networks"}));
  EXPECT_EQ(std::filesystem::file_size(path_), 19u);
}

TEST_F(KeptNetworksTest, NothingIsLeftWhereNothingWasKeptOrAllIsDone) {
  static_cast<void>(open(false));
  EXPECT_FALSE(std::filesystem::exists(path_));
  keep({0});
  open(true).remove();
  EXPECT_FALSE(std::filesystem::exists(path_));
}

// The second of four networks ends the run; what goes on with it teaches those alone that are not there, and finds the same.
TEST_F(KeptNetworksTest, AStudyGoesOnWithThem) {
  const auto square = [](std::size_t k) { return std::vector<std::int64_t>{static_cast<std::int64_t>(k * k)}; };
  const auto name = [](std::size_t) { return "square"; };
  ReproduceOptions options;
  options.jobs = 1;
  const std::vector<std::vector<std::int64_t>> all = run_in_processes<std::int64_t>(4, options, name, square);
  {
    KeptNetworks kept = open(false);
    options.kept = &kept;
    const auto fails = [&](std::size_t k) { return k == 2 ? throw InputError("killed") : square(k); };
    EXPECT_THROW(run_in_processes<std::int64_t>(4, options, name, fails), InputError);
    EXPECT_EQ(kept.size(), 2u);
  }
  KeptNetworks kept = open(true);
  options.kept = &kept;
  const auto only_what_is_left = [&](std::size_t k) { return k < 2 ? throw InputError("taught again") : square(k); };
  EXPECT_EQ(run_in_processes<std::int64_t>(4, options, name, only_what_is_left), all);
  EXPECT_EQ(kept.size(), 4u);
}

// Of the command: what cannot be gone on with is refused before anything is simulated.
TEST_F(KeptNetworksTest, ResumeNeedsAPageAStudyThatTeachesNetworksAndItsOwnFile) {
  ReproduceCommand command;
  command.resume = true;
  command.name = "learned/scaling";
  EXPECT_THAT(refusal_of([&] { command.run(); }), mentions({"-o"}));
  command.name = "hd-papillarray/latency";
  command.output = path("study.html");
  EXPECT_THAT(refusal_of([&] { command.run(); }), mentions({"--resume"}));
  command.name = "learned/scaling";
  keep({0});
  EXPECT_THAT(refusal_of([&] { command.run(); }), mentions({"another build"}));
  EXPECT_EQ(kept_now(), 1u);
}

}  // namespace
}  // namespace slipbench::reproduce::grid_test
