"""CMakeLists.txt defines the version; program, CITATION.cff, CHANGELOG.md and wheel agree.

Arguments: the project's root, the program.
"""

import re
import subprocess
import sys
import tomllib
import unittest
from pathlib import Path

ROOT, PROGRAM = Path(sys.argv[1]), sys.argv[2]
del sys.argv[1:]


def found(pattern, name):
    """Returns the first match's group in a file, or the text found instead."""
    text = (ROOT / name).read_text(encoding="utf-8")
    match = re.search(pattern, text, re.MULTILINE)
    return match[1] if match else f"{name}: nothing matches {pattern}"


class VersionTest(unittest.TestCase):
    version = found(r"^project\(slipbench VERSION (\d+\.\d+\.\d+) ", "CMakeLists.txt")

    def test_program(self):
        printed = subprocess.run(
            [PROGRAM, "--version"], capture_output=True, text=True, check=True
        ).stdout
        self.assertEqual(re.findall(r"\d+\.\d+\.\d+", printed)[:1], [self.version])

    def test_citation(self):
        self.assertEqual(found(r"^version: (\S+)$", "CITATION.cff"), self.version)

    def test_newest_section_of_the_changelog(self):
        self.assertEqual(
            found(r"^## \[(?!Unreleased\])(.+?)\] - \d{4}-\d\d-\d\d$", "CHANGELOG.md"), self.version
        )
        self.assertEqual(
            found(r"^date-released: (.*)$", "CITATION.cff"),
            found(r"^## \[[\d.]+\] - (.*)$", "CHANGELOG.md"),
        )

    def test_wheel(self):
        about = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
        self.assertEqual(about["project"]["dynamic"], ["version"])
        source = about["tool"]["scikit-build"]["metadata"]["version"]
        self.assertEqual(
            found(source["regex"].replace("?P<value>", ""), source["input"]), self.version
        )

    def test_consumer(self):
        self.assertEqual(
            found(r"find_package\(slipbench ([\d.]+) ", "tests/install/consumer/CMakeLists.txt"),
            self.version.rpartition(".")[0],
        )


if __name__ == "__main__":
    unittest.main()
