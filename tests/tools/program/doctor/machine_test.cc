#include "tools/program/doctor/doctor.h"

#include <vector>

#include "tests/expect.h"
#include "tests/tools/program/doctor/path_folder.h"

namespace slipbench {
namespace {

using ::testing::UnorderedElementsAre;

TEST(Machine, FindsAProgramOnPathOnly) {
  PathFolder path;
  const std::string program = path.add_program("painter", "");
  EXPECT_EQ(find_program("painter"), program);
  EXPECT_EQ(find_program("sculptor"), "");
}

TEST(Machine, CountsOnlyPackagesThatAreFullyInstalled) {
  PathFolder path;
  path.add_program("dpkg-query", "one 1.0-2 installed\ntwo 2.0 config-files\nthree 3:3.0 installed");
  const std::vector<std::string> names = {"one", "two", "three", "four"};
  EXPECT_THAT(installed_packages(names), UnorderedElementsAre(Pair("one", "1.0-2"), Pair("three", "3:3.0")));
}

TEST(Machine, KnowsNoPackagesWithoutDpkg) {
  const PathFolder path;
  const std::vector<std::string> names = {"one"};
  EXPECT_THAT(installed_packages(names), IsEmpty());
}

TEST(Machine, NamesTheProcessorAndTheSystem) {
  EXPECT_NE(cpu_name(), "");
  EXPECT_NE(operating_system(), "");
}

}  // namespace
}  // namespace slipbench
