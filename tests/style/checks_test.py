"""Each check of tools/lint passes a clean tree and finds a planted violation.

Arguments: the project's root, then unittest's.
"""

import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(sys.argv.pop(1))

CLEAN = {
    "sim/core/a.h": "// A.\n#pragma once\n\n#include <vector>\n\n#include <Eigen/Core>\n",
    "sim/mujoco/b.cc": '#include "sim/mujoco/b.h"\n\n#include <mujoco/mujoco.h>\n\n#include "sim/core/a.h"\n',
    "sim/mujoco/b.h": "#pragma once\n",
    "sensors/pad/c.h": "#pragma once\n",
    "sensors/pad/c.cc": '#include "sensors/pad/c.h"\n\n#include "sensors/electronics/d.h"\n#include "sim/core/a.h"\n',
    "sensors/skin/skin.cc": '#include "sim/api/sensor_kind.h"\n',
    "sensors/gel/gel.cc": '#include "sensors/plugin_abi.h"\n',
    "tests/sim/core/a_test.cc": '#include "tools/trial/run.h"\n',
}

# Variables, so that this file passes the check of citations.
UNKNOWN_KEY = "nobody1999"
OUTSIDE = "papers" + "/"

# Planted violations: the check that finds each, its file and text, and words of the finding.
VIOLATIONS = (
    ("include_rule", "sensors/pad/d.h", '\n#include "detectors/e.h"\n', ":2:", "sensors/pad/"),
    ("include_rule", "sensors/pad/d.h", '#include "sensors/skin/e.h"\n', "sensors/electronics/"),
    ("include_rule", "sensors/pad/d.h", '#include "sim/contact/field.h"\n', "sim/core/"),
    ("include_rule", "detectors/d.h", '#include "sim/contact/field.h"\n', "sim/core/"),
    ("include_rule", "sim/core/d.h", '#include "sim/core/e.cc"\n', "no header"),
    (
        "include_rule",
        "sim/core/d.cc",
        '#include "sim/core/a.h"\n',
        "header of its name",
        '"sim/core/d.h"',
    ),
    (
        "include_rule",
        "sim/core/a.cc",
        "#include <vector>\n",
        'includes the header of its name: "sim/core/a.h"',
    ),
    (
        "include_rule",
        "controllers/d.cc",
        '#include "sim/core/a.h"\n',
        "header of its name",
        "controllers/controller_kinds.h",
    ),
    (
        "include_rule",
        "sensors/pad/pad.cc",
        '#include "sim/core/a.h"\n',
        "header of its name",
        "sim/api/sensor_kind.h",
    ),
    ("include_rule", "detectors/d.hpp", "\n", ".h or .cc"),
    ("include_rule", "detectors/d.h", '#include "sim/api/contact_frame.h"\n', "truth"),
    ("include_rule", "rtl/d.h", '#include "sim/api/sensor.h"\n', "truth"),
    ("include_rule", "controllers/d.h", '#include "detectors/e.h"\n', "controllers/"),
    ("include_rule", "sim/contact/d.h", '#include "tools/trial/run.h"\n', "sim/"),
    ("include_rule", "tools/trial/d.h", '#include "tests/e.h"\n', "tools/"),
    ("include_rule", "sim/motion/d.h", "#include <mujoco/mujoco.h>\n", "only sim/mujoco"),
    ("include_rule", "sim/contact/d.h", '#include "sim/mujoco/version.h"\n', "sim/contact/"),
    ("include_rule", "sim/motion/d.h", '#include "sim/contact/field.h"\n', "sim/core/"),
    ("include_rule", "sim/scene/d.h", '#include "sim/grasp/drive.h"\n', "sim/core/"),
    ("include_rule", "tools/dataset/d.h", '#include "tools/trial/run.h"\n', "tools/files/"),
    ("include_rule", "tools/dataset/d.h", '#include "sim/scene/scene.h"\n', "sim/core/"),
    ("include_rule", "tools/trial/d.h", '#include "tools/studies/result.h"\n', "tools/files/"),
    ("include_rule", "sim/core/d.h", "#include <yaml-cpp/yaml.h>\n", "standard library"),
    ("include_rule", "sim/core/d.h", "#include <Random123/philox.h>\n", "standard library"),
    ("include_rule", "sim/core/d.h", '#include "a.h"\n', "project root"),
    ("include_rule", "detectors/d.h", "#include <sim/api/contact_frame.h>\n", "in quotes"),
    (
        "include_rule",
        "detectors/d.h",
        '#include "detectors/../sim/api/contact_frame.h"\n',
        "from the project root",
    ),
    ("include_rule", "detectors/d.h", "#include HEADER\n", "cannot be read"),
    ("include_rule", "detectors/d.h", '/* */ #include "sim/contact/field.h"\n', "cannot be read"),
    ("include_rule", "detectors/d.h", '#include /* */ "sim/contact/field.h"\n', "cannot be read"),
    ("include_rule", "detectors/d.h", "# \\\n", "cannot be read"),
    ("include_rule", "sim/other/d.h", "#include <vector>\n", "layer of sim"),
    ("include_rule", "tools/other/d.h", "#include <vector>\n", "folder of tools"),
    ("citations", "sim/core/d.h", f"// The law of [{UNKNOWN_KEY}].\n", ":1:", UNKNOWN_KEY),
    ("citations", "docs/references.bib", f"@book{{{UNKNOWN_KEY},\n}}\n", ":1:", "not cited"),
    ("citations", "tools/files/d.py", f"# As in {OUTSIDE}law.\n", ":1:", "not in the tree"),
)


