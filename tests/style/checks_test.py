"""Each check of tools/lint passes a clean tree and finds a violation planted in it. Arguments: the project's root, then unittest's."""

import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(sys.argv.pop(1))

CLEAN = {
    "sim/core/README.md": "# sim/core\n",
    "sim/core/a.h": "// A.\n#pragma once\n\n#include <vector>\n\n#include <Eigen/Core>\n",
    "sim/mujoco/README.md": "# sim/mujoco\n",
    "sim/mujoco/b.cc": '#include <mujoco/mujoco.h>\n\n#include "sim/core/a.h"\n',
    "sensors/pad/README.md": "# sensors/pad\n",
    "sensors/pad/c.cc": '#include "sensors/pad/c.h"\n\n#include "sensors/electronics/d.h"\n#include "sim/core/a.h"\n',
    "tests/sim/core/a_test.cc": '#include "tools/program/run/run.h"\n',
    "run.sh": '#!/usr/bin/env bash\necho "$1"\n',
}


sys.path.insert(0, str(ROOT / "tools/lint"))
from readmes import commands  # noqa: E402
from tree import HAS_CLANG_14  # noqa: E402


class PlantedViolation(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.tree = Path(folder.name)
        for path, text in CLEAN.items():
            self.plant(path, text)
        shutil.copy(ROOT / ".clang-format", self.tree)
        shutil.copy(ROOT / ".clang-tidy", self.tree)

    def plant(self, path, text):
        (self.tree / path).parent.mkdir(parents=True, exist_ok=True)
        (self.tree / path).write_text(text, encoding="utf-8")

    def run_check(self, check, *arguments):
        return subprocess.run(
            [sys.executable, ROOT / "tools/lint" / f"{check}.py", self.tree, *arguments], capture_output=True, text=True, check=False)

    def assert_found(self, check, path, text, *words):
        """The check is content with the clean tree, and no more once `text` stands in `path`; its finding holds `words`."""
        before = self.run_check(check)
        self.assertEqual(before.returncode, 0, before.stdout + before.stderr)
        self.plant(path, text)
        after = self.run_check(check)
        self.assertEqual(after.returncode, 1, after.stdout + after.stderr)
        self.assertEqual(len(after.stdout.splitlines()), 1, after.stdout)
        for word in (path, *words):
            self.assertIn(word, after.stdout)


class ChecksTest(PlantedViolation):
    def test_sensor_includes_detector(self):
        self.assert_found("include_rule", "sensors/pad/d.h", '\n#include "detectors/e.h"\n', ":2:", "sensors/pad/")

    def test_sensor_includes_other_sensor(self):
        self.assert_found("include_rule", "sensors/pad/d.h", '#include "sensors/skin/e.h"\n', "sensors/electronics/")

    def test_sensor_includes_simulation(self):
        self.assert_found("include_rule", "sensors/pad/d.h", '#include "sim/field/field.h"\n', "sim/core/")

    def test_detector_includes_simulation(self):
        self.assert_found("include_rule", "detectors/d.h", '#include "sim/field/field.h"\n', "sim/core/")

    def test_include_that_goes_round_the_rule(self):
        for line, found in (('#include <sim/core/contact_frame.h>', "in quotes"),
                            ('#include "detectors/../sim/core/contact_frame.h"', "from the project root"),
                            ('#include HEADER', "cannot be read"), ('/* */ #include "sim/field/field.h"', "cannot be read"),
                            ('#include /* */ "sim/field/field.h"', "cannot be read"), ('# \\', "cannot be read")):
            with self.subTest(line):
                self.assert_found("include_rule", "detectors/d.h", line + "\n", found)
                self.plant("detectors/d.h", "\n")

    def test_source_that_is_included(self):
        self.assert_found("include_rule", "sim/core/d.cc", '#include "sim/core/e.cc"\n', "no header")

    def test_source_of_another_ending(self):
        self.assert_found("include_rule", "detectors/d.hpp", "\n", ".h or .cc")

    def test_no_layer_and_no_floor(self):
        self.assert_found("include_rule", "sim/other/d.h", "#include <vector>\n", "layer of sim")
        self.plant("sim/other/d.h", "\n")
        self.assert_found("include_rule", "tools/other/d.h", "#include <vector>\n", "floor of tools")

    def test_detector_includes_truth(self):
        self.assert_found("include_rule", "detectors/d.h", '#include "sim/core/contact_frame.h"\n', "truth")

    def test_detector_includes_what_measures_truth(self):
        self.assert_found("include_rule", "rtl/d.h", '#include "sim/core/sensor.h"\n', "truth")

    def test_controller_includes_detector(self):
        self.assert_found("include_rule", "controllers/d.h", '#include "detectors/e.h"\n', "controllers/")

    def test_simulation_includes_tools(self):
        self.assert_found("include_rule", "sim/field/d.h", '#include "tools/program/run/run.h"\n', "sim/")

    def test_tool_includes_test(self):
        self.assert_found("include_rule", "tools/program/run/d.h", '#include "tests/e.h"\n', "tools/")

    def test_mujoco_outside_its_folder(self):
        self.assert_found("include_rule", "sim/motion/d.h", "#include <mujoco/mujoco.h>\n", "only sim/mujoco")

    def test_field_includes_mujoco_folder(self):
        self.assert_found("include_rule", "sim/field/d.h", '#include "sim/mujoco/version.h"\n', "sim/field/")

    def test_motion_includes_field(self):
        self.assert_found("include_rule", "sim/motion/d.h", '#include "sim/field/field.h"\n', "sim/core/")

    def test_scene_includes_grasp(self):
        self.assert_found("include_rule", "sim/scene/d.h", '#include "sim/grasp/drive.h"\n', "sim/core/")

    def test_base_includes_program(self):
        self.assert_found("include_rule", "tools/base/dataset/d.h", '#include "tools/program/run/run.h"\n', "tools/base/")

    def test_base_includes_simulation(self):
        self.assert_found("include_rule", "tools/base/dataset/d.h", '#include "sim/scene/scene.h"\n', "sim/core/")

    def test_program_includes_study(self):
        self.assert_found("include_rule", "tools/program/run/d.h", '#include "tools/studies/result.h"\n', "tools/program/")

    def test_core_includes_library(self):
        self.assert_found("include_rule", "sim/core/d.h", "#include <yaml-cpp/yaml.h>\n", "standard library")

    def test_core_header_includes_random123(self):
        self.assert_found("include_rule", "sim/core/d.h", "#include <Random123/philox.h>\n", "standard library")

    def test_include_not_from_the_root(self):
        self.assert_found("include_rule", "sim/core/d.h", '#include "a.h"\n', "project root")

    def test_folder_without_readme(self):
        self.plant("sim/core/a.h", "\n")
        self.plant("sim/field/f.h", "\n")
        self.assertIn("sim/field: no README.md", self.run_check("readmes").stdout)

    def test_tests_folder_that_mirrors_nothing(self):
        self.plant("tests/oracle/f.cc", "\n")
        self.assertIn("tests/oracle: no README.md", self.run_check("readmes").stdout)

    def test_trained_classifier_is_explained_above(self):
        self.plant("detectors/memories/mine/model.txt", "slipbench_hd: 1\n")
        self.assertIn("detectors/memories/mine: no README.md", self.run_check("readmes").stdout)
        self.plant("detectors/memories/README.md", "# mine\n")
        self.assertNotIn("detectors/memories", self.run_check("readmes").stdout)

    def test_link_that_leads_nowhere(self):
        self.assert_found("readmes", "sim/core/README.md", "# sim/core\n\nSee [b](../mujoco/b.cc), [c](../mujoco/c.cc).\n", ":3:", "c.cc leads nowhere")

    def test_anchor_without_heading(self):
        self.assert_found("readmes", "sim/core/README.md", "# It's two-words\n[up](#its-two-words) [down](#down)\n", ":2:", "#down")

    def test_file_that_is_not_there(self):
        self.assert_found("readmes", "sim/core/README.md", "`a.h`, `core/a.{h,md}`, `SCENE.yaml`, `../mujoco/b.cc`, `*.h`\n", "`core/a.{h,md}`")

    def test_path_without_backticks(self):
        self.assert_found("readmes", "sim/core/README.md", "In sim/mujoco/b and sim/mujoco/c.cc.\n", "sim/mujoco/c.cc")

    def test_words_that_are_not_there(self):
        self.plant("sim/core/a.h", "class PadHolder {};\nint grip_force();\n")
        for word in ("gone()", "PadHolder::gone", "OtherHolder", "grip_farce", "build/release/bin/gone"):
            self.plant("sim/core/README.md", f"`PadHolder`, `grip_force()`, `{word}`\n")
            found = self.run_check("readmes").stdout.splitlines()
            self.assertEqual(found, [f"sim/core/README.md:1: `{word}` is not in the tree"])

    def test_command_that_no_test_runs(self):
        self.assert_found("readmes", "sim/core/README.md", "```sh\n./slipbench list\n```\n\n    ./slipbench doctor\n", "doctor")

    def test_block_of_commands_that_is_not_run(self):
        for text, found in (("```bash\n./slipbench list\n```\n", "```sh"), ("```sh\ncmake --preset gone\n```\n", "begins with"),
                            ("- a\n  ```sh\n  ./slipbench list\n  ```\n", "line's begin")):
            with self.subTest(text):
                self.assert_found("readmes", "sim/core/README.md", text, found)
                self.plant("sim/core/README.md", "# sim/core\n")

    def test_link_of_another_form(self):
        self.assert_found("readmes", "sim/core/README.md", '[t](gone.md "title")\n', "gone.md leads nowhere")
        self.plant("sim/core/README.md", "# sim/core\n")
        self.assert_found("readmes", "sim/core/README.md", '<img src="gone.png">\n', "[text](where)")

    def test_long_door(self):
        self.assert_found("readmes", "README.md", "# a\n" * 151, "151 lines")

    def test_wide_door(self):
        wide = "a " * 70
        self.plant("sim/core/README.md", wide)
        allowed = f"| {wide} |\n```\n{wide}\n```\n![{wide}](sim/core/README.md)\n"
        self.assert_found("readmes", "README.md", f"{allowed}{wide}\n", ":6:", "140 columns")

    def test_commands_of_a_text(self):
        text = ("```yaml a.yaml\nslipbench: 1\n```\n```sh\n./slipbench run a.yaml \\\n  -o a.h5   # writes\nls\n```\n"
                "```sh no-run\n./slipbench demo\n```\n")
        self.assertEqual(list(commands(text)), [("file", "a.yaml", "slipbench: 1\n"), ("run", "./slipbench run a.yaml -o a.h5")])

    def test_marker(self):
        self.assert_found("no_leftovers", "sim/core/d.h", "// TO" "DO: more\n", ":1:", "marker")

    def test_unfilled_place(self):
        self.plant("cmake/config.cmake.in", "set(root @ROOT@)\n")
        self.assert_found("no_leftovers", "sim/core/README.md", "# sim/core\n\nMail a@b.c and d@e.f. Takes @TIME_" "2@ s.\n", ":3:", "@TIME_" "2@")

    def test_code_in_comment(self):
        self.assert_found("no_leftovers", "sim/core/d.cc", "int a;\n// int b = 1;\n", ":2:", "code in a comment")

    def test_disabled_block(self):
        self.assert_found("no_leftovers", "sim/core/d.cc", "#if 0\n", ":1:", "code in a comment")

    def test_python_code_in_comment(self):
        self.assert_found("no_leftovers", "tools/base/d.py", "# print(1)\n", ":1:", "code in a comment")

    def test_large_file(self):
        self.assert_found("no_leftovers", "data.bin", "x" * 1_000_001, "1000001 bytes")

    def test_type_defined_twice(self):
        self.plant("sim/core/d.h", "class Gauge {\n};\n")
        self.assert_found("one_definition", "tools/base/e.h", "struct Gauge final : public Base {\n};\n", "Gauge", "sim/core/d.h:1")

    def test_type_of_another_namespace(self):
        self.plant("sim/core/d.h", "namespace slipbench {\n\nclass Gauge {\n};\n")
        self.plant("tools/base/e.h", "namespace slipbench::base {\n\nclass Gauge {\n};\n")
        self.assertEqual(self.run_check("one_definition").returncode, 0)

    def test_type_announced_twice(self):
        self.plant("sim/core/d.h", "class Gauge;\n")
        self.plant("tools/base/e.h", "class Gauge;\nclass Gauge {\n};\n")
        self.assertEqual(self.run_check("one_definition").returncode, 0)

    @unittest.skipUnless(HAS_CLANG_14, "no clang-format-14")
    def test_layout(self):
        self.assert_found("clang_format", "sim/core/d.cc", "int  a;\n", "--fix")

    @unittest.skipUnless(HAS_CLANG_14, "no clang-format-14")
    def test_layout_is_mended(self):
        self.plant("sim/core/d.cc", "int  a;\n")
        self.assertEqual(self.run_check("clang_format", "--fix").returncode, 0)
        self.assertEqual((self.tree / "sim/core/d.cc").read_text(encoding="utf-8"), "int a;\n")

    def test_shell_script(self):
        self.assert_found("shell_check", "run.sh", "#!/usr/bin/env bash\nrm $1\n", "SC2086")


class TidyTest(PlantedViolation):
    def test_lint(self):
        # A std::string moved from and then read: bugprone-use-after-move.
        faulty = ("#include <string>\n#include <utility>\nstd::string f(std::string s) {\n"
                  "  std::string t = std::move(s);\n  return s + t;\n}\n")
        build = self.tree / "build"
        build.mkdir()
        command = {"directory": str(build), "file": "../sim/core/d.cc", "command": "g++ -std=c++20 -o d.o -c ../sim/core/d.cc"}
        (build / "compile_commands.json").write_text(json.dumps([command]), encoding="utf-8")
        self.plant("sim/core/d.cc", faulty.replace("return s + t", "return t"))
        for _ in range(2):  # the second time from memory
            clean = self.run_check("clang_tidy", build)
            self.assertEqual(clean.returncode, 0, clean.stdout + clean.stderr)
        self.plant("sim/core/d.cc", faulty)
        for _ in range(2):
            found = self.run_check("clang_tidy", build)
            self.assertEqual(found.returncode, 1, found.stdout + found.stderr)
            self.assertIn("bugprone-use-after-move", found.stdout)


if __name__ == "__main__":
    unittest.main()
