"""Detectors that misbehave: --isolate keeps their trials apart. Arguments: the program, plugins/misbehaves.cc as a library."""

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

LIMIT = 2.0  # s, above what an honest trial takes on a machine that does much else
IN_UPDATE = "detector.library: 'misbehaves.so' {} in update"
# What the message of the failed trial holds; None: nothing happens.
DEEDS = {
    "segv": IN_UPDATE.format("crashed") + ": SIGSEGV",
    "abort": IN_UPDATE.format("crashed") + ": SIGABRT",
    "fpe": IN_UPDATE.format("crashed") + ": SIGFPE",
    "stack": IN_UPDATE.format("crashed") + ": SIGSEGV",
    "heap": IN_UPDATE.format("crashed") + ": SIGABRT",
    "thread": IN_UPDATE.format("crashed") + ": SIGSEGV",
    "kill": IN_UPDATE.format("crashed") + ": Killed",
    "exit": IN_UPDATE.format("ended its process"),
    "_exit": IN_UPDATE.format("ended its process"),
    "files": "its process ended",
    "loop": IN_UPDATE.format("was still at work") + f" after {LIMIT:g} s, the limit",
    "deaf": IN_UPDATE.format("was still at work") + f" after {LIMIT:g} s, the limit",
    "memory": "threw 'std::bad_alloc' in update",
    "folder": None,
    "output": None,
    "latest": None,
}


def values(deeds):
    """An honest value between any two deeds; a cell each, of two trials."""
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
            scene_text(trials=1) + f"detector: {{type: plugin, library: misbehaves.so, parameters: {{deed: {deed}}}}}\n", encoding="ascii"
        )
        command = [PROGRAM, "run", "scene.yaml", "-o", "out.h5", *words]
        return subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def start(self, deeds, *words, honest=False):
        text = scene_text(trials=1).replace("  motion.speed", f"  detector.parameters.deed: {json.dumps(values(deeds))}\n  motion.speed")
        text = text.replace("[1 mm/s, 4 mm/s, 16 mm/s]", "[1 mm/s, 4 mm/s]")
        (self.folder / "scene.yaml").write_text(text + "detector: {type: plugin, library: misbehaves.so}\n", encoding="ascii")
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

    def bytes_of(self, deeds, *words, **options):
        self.sweep(deeds, "-o", "out.h5", "--quiet", *words, **options)
        content = (self.folder / "out.h5").read_bytes()
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
        out, _ = self.sweep(DEEDS, "--trial-limit", str(LIMIT), "--trial-memory", "1000", "--json", "-o", "out.h5", status=1)
        failed = {one["trial"]: one["message"] for one in json.loads(out)["failed"]}
        expected = {trial: DEEDS.get(deed) for i, deed in enumerate(values(DEEDS)) for trial in (2 * i, 2 * i + 1)}
        self.assertEqual(set(failed), {trial for trial, text in expected.items() if text})
        for trial, message in failed.items():
            self.assertIn(f"trial {trial}: ", message)
            self.assertIn(expected[trial], message)
        honest = digests(self.folder / "honest.h5")
        self.assertEqual(digests(self.folder / "out.h5"), {name: honest[name] for name in honest if int(name[5:]) not in failed})

    def test_a_single_trial_is_kept_apart_too(self):
        for deed, text in (("_exit", IN_UPDATE.format("ended its process")), ("folder", None)):
            with self.start_one(deed) as process:
                _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 2 if text else 0, error)
            self.assertEqual([path.name for path in self.folder.glob("out*")], [] if text else ["out.h5"])
            self.assertIn(text or "", error)
        with self.start_one("loop") as process:
            time.sleep(1.0)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=60), 130)
        self.assert_nothing_runs()

    def test_a_single_trial_tells_how_far_it_is(self):
        with self.start_one("slow") as process:  # 300 updates of 25 ms; nothing is told in the first 5 s
            _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, error)
        self.assertRegex(error, r"\b[1-9][0-9](\.\d)? % of the trial")

    def test_bytes_are_those_of_one_process(self):
        whole = self.bytes_of(["folder"], "--no-isolate", honest=True)
        for words in (["--jobs", "1"], ["--jobs", "3"]):
            self.assertEqual(self.bytes_of(["folder"], *words), whole)
        for k in "12":
            self.sweep(["folder"], "--shard", f"{k}/2", "-o", f"{k}.h5")
        subprocess.run([PROGRAM, "merge", "1.h5", "2.h5", "-o", "merged.h5"], cwd=self.folder, check=True, capture_output=True)
        self.assertEqual((self.folder / "merged.h5").read_bytes(), whole)
        crashed = self.bytes_of(["abort", "exit"], "--jobs", "1", status=1)
        self.assertEqual(self.bytes_of(["abort", "exit"], "--jobs", "3", status=1), crashed)

    def test_a_limit_is_kept_to_a_second(self):
        begin = time.monotonic()
        _, error = self.sweep(["loop"], "--trial-limit", "1 s", "--jobs", "1", status=1)
        # Two trials loop. The others are short.
        self.assertLess(time.monotonic() - begin, 2 * (1.0 + 1.0))
        self.assertIn("2 of 6 trials failed: 2 and 3", error)

    def test_what_is_wrong_before_the_first_trial_is_refused(self):
        for deed, text in {"make segv": "crashed", "make _exit": "ended its process", "make loop": "was still at work"}.items():
            _, error = self.sweep([deed], "--trial-limit", "1 s", status=2)
            self.assertIn(f"scene.yaml:15: detector.library: 'misbehaves.so' {text} in slipbench_make_detector", error)
        _, error = self.sweep(["none"], "--trial-limit", "1 s", "--no-isolate", status=2)
        self.assertIn("--no-isolate", error)

    def test_a_library_that_changes_ends_the_sweep(self):
        library = self.folder / "misbehaves.so"
        for way in ("another file", "written over"):
            library.unlink()
            shutil.copy(LIBRARY, library)
            with self.start(["none"], "--trials", "20000", "--jobs", "1", "-o", "out.h5") as process:
                while process.poll() is None and not (self.folder / "out.h5.partial").exists():
                    time.sleep(0.01)
                if way == "another file":
                    library.unlink()
                library.write_bytes(LIBRARY.read_bytes() + b"other")
                _, error = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 2, error)
            self.assertIn("misbehaves.so has changed since the first trial began", error)
            (self.folder / "out.partial.h5").unlink(missing_ok=True)

    def test_signals_end_all_processes(self):
        whole = self.bytes_of(["loop"], honest=True)
        for way, status in ((signal.SIGINT, 130), (signal.SIGTERM, 130), (signal.SIGKILL, -signal.SIGKILL)):
            with self.start(["loop"], "-o", "out.h5", "--jobs", "2") as process:
                time.sleep(2.0)  # both trials that loop have begun
                process.send_signal(way)
                begin = time.monotonic()
                self.assertEqual(process.wait(timeout=60), status)
                self.assertLess(time.monotonic() - begin, 1.0)
            self.assert_nothing_runs()
            self.assertEqual(self.bytes_of(["loop"], "--resume", honest=True), whole)


if __name__ == "__main__":
    unittest.main()
