"""The formats that Python writes: a signal and a full disk leave no half-written file under its name. Arguments: the project's root, the program."""

import fcntl
import os
import re
import resource
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from _made import PROGRAM, ROOT, ExportTest, contents, export

FORMATS = ("lerobot", "mcap", "parquet")
TRIALS = 3  # the export tells after the first what the others take
NOTICE = "slipbench: stopping after this trial; once more to stop at once\n"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interruption(ExportTest):
    @classmethod
    def setUpClass(cls):
        folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.dataset = str(folder / "many.h5")
        subprocess.run([PROGRAM, "sweep", str(ROOT / "scenes/papillarray/stage.yaml"), "--trials", str(TRIALS), "--set", "sweep={}", "-o", cls.dataset, "--quiet"],
                       check=True)

    def interrupt(self, format, out, *steps):
        """Sends each step's signal once what it waits for holds of the process and `out`; returns how the export ended and what it said.

        Its stderr is a full pipe until then: it waits with the line that follows the first trial, however slow this process is.
        """
        read_end, write_end = os.pipe()
        os.write(write_end, b" " * fcntl.fcntl(write_end, fcntl.F_SETPIPE_SZ, 4096))
        process = subprocess.Popen([PROGRAM, "export", self.dataset, "--format", format, "-o", str(out)], stderr=write_end, stdout=subprocess.DEVNULL)
        os.close(write_end)
        for number, holds in steps:
            while process.poll() is None and not holds(process.pid, out):
                time.sleep(0.01)
            process.send_signal(number)
        with os.fdopen(read_end) as told:
            text = told.read().lstrip()
        return process.wait(timeout=60), text

    def test_a_signal_leaves_nothing(self):
        for format in FORMATS:
            for number in SIGNALS:
                with self.subTest(format=format, signal=number.name):
                    out = self.folder / f"{format}-{number.name}"
                    status, told = self.interrupt(format, out, (number, has_written))
                    self.assertEqual((status, out.exists()), (130, False), told)
                    self.assertEqual(told, NOTICE)

    def test_a_signal_while_python_starts_leaves_nothing(self):
        status, told = self.interrupt("parquet", self.folder / "out", (signal.SIGINT, is_python))
        self.assertEqual((status, (self.folder / "out").exists(), told), (130, False, NOTICE))

    def test_the_second_signal_ends_at_once(self):
        status, _ = self.interrupt("parquet", self.folder / "out", (signal.SIGINT, has_written), (signal.SIGINT, catches_no_interrupt))
        self.assertEqual(status, -signal.SIGINT)

    def test_a_killed_export_leaves_nothing_under_its_name_and_the_next_one_goes_through(self):
        for format in FORMATS:
            with self.subTest(format=format):
                out, whole = self.folder / format, self.folder / f"{format}-whole"
                self.assertEqual(self.interrupt(format, out, (signal.SIGKILL, has_written))[0], -signal.SIGKILL)
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


def has_written(_, out):
    return any(files for _, _, files in os.walk(out))


def is_python(pid, _):
    return b"slipbench._export" in Path(f"/proc/{pid}/cmdline").read_bytes()


def catches_no_interrupt(pid, _):
    """SigCgt is a mask, with signal 1 as its lowest bit."""
    caught = re.search(r"^SigCgt:\s*(\w+)$", Path(f"/proc/{pid}/status").read_text(encoding="ascii"), re.MULTILINE)
    return not int(caught[1], 16) >> (signal.SIGINT - 1) & 1


if __name__ == "__main__":
    unittest.main()
