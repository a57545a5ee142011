#include "sim/mujoco/mujoco_call.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// A call's thread-local record must end with the call: a later error of MuJoCo outside any call
// would jump into its dead frame.
TEST(MujocoCall, AnExceptionOfOurOwnEndsItToo) {
  EXPECT_THROW(call_mujoco([] { throw std::runtime_error("own"); }), std::runtime_error);
  EXPECT_EXIT(mju_error("outside of a call"), testing::ExitedWithCode(1), "ERROR: outside of a call");
}

}  // namespace
}  // namespace slipbench
