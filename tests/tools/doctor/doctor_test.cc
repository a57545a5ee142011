#include "tools/doctor/doctor.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/expect.h"
#include "tests/tools/doctor/path_folder.h"

namespace slipbench {
namespace {

Check check_named(const std::string& name) {
  const std::vector<Check> checks = run_checks();
  const auto found = std::ranges::find(checks, name, &Check::name);
  EXPECT_NE(found, checks.end()) << name;
  return found == checks.end() ? Check{} : *found;
}

std::string printed(bool json, int& status) {
  ::testing::internal::CaptureStdout();
  status = doctor_main(json);
  return ::testing::internal::GetCapturedStdout();
}

TEST(Doctor, LibrariesAreInOrderWhereTheProgramWasBuilt) {
  for (const Check& check : run_checks()) {
    if (check.group == "libraries" && check.name != "MuJoCo") {
      EXPECT_EQ(check.status, CheckStatus::ok) << check.name << ": " << check.remedy;
      EXPECT_THAT(check.found, ::testing::MatchesRegex("[0-9]+\\.[0-9.]+")) << check.name;
    }
  }
}

TEST(Doctor, NamesFlagsOfTheFloatingPointContract) { EXPECT_THAT(check_named("flags").found, HasSubstr("-ffp-contract=off")); }

TEST(Doctor, SetOfPackagesIsInOrderWhenAllAreInstalled) {
  std::string all;
  std::size_t wanted = 0;
  for (const SetupPackage& package : setup_packages()) {
    all += std::string(package.name) + " 1.0 installed\n";
    wanted += package.set == "build" ? 1 : 0;
  }
  PathFolder path;
  path.add_program("dpkg-query", all);
  const Check check = check_named("Debian packages to build");
  EXPECT_EQ(check.status, CheckStatus::ok);
  EXPECT_EQ(check.found, std::to_string(wanted) + " of " + std::to_string(wanted));
  EXPECT_EQ(check.remedy, "");
}

TEST(Doctor, MissingPackagesComeWithTheOneCommand) {
  std::string all_but_cmake;
  for (const SetupPackage& package : setup_packages()) {
    if (package.name != "cmake") all_but_cmake += std::string(package.name) + " 1.0 installed\n";
  }
  PathFolder path;
  path.add_program("dpkg-query", all_but_cmake);
  const Check check = check_named("Debian packages to build");
  EXPECT_EQ(check.status, CheckStatus::missing);
  EXPECT_EQ(check.remedy, "apt-get install --yes --no-install-recommends cmake");
  EXPECT_EQ(check_named("Debian packages to test").status, CheckStatus::ok);
}

TEST(Doctor, BrowserIsLookedForOnPath) {
  PathFolder path;
  EXPECT_EQ(check_named("browser for reports").status, CheckStatus::missing);
  const std::string program = path.add_program("firefox", "");
  EXPECT_EQ(check_named("browser for reports").found, program);
}

TEST(Doctor, WhatIsOptionalDoesNotChangeTheExitStatus) {
  int status_here = -1;
  printed(false, status_here);
  const PathFolder path;  // no packages, no browser
  int status = -1;
  const std::string text = printed(false, status);
  EXPECT_EQ(status, status_here);
  EXPECT_THAT(text, HasSubstr("missing (optional)"));
  EXPECT_THAT(text, HasSubstr("-> apt-get install --yes --no-install-recommends g++"));
}

TEST(Doctor, JsonSaysWhatTheChecksSay) {
  int status = -1;
  const nlohmann::json report = nlohmann::json::parse(printed(true, status));
  EXPECT_EQ(report.at("ok").get<bool>(), status == 0);
  const std::vector<Check> checks = run_checks();
  ASSERT_EQ(report.at("checks").size(), checks.size());
  for (std::size_t i = 0; i < checks.size(); ++i) {
    EXPECT_EQ(report["checks"][i].at("name"), checks[i].name);
    EXPECT_EQ(report["checks"][i].at("found"), checks[i].found);
    EXPECT_EQ(report["checks"][i].at("status") == "ok", checks[i].status == CheckStatus::ok);
  }
}

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
