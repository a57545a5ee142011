// The dataset of a sweep: batches, their state after an end at any instant, and the continuation.
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <functional>
#include <map>

#include <hdf5.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/batches.h"
#include "tools/dataset/finished_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/files/output_file.h"

namespace slipbench::testing::batches_test {
namespace {

// Called with the path of each file and folder before it is synced.
std::function<void(const std::string&)> before_sync;

}  // namespace
}  // namespace slipbench::testing::batches_test

// Replaces the C library's in this program.
extern "C" int fsync(int descriptor) {
  const auto& call = slipbench::testing::batches_test::before_sync;
  if (call) call(std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor)).string());
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

namespace slipbench::testing::batches_test {
namespace {

const DatasetHeader header{"1.2.3", "slipbench: 1\nseed: 7\n", "{}", 7, "slipbench sweep a.yaml"};
constexpr std::size_t rows = 400;
constexpr std::size_t trials = 9;
constexpr std::uint64_t several = 200'000;  // bytes: nine trials fill more than one file

std::string params_of(const TrialRecord& record) { return record.params; }

struct BatchesTest : FolderTest {
  static void append(SweepWriter& writer, std::size_t begin, std::size_t end) {
    TrialEncoder encoder;
    for (std::size_t k = begin; k < end; ++k) writer.append(encoder.encode(make_grasp_record(k, rows)));
  }
  // Writes the trials up to `end` in batches of two, continuing with existing ones, and then calls
  // `finish`.
  std::size_t run(std::size_t end, const std::function<void(SweepWriter&)>& finish, std::uint64_t limit = several) {
    SweepWriter writer(path("out.h5"), header, limit);
    const std::map<std::size_t, std::string> held = writer.resume(&params_of);
    TrialEncoder encoder;
    for (std::size_t k = 0; k < end; ++k) {
      if (!held.contains(k)) writer.append(encoder.encode(make_grasp_record(k, rows)));
      if (k % 2 == 1) writer.finish_batch();
    }
    finish(writer);
    return held.size();
  }
  static void commit(SweepWriter& writer) { writer.commit(); }
  static void keep(SweepWriter& writer) { writer.keep(); }
  // Returns the status of a process that is killed after `end` trials.
  int kill(std::size_t end) {
    return in_child([&] { run(end, [](SweepWriter&) { ::raise(SIGKILL); }); });
  }
  std::vector<std::string> digests() { return DatasetReader(path("out.h5")).content_sha256(); }
  // Digests of an undisturbed run.
  std::vector<std::string> undisturbed() {
    run(trials, &commit);
    const std::vector<std::string> expected = digests();
    for (const std::string& name : names()) std::filesystem::remove(path(name));
    return expected;
  }
  std::string batch(std::size_t k) { return shard_path(path("out.h5.partial/batch.h5"), k); }
};

TEST_F(BatchesTest, JoinedBatchesAreTheDatasetOfOne) {
  const std::vector<std::string> expected = undisturbed();
  ASSERT_GE(expected.size(), 2U);
  SweepWriter writer(path("out.h5"), header, several);
  append(writer, 0, trials);  // a single batch, split into files
  writer.commit();
  EXPECT_EQ(digests(), expected);
  EXPECT_THAT(names(), Not(Contains("out.h5.partial")));
}

TEST_F(BatchesTest, OneBatchBecomesTheDataset) {
  SweepWriter writer(path("out.h5"), header);
  append(writer, 0, trials);
  EXPECT_THAT(writer.commit(), ElementsAre(path("out.h5")));
  const std::vector<std::string> expected = digests();
  std::filesystem::remove(path("out.h5"));
  run(trials, &commit, DatasetWriter::default_shard_limit);
  EXPECT_EQ(digests(), expected);
  EXPECT_EQ(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_FILE), 0);
}

TEST_F(BatchesTest, GivesTheContentOfAnUndisturbedRun) {
  const std::vector<std::string> expected = undisturbed();
  for (std::size_t first = 0; first < trials; ++first) {
    if (first % 2 == 0) {
      EXPECT_TRUE(WIFSIGNALED(kill(first)));
      EXPECT_EQ(run(std::min(trials, first + 1), &keep), first);
    } else {
      run(first, &keep);
      EXPECT_TRUE(WIFSIGNALED(kill(std::min(trials, first + 1))));
    }
    EXPECT_GE(run(trials, &commit), first);
    EXPECT_EQ(digests(), expected) << first;
    EXPECT_THAT(names(), Not(Contains("out.h5.partial")));
    for (const std::string& name : names()) std::filesystem::remove(path(name));
  }
}

// Finished batches are a readable dataset even before the run ends.
TEST_F(BatchesTest, BatchesAreReadAsOneDataset) {
  ASSERT_TRUE(WIFSIGNALED(kill(7)));
  const DatasetReader reader(batch(0));
  EXPECT_FALSE(reader.complete());
  EXPECT_EQ(reader.files().size(), 3U);
  ASSERT_EQ(reader.trials().size(), 6U);
  EXPECT_THAT(reader.mask("train"), IsEmpty());
  for (const std::size_t trial : reader.trials())
    EXPECT_EQ(reader.read<float>(trial, "labels/pad/force"), make_record(trial, rows).sensors[0].labels.force);
}

TEST_F(BatchesTest, ALargeBatchIsFinishedByItself) {
  constexpr std::uint64_t limit = 1'000'000;
  SweepWriter writer(path("out.h5"), header, DatasetWriter::default_shard_limit, limit);
  EXPECT_FALSE(writer.due());
  append(writer, 0, 25);
  EXPECT_LE(*writer.due(), std::chrono::steady_clock::now() + SweepWriter::batch_time);
  EXPECT_GE(writer.finished(), 10U);
  EXPECT_LT(writer.finished(), 25U);
  const std::vector<std::string> batches = writer.keep();
  EXPECT_GE(batches.size(), 3U);
  for (const std::string& name : batches) EXPECT_LE(std::filesystem::file_size(name), limit);
}

// After a power failure, a file has its content if it was synced, and its name if the folder was
// synced afterwards.
TEST_F(BatchesTest, ABatchIsSyncedBeforeItIsNamedAndItsFolderAfterwards) {
  const std::string folder = std::filesystem::canonical(path("")).string() + "/out.h5.partial";
  SweepWriter writer(path("out.h5"), header);
  append(writer, 0, 1);
  std::vector<std::string> synced;
  std::vector<bool> named;
  before_sync = [&](const std::string& name) {
    synced.push_back(name);
    named.push_back(std::filesystem::exists(batch(0)));
  };
  writer.finish_batch();
  before_sync = nullptr;
  ASSERT_EQ(synced.size(), 2U);
  EXPECT_EQ(std::filesystem::path(synced[0]).parent_path(), folder);
  EXPECT_EQ(synced[1], folder);
  EXPECT_THAT(named, ElementsAre(false, true));
}

TEST_F(BatchesTest, NothingLeftIsNothingKept) {
  EXPECT_EQ(run(0, &keep), 0U);
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(BatchesTest, FinishedTrialsAreNotThrownAway) {
  run(3, &keep);
  const auto refusal = [&] { return refusal_of([&] { SweepWriter(path("out.h5"), header).refuse_left(); }); };
  EXPECT_EQ(
      refusal(),
      "cannot write " + path("out.h5") + ": " + path("out.h5.partial") +
          " contains 2 batches of finished trials of an unfinished sweep; continue it with --resume, choose a new name, or move " +
          path("out.h5.partial") + " away");
  EXPECT_THAT(refusal_of([&] { DatasetWriter(path("out.h5"), header); }), HasSubstr("contains 2 batches"));
  EXPECT_EQ(run(3, &keep), 3U);
}

// For each property of a run: a change, and a word of the error.
TEST_F(BatchesTest, AnotherRunsTrialsAreRefusedByWhatDiffers) {
  run(3, &keep);
  const std::string before = file_sha256(batch(0));
  const std::vector<std::pair<std::function<void(DatasetHeader&)>, std::string>> changes{
      {[](DatasetHeader& now) { now.seed = 8; }, "seed 7, this run has 8"},
      {[](DatasetHeader& now) { now.scene = "slipbench: 1\nseed: 9\n"; },
       "scene with 'seed: 7' in line 2, where the scene of this run has 'seed: 9'"},
      {[](DatasetHeader& now) { now.scene = "slipbench: 1\n"; },
       "scene with 'seed: 7' in line 2, where the scene of this run ends;"},
      {[](DatasetHeader& now) { now.version = "1.2.4"; }, "version 1.2.3, this run has 1.2.4"},
      {[](DatasetHeader& now) { now.overrides = R"({"a": "1"})"; }, R"(overrides {}, this run has {"a": "1"})"},
      {[](DatasetHeader& now) { now.command += " --trials 3"; }, "command slipbench sweep a.yaml, this"},
      {[](DatasetHeader& now) {
         now.files = {{"a.so", "b"}};
       },
       "no file a.so, which"},
  };
  for (const auto& [change, word] : changes) {
    DatasetHeader now = header;
    change(now);
    EXPECT_THAT(refusal_of([&] { SweepWriter(path("out.h5"), now).resume(&params_of); }),
                AllOf(StartsWith("cannot resume " + path("out.h5") + ": " + batch(0) + " was written by another run: "),
                      HasSubstr(word)));
  }
  EXPECT_EQ(file_sha256(batch(0)), before);
}

TEST_F(BatchesTest, FilesOfTheSceneAreTheSame) {
  const std::string digest(64, 'a');
  DatasetHeader named = header;
  named.files = {{"mine.so", digest}, {"model.xml", digest}};
  {
    SweepWriter writer(path("out.h5"), named);
    append(writer, 0, 1);
    writer.keep();
  }
  EXPECT_EQ(DatasetReader(batch(0)).header().files, named.files);
  const auto refusal = [&](const std::map<std::string, std::string>& files) {
    DatasetHeader now = named;
    now.files = files;
    return refusal_of([&] { SweepWriter(path("out.h5"), now).resume(&params_of); });
  };
  EXPECT_THAT(refusal({{"mine.so", std::string(64, 'b')}, {"model.xml", digest}}), HasSubstr("mine.so has changed since then;"));
  EXPECT_THAT(refusal({{"mine.so", digest}}), HasSubstr("file model.xml, which the scene of this run does not use;"));
}

// The lock belongs to the folder: runs that write, continue or only read hold it.
TEST_F(BatchesTest, TwoRunsDoNotShareATarget) {
  const SweepWriter first(path("out.h5"), header);
  EXPECT_THAT(refusal_of([&] { SweepWriter(path("out.h5"), header); }), HasSubstr("another run is writing it"));
  EXPECT_THAT(refusal_of([&] { DatasetWriter(path("out.h5"), header); }), HasSubstr("another run is writing it"));
}

TEST_F(BatchesTest, WholeDatasetIsComplete) {
  EXPECT_FALSE(finished_dataset(path("out.h5"), header));
  run(trials, [](SweepWriter& writer) {
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
  // Another run that asks to continue must not replace it.
  EXPECT_THAT(refusal_of([&] { SweepWriter(path("out.h5"), other).resume(&params_of); }),
              HasSubstr("out.h5 was written by another run: seed 7"));
}

// A batch is not joined if a trial no longer matches its digest.
TEST_F(BatchesTest, DamagedBatchIsSimulatedAgain) {
  const std::vector<std::string> expected = undisturbed();
  for (const bool readable : {true, false}) {
    run(6, &keep);
    if (readable) {
      const hid_t file = H5Fopen(batch(1).c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
      const hid_t labels = H5Oopen(file, "/data/demo_3/labels/pad", H5P_DEFAULT);
      const hid_t attribute = H5Aopen(labels, "onset_time_s", H5P_DEFAULT);
      const std::array<double, 2> onsets{1.2345, 1.2345};
      ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, onsets.data()), 0);
      H5Aclose(attribute);
      H5Oclose(labels);
      H5Fclose(file);
    } else {
      std::filesystem::resize_file(batch(1), 1000);
    }
    {
      SweepWriter writer(path("out.h5"), header, several);
      const auto held = writer.resume(&params_of);
      EXPECT_THAT(writer.damaged(), ElementsAre(batch(1) + ".damaged"));
      EXPECT_EQ(held.size(), 4U);
      EXPECT_EQ(held.at(5), make_grasp_record(5, rows).params);
    }
    EXPECT_EQ(run(trials, &commit), 4U);  // the missing trials come first
    EXPECT_EQ(digests(), expected);
    for (const std::string& name : names()) std::filesystem::remove(path(name));
  }
}

// One flipped bit outside the trials: in a group's text.
TEST_F(BatchesTest, DamageBesideTheTrialsIsFound) {
  const std::vector<std::string> expected = undisturbed();
  run(6, &keep);
  const hid_t file = H5Fopen(batch(0).c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t groups = H5Dopen(file, "/group", H5P_DEFAULT);
  const hid_t type = H5Dget_type(groups);
  std::vector<char> texts(H5Tget_size(type) * 2);
  ASSERT_GE(H5Dread(groups, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), 0);
  texts.front() = static_cast<char>(texts.front() ^ 1);
  ASSERT_GE(H5Dwrite(groups, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), 0);
  H5Tclose(type);
  H5Dclose(groups);
  H5Fclose(file);
  EXPECT_EQ(run(trials, &commit), 4U);
  EXPECT_EQ(digests(), expected);
}

// Without a working reader the batches are not judged and stay unchanged.
TEST_F(BatchesTest, ResumeWithoutAReaderLosesNothing) {
  run(6, &keep);
  std::ofstream(path("libstdc++.so.6"));
  const int status = in_child([&] {
    ::setenv("LD_LIBRARY_PATH", path("").c_str(), 1);
    std::ofstream(path("message")) << refusal_of([&] { run(trials, &commit); });
  });
  EXPECT_EQ(status, 0);
  EXPECT_THAT(bytes_of(path("message")), StartsWith("cannot resume: " + batch(0) + ": cannot be read"));
  std::filesystem::remove(path("libstdc++.so.6"));
  EXPECT_EQ(run(trials, &commit), 6U);
}

// A copied batch adds nothing. A batch with different trials of the same numbers is refused.
TEST_F(BatchesTest, TrialsThatStandTwice) {
  const std::vector<std::string> expected = undisturbed();
  run(6, &keep);
  std::filesystem::copy_file(batch(0), batch(7));
  EXPECT_EQ(run(trials, &commit), 6U);
  EXPECT_EQ(digests(), expected);
  std::filesystem::remove(path("out.h5"));
  run(2, &keep);
  std::filesystem::rename(batch(0), path("kept"));
  {
    SweepWriter writer(path("out.h5"), header, several);
    TrialEncoder encoder;
    writer.append(encoder.encode(make_grasp_record(0, rows / 2)));
    writer.keep();
  }
  std::filesystem::rename(path("kept"), batch(7));
  EXPECT_THAT(refusal_of([&] { run(trials, &commit); }),
              AllOf(HasSubstr("trial 0 is in " + batch(0)), HasSubstr("with other content, in " + batch(7))));
}

// A limit on the file's size emulates a full disk: the write fails half-way in the same place. Nine
// trials in batches of two, each smaller than the dataset, are left.
TEST_F(BatchesTest, FullDiskKeepsTheBatches) {
  const auto commit_as_one = [&] { return run(trials, &commit, DatasetWriter::default_shard_limit); };
  commit_as_one();
  const std::vector<std::string> expected = digests();
  const std::uintmax_t whole = std::filesystem::file_size(path("out.h5"));
  std::filesystem::remove(path("out.h5"));
  for (const auto& [limit, held] : std::vector<std::pair<rlim_t, std::size_t>>{
           {100, 0}, {3'000, 0}, {whole / 9, 0}, {whole / 3, trials}, {whole / 2, trials}, {whole - 10'000, trials}}) {
    const int status = in_child([&] {
      const rlimit limits{limit, limit};
      ::setrlimit(RLIMIT_FSIZE, &limits);
      std::signal(SIGXFSZ, SIG_IGN);
      const std::string message = refusal_of(commit_as_one);
      const bool good = message.starts_with("cannot write " + path("out.h5.partial/")) && message.ends_with(": File too large");
      ::_exit(good ? 0 : 1);
    });
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0) << limit;
    EXPECT_EQ(commit_as_one(), held) << limit;
    EXPECT_EQ(digests(), expected);
    EXPECT_THAT(names(), ElementsAre("out.h5"));
    std::filesystem::remove(path("out.h5"));
  }
}

// A run killed between renaming its files and the end keeps all batches.
TEST_F(BatchesTest, KilledAtTheEndItIsJoinedAgain) {
  const std::vector<std::string> expected = undisturbed();
  run(trials, &keep);
  std::filesystem::create_directory(path("kept"));
  std::filesystem::copy(path("out.h5.partial"), path("kept"));
  run(trials, &commit);
  std::filesystem::rename(path("kept"), path("out.h5.partial"));
  EXPECT_EQ(run(trials, &commit), trials);
  EXPECT_EQ(digests(), expected);
  EXPECT_THAT(names(), Not(Contains("out.h5.partial")));
}

// More batches than a reader has files open at a time.
TEST_F(BatchesTest, ManyBatchesAreReadAndJoined) {
  constexpr std::size_t many = 150;
  {
    SweepWriter writer(path("out.h5"), header);
    for (std::size_t k = 0; k < many; ++k) {
      writer.append(make_trial(k, 1));
      writer.finish_batch();
    }
    EXPECT_EQ(writer.keep().size(), many);
  }
  const DatasetReader reader(batch(0));
  ASSERT_EQ(reader.trials().size(), many);
  for (const std::size_t trial : {std::size_t{149}, std::size_t{0}, std::size_t{75}})
    EXPECT_EQ(reader.read_trial(trial).outcome.max_slip_distance, 0.5 * static_cast<double>(trial));
  SweepWriter writer(path("out.h5"), header);
  EXPECT_EQ(writer.resume(&params_of).size(), many);
  EXPECT_EQ(writer.commit().size(), 1U);
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), many);
}

TEST_F(BatchesTest, FailedTrialsAreInEveryFile) {
  SweepWriter writer(path("out.h5"), header, several);
  append(writer, 0, trials);
  writer.add_failed({9, "trial 9: unstable", "slipbench run a.yaml --trial 9"});
  writer.commit();
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
}  // namespace slipbench::testing::batches_test
