// Going on with what a run that did not come to its end has left.
#include <array>
#include <csignal>
#include <functional>

#include <sys/wait.h>
#include <unistd.h>

#include <hdf5.h>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/base/dataset/writer.h"
#include "tools/base/files/output_file.h"

namespace slipbench::testing::resume_test {
namespace {

const DatasetHeader header{"1.2.3", "slipbench: 1\nseed: 7\n", "{}", 7, "slipbench sweep a.yaml"};
constexpr std::size_t rows = 40;
constexpr std::size_t trials = 9;
constexpr std::uint64_t several = 100'000;  // bytes: nine trials fill more than one file

struct ResumeTest : FolderTest {
  // Writes the trials up to `end`, those that are kept from what is kept. Then the run ends as `finish` says.
  void run(std::size_t end, const std::function<void(DatasetWriter&)>& finish, std::uint64_t limit = several) {
    const KeptTrials kept(path("out.h5"), header);
    DatasetWriter writer(path("out.h5"), header, trials, limit, &kept);
    TrialEncoder encoder;
    for (std::size_t k = 0; k < end; ++k) {
      EncodedTrial trial = kept.holds(k) ? kept.read(k)->encoded : encoder.encode(make_grasp_record(k, rows));
      trial.material = "acrylic";
      writer.append(trial);
    }
    finish(writer);
  }
  void interrupt(std::size_t end) {
    run(end, [](DatasetWriter& writer) { writer.keep_partial(); });
  }
  void kill(std::size_t end) {
    const int status = in_child([&] {
      run(end, [](DatasetWriter& writer) {
        writer.publish();
        ::raise(SIGKILL);
      });
    });
    ASSERT_TRUE(WIFSIGNALED(status));
  }
  // Every file by its name and the digest of its bytes.
  std::vector<std::string> all_bytes() {
    std::vector<std::string> all;
    for (const std::string& name : names()) all.push_back(name + " " + text_sha256(bytes_of(path(name))));
    return all;
  }
  // What a run that nobody disturbs writes.
  std::vector<std::string> undisturbed() {
    run(trials, [](DatasetWriter& writer) { writer.commit(); });
    const std::vector<std::string> bytes = all_bytes();
    for (const std::string& name : names()) std::filesystem::remove(path(name));
    return bytes;
  }
};

TEST_F(ResumeTest, GivesTheBytesOfAnUndisturbedRun) {
  const std::vector<std::string> expected = undisturbed();
  for (std::size_t first = 0; first < trials; ++first) {
    first % 2 == 0 ? interrupt(first) : kill(first);
    kill(std::min(trials, first + 1));
    interrupt(std::min(trials, first + 2));
    run(trials, [](DatasetWriter& writer) { writer.commit(); });
    EXPECT_EQ(all_bytes(), expected) << first;
    for (const std::string& name : names()) std::filesystem::remove(path(name));
  }
}

// The second run is ended before it has as much as the first.
TEST_F(ResumeTest, ShorterRunDoesNotReplaceALongerOne) {
  interrupt(7);
  const std::vector<std::string> kept = all_bytes();
  interrupt(2);
  EXPECT_EQ(all_bytes(), kept);
  kill(2);
  EXPECT_EQ(KeptTrials(path("out.h5"), header).size(), 7U);
  interrupt(8);
  EXPECT_EQ(KeptTrials(path("out.h5"), header).size(), 8U);
}

TEST_F(ResumeTest, NothingLeftIsNothingKept) {
  const KeptTrials kept(path("out.h5"), header);
  EXPECT_EQ(kept.size(), 0U);
  EXPECT_FALSE(kept.holds(0));
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(ResumeTest, AnotherRunsTrialsAreRefusedByWhatDiffers) {
  kill(3);
  const std::vector<std::string> before = all_bytes();
  const auto refusal = [&](DatasetHeader now) { return refusal_of([&] { KeptTrials(path("out.h5"), now); }); };
  const auto changed = [](const auto& change) {
    DatasetHeader now = header;
    change(now);
    return now;
  };
  EXPECT_THAT(refusal(changed([](DatasetHeader& now) { now.seed = 8; })),
              mentions({path("out.h5"), path("out.h5.partial"), "seed 7", "8"}));
  EXPECT_THAT(refusal(changed([](DatasetHeader& now) { now.scene = "slipbench: 1\nseed: 9\n"; })),
              mentions({"line 2", "seed: 7", "seed: 9"}));
  EXPECT_THAT(refusal(changed([](DatasetHeader& now) { now.scene = "slipbench: 1\n"; })), mentions({"line 2", "seed: 7", "end"}));
  EXPECT_THAT(refusal(changed([](DatasetHeader& now) { now.version = "1.2.4"; })), mentions({"version", "1.2.3", "1.2.4"}));
  EXPECT_THAT(refusal(changed([](DatasetHeader& now) { now.overrides = R"({"a": "1"})"; })),
              HasSubstr(R"(overrides {}, this run has {"a": "1"})"));
  EXPECT_THAT(refusal(changed([](DatasetHeader& now) { now.command += " --trials 3"; })),
              mentions({"command", "slipbench sweep a.yaml"}));
  EXPECT_EQ(all_bytes(), before);
}

TEST_F(ResumeTest, RunThatIsWritingIsLeftAlone) {
  const DatasetWriter writer(path("out.h5"), header, 1);
  EXPECT_THAT(refusal_of([&] { KeptTrials(path("out.h5"), header); }), mentions({"another run"}));
}

TEST_F(ResumeTest, RunThatGoesOnIsLeftAlone) {
  for (const bool killed : {true, false}) {
    killed ? kill(3) : interrupt(3);
    const std::vector<std::string> before = all_bytes();
    {
      const KeptTrials first(path("out.h5"), header);
      EXPECT_THAT(refusal_of([&] { KeptTrials(path("out.h5"), header); }), mentions({"another run"}));
      EXPECT_THAT(refusal_of([&] { DatasetWriter(path("out.h5"), header, trials); }), mentions({"another run"}));
      EXPECT_EQ(first.size(), 3U);
    }
    EXPECT_EQ(KeptTrials(path("out.h5"), header).size(), 3U);
    for (const std::string& name : names()) std::filesystem::remove(path(name));
  }
}

TEST_F(ResumeTest, FilesOfTheSceneAreTheSame) {
  const std::string digest(64, 'a');
  DatasetHeader named = header;
  named.files = {{"mine.so", digest}, {"model.xml", digest}};
  const TrialRecord record = make_grasp_record(0, rows);
  {
    DatasetWriter writer(path("out.h5"), named, trials);
    TrialEncoder encoder;
    writer.append(encoder.encode(record));
    writer.keep_partial();
  }
  EXPECT_EQ(DatasetReader(path("out.partial.h5")).header().files, named.files);
  EXPECT_EQ(KeptTrials(path("out.h5"), named).size(), 1U);
  const auto refusal = [&](const std::map<std::string, std::string>& files) {
    DatasetHeader now = named;
    now.files = files;
    return refusal_of([&] { KeptTrials(path("out.h5"), now); });
  };
  EXPECT_THAT(refusal({{"mine.so", std::string(64, 'b')}, {"model.xml", digest}}), mentions({"mine.so", "changed"}));
  EXPECT_THAT(refusal({{"mine.so", digest}}), mentions({"model.xml", "scene"}));
  EXPECT_THAT(refusal({{"a.so", digest}, {"mine.so", digest}, {"model.xml", digest}}), mentions({"a.so"}));
}

// The first file could not be finished, the later ones were: they say that they are complete.
TEST_F(ResumeTest, LaterFilesDoNotMakeADatasetComplete) {
  const std::vector<std::string> expected = undisturbed();
  run(trials, [](DatasetWriter& writer) { writer.commit(); });
  const std::size_t files = names().size();
  ASSERT_GE(files, 2U);
  std::filesystem::create_directory(path("later"));
  for (std::size_t k = 1; k < files; ++k)
    std::filesystem::rename(shard_path(path("out.h5"), k), shard_path(path("later/out.h5"), k));
  std::filesystem::remove(path("out.h5"));
  interrupt(trials);
  const std::string kept = kept_path(path("out.h5"));
  for (std::size_t k = 1; k < files; ++k) std::filesystem::rename(shard_path(path("later/out.h5"), k), shard_path(kept, k));
  std::filesystem::remove(path("later"));
  EXPECT_FALSE(DatasetReader(kept).complete());
  run(trials, [](DatasetWriter& writer) { writer.commit(); });
  EXPECT_EQ(all_bytes(), expected);
}

TEST_F(ResumeTest, WholeDatasetIsComplete) {
  EXPECT_FALSE(finished_dataset(path("out.h5"), header));
  run(trials, [](DatasetWriter& writer) {
    writer.add_failed({trials, "unstable", "slipbench run"});
    writer.commit();
  });
  const std::optional<FinishedDataset> whole = finished_dataset(path("out.h5"), header);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->trials, trials);
  EXPECT_EQ(whole->failed.size(), 1U);
  EXPECT_EQ(whole->files.size(), names().size());
  DatasetHeader other = header;
  other.seed = 8;
  EXPECT_FALSE(finished_dataset(path("out.h5"), other));
  EXPECT_FALSE(finished_dataset(path("no.h5"), header));
  // Of another run it is not replaced.
  EXPECT_THAT(refusal_of([&] { KeptTrials(path("out.h5"), other); }), mentions({"out.h5", "seed 7"}));
}

// The run is killed between the end of its files and their renaming.
TEST_F(ResumeTest, WholeFilesGetTheirNames) {
  const std::vector<std::string> expected = undisturbed();
  for (const bool all : {true, false}) {
    run(trials, [](DatasetWriter& writer) { writer.commit(); });
    const std::vector<std::string> files = names();
    ASSERT_GE(files.size(), 2U);
    for (const std::string& name : files) {
      // The later files are renamed first.
      if (all || name == "out.h5") std::filesystem::rename(path(name), temporary_path(path(name)));
    }
    EXPECT_THAT(refusal_of([&] { DatasetWriter(path("out.h5"), header, trials, several); }), HasSubstr("--resume"));
    EXPECT_EQ(KeptTrials(path("out.h5"), header).size(), 0U);
    EXPECT_EQ(all_bytes(), expected);
    EXPECT_TRUE(finished_dataset(path("out.h5"), header));
    for (const std::string& name : names()) std::filesystem::remove(path(name));
  }
}

// What a trial's digest does not cover any more is not written again under a new one.
TEST_F(ResumeTest, DamagedTrialIsNotKept) {
  run(
      3, [](DatasetWriter& writer) { writer.keep_partial(); }, DatasetWriter::default_shard_limit);
  const hid_t file = H5Fopen(path("out.partial.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t labels = H5Oopen(file, "/data/demo_1/labels/pad", H5P_DEFAULT);
  const hid_t attribute = H5Aopen(labels, "onset_time_s", H5P_DEFAULT);
  const std::array<double, 2> onsets{1.2345, 1.2345};
  ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, onsets.data()), 0);
  H5Aclose(attribute);
  H5Oclose(labels);
  H5Fclose(file);
  const KeptTrials kept(path("out.h5"), header);
  EXPECT_EQ(kept.size(), 3U);
  EXPECT_FALSE(kept.read(1));
  EXPECT_TRUE(kept.read(2));
}

// The list of a file is one block, however long the names in it.
TEST_F(ResumeTest, TrialsOfFiveDigitsAreKept) {
  const int status = in_child([&] {
    DatasetWriter writer(path("out.h5"), header, 12'000);
    for (std::size_t k = 9'000; k < 11'000; ++k) {
      TrialRecord record = make_record(k, 1);
      record.sensors.clear();
      record.body_time.clear();
      record.bodies.clear();
      writer.append(TrialEncoder().encode(record));
      if (k % 100 == 99) writer.publish();
    }
    ::raise(SIGKILL);
  });
  ASSERT_TRUE(WIFSIGNALED(status));
  const DatasetReader reader(path("out.h5.partial"));
  ASSERT_EQ(reader.trials().size(), 2'000U);
  for (const std::size_t trial : reader.trials()) EXPECT_EQ(reader.read_trial(trial).outcome.touch_time, 0.125);
}

TEST_F(ResumeTest, FailedTrialsAreInEveryFile) {
  run(trials, [](DatasetWriter& writer) {
    writer.add_failed({9, "trial 9: unstable", "slipbench run a.yaml --trial 9"});
    writer.commit();
  });
  ASSERT_GE(names().size(), 2U);
  for (const std::string& name : names()) {
    const std::optional<FileAbout> about = file_about(path(name));
    ASSERT_EQ(about->failed.size(), 1U);
    EXPECT_EQ(about->failed[0].trial, 9U);
    EXPECT_EQ(about->failed[0].message, "trial 9: unstable");
    EXPECT_EQ(about->failed[0].command, "slipbench run a.yaml --trial 9");
  }
  EXPECT_EQ(DatasetReader(path("out.h5")).failed().size(), 1U);
}

TEST(Failures, AreToldByTheirNumbers) {
  EXPECT_EQ(failures_text({}, 5), "");
  EXPECT_EQ(failures_text({{17, "", ""}}, 200), "1 of 200 trials failed: 17");
  EXPECT_EQ(failures_text({{17, "", ""}, {44, "", ""}, {90, "", ""}}, 200), "3 of 200 trials failed: 17, 44 and 90");
  const std::vector<FailedTrial> many(12, {7, "", ""});
  EXPECT_EQ(failures_text(many, 200), "12 of 200 trials failed: 7, 7, 7, 7, 7, 7, 7, 7, 7, 7 and 2 more");
}

}  // namespace
}  // namespace slipbench::testing::resume_test
