"""The formats that Python writes: a signal and a full disk leave no half-written file under its name. Arguments: the project's root, the program."""

import os
import resource
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from _made import PROGRAM, ROOT, ExportTest, contents, export

FORMATS = ("lerobot", "mcap", "parquet")
TRIALS = 30  # which take each format more than half a second, so that a signal comes in the midst


class Interruption(ExportTest):
    @classmethod
    def setUpClass(cls):
        folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.dataset = str(folder / "many.h5")
        subprocess.run([PROGRAM, "sweep", str(ROOT / "scenes/papillarray/stage.yaml"), "--trials", str(TRIALS), "--set", "sweep={}", "-o", cls.dataset, "--quiet"],
                       check=True)

    def interrupt(self, format, number, out):
        """Sends the signal once something lies in `out`, and returns how the export ended and what it said."""
        process = subprocess.Popen([PROGRAM, "export", self.dataset, "--format", format, "-o", str(out)], stderr=subprocess.PIPE, text=True)
        while process.poll() is None and not (out.exists() and contents_exist(out)):
            time.sleep(0.01)
        process.send_signal(number)
        _, told = process.communicate(timeout=60)
        return process.returncode, told

    def test_a_signal_leaves_nothing(self):
        for format in FORMATS:
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(format=format, signal=number.name):
                    out = self.folder / f"{format}-{number.name}"
                    status, told = self.interrupt(format, number, out)
                    self.assertEqual((status, out.exists()), (130, False))
                    self.assertNotIn("Traceback", told)

    def test_a_killed_export_leaves_nothing_under_its_name_and_the_next_one_goes_through(self):
        for format in FORMATS:
            with self.subTest(format=format):
                out, whole = self.folder / format, self.folder / f"{format}-whole"
                self.assertEqual(self.interrupt(format, signal.SIGKILL, out)[0], -signal.SIGKILL)
                left = set(contents(out))
                self.assertTrue(left)
                self.assertEqual({name for name in left if ".partial" not in name}, set())
                export(self.dataset, out, "--format", format)
                export(self.dataset, whole, "--format", format)
                self.assertEqual(contents(out), contents(whole))

    def test_a_full_disk_is_told_and_leaves_nothing(self):
        """A limit on a file's size stands for the full disk: the write fails half-way in the same place."""
        for format in FORMATS:
            with self.subTest(format=format):
                whole = self.folder / f"{format}-whole"
                export(self.dataset, whole, "--format", format, "--trial", "0")
                limit = max(len(text) for text in contents(whole).values()) // 2
                out = self.folder / format
                done = subprocess.run([PROGRAM, "export", self.dataset, "--format", format, "-o", str(out)], capture_output=True, text=True, check=False,
                                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
                self.assertEqual((done.returncode, out.exists()), (2, False))
                self.assertRegex(done.stderr, r"slipbench: .*cannot be written: .*File too large")
                self.assertNotIn("Traceback", done.stderr)


def contents_exist(folder):
    return any(files for _, _, files in os.walk(folder))


if __name__ == "__main__":
    unittest.main()
