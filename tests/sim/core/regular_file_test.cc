#include "sim/core/process/regular_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/expect.h"

namespace slipbench {
namespace {

std::string refusal(const std::string& path, std::uintmax_t most) {
  return refusal_of([&] { check_regular_file(path, most); });
}

TEST(RegularFile, RefusesWhatIsNone) {
  const std::string name = testing::TempDir() + "slipbench_regular_" + std::to_string(getpid());
  EXPECT_EQ(refusal(name, 3), "accepted");  // nothing there: opening it says so
  ASSERT_EQ(mkfifo(name.c_str(), 0600), 0);
  EXPECT_EQ(refusal(name, 3), name + ": is a pipe, no file");
  std::filesystem::remove(name);
  EXPECT_EQ(refusal("/dev/null", 3), "/dev/null: is a device, no file");
  EXPECT_EQ(refusal("/tmp", 3), "/tmp: is a folder, no file");
  std::ofstream(name) << "abc";
  EXPECT_EQ(refusal(name, 3), "accepted");
  EXPECT_EQ(refusal(name, 2), name + ": has 3 bytes; allowed: at most 2");
  std::filesystem::remove(name);
}

}  // namespace
}  // namespace slipbench
