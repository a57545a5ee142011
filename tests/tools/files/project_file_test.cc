#include "tools/files/project/project_file.h"

#include "tests/expect.h"

namespace slipbench {
namespace {

TEST(ProjectFile, IsThereOrSaysWhereItWasLookedFor) {
  EXPECT_TRUE(project_file("scenes/papillarray/hexapod.yaml").ends_with("scenes/papillarray/hexapod.yaml"));
  EXPECT_THAT(refusal_of([] { project_file("nowhere/nothing.yaml"); }), HasSubstr("nowhere/nothing.yaml"));
}

TEST(ProjectFile, AShippedSceneHasAName) {
  for (const char* name : {"papillarray/hexapod.yaml", "scenes/papillarray/hexapod.yaml"})
    EXPECT_TRUE(scene_path(name).ends_with("/scenes/papillarray/hexapod.yaml")) << name;
  for (const char* name : {"nowhere.yaml", "papillarray", "README.md", "/papillarray/hexapod.yaml", "", "-"})
    EXPECT_EQ(scene_path(name), name);
}

}  // namespace
}  // namespace slipbench
