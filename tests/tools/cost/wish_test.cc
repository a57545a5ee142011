// The accuracy requirement of a scene, used as by a user of the program.
#include <filesystem>
#include <fstream>

#include "tests/expect.h"
#include "tests/tools/cli/commands/child_process.h"
#include "tools/dataset/reader.h"

namespace slipbench {
namespace {

constexpr const char* wishing =
    "slipbench: 1\nduration: 1.2 s\nmotion: {kind: stage, start: 0.7 s}\nsensors: {pad: {type: papillarray, rate: 100 Hz}}\n"
    "sweep: {motion.speed: [4 mm/s, 8 mm/s]}\naccuracy: {onset: 1 %}\nexpect: {gross_slip_by: 1.2 s}\n";

TEST(Wish, IsSettledOnceForRunSweepAndCheck) {
  const TemporaryFolder folder;
  std::ofstream(folder / "wish.yaml") << wishing;
  const ChildResult run = run_program_file({"run", folder / "wish.yaml"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("accuracy: searching for the cheapest setting that meets the accuracy of "));
  EXPECT_THAT(run.err, HasSubstr("compared with closed form in one trial; " + (folder / "wish.yaml.accuracy.json")));
  const ChildResult all = run_program_file({"run", folder / "wish.yaml", "--trials", "2"});
  EXPECT_EQ(all.status, 0) << all.err;
  EXPECT_THAT(all.err, HasSubstr("compared with closed form in 2 trials; "));
  const ChildResult sweep = run_program_file({"sweep", folder / "wish.yaml", "-o", folder / "first.h5"});
  EXPECT_EQ(sweep.status, 0) << sweep.err;
  EXPECT_EQ(sweep.err.find("(only once)"), std::string::npos) << sweep.err;
  const ChildResult check = run_program_file({"check", folder / "wish.yaml", "--json"});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.err, IsEmpty());
  EXPECT_THAT(check.out, HasSubstr("--set accuracy=none"));  // in the command that replays a trial
  // The found setting, given by hand, gives the same content without a record.
  const std::string record = bytes_of(folder / "wish.yaml.accuracy.json");
  const ChildResult again = run_program_file(
      {"sweep", folder / "wish.yaml", "-o", folder / "second.h5", "--set", "accuracy=none", "--set", "time_step=10 ms"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(DatasetReader(folder / "first.h5").content_sha256(), DatasetReader(folder / "second.h5").content_sha256());
  EXPECT_EQ(bytes_of(folder / "wish.yaml.accuracy.json"), record);
}

TEST(Wish, ThatCannotBeMetEndsTheProgramWithWhatCan) {
  const TemporaryFolder folder;
  std::ofstream(folder / "wish.yaml") << wishing;
  const ChildResult run = run_program_file({"run", folder / "wish.yaml", "--set", "accuracy={slip_distance: 0.000001 %}", "--set",
                                            "effects=[texture]", "-o", folder / "out.h5"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, mentions({"accuracy.slip_distance", "1e-06 %", "demonstrated"}));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "wish.yaml.accuracy.json"));
}

}  // namespace
}  // namespace slipbench
