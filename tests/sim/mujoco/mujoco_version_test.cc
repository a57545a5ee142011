#include "sim/mujoco/mjcf.h"

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// The pin is written once, in cmake/SlipbenchDependencies.cmake; the library says its version itself.
TEST(MujocoVersion, LoadedLibraryIsThePinnedOne) { EXPECT_EQ(mujoco_library_version(), SLIPBENCH_MUJOCO_VERSION); }

TEST(MujocoVersion, HeadersAreOfTheLoadedLibrary) { EXPECT_TRUE(mujoco_header_matches_library()); }

}  // namespace
}  // namespace slipbench
