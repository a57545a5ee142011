"""Kills sweeps at random instants.

Batches stay readable, and --resume gives the undisturbed digest.

usage: kill_test.py ROOT SLIPBENCH PLUGIN KIND ENDS SEED [TRIALS]

KIND: stage, grasp, outcome or plugin. TRIALS: of each speed of a stage (default: 250). Of four ends
two are SIGKILL, one is a full disk (a limit on the file's size) and one SIGTERM. After each: no
file with a batch's final name is lost, h5py reads all trials of each, the last batch is at most 5 s
old, --resume simulates no trial of a batch again, and the digest is right.
"""

import json
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
from short_sweep import scene_text

SECONDS = 240  # no reader and no run takes longer
OLDEST = 5.0  # s, largest age of work that is repeated
SLOW = 5.0  # s more on a busy machine, where a trial or a sync takes longer


def kinds(root, plugin, trials):
    """Returns scene and words of each kind of sweep.

    Each takes some seconds and so has more than one batch.
    """
    some = ["--trials", trials]
    return {
        "stage": (None, some),
        "outcome": (None, ["--trials", "2000", "--record", "outcome"]),
        "grasp": (
            root / "scenes/grasp/lift.yaml",
            [
                "--set",
                "duration=2 s",
                "motion.distance=10 mm",
                "sweep={box.mass: [50 g, 100 g], trials: 60}",
            ],
        ),
        "plugin": (
            None,
            [
                *some,
                "--set",
                f"detector={{type: plugin, library: {plugin}, parameters: {{deed: none}}}}",
            ],
        ),
    }


def read(name, item):
    """Reads the attributes and the array of an object, for `visititems`."""
    dict(item.attrs)
    if isinstance(item, h5py.Dataset):
        _ = item[()]


def read_all(path):
    """Reads every array and attribute of a file; returns its trials."""
    with h5py.File(path, locking=False) as file:
        for demo in file["data"].values():
            dict(demo.attrs)
            demo.visititems(read)
        return len(file["data"])


def content(path):
    with h5py.File(path) as file:
        return file.attrs["content_sha256"]


def batches(out):
    folder = Path(f"{out}.partial")
    return sorted(folder.glob("batch*.h5")) if folder.is_dir() else []


class Ends:
    def __init__(self, root, program, plugin, kind, seed, trials="250"):
        self.program, self.kind, self.draw = program, kind, random.Random(seed)
        self.scene, self.words = kinds(root, plugin, trials)[kind]
        self.oldest = self.repeated = 0.0

    def sweep(self, out, *more, **options):
        words = [self.program, "sweep", self.scene, *self.words, "-o", out, *more]
        return subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options
        )

    def finish(self, sweep, statuses=(0,)):
        told, said = sweep.communicate(timeout=SECONDS)
        assert sweep.returncode in statuses, f"{self.kind}: status {sweep.returncode}: {said}"
        return told

    def disturb(self, out, way, duration, size):
        """Ends a sweep; returns the number of trials in its batches."""
        limit = self.draw.randrange(size // 20, size) if way == "full" else resource.RLIM_INFINITY
        begin = ended = time.time()
        sweep = self.sweep(out, "--quiet", "--jobs", self.draw.choice("12"),
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))  # fmt: skip
        seen = []
        if way != "full":
            wait = begin + self.draw.uniform(0.0, 1.1 * duration)
            while time.time() < wait and sweep.poll() is None:
                seen = batches(out)
                time.sleep(0.01)
            sweep.send_signal(signal.SIGKILL if way == "kill" else signal.SIGTERM)
            ended = time.time()
        self.finish(
            sweep,
            {"kill": (-signal.SIGKILL, 0), "term": (130, 0, -signal.SIGTERM), "full": (2,)}[way],
        )
        if out.exists():  # already at its end
            return None
        left = batches(out)
        assert set(seen) <= set(left), f"{way}: {set(seen) - set(left)} are lost"
        if way == "kill":
            # Renaming sets the time of the file's own entry. The lock is made when the trials
            # begin.
            lock = Path(f"{out}.partial/lock")
            begun = lock.stat().st_mtime if lock.exists() else begin
            age = ended - max([begun, *(path.stat().st_ctime for path in left)])
            self.oldest = max(self.oldest, age)
            assert age <= OLDEST + SLOW, f"the last batch was {age:.1f} s old"
        return sum(map(read_all, left))

    def run(self, ends):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            if self.scene is None:
                self.scene = folder / "scene.yaml"
                self.scene.write_text(scene_text(trials=30), encoding="ascii")
            whole, out = folder / "whole.h5", folder / "out.h5"
            begin = time.monotonic()
            told = json.loads(self.finish(self.sweep(whole, "--json")))
            duration, size, trials = (
                time.monotonic() - begin,
                whole.stat().st_size,
                len(told["trials"]),
            )
            held_in_all = 0
            for attempt in range(ends):
                held = self.disturb(
                    out, ("kill", "full", "kill", "term")[attempt % 4], duration, size
                )
                if held is not None:
                    told = json.loads(self.finish(self.sweep(out, "--resume", "--json")))
                    assert told["resumed"] == held, (
                        f"{held} trials were in batches, {told['resumed']} were taken from them"
                    )
                    assert len(told["trials"]) == trials
                    held_in_all += held
                assert content(out) == content(whole), f"attempt {attempt}: another content digest"
                assert {path.name for path in folder.iterdir()} <= {
                    "out.h5",
                    "scene.yaml",
                    "whole.h5",
                }
                out.unlink()
        print(f"{self.kind}: {ends} sweeps of {trials} trials, {duration:.1f} s, were ended at random instants; {held_in_all} trials were kept; "
              f"none of a finished batch was lost; the last batch was at most {self.oldest:.1f} s old")  # fmt: skip


if __name__ == "__main__":
    Ends(
        Path(sys.argv[1]),
        Path(sys.argv[2]),
        sys.argv[3],
        sys.argv[4],
        int(sys.argv[6]),
        *sys.argv[7:],
    ).run(int(sys.argv[5]))
