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
    "sim/core/README.md": "# sim/core\n",
    "sim/core/a.h": "// A.\n#pragma once\n\n#include <vector>\n\n#include <Eigen/Core>\n",
    "sim/mujoco/README.md": "# sim/mujoco\n",
    "sim/mujoco/b.cc": '#include "sim/mujoco/b.h"\n\n#include <mujoco/mujoco.h>\n\n#include "sim/core/a.h"\n',
    "sim/mujoco/b.h": "#pragma once\n",
    "sensors/pad/README.md": "# sensors/pad\n",
    "sensors/pad/c.h": "#pragma once\n",
    "sensors/pad/c.cc": '#include "sensors/pad/c.h"\n\n#include "sensors/electronics/d.h"\n#include "sim/core/a.h"\n',
    "tests/sim/core/a_test.cc": '#include "tools/trial/run.h"\n',
}


sys.path.insert(0, str(ROOT / "tools/lint"))
from readmes import commands  # noqa: E402

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
    (
        "readmes",
        "sim/core/README.md",
        "# sim/core\n\nSee [b](../mujoco/b.cc), [c](../mujoco/c.cc).\n",
        ":3:",
        "c.cc leads nowhere",
    ),
    (
        "readmes",
        "sim/core/README.md",
        "# It's two-words\n[up](#its-two-words) [down](#down)\n",
        ":2:",
        "#down",
    ),
    (
        "readmes",
        "sim/core/README.md",
        "`a.h`, `core/a.{h,md}`, `SCENE.yaml`, `../mujoco/b.cc`, `*.h`\n",
        "`core/a.{h,md}`",
    ),
    ("readmes", "sim/core/README.md", "In sim/mujoco/b and sim/mujoco/c.cc.\n", "sim/mujoco/c.cc"),
    (
        "readmes",
        "sim/core/README.md",
        "```sh\n./slipbench list\n```\n\n    ./slipbench doctor\n",
        "doctor",
    ),
    ("readmes", "README.md", "# a\n" * 151, "151 lines"),
    ("no_leftovers", "sim/core/d.h", "// TODO: more\n", ":1:", "marker"),
    ("no_leftovers", "sim/core/d.cc", "int a;\n// int b = 1;\n", ":2:", "code in a comment"),
    ("no_leftovers", "sim/core/d.cc", "#if 0\n", ":1:", "code in a comment"),
    ("no_leftovers", "tools/files/d.py", "# print(1)\n", ":1:", "code in a comment"),
    ("no_leftovers", "data.bin", "x" * 1_000_001, "1000001 bytes"),
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
    ("readmes", "sim/core/README.md", "```bash\n./slipbench list\n```\n", "```sh"),
    ("readmes", "sim/core/README.md", "```sh\ncmake --preset gone\n```\n", "begins with"),
    ("readmes", "sim/core/README.md", "- a\n  ```sh\n  ./slipbench list\n  ```\n", "line's begin"),
    ("readmes", "sim/core/README.md", '[t](gone.md "title")\n', "gone.md leads nowhere"),
    ("readmes", "sim/core/README.md", '<img src="gone.png">\n', "[text](where)"),
    (
        "wording",
        "sim/core/README.md",
        "# sim/core\n\nThe motion is told where it ends.\n",
        ":3:",
        "is told",
    ),
    ("wording", "sim/core/README.md", "The gain is worked out once.\n", ":1:", "computed"),
    (
        "wording",
        "sim/core/d.cc",
        'throw Error("allowed: that of the pad");\n',
        ":1:",
        "name what is allowed",
    ),
    ("wording", "sim/core/d.h", "// A band below it is none.\n", ":1:", "is none"),
    ("wording", "sim/core/d.h", "// The same to the bit.\n", "bit-identical"),
    ("wording", "sim/core/d.h", "// Copies it, lest it changes.\n", "so that ... not"),
    ("wording", "scenes/a.yaml", "# The pad stands ahead of the finger.\n", "is offset"),
    ("wording", "tools/files/d.py", '"""The house rules."""\n', "project"),
    ("wording", "sim/core/d.h", "int a;\n  // Of a pad: its area.\n", ":2:", "'Of'"),
    ("wording", "sim/core/d.h", "int area;  // What a pad covers.\n", ":1:", "'What'"),
    (
        "wording",
        "tools/files/d.py",
        'def f():\n    """Whether the pad is idle."""\n',
        ":2:",
        "True if",
    ),
    ("wording", "cmake/d.cmake", "# What a build reads.\n", ":1:", "'What'"),
    ("wording", "sim/core/d.cc", 'throw Error("the mesh is no box");\n', ":1:", "is not a"),
    (
        "wording",
        "sim/core/d.cc",
        'throw Error("2 rows; allowed: as many");\n',
        ":1:",
        "name what is allowed",
    ),
    ("citations", "sim/core/d.h", "// The law of [nobody1999].\n", ":1:", "nobody1999"),
    ("citations", "docs/references.bib", "@book{nobody1999,\n}\n", ":1:", "not cited"),
    ("citations", "tools/files/d.py", "# As in papers/law.\n", ":1:", "not in the tree"),
    ("wording", "tools/files/e.py", "fail('the run has gone wrong')\n", ":1:", "diverges"),
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
        """Expects the check to pass on the clean tree, and to fail once `text` is in `path`, with a
        finding that contains `words`.
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

    def test_folder_without_readme(self):
        self.plant("sim/core/a.h", "\n")
        self.plant("sim/contact/f.h", "\n")
        self.assertIn("sim/contact: no README.md", self.run_check("readmes").stdout)

    def test_tests_folder_that_mirrors_nothing(self):
        self.plant("tests/oracle/f.cc", "\n")
        self.assertIn("tests/oracle: no README.md", self.run_check("readmes").stdout)

    def test_trained_classifier_is_explained_above(self):
        self.plant("detectors/memories/mine/model.txt", "slipbench_hd: 1\n")
        self.assertIn("detectors/memories/mine: no README.md", self.run_check("readmes").stdout)
        self.plant("detectors/memories/README.md", "# mine\n")
        self.assertNotIn("detectors/memories", self.run_check("readmes").stdout)

    def test_words_that_are_not_there(self):
        self.plant("sim/core/a.h", "class PadHolder {};\nint grip_force();\n")
        for word in (
            "gone()",
            "PadHolder::gone",
            "OtherHolder",
            "grip_farce",
            "build/release/bin/gone",
        ):
            self.plant("sim/core/README.md", f"`PadHolder`, `grip_force()`, `{word}`\n")
            found = self.run_check("readmes").stdout.splitlines()
            self.assertEqual(found, [f"sim/core/README.md:1: `{word}` is not in the tree"])

    def test_wide_root_readme(self):
        wide = "a " * 70
        self.plant("sim/core/README.md", wide)
        allowed = f"| {wide} |\n```\n{wide}\n```\n![{wide}](sim/core/README.md)\n"
        self.assert_found("readmes", "README.md", f"{allowed}{wide}\n", ":6:", "140 columns")

    def test_plain_wording(self):
        self.plant(
            "sim/core/a.h",
            "// Returns the pad; null if there is none, or if there\n// is none yet.\n// Of two pads, the first.\n",
        )
        self.plant("CHANGELOG.md", "- The gain is worked out once.\n")
        found = self.run_check("wording")
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)

    def test_subjects_of_commits(self):
        def git(*arguments):
            identity = [
                "-c",
                "user.name=a",
                "-c",
                "user.email=a@b",
                "-c",
                "init.defaultBranch=main",
            ]
            subprocess.run(
                ["git", "-C", self.tree, *identity, *arguments], capture_output=True, check=True
            )

        def commit(subject):
            git("commit", "--allow-empty", "--no-verify", "--message", subject)

        outside = self.run_check("commits")
        self.assertEqual((outside.returncode, outside.stdout), (0, ""), outside.stderr)
        self.assertIn("not checked", outside.stderr)
        git("init")
        commit("Repaired a thing before the first tag.")
        git("tag", "v1")
        self.assertEqual(self.run_check("commits").returncode, 0)
        commit("cli: report unknown options")
        commit("Merge branch 'a'")
        self.assertEqual(self.run_check("commits").returncode, 0)
        for subject, words in (
            ("report unknown options", "expected 'area:"),
            ("Cli: report options", "expected 'area:"),
            ("cli: report unknown options.", "expected 'area:"),
            ("cli: added an option", "imperative"),
            ("cli: report options that " + 8 * "longer ", "72"),
            ("cli: say what the loop is told", "is told"),
        ):
            with self.subTest(subject):
                commit(subject)
                found = self.run_check("commits")
                self.assertEqual(found.returncode, 1)
                self.assertIn(words, found.stdout)
                self.plant("message", f"# A comment.\n{subject}\n\nThe body.\n")
                message = subprocess.run(
                    [sys.executable, ROOT / "tools/lint/commits.py", self.tree / "message"],
                    capture_output=True,
                    text=True,
                    check=False,
                )
                self.assertEqual(message.returncode, 1)
                self.assertIn(words, message.stdout)
                git("reset", "--hard", "HEAD^")

    def test_commands_of_a_text(self):
        text = (
            "```yaml a.yaml\nslipbench: 1\n```\n```sh\n./slipbench run a.yaml \\\n  -o a.h5   # writes\nls\n```\n"
            "```sh no-run\n./slipbench demo\n```\n"
        )
        self.assertEqual(
            list(commands(text)),
            [("file", "a.yaml", "slipbench: 1\n"), ("run", "./slipbench run a.yaml -o a.h5")],
        )

    def test_rooms(self):
        def found(path, text):
            self.plant(path, text)
            return self.run_check("rooms").stdout.splitlines()

        self.plant("sim/core/room/e.h", '#include "sim/core/a.h"\n')
        self.run_check("rooms", "--fix")
        self.assertEqual(found("sim/core/a.h", "\n"), [])
        self.assertEqual(
            found("sim/core/a.h", '#include "sim/core/room/e.h"\n'),
            ["sim/core: includes lead back to it: sim/core -> sim/core/room -> sim/core"],
        )
        back = '#include "sensors/pad/c.h"\n'
        self.assertEqual(
            found("sim/core/a.h", back),
            ["sensors/pad: includes lead back to it: sensors/pad -> sim/core -> sensors/pad"],
        )
        self.plant(
            "sim/core/a.h", "\n"
        )  # through a subfolder whose include leads back to the layer, but not to the folder
        self.assertEqual(
            found("sim/core/lower/f.h", back),
            ["sensors: includes lead back to it: sensors -> sim/core -> sensors"],
        )
        anew = (
            "ARCHITECTURE.svg: not what the includes are; draw it with: tools/lint/rooms.py . --fix"
        )
        self.assertEqual(found("sim/core/lower/f.h", '#include "sim/lowest/g.h"\n'), [anew])
        self.plant("sim/core/lower/f.h", "\n")
        self.plant("sim/core/a.h", "\n")
        for number in range(29):
            self.assertEqual(found(f"sim/core/b{number}.h", "\n"), [])
        self.assertEqual(
            found("sim/core/b29.h", "\n"),
            ["sim/core: 31 sources; allowed: 30, so that a folder is seen whole"],
        )

    def test_unfilled_place(self):
        self.plant("cmake/config.cmake.in", "set(root @ROOT@)\n")
        self.assert_found(
            "no_leftovers",
            "sim/core/README.md",
            "# sim/core\n\nMail a@b.c and d@e.f. Takes @TIME_2@ s.\n",
            ":3:",
            "@TIME_2@",
        )

    def test_type_defined_twice(self):
        self.plant("sim/core/d.h", "class Gauge {\n};\n")
        self.assert_found(
            "one_definition",
            "tools/files/e.h",
            "struct Gauge final : public Base {\n};\n",
            "Gauge",
            "sim/core/d.h:1",
        )

    def test_type_of_another_namespace(self):
        self.plant("sim/core/d.h", "namespace slipbench {\n\nclass Gauge {\n};\n")
        self.plant("tools/files/e.h", "namespace slipbench::base {\n\nclass Gauge {\n};\n")
        self.assertEqual(self.run_check("one_definition").returncode, 0)

    def test_type_announced_twice(self):
        self.plant("sim/core/d.h", "class Gauge;\n")
        self.plant("tools/files/e.h", "class Gauge;\nclass Gauge {\n};\n")
        self.assertEqual(self.run_check("one_definition").returncode, 0)


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
