#include "sim/mujoco/mjcf.h"

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// The pinned version is in cmake/SlipbenchDependencies.cmake only; the library reports its own
// version.
TEST(MujocoVersion, LoadedLibraryIsThePinnedOne) { EXPECT_EQ(mujoco_library_version(), SLIPBENCH_MUJOCO_VERSION); }

TEST(MujocoVersion, HeadersAreOfTheLoadedLibrary) { EXPECT_TRUE(mujoco_header_matches_library()); }

}  // namespace
}  // namespace slipbench