class PlantedViolation(unittest.TestCase):
    def setUp(self):
        self.tree = Path(self.enterContext(tempfile.TemporaryDirectory()))
        for path, text in CLEAN.items():
            self.plant(path, text)
        shutil.copy(ROOT / ".clang-tidy", self.tree)

    def plant(self, path, text):
        (self.tree / path).parent.mkdir(parents=True, exist_ok=True)
        (self.tree / path).write_text(text, encoding="utf-8")

    def run_check(self, check, *arguments):
        return subprocess.run(
            [sys.executable, ROOT / "tools/lint" / f"{check}.py", self.tree, *arguments],
            capture_output=True,
            text=True,
            check=False,
        )

    def assert_found(self, check, path, text, *words):
        """Expects the check to pass on the clean tree, and to fail once `text` is in `path`.

        The finding must contain `words`.
        """
        before = self.run_check(check)
        self.assertEqual(before.returncode, 0, before.stdout + before.stderr)
        self.plant(path, text)
        after = self.run_check(check)
        self.assertEqual(after.returncode, 1, after.stdout + after.stderr)
        self.assertEqual(len(after.stdout.splitlines()), 1, after.stdout)
        for word in (path, *words):
            self.assertIn(word, after.stdout)


class ChecksTest(PlantedViolation):
    def test_planted_violations(self):
        for check, path, text, *words in VIOLATIONS:
            with self.subTest(check, path=path, text=text[:80]):
                self.assert_found(check, path, text, *words)
                self.plant(path, CLEAN[path]) if path in CLEAN else (self.tree / path).unlink()


class TidyTest(PlantedViolation):
    def test_lint(self):
        # A std::string moved from and then read: bugprone-use-after-move.
        faulty = (
            "#include <string>\n#include <utility>\nstd::string f(std::string s) {\n"
            "  std::string t = std::move(s);\n  return s + t;\n}\n"
        )
        build = self.tree / "build"
        build.mkdir()
        command = {
            "directory": str(build),
            "file": "../sim/core/d.cc",
            "command": "g++ -std=c++20 -o d.o -c ../sim/core/d.cc",
        }
        (build / "compile_commands.json").write_text(json.dumps([command]), encoding="utf-8")
        self.plant("sim/core/d.cc", faulty.replace("return s + t", "return t"))
        for _ in range(2):  # the second time from the cache
            clean = self.run_check("clang_tidy", build)
            self.assertEqual(clean.returncode, 0, clean.stdout + clean.stderr)
        self.plant("sim/core/d.cc", faulty)
        for _ in range(2):
            found = self.run_check("clang_tidy", build)
            self.assertEqual(found.returncode, 1, found.stdout + found.stderr)
            self.assertIn("bugprone-use-after-move", found.stdout)


class WarningsTest(PlantedViolation):
    def test_warning(self):
        faulty = "double f(int a) {\n  return a & (a > 1) ? 1.0 : 2.0;\n}\n"  # clang alone warns
        build = self.tree / "build"
        build.mkdir()
        command = {
            "directory": str(build),
            "file": "../sim/core/d.cc",
            "command": "g++ -std=c++20 -Wall -o d.o -c ../sim/core/d.cc",
        }
        (build / "compile_commands.json").write_text(json.dumps([command]), encoding="utf-8")
        self.plant("sim/core/d.cc", faulty.replace("a & (a > 1)", "(a & 1) > 0"))
        clean = self.run_check("clang_warnings", build)
        self.assertEqual(clean.returncode, 0, clean.stdout + clean.stderr)
        self.plant("sim/core/d.cc", faulty)
        found = self.run_check("clang_warnings", build)
        self.assertEqual(found.returncode, 1, found.stdout + found.stderr)
        self.assertIn("-Wbitwise-conditional-parentheses", found.stdout)


if __name__ == "__main__":
    unittest.main()
