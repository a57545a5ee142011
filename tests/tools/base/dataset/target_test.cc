// What a run may replace and remove: the user's files, other datasets and links stay.
#include <sys/stat.h>

#include <hdf5.h>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/dataset/writer.h"
#include "tools/base/files/output_file.h"

namespace slipbench::testing::target_test {
namespace {

constexpr std::size_t rows = 400;
constexpr std::uint64_t several = 100'000;  // bytes: eight trials fill more than one file

struct TargetTest : FolderTest {
  // A dataset of another seed is another one.
  std::vector<std::string> write(const std::string& name, std::size_t trials, std::uint64_t limit = several,
                                 std::uint64_t seed = 7) {
    DatasetWriter writer(path(name), {"1.2.3", "scene", "{}", seed, "slipbench sweep a.yaml"}, trials, limit);
    for (std::size_t k = 0; k < trials; ++k) writer.append(make_trial(k, rows));
    return writer.commit();
  }
  std::string refusal(const std::string& name, std::size_t planned = 1) {
    return refusal_of([&] { DatasetWriter writer(path(name), {}, planned); });
  }
  void write_text(const std::string& name, const std::string& text) { std::ofstream(path(name)) << text; }
  // HDF5 of another program.
  void write_foreign(const std::string& name) {
    const hid_t file = H5Fcreate(path(name).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, "robot", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(file);
  }
};

TEST_F(TargetTest, LinkUnderTheTemporaryNameIsNotFollowed) {
  write_text("precious.txt", "precious");
  std::filesystem::create_symlink(path("precious.txt"), path("out.h5.partial"));
  EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5.partial"), "symbolic link", path("precious.txt")}));
  EXPECT_EQ(bytes_of(path("precious.txt")), "precious");
}

TEST_F(TargetTest, FileUnderTheTemporaryNameIsKept) {
  write_text("out.h5.partial", "precious");
  EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5"), path("out.h5.partial"), "dataset"}));
  EXPECT_EQ(bytes_of(path("out.h5.partial")), "precious");
}

TEST_F(TargetTest, LeftoverWithoutATrialIsReplaced) {
  write_text("out.h5.partial", "");
  write("out.h5", 1);
  write_text("out.h5.partial", std::string(600, '\0'));  // killed before it had a superblock
  write("out.h5", 2, DatasetWriter::default_shard_limit);
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), 2U);
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(TargetTest, UnreadableLeftoverIsKept) {
  write("out.h5", 1);
  write_text("out.h5.partial", bytes_of(path("out.h5")).substr(0, 600));
  EXPECT_THAT(refusal("out.h5"), mentions({"read", path("out.h5.partial")}));
  EXPECT_EQ(bytes_of(path("out.h5.partial")).size(), 600U);
}

// A dataset that is whole goes only where the user names it, whatever it is called.
TEST_F(TargetTest, WholeDatasetIsNoLeftover) {
  write("out.partial.h5", 1, DatasetWriter::default_shard_limit);
  const std::string before = file_sha256(path("out.partial.h5"));
  EXPECT_THAT(refusal("out.h5"), mentions({"complete", path("out.partial.h5")}));
  EXPECT_EQ(file_sha256(path("out.partial.h5")), before);
  EXPECT_THAT(names(), ElementsAre("out.partial.h5"));
}

TEST_F(TargetTest, WholeDatasetThatCameMeanwhileIsNotRemoved) {
  DatasetWriter writer(path("out.h5"), {}, 1);
  writer.append(make_trial(0, rows));
  write("other.h5", 1);
  std::filesystem::rename(path("other.h5"), path("out.partial.h5"));
  writer.commit();
  EXPECT_THAT(names(), ElementsAre("out.h5", "out.partial.h5"));
}

// Finished work is thrown away by nobody but its owner.
TEST_F(TargetTest, TrialsOfAnInterruptedRunAreKept) {
  {
    DatasetWriter writer(path("out.h5"), {}, 3);
    for (std::size_t k = 0; k < 3; ++k) writer.append(make_trial(k, rows));
    writer.keep_partial();
  }
  const std::string before = file_sha256(path("out.partial.h5"));
  for (const std::string name : {"out.partial.h5", "out.h5.partial"}) {
    std::filesystem::rename(path(names().front()), path(name));
    EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5"), path(name), "3 trials", "--resume"}));
    EXPECT_EQ(file_sha256(path(name)), before);
  }
}

TEST_F(TargetTest, FileOfAnotherProgramIsKept) {
  write_foreign("out.h5");
  const std::string before = bytes_of(path("out.h5"));
  EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5"), "dataset"}));
  EXPECT_EQ(bytes_of(path("out.h5")), before);
}

// 2001 trials need a second file, which is looked at before the run begins.
TEST_F(TargetTest, FileInTheWayOfALaterOneIsKept) {
  write_text("out-0001.h5", "my notes");
  EXPECT_THAT(refusal("out.h5", 2001), mentions({path("out.h5"), path("out-0001.h5"), "file 1", "dataset"}));
  for (const std::string in_the_way : {"out-0001.h5.partial", "out.partial-0001.h5"}) {
    std::filesystem::rename(path(names().front()), path(in_the_way));
    EXPECT_THAT(refusal("out.h5", 2001), mentions({path(in_the_way)}));
    EXPECT_EQ(bytes_of(path(in_the_way)), "my notes");
  }
  EXPECT_THAT(names(), ElementsAre("out.partial-0001.h5"));
}

TEST_F(TargetTest, DatasetOfItsOwnInTheWayIsKept) {
  write("out-0001.h5", 1);
  EXPECT_THAT(refusal("out.h5", 2001), mentions({"file 1", "file 0", "another dataset"}));
  EXPECT_EQ(DatasetReader(path("out-0001.h5")).trials().size(), 1U);
}

TEST_F(TargetTest, LaterFileOfADatasetIsNotReplacedAlone) {
  ASSERT_GE(write("out.h5", 8).size(), 2U);
  EXPECT_THAT(refusal("out-0001.h5"), mentions({"file 1", "another dataset"}));
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), 8U);
}

