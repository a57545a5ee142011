// Rules for replacing and removing files: the user's files, other datasets and links are kept.
#include <sys/stat.h>

#include <hdf5.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/writer.h"
#include "tools/files/output_file.h"

namespace slipbench::testing::target_test {
namespace {

constexpr std::size_t rows = 400;
constexpr std::uint64_t several = 100'000;  // bytes: eight trials fill more than one file

struct TargetTest : FolderTest {
  // A dataset of another seed is a different dataset.
  std::vector<std::string> write(const std::string& name, std::size_t trials, std::uint64_t limit = several,
                                 std::uint64_t seed = 7) {
    DatasetWriter writer(path(name), {"1.2.3", "scene", "{}", seed, "slipbench sweep a.yaml"}, limit);
    for (std::size_t k = 0; k < trials; ++k) writer.append(make_trial(k, rows));
    return writer.commit();
  }
  std::string refusal(const std::string& name) {
    return refusal_of([&] { DatasetWriter writer(path(name), {}); });
  }
  void write_text(const std::string& name, const std::string& text) { std::ofstream(path(name)) << text; }
  // HDF5 of another program.
  void write_foreign(const std::string& name) {
    const hid_t file = H5Fcreate(path(name).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, "robot", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Fclose(file);
  }
};

TEST_F(TargetTest, LinkUnderTheFoldersNameIsNotFollowed) {
  std::filesystem::create_directory(path("precious"));
  std::filesystem::create_directory_symlink(path("precious"), path("out.h5.partial"));
  EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5.partial"), "folder"}));
  EXPECT_TRUE(std::filesystem::is_empty(path("precious")));
}

TEST_F(TargetTest, FileUnderTheFoldersNameIsKept) {
  write_text("out.h5.partial", "precious");
  EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5"), path("out.h5.partial"), "folder"}));
  EXPECT_EQ(bytes_of(path("out.h5.partial")), "precious");
}

TEST_F(TargetTest, FolderOfTheUserIsKept) {
  std::filesystem::create_directory(path("out.h5.partial"));
  write_text("out.h5.partial/notes.partial", "precious");
  EXPECT_THAT(refusal("out.h5"), HasSubstr("exists and was not made by a run"));
  EXPECT_EQ(bytes_of(path("out.h5.partial/notes.partial")), "precious");
  std::filesystem::remove(path("out.h5.partial/notes.partial"));
  write("out.h5", 1);  // an empty one is equivalent to a new one
  EXPECT_THAT(names(), ElementsAre("out.h5"));
}

TEST_F(TargetTest, FileOfAnotherProgramIsKept) {
  write_foreign("out.h5");
  const std::string before = bytes_of(path("out.h5"));
  EXPECT_THAT(refusal("out.h5"), mentions({path("out.h5"), "dataset"}));
  EXPECT_EQ(bytes_of(path("out.h5")), before);
}

TEST_F(TargetTest, LaterFileOfADatasetIsNotReplacedAlone) {
  ASSERT_GE(write("out.h5", 8).size(), 2U);
  EXPECT_THAT(refusal("out-0001.h5"), mentions({"file 1", "another dataset"}));
  EXPECT_EQ(DatasetReader(path("out.h5")).trials().size(), 8U);
}

// The number of files is known only while they are written. For each obstacle, a word of the error.
TEST_F(TargetTest, FileInTheWayOfALaterOneIsKept) {
  write_text("out-0001.h5", "my notes");
  const std::string message = refusal_of([&] { write("out.h5", 8); });
  EXPECT_THAT(message, mentions({path("out.h5"), path("out-0001.h5"), "file 1"}));
  EXPECT_EQ(bytes_of(path("out-0001.h5")), "my notes");
  EXPECT_THAT(names(), ElementsAre("out-0001.h5"));
  // A run that needs no second file ignores it.
  write("out.h5", 1);
  EXPECT_THAT(names(), ElementsAre("out-0001.h5", "out.h5"));
}

TEST_F(TargetTest, DatasetOfItsOwnInTheWayIsKept) {
  write("out-0001.h5", 1);
  EXPECT_THAT(refusal_of([&] { write("out.h5", 8); }), HasSubstr("exists and is file 0 of another dataset"));
  EXPECT_EQ(DatasetReader(path("out-0001.h5")).trials().size(), 1U);
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
  // A hard link is a regular file: it is replaced, not written through.
  std::filesystem::remove(path("a.txt.partial"));
  std::filesystem::create_hard_link(path("precious.txt"), path("a.txt.partial"));
  write_text_file(path("a.txt"), "note");
  EXPECT_EQ(bytes_of(path("precious.txt")), "precious");
  EXPECT_EQ(bytes_of(path("a.txt")), "note");
}

TEST_F(TargetTest, TextsAppearTogetherOrNotAtAll) {
  ::mkdir(path("b.txt.partial").c_str(), 0777);  // the second file cannot be written
  EXPECT_THAT(refusal_of([&] {
                write_text_files({{path("a.txt"), "1"}, {path("b.txt"), "2"}});
              }),
              HasSubstr("cannot write " + path("b.txt")));
  EXPECT_FALSE(std::filesystem::exists(path("a.txt")));
  EXPECT_FALSE(std::filesystem::exists(path("a.txt.partial")));
  std::filesystem::remove(path("b.txt.partial"));
  write_text_files({{path("a.txt"), "1"}, {path("b.txt"), "2"}});
  EXPECT_EQ(bytes_of(path("a.txt")) + bytes_of(path("b.txt")), "12");
}

}  // namespace
}  // namespace slipbench::testing::target_test
