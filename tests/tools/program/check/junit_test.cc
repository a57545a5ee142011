// The XML, read by another program's parser.
#include "tools/program/check/check.h"

#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tools/program/commands/child_process.h"

namespace slipbench {
namespace {

// A scene called as no scene should be, one expectation failed, one kept, and a second one that tests nothing.
std::vector<SceneCheck> checks() {
  ExpectationResult failed;
  failed.name = "max_slip";
  failed.limit = "at most 3 mm";
  failed.kept = 18;
  failed.trials = failed.needed = 20;
  failed.worst = {7, 4.1e-3};
  failed.worst_text = "4.1 mm";
  failed.replay = "slipbench run 'a&b<\">.yaml' --set 'description=]]>' --seed 1 --trial 7";
  failed.control_kept = 0;
  ExpectationResult kept = failed;
  kept.name = "dropped";
  kept.kept = 20;
  SceneCheck first;
  first.scene_path = "a&b<\"'>\t\x01.yaml";
  first.control = "hold_preset";
  first.verdict = Verdict::failed;
  first.expectations = {failed, kept};
  first.failures = {"trial 3: <unstable>"};
  first.files = {"left/trial_7.h5"};
  SceneCheck second = first;
  second.scene_path = "second.yaml";
  second.verdict = Verdict::tests_nothing;
  second.expectations = {kept};
  SceneCheck third;
  third.scene_path = "third.yaml";
  return {first, second, third};
}

TEST(JUnit, IsReadAsItWasMeant) {
  const TemporaryFolder folder;
  std::ofstream(folder / "j.xml") << junit_xml(checks());
  std::ofstream(folder / "read.py") << R"(
import xml.etree.ElementTree as tree
root = tree.parse('j.xml').getroot()
print(root.tag, [root.get(key) for key in ('tests', 'failures', 'errors', 'skipped')])
for suite in root:
    print(suite.tag, repr(suite.get('name')), [suite.get(key) for key in ('tests', 'failures', 'errors', 'skipped')])
    for case in suite:
        print(' ', case.tag, case.get('name'), case.get('classname') == suite.get('name'))
        for part in case:
            print('   ', part.tag, part.get('type'), part.get('message'))
            print(part.text)
)";
  const ChildResult read = run_shell("python3 read.py", folder / "");
  EXPECT_EQ(read.status, 0) << read.err;
  EXPECT_EQ(read.out, R"x(testsuites ['6', '2', '0', '1']
testsuite 'a&b<"\'>\t?.yaml' ['3', '1', '0', '0']
  testcase max_slip True
    failure expectation max_slip: at most 3 mm in 18 of 20 trials, needed in 20; worst: 4.1 mm in trial 7
max_slip: at most 3 mm in 18 of 20 trials, needed in 20; worst: 4.1 mm in trial 7
replay: slipbench run 'a&b<">.yaml' --set 'description=]]>' --seed 1 --trial 7
trial 3: <unstable>
left: left/trial_7.h5
  testcase dropped True
  testcase negative_control True
testsuite 'second.yaml' ['2', '1', '0', '0']
  testcase dropped True
  testcase negative_control True
    failure expectation tests nothing
tests nothing: the negative control, controller hold_preset, keeps all of it too; a heavier box, a smoother surface or a lower preset make a test of it
testsuite 'third.yaml' ['1', '0', '0', '1']
  testcase expect True
    skipped None the scene expects nothing
None
)x");
}

}  // namespace
}  // namespace slipbench