// How many files large trials need shows only while they are written.
TEST_F(TargetTest, FileMetDuringTheRunIsKept) {
  write_text("out-0001.h5", "my notes");
  const std::string message = refusal_of([&] { write("out.h5", 8); });
  EXPECT_THAT(message, mentions({path("out.h5"), path("out-0001.h5"), "file 1"}));
  EXPECT_EQ(bytes_of(path("out-0001.h5")), "my notes");
  EXPECT_THAT(names(), ElementsAre("out-0001.h5", "out.partial.h5"));
  EXPECT_GE(DatasetReader(path("out.partial.h5")).trials().size(), 1U);
  // A run that needs no second file does not mind.
  std::filesystem::remove(path("out.partial.h5"));
  write("out.h5", 1);
  EXPECT_THAT(names(), ElementsAre("out-0001.h5", "out.h5"));
}

TEST_F(TargetTest, DatasetOfSeveralFilesIsReplacedWhole) {
  ASSERT_GE(write("out.h5", 8).size(), 3U);
  EXPECT_GE(write("out.h5", 8).size(), 3U);
  EXPECT_EQ(write("out.h5", 1).size(), 1U);
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(TargetTest, LaterFileOfAnotherDatasetStays) {
  ASSERT_GE(write("out.h5", 8).size(), 2U);
  ASSERT_GE(write("other.h5", 8, several, 8).size(), 2U);
  std::filesystem::rename(path("other-0001.h5"), path("out-0001.h5"));
  write("out.h5", 1);
  EXPECT_TRUE(std::filesystem::exists(path("out-0001.h5")));
}

const TextKind kind{"note", [](std::string_view text) { return text.starts_with("note"); }};

TEST_F(TargetTest, TextReplacesOnlyItsOwnKind) {
  const auto refused = [&] { return refusal_of([&] { check_text_target(path("a.txt"), {path("a.h5")}, kind); }); };
  check_text_target(path("a.txt"), {path("a.h5")}, kind);
  for (const std::string name : {"a.txt", "a.txt.partial"}) {
    write_text(name, "slipbench: 1\n");
    EXPECT_THAT(refused(), mentions({path("a.txt"), path(name), "note"}));
    write_text(name, "");
    check_text_target(path("a.txt"), {path("a.h5")}, kind);
    write_text(name, "note 1");
    check_text_target(path("a.txt"), {path("a.h5")}, kind);
    std::filesystem::remove(path(name));
    std::filesystem::create_symlink(path("note.txt"), path(name));
    EXPECT_THAT(refused(), mentions({path(name), "symbolic link", path("note.txt")}));
    std::filesystem::remove(path(name));
    ::mkdir(path(name).c_str(), 0777);
    EXPECT_THAT(refused(), mentions({"folder"}));
    std::filesystem::remove(path(name));
  }
}

TEST_F(TargetTest, TextDoesNotFollowALinkThatCameMeanwhile) {
  write_text("precious.txt", "precious");
  std::filesystem::create_symlink(path("precious.txt"), path("a.txt.partial"));
  EXPECT_THAT(refusal_of([&] { write_text_file(path("a.txt"), "note"); }), HasSubstr("cannot write " + path("a.txt")));
  EXPECT_EQ(bytes_of(path("precious.txt")), "precious");
  EXPECT_FALSE(std::filesystem::exists(path("a.txt")));
}

}  // namespace
}  // namespace slipbench::testing::target_test
