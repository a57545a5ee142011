#include "tools/files/project/project_file.h"

#include "tests/expect.h"

namespace slipbench {
namespace {

TEST(ProjectFile, IsThereOrSaysWhereItWasLookedFor) {
  EXPECT_TRUE(project_file("scenes/papillarray/hexapod.yaml").ends_with("scenes/papillarray/hexapod.yaml"));
  EXPECT_THAT(refusal_of([] { project_file("nowhere/nothing.yaml"); }), HasSubstr("nowhere/nothing.yaml"));
}

}  // namespace
}  // namespace slipbench
