"""Formats written by Python: a signal or a full disk leaves no half-written file under its name.

Arguments: the project's root, the program.
"""

import fcntl
import functools
import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from itertools import cycle
from pathlib import Path

from _made import PROGRAM, ROOT, ExportTest, contents, export

FORMATS = ("lerobot", "mcap", "parquet", "rosbag2")
# Formats written by C++ that have a file for each trial, and the names of the files.
FILES_OF_TRIALS = {"csv": "demo_{}-pad.csv", "npz": "demo_{}.npz", "vendor-csv": "LOG_demo_{}.csv"}
TRIALS = 3  # after the first trial the export reports the expected total
NOTICE = "slipbench: stopping after this trial; interrupt again to stop at once\n"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

# Argument: the request. Writes it as if a signal came after the last trial.
AFTER_THE_LAST = """
import json, signal, sys
from slipbench._export import write
from slipbench._export.request import Progress, Request
from slipbench._program import interruptible
request = Request(**json.loads(sys.argv[1]))
try:
    with interruptible("stopping after this trial") as interrupt:
        progress = Progress(request, interrupt, print)
        progress.update = lambda done, written: signal.raise_signal(signal.SIGINT) if done == len(request.trials) else None
        write(request, progress)
except KeyboardInterrupt:
    print("interrupted")
"""


