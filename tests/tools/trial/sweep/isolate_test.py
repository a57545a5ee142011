"""Misbehaving detectors: --isolate contains the damage to their own trials.

Arguments: the program, plugins/misbehaves.cc as a library.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
from short_sweep import scene_text

LIBRARY = Path(sys.argv.pop(2)).resolve()
PROGRAM = Path(sys.argv.pop(1)).resolve()

LIMIT = 2.0  # s, above the time of an honest trial on a busy machine
KILLED_BY = "its worker process was killed by "
UNFINISHED = "its worker process ended with status {} before its work was done"
LATE = f"its worker process was still running at the limit of {LIMIT:g} s"
IN_UPDATE = "detector.library: 'misbehaves.so' threw {} in update"
# Words in the failed trial's message; None: no trial fails.
DEEDS = {
    "segv": KILLED_BY + "SIGSEGV",
    "abort": KILLED_BY + "SIGABRT",
    "fpe": KILLED_BY + "SIGFPE",
    "stack": KILLED_BY + "SIGSEGV",
    "heap": KILLED_BY + "SIGABRT",
    "thread": KILLED_BY + "SIGSEGV",
    "kill": KILLED_BY + "SIGKILL",
    "destroy": KILLED_BY + "SIGSEGV",
    "pipe": "its worker process returned an invalid result",
    "exit": UNFINISHED.format(0),
    "_exit": UNFINISHED.format(0),
    "files": UNFINISHED.format(1),
    "loop": LATE,
    "deaf": LATE,
    "memory": IN_UPDATE.format("'std::bad_alloc'"),
    "throw": IN_UPDATE.format("'out of ideas'"),
    "folder": None,
    "output": None,
    "latest": None,
    "rounding": None,
    "signals": None,
    "fork": None,
}
CHANGES_ITS_TRIAL = "rounding"


def values(deeds):
    """Returns an honest value between any two deeds; one cell each, with two trials."""
    return [value for deed in deeds for value in ("none", deed)] + ["none"]


def digests(path):
    with h5py.File(path) as file:
        return {name: demo.attrs["sha256"] for name, demo in file["data"].items()}


class IsolateTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory())).resolve()
        os.symlink(LIBRARY, self.folder / "misbehaves.so")

    def start_one(self, deed, *words):
        (self.folder / "scene.yaml").write_text(
            scene_text(trials=1)
            + f"detector: {{type: plugin, library: misbehaves.so, parameters: {{deed: {deed}}}}}\n",
            encoding="ascii",
        )
        command = [PROGRAM, "run", "scene.yaml", "-o", "out.h5", *words]
        return subprocess.Popen(
            command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    def start(self, deeds, *words, honest=False):
        text = scene_text(trials=1).replace(
            "  motion.speed",
            f"  detector.parameters.deed: {json.dumps(values(deeds))}\n  motion.speed",
        )
        text = text.replace("[1 mm/s, 4 mm/s, 16 mm/s]", "[1 mm/s, 4 mm/s]")
        (self.folder / "scene.yaml").write_text(
            text + "detector: {type: plugin, library: misbehaves.so}\n", encoding="ascii"
        )
        return subprocess.Popen(
            [PROGRAM, "sweep", "scene.yaml", *words],
            cwd=self.folder,
            env=dict(os.environ, **({"SLIPBENCH_HONEST": "1"} if honest else {})),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def sweep(self, deeds, *words, status=0, **options):
        with self.start(deeds, *words, **options) as process:
            out, error = process.communicate(timeout=120)
        self.assertEqual(process.returncode, status, error)
        return out, error

    def content_of(self, deeds, *words, **options):
        self.sweep(deeds, "-o", "out.h5", "--quiet", *words, **options)
        with h5py.File(self.folder / "out.h5") as file:
            content = file.attrs["content_sha256"]
        (self.folder / "out.h5").unlink()
        return content

    def assert_nothing_runs(self):
        time.sleep(1.0)
        for process in Path("/proc").glob("[0-9]*"):
            try:
                place = os.readlink(process / "cwd")
            except OSError:
                continue
            self.assertNotEqual(place, str(self.folder), (process / "cmdline").read_bytes())

    def test_a_deed_fails_its_trial_alone(self):
        self.sweep(DEEDS, "--no-isolate", "-o", "honest.h5", honest=True)
        out, _ = self.sweep(DEEDS, "--trial-limit", str(LIMIT), "--json", "-o", "out.h5", status=1)
        failed = {one["trial"]: one["message"] for one in json.loads(out)["failed"]}
        expected = {
            trial: DEEDS.get(deed)
            for i, deed in enumerate(values(DEEDS))
            for trial in (2 * i, 2 * i + 1)
        }
        self.assertEqual(set(failed), {trial for trial, text in expected.items() if text})
        for trial, message in failed.items():
            self.assertIn(f"trial {trial}: ", message)
            self.assertIn(expected[trial], message)
        changed = {2 * values(DEEDS).index(CHANGES_ITS_TRIAL) + k for k in (0, 1)}
        honest, found = digests(self.folder / "honest.h5"), digests(self.folder / "out.h5")
        self.assertEqual(set(found), {name for name in honest if int(name[5:]) not in failed})
        for name, digest in found.items():
            self.assertEqual(digest == honest[name], int(name[5:]) not in changed, name)
        self.assert_nothing_runs()

    def test_a_single_trial_is_isolated_where_it_is_asked_for(self):
        for deed, text in (("_exit", UNFINISHED.format(0)), ("folder", None)):
            with self.start_one(deed, "--isolate") as process:
                _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 2 if text else 0, error)
            self.assertEqual(
                [path.name for path in self.folder.glob("out*")], [] if text else ["out.h5"]
            )
            self.assertIn(text or "", error)
        with self.start_one("loop", "--isolate") as process:
            time.sleep(1.0)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=60), 130)
        self.assert_nothing_runs()

    def test_a_crash_ends_the_program_without_isolation(self):
        with self.start_one("segv") as process:
            self.assertEqual(process.wait(timeout=60), -signal.SIGSEGV)
        self.assertFalse((self.folder / "out.h5").exists())

    def test_a_single_trial_tells_how_far_it_is(self):
        with self.start_one(
            "slow"
        ) as process:  # 300 updates of 25 ms; nothing is printed in the first 5 s
            _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, error)
        self.assertRegex(error, r"\b[1-9][0-9](\.\d)? % of the trial")

    def test_bytes_are_those_of_one_process(self):
        whole = self.content_of(["folder"], "--no-isolate", honest=True)
        for words in (["--jobs", "1"], ["--jobs", "3"]):
            self.assertEqual(self.content_of(["folder"], *words), whole)
        for k in "12":
            self.sweep(["folder"], "--shard", f"{k}/2", "-o", f"{k}.h5")
        subprocess.run(
            [PROGRAM, "merge", "1.h5", "2.h5", "-o", "merged.h5"],
            cwd=self.folder,
            check=True,
            capture_output=True,
        )
        with h5py.File(self.folder / "merged.h5") as file:
            self.assertEqual(file.attrs["content_sha256"], whole)
        crashed = self.content_of(["abort", "exit"], "--jobs", "1", status=1)
        self.assertEqual(self.content_of(["abort", "exit"], "--jobs", "3", status=1), crashed)

    def test_a_limit_is_kept_to_a_second(self):
        begin = time.monotonic()
        _, error = self.sweep(["loop"], "--trial-limit", "1 s", "--jobs", "1", status=1)
        # Two trials loop. The others are short.
        self.assertLess(time.monotonic() - begin, 2 * (1.0 + 1.0))
        self.assertIn("2 of 6 trials failed: 2 and 3", error)

    def test_what_is_wrong_before_the_first_trial_is_refused(self):
        texts = {
            "make segv": "was killed by SIGSEGV",
            "make _exit": "ended with status 0",
            "make loop": "was still running at the limit of 3 s",
        }
        for deed, text in texts.items():
            _, error = self.sweep([deed], "--trial-limit", "0.5 s", status=2)
            self.assertIn(f"before the first trial: its process {text}", error)
        _, error = self.sweep(["none"], "--trial-limit", "1 s", "--no-isolate", status=2)
        self.assertIn("--no-isolate", error)

    def test_a_library_that_changes_ends_the_sweep(self):
        library = self.folder / "misbehaves.so"
        for way in ("another file", "written over"):
            library.unlink()
            shutil.copy(LIBRARY, library)
            with self.start(
                ["none"], "--trials", "20000", "--jobs", "1", "-o", "out.h5"
            ) as process:
                while process.poll() is None and not (self.folder / "out.h5.partial").exists():
                    time.sleep(0.01)
                if way == "another file":
                    library.unlink()
                library.write_bytes(LIBRARY.read_bytes() + b"other")
                _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 2, error)
            self.assertIn("misbehaves.so has changed during the run", error)
            shutil.rmtree(self.folder / "out.h5.partial", ignore_errors=True)

    def test_signals_end_all_processes(self):
        whole = self.content_of(["loop"], honest=True)
        for way, status in (
            (signal.SIGINT, 130),
            (signal.SIGTERM, 130),
            (signal.SIGKILL, -signal.SIGKILL),
        ):
            with self.start(["loop"], "-o", "out.h5", "--jobs", "2") as process:
                time.sleep(2.0)  # both looping trials have begun
                process.send_signal(way)
                begin = time.monotonic()
                self.assertEqual(process.wait(timeout=60), status)
                self.assertLess(time.monotonic() - begin, 1.0)
            self.assert_nothing_runs()
            self.assertEqual(self.content_of(["loop"], "--resume", honest=True), whole)


if __name__ == "__main__":
    unittest.main()
