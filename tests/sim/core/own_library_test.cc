#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "sim/core/process/interrupted.h"
#include "sim/core/process/own_library.h"
#include "sim/core/process/regular_file.h"
#include "tests/expect.h"

namespace slipbench {
namespace {

TEST(OwnLibrary, StandsByTheProgramsFolder) {
  const std::filesystem::path program = std::filesystem::canonical("/proc/self/exe");
  EXPECT_EQ(own_path("a.txt"), (program.parent_path() / "a.txt").string());
  EXPECT_EQ(own_path("../lib/a.so"), (program.parent_path().parent_path() / "lib/a.so").string());
}

TEST(OwnLibrary, ThatIsMissingIsNamedWithWhatHelps) {
  EXPECT_THAT(refusal_of([&] { own_symbol("../lib/gone.so", "make", "allowed: another build"); }),
              mentions({own_path("../lib/gone.so"), "allowed: another build"}));
}

std::string refusal(const std::string& path, std::uintmax_t most) {
  return refusal_of([&] { check_regular_file(path, most); });
}

TEST(RegularFile, RefusesWhatIsNone) {
  const std::string name = testing::TempDir() + "slipbench_regular_" + std::to_string(getpid());
  EXPECT_EQ(refusal(name, 3), "accepted");  // no such file: opening it reports that
  ASSERT_EQ(mkfifo(name.c_str(), 0600), 0);
  EXPECT_THAT(refusal(name, 3), refused_at(name, {"pipe"}));
  std::filesystem::remove(name);
  EXPECT_THAT(refusal("/dev/null", 3), refused_at("/dev/null", {"device"}));
  EXPECT_THAT(refusal("/tmp", 3), refused_at("/tmp", {"folder"}));
  std::ofstream(name) << "abc";
  EXPECT_EQ(refusal(name, 3), "accepted");
  EXPECT_THAT(refusal(name, 2), refused_at(name, {"3 bytes", "2"}));
  std::filesystem::remove(name);
}

TEST(Interrupted, EndsTheWorkOfTheThreadThatHasTheScope) {
  std::atomic<bool> interrupt{false};
  const InterruptScope scope(&interrupt);
  EXPECT_NO_THROW(end_if_interrupted());
  interrupt = true;
  EXPECT_THROW(end_if_interrupted(), Interrupted);
  std::thread([] { EXPECT_NO_THROW(end_if_interrupted()); }).join();
}

TEST(Interrupted, ScopesNest) {
  const std::atomic<bool> interrupt{true};
  EXPECT_NO_THROW(end_if_interrupted());
  {
    const InterruptScope outer(&interrupt);
    {
      const InterruptScope inner(nullptr);
      EXPECT_NO_THROW(end_if_interrupted());
    }
    EXPECT_THROW(end_if_interrupted(), Interrupted);
  }
  EXPECT_NO_THROW(end_if_interrupted());
}

}  // namespace

}  // namespace slipbench
