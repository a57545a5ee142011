#include "tools/files/output_file.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/dataset/record/test_records.h"

namespace slipbench {
namespace {

TEST(ScratchFolders, GoWithAllThatLiesInThem) {
  std::string path;
  {
    const ScratchFolder folder, other;
    path = folder.path();
    EXPECT_NE(path, other.path());
    EXPECT_TRUE(std::filesystem::is_empty(path));
    EXPECT_EQ(folder.file("a.h5"), path + "/a.h5");
    std::filesystem::create_directory(folder.file("deep"));
    std::ofstream(folder.file("deep/a.txt")) << "text";
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

// Not even root can make a folder in /proc.
TEST(ScratchFolders, SayWhereTheyCannotBeMade) {
  const char* const previous = std::getenv("TMPDIR");
  const std::string before = previous == nullptr ? "" : previous;
  ::setenv("TMPDIR", "/proc", 1);
  const std::string message = refusal_of([] { const ScratchFolder folder; });
  previous == nullptr ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before.c_str(), 1);
  EXPECT_THAT(message, HasSubstr(" /proc/slipbench-"));
}

}  // namespace
}  // namespace slipbench
