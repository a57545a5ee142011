#include "tools/studies/study_catalogue.h"

#include <set>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/base/project/project_file.h"

namespace slipbench::reproduce {
namespace {

TEST(Reproductions, AreFoundByTheirName) {
  std::set<std::string> names;
  for (const Reproduction& one : reproductions()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_EQ(&find_reproduction(one.name), &one);
  }
}

TEST(Reproductions, UnknownNamesGetTheNearest) {
  EXPECT_THAT(refusal_of([] { find_reproduction("hd-papillarray/latancy"); }),
              HasSubstr("unknown reproduction 'hd-papillarray/latancy'; did you mean 'hd-papillarray/latency'?"));
}

TEST(ProjectFile, IsThereOrSaysWhereItWasLookedFor) {
  EXPECT_TRUE(project_file("scenes/papillarray/hexapod.yaml").ends_with("scenes/papillarray/hexapod.yaml"));
  EXPECT_EQ(find_project_file("nowhere/nothing.yaml"), std::nullopt);
  EXPECT_THAT(refusal_of([] { project_file("nowhere/nothing.yaml"); }), HasSubstr("nowhere/nothing.yaml"));
}

}  // namespace
}  // namespace slipbench::reproduce