class Interruption(ExportTest):
    @classmethod
    def setUpClass(cls):
        folder = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.dataset = str(folder / "many.h5")
        subprocess.run(
            [
                PROGRAM,
                "sweep",
                str(ROOT / "scenes/papillarray/stage.yaml"),
                "--trials",
                str(TRIALS),
                "--set",
                "sweep={}",
                "-o",
                cls.dataset,
                "--quiet",
            ],
            check=True,
        )

    def interrupt(self, format, out, holds, *numbers, ignored=()):
        """Sends the signals once `holds` of the process and `out`.

        If both signals are equal, repeats the second until the process ends.

        Until then the export's stderr is a full pipe, so that the export waits with the line after
        the first trial, however slow this process is. Returns the exit status and the output
        without that line.
        """
        read_end, write_end = os.pipe()
        os.write(write_end, b" " * fcntl.fcntl(write_end, fcntl.F_SETPIPE_SZ, 4096))
        process = subprocess.Popen(
            [PROGRAM, "export", self.dataset, "--format", format, "-o", str(out)],
            stderr=write_end,
            stdout=subprocess.DEVNULL,
            preexec_fn=lambda: [signal.signal(number, signal.SIG_IGN) for number in ignored],
        )
        os.close(write_end)
        wait_for(lambda: process.poll() is not None or holds(process.pid, out), process)
        for number in numbers:
            process.send_signal(number)
        if numbers[1:] == numbers[:1]:  # two of one signal may be merged into one
            wait_for(lambda: process.send_signal(numbers[0]) or process.poll() is not None, process)
        with os.fdopen(read_end) as told:
            text = re.sub(
                f"^{TRIALS} trials, about .*\n", "", told.read().lstrip(), flags=re.MULTILINE
            )
        return process.wait(timeout=60), text

    def test_a_signal_leaves_nothing(self):
        for format, number in zip(
            FORMATS, cycle(SIGNALS), strict=False
        ):  # leftovers do not depend on the signal
            with self.subTest(format=format, signal=number.name):
                status, told = self.interrupt(format, self.folder / format, has_written, number)
                self.assertEqual(
                    (status, (self.folder / format).exists(), told), (130, False, NOTICE)
                )

    def test_a_signal_keeps_the_files_of_finished_trials_alone(self):
        """The signal comes while the first trial is written, or while the program waits after it.

        Then the next check follows the second trial.
        """
        for (format, name), number in zip(FILES_OF_TRIALS.items(), SIGNALS, strict=True):
            with self.subTest(format=format, signal=number.name):
                out = self.folder / format
                status, told = self.interrupt(format, out, has_written, number)
                files = sorted(contents(out))
                kept = ["1 file is kept", "2 files are kept"][len(files) - 1]
                self.assertEqual((status, told), (130, f"{NOTICE}slipbench: interrupted; {kept}\n"))
                self.assertEqual(files, [name.format(trial) for trial in range(len(files))])

    def test_a_signal_leaves_nothing_of_a_robomimic_file(self):
        out = self.folder / "out"
        status, told = self.interrupt("robomimic", out, has_written, signal.SIGINT)
        self.assertEqual((status, out.exists()), (130, False))
        self.assertEqual(told, NOTICE + "slipbench: interrupted; nothing is kept\n")

    def test_a_signal_while_python_starts_leaves_nothing(self):
        status, told = self.interrupt("parquet", self.folder / "out", is_python, signal.SIGINT)
        self.assertEqual((status, (self.folder / "out").exists(), told), (130, False, NOTICE))

    def test_the_second_signal_ends_at_once(self):
        for numbers in (
            (signal.SIGINT, signal.SIGINT),
            (signal.SIGTERM, signal.SIGINT),
            (signal.SIGHUP, signal.SIGTERM),
        ):
            for holds in (has_written, is_python):
                with self.subTest(signals=numbers, holds=holds.__name__):
                    out = self.folder / "-".join(
                        [holds.__name__, *(number.name for number in numbers)]
                    )
                    status, told = self.interrupt("parquet", out, holds, *numbers)
                    self.assertIn(status, [-number for number in numbers])
                    self.assertNotIn("Traceback", told)

    def test_an_ignored_signal_stays_ignored(self):
        for number in SIGNALS:
            with self.subTest(signal=number.name):
                status, told = self.interrupt(
                    "parquet", self.folder / number.name, has_written, number, ignored=[number]
                )
                self.assertEqual(status, 0)
                self.assertRegex(told, rf"^{TRIALS}/{TRIALS} trials \(100 %\), .*\n$")

    def test_a_signal_after_the_last_trial_leaves_nothing(self):
        """The files are kept from the moment on at which they get their names."""
        request = {
            "dataset": self.dataset,
            "trials": [0],
            "sensors": ["pad"],
            "rate": None,
            "labels": None,
            "label_speed": None,
            "points": False,
            "licence": "",
            "files": [],
        }
        for format in FORMATS:
            with self.subTest(format=format):
                out = self.folder / format
                words = json.dumps(request | {"format": format, "out": str(out)})
                done = subprocess.run(
                    [sys.executable, "-P", "-c", AFTER_THE_LAST, words],
                    capture_output=True,
                    text=True,
                    check=False,
                    env=os.environ | {"PYTHONPATH": str(Path(PROGRAM).parents[1] / "python")},
                )
                self.assertEqual(
                    (done.returncode, done.stdout, out.exists()),
                    (0, "interrupted\n", False),
                    done.stderr,
                )

    def test_a_killed_export_leaves_nothing_under_its_name_and_the_next_one_goes_through(self):
        for format in FORMATS:
            with self.subTest(format=format):
                out, whole = self.folder / format, self.folder / f"{format}-whole"
                self.assertEqual(
                    self.interrupt(format, out, has_written, signal.SIGKILL)[0], -signal.SIGKILL
                )
                left = set(contents(out))
                self.assertTrue(left)
                self.assertEqual({name for name in left if ".partial" not in name}, set())
                export(self.dataset, out, "--format", format)
                export(self.dataset, whole, "--format", format)
                self.assertEqual(contents(out), contents(whole))

    def test_a_full_disk_is_told_and_leaves_nothing(self):
        """A limit on a file's size emulates a full disk.

        The write fails half-way in the same place.
        """
        for format in FORMATS:
            with self.subTest(format=format):
                whole = self.folder / f"{format}-whole"
                export(self.dataset, whole, "--format", format, "--trial", "0")
                limit = max(len(text) for text in contents(whole).values()) // 2
                out = self.folder / format
                done = subprocess.run(
                    [PROGRAM, "export", self.dataset, "--format", format, "-o", str(out)],
                    capture_output=True,
                    text=True,
                    check=False,
                    preexec_fn=functools.partial(
                        resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit)
                    ),
                )
                self.assertEqual((done.returncode, out.exists()), (2, False))
                self.assertRegex(done.stderr, r"^slipbench: cannot write .*: File too large\n$")
                self.assertNotIn("Traceback", done.stderr)


def wait_for(condition, process):
    """Ends the process if the condition does not occur."""
    last = time.monotonic() + 120
    while not condition():
        if time.monotonic() > last:
            process.kill()
            raise AssertionError("the export came to nothing in two minutes")
        time.sleep(0.01)


def has_written(_, out):
    return any(files for _, _, files in os.walk(out))


def is_python(pid, _):
    return b"slipbench._export" in Path(f"/proc/{pid}/cmdline").read_bytes()


if __name__ == "__main__":
    unittest.main()
