"""Datasets that version 0.2.0 wrote are read by every command and by Python, with their values.

Arguments: the program, the folder with the Python package. README.md in version_0.2.0 says where the
files come from.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, PACKAGE = sys.argv[1:3]
del sys.argv[1:]
FILES = Path(__file__).parent / "version_0.2.0"
EXPECTED = json.loads((FILES / "expected.json").read_text(encoding="utf-8"))
sys.path.insert(0, PACKAGE)


class OldFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        for name in EXPECTED:
            shutil.copy(FILES / name, self.folder / f"{name}.h5")

    def run_program(self, *words, status=0):
        done = subprocess.run(
            [PROGRAM, *words], cwd=self.folder, capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, status, f"{words}: {done.stdout}{done.stderr}")
        return done.stdout

    def each(self):
        for name, expected in EXPECTED.items():
            with self.subTest(name):
                yield f"{name}.h5", expected

    def test_verify_finds_them_sound(self):
        for name, expected in self.each():
            found = json.loads(self.run_program("verify", name, "--json"))["datasets"][0]
            self.assertEqual(
                (found["holds"], found["trials"], found["complete"]),
                (True, len(expected["trials"]), expected["complete"]),
            )

    def test_commands_read_them(self):
        for name, _ in self.each():
            stem = Path(name).stem
            self.run_program("report", name, "-o", f"{stem}.html")
            self.assertIn(
                "<!DOCTYPE html>", (self.folder / f"{stem}.html").read_text(encoding="utf-8")
            )
        self.run_program("export", "stage.h5", "--format", "csv", "-o", "tables", "-q")
        self.assertEqual(len(list((self.folder / "tables").glob("*.csv"))), 1)
        self.assertEqual(
            json.loads(self.run_program("eval", "force_ratio", "stage.h5", "--json"))["all"][
                "trials"
            ],
            1,
        )

    @unittest.skipUnless(os.path.isdir(PACKAGE), "no Python package")
    def test_python_reads_their_values(self):
        import slipbench

        for name, expected in self.each():
            with slipbench.open(str(self.folder / name)) as data:
                self.assertEqual(data.version, "0.2.0")
                self.assertEqual(
                    {str(trial): data[trial].sha256 for trial in data}, expected["trials"]
                )
                for path, total in expected["arrays"].items():
                    trial, kind, sensor, array = path.split("/")
                    values = getattr(getattr(data[int(trial)], kind)[sensor], array)
                    self.assertAlmostEqual(
                        float(values[:].astype("float64").sum()), total, msg=f"{name}: {path}"
                    )


if __name__ == "__main__":
    unittest.main()
