#include "sim/core/process/own_library.h"

#include <filesystem>

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
              AllOf(StartsWith("cannot load a library: " + own_path("../lib/gone.so")), EndsWith("; allowed: another build")));
}

}  // namespace
}  // namespace slipbench
