"""Tests `slipbench view --rerun` with the test's own Python: rerun_test.py PROGRAM.

A module of the test replaces rerun-sdk, which takes 700 MB, and records what it is sent. If the
real one is installed, too, it saves a recording, which is read back.
"""

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv.pop(1)).resolve()
SCENE = """slipbench: 1
duration: 0.5 s
seed: 1
motion: {kind: stage, gap: 0.1 mm, compression: 1 mm, approach_speed: 20 mm/s, start: 0.2 s, speed: 8 mm/s, acceleration: 1 m/s2}
sensors: {pad: {type: papillarray, rate: 1 kHz}}
sweep: {motion.speed: [8 mm/s, 16 mm/s], trials: 4}
"""
# Rerun as far as it is used. Any other call, such as log(), which sends a row, fails.
STAND_IN = """
import atexit, json, os
said = []
atexit.register(lambda: open(os.environ["SAID"], "w").write(json.dumps(said)))
escape_entity_path_part = lambda part: part
class TimeColumn:
    def __init__(self, timeline, *, duration): self.rows, self.timeline = list(map(float, duration)), timeline
class Scalars:
    @staticmethod
    def columns(*, scalars): return {"shape": list(scalars.shape), "type": str(scalars.dtype), "last": scalars[-1].tolist()}
class Transform3D:
    @staticmethod
    def columns(*, translation, quaternion): return {"translation": list(translation.shape), "first_turn": quaternion[0].tolist()}
class RecordingStream:
    def __init__(self, application, *, recording_id): said.append(["recording", recording_id])
    def save(self, path): said.append(["save", path])
    def spawn(self): said.append(["spawn"])
    def connect_grpc(self): said.append(["connect"])
    def send_recording_name(self, name): said.append(["name", name])
    def flush(self): pass
    def send_columns(self, entity, indexes, columns):
        [index] = indexes
        said.append(["columns", entity, index.timeline, len(index.rows), index.rows[0], index.rows[-1], columns])
"""


