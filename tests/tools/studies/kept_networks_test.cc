// What a study that was killed leaves of its networks, and what goes on with it.
#include "tools/studies/kept_networks.h"

#include <filesystem>
#include <fstream>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/studies/grid.h"
#include "tools/studies/reproduce_command.h"

namespace slipbench::reproduce::kept_networks_test {
namespace {

class KeptNetworksTest : public slipbench::testing::FolderTest {
 protected:
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
  EXPECT_THAT(refusal_of([&] { open(true); }), HasSubstr("is damaged before its last network; allowed: delete the file"));
  EXPECT_EQ(std::filesystem::file_size(path_), whole);
}

TEST_F(KeptNetworksTest, WorkOfHoursIsNotOverwrittenAndNotTakenForAnother) {
  keep({0});
  EXPECT_THAT(refusal_of([&] { open(false); }),
              HasSubstr("holds 1 networks of a run that did not come to its end; allowed: --resume"));
  EXPECT_THAT(refusal_of([&] { open(false, "another"); }), HasSubstr("holds 1 networks"));
  EXPECT_THAT(refusal_of([&] { open(true, "another"); }), HasSubstr("is of other options, data, scenes or another build"));
  EXPECT_EQ(kept_now(), 1u);
  std::ofstream(path_) << "a text of the user\n";
  EXPECT_THAT(refusal_of([&] { open(true); }), HasSubstr("holds no networks of a study"));
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
  command.name = "piezo-fft-gru/table2";
  EXPECT_THAT(refusal_of([&] { command.run(); }), HasSubstr("allowed: with -o"));
  command.name = "hd-papillarray/latency";
  command.output = path("study.html");
  EXPECT_THAT(refusal_of([&] { command.run(); }), HasSubstr("does not take --resume"));
  command.name = "piezo-fft-gru/table2";
  keep({0});
  EXPECT_THAT(refusal_of([&] { command.run(); }), HasSubstr("is of other options, data, scenes or another build"));
  EXPECT_EQ(kept_now(), 1u);
}

}  // namespace
}  // namespace slipbench::reproduce::kept_networks_test
