#include "sim/core/own_library.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

TEST(OwnLibrary, StandsByTheProgramsFolder) {
  const std::filesystem::path program = std::filesystem::canonical("/proc/self/exe");
  EXPECT_EQ(own_path("a.txt"), (program.parent_path() / "a.txt").string());
  EXPECT_EQ(own_path("../lib/a.so"), (program.parent_path().parent_path() / "lib/a.so").string());
}

TEST(OwnLibrary, ThatIsMissingIsNamedWithWhatHelps) {
  try {
    own_symbol("../lib/gone.so", "make", "allowed: another build");
    FAIL() << "found";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::StartsWith("cannot load a library: " + own_path("../lib/gone.so")),
                                             testing::EndsWith("; allowed: another build")));
  }
}

}  // namespace
}  // namespace slipbench