class Rerun(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "scene.yaml").write_text(SCENE)
        self.environment = {
            **os.environ,
            "SLIPBENCH_PYTHON": sys.executable,
            "SAID": str(self.folder / "said.json"),
            "TMPDIR": str(self.folder),
        }

    def run_program(self, *words, **more):
        return subprocess.run(
            [PROGRAM, *words],
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=300,
            env={**self.environment, **more},
        )

    def use(self, module):
        (self.folder / "modules").mkdir()
        (self.folder / "modules/rerun.py").write_text(module)
        self.environment["PYTHONPATH"] = str(self.folder / "modules")

    def said(self):
        return json.loads((self.folder / "said.json").read_text())

    def record(self):
        self.assertEqual(
            self.run_program("sweep", "scene.yaml", "-o", "a.h5", "--quiet").returncode, 0
        )

    def test_sends_columns(self):
        self.use(STAND_IN)
        self.record()
        done = self.run_program("view", "a.h5", "--rerun", "--trial", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        said = self.said()
        self.assertEqual(
            [one for one in said if one[0] in ("spawn", "name")],
            [["spawn"], ["name", "a.h5, trial 3"]],
        )
        sent = {one[1]: one[2:] for one in said if one[0] == "columns"}
        # 500 samples of 0.5 s at 1 kHz, from 0 on; nine pillars with three components each.
        timeline, rows, first, last, columns = sent["sensors/pad/force [N]"]
        self.assertEqual(
            (timeline, rows, first, columns["shape"], columns["type"]),
            ("trial_time", 500, 0.0, [500, 27], "float64"),
        )
        self.assertAlmostEqual(last, 0.499, places=9)
        self.assertEqual(sent["labels/pad/state"][4]["shape"], [500, 1])
        # The stage's pad does not turn: the real part, stored first and sent last, is 1 or -1.
        pose = sent["truth/surface/pose"][4]
        self.assertEqual(pose["translation"], [500, 3])
        self.assertEqual([abs(part) for part in pose["first_turn"]], [0.0, 0.0, 0.0, 1.0])
        # Every array with rows in time is sent once, and nothing else.
        self.assertEqual(len(sent), sum(one[0] == "columns" for one in said))
        self.assertFalse([name for name in sent if "events" in name or name.endswith("/t")])
        self.assertEqual(
            [path.name for path in self.folder.glob("slipbench-rerun-*")],
            [],
            "what Python read is left behind",
        )

    def test_shows_recordings_without_truth(self):
        self.use(STAND_IN)
        self.record()
        for words in (
            ("export", "a.h5", "--format", "vendor-csv", "-o", "logs"),
            ("import", "logs", "--format", "papillarray-csv", "-o", "real.h5"),
        ):
            self.assertEqual(self.run_program(*words).returncode, 0, words)
        done = self.run_program("view", "real.h5", "--rerun", "--trial", "3")
        self.assertEqual(done.returncode, 0, done.stderr)
        sent = {one[1]: one[2:] for one in self.said() if one[0] == "columns"}
        self.assertEqual(
            sent["sensors/pad/force [N]"][4]["shape"], [500, 27]
        )  # as in test_sends_columns()
        self.assertEqual(sent["labels/pad/state_recorded"][4]["shape"], [500, 1])
        self.assertEqual(
            [name for name in sent if name.startswith("labels/")], ["labels/pad/state_recorded"]
        )
        self.assertFalse(
            [name for name in sent if name.startswith("truth/")], "there are no bodies"
        )

    def test_follows_a_run(self):
        self.use(STAND_IN)
        # A run of seconds: two speeds, 2400 draws each, so that there is more than one batch.
        run = subprocess.Popen(
            [
                PROGRAM,
                "sweep",
                "scene.yaml",
                "--trials",
                "2400",
                "--jobs",
                "1",
                "-o",
                "a.h5",
                "--quiet",
            ],
            cwd=self.folder,
        )
        self.addCleanup(run.wait)
        end = time.monotonic() + 60
        while not (self.folder / "a.h5.partial").exists():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)
        done = self.run_program("view", "a.h5", "--rerun", "--json")
        self.assertEqual(run.wait(), 0)
        self.assertEqual(done.returncode, 0, done.stderr)
        trials = json.loads(done.stdout)["trials"]
        self.assertEqual(trials, sorted(set(trials)))
        self.assertEqual(trials[-1], 4799)  # all of them
        self.assertGreater(len(trials), 1)
        names = [one[1] for one in self.said() if one[0] == "name"]
        self.assertEqual(names, [f"a.h5, trial {trial}" for trial in trials])
        self.assertEqual(
            [one[0] for one in self.said() if one[0] in ("spawn", "connect")],
            ["spawn"] + ["connect"] * (len(trials) - 1),
        )

    def test_says_how_to_get_it(self):
        self.use("raise ImportError")
        self.record()
        for subject in ("a.h5", "scene.yaml"):
            done = self.run_program("view", subject, "--rerun")
            self.assertEqual(done.returncode, 2)
            self.assertEqual(
                done.stderr,
                f"slipbench: view: --rerun needs rerun-sdk, which {sys.executable} does not have; install it: "
                f"{sys.executable} -m pip install rerun-sdk\n",
            )
            self.assertEqual(done.stdout, "")
        self.assertFalse(
            (self.folder / "scene.h5").exists(), "simulated before it looked for rerun-sdk"
        )

    def test_a_failure_of_rerun_is_one_message(self):
        self.use(
            STAND_IN.replace(
                "def flush(self): pass", "def flush(self): raise TypeError('no such argument')"
            )
        )
        self.record()
        done = self.run_program("view", "a.h5", "--rerun")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(
            done.stderr.splitlines()[-1],
            f"slipbench: view: --rerun: rerun-sdk of {sys.executable} failed: TypeError: no such argument",
        )
        self.assertNotIn("Traceback", done.stderr)

    def test_refusals(self):
        self.use(STAND_IN)
        self.record()
        (self.folder / "mine.rrd").write_text("mine")
        for words, names in (
            (("a.h5", "--trial", "9"), "view: a.h5.*trial 9"),
            (("b.h5",), "view: b.h5: does not exist"),
            (("a.h5", "-o", "mine.rrd"), "mine.rrd"),
            (("a.h5", "-o", "a.html"), "view: -o.*'a.html'.*.rrd"),
        ):
            done = self.run_program("view", *words, "--rerun")
            self.assertEqual(done.returncode, 2, words)
            self.assertRegex(done.stderr, names)
        self.assertEqual((self.folder / "mine.rrd").read_text(), "mine")
        done = self.run_program("view", "a.h5", "--rerun", SLIPBENCH_PYTHON="/absent/python3")
        self.assertEqual(done.returncode, 2)
        self.assertIn(
            "view: --rerun needs Python with rerun-sdk; cannot start /absent/python3", done.stderr
        )

    @unittest.skipUnless(
        importlib.util.find_spec("rerun"), "rerun-sdk is not in this Python: pip install rerun-sdk"
    )
    def test_rerun_itself_saves_a_recording(self):
        self.record()
        done = self.run_program("view", "a.h5", "--rerun", "-o", "a.rrd")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "a.rrd").read_bytes().startswith(b"RRF"))
        stats = subprocess.run(
            [sys.executable, "-m", "rerun", "rrd", "stats", "a.rrd"],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        self.assertIn("num_rows_max = 500\n", stats)
        self.assertIn("/sensors/pad/force", stats)


if __name__ == "__main__":
    unittest.main()
