"""A sweep of some seconds, its undivided dataset, and helpers for tests with real schedulers."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "sweep"))
from short_sweep import scene_text  # noqa: E402

SHARDS = 8
OUTCOMES = ("--record", "outcome")  # arrays would take longer to verify than to simulate
PATIENCE = 300  # s, after which a scheduler counts as hung


def wait_for(what, condition):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"{what}: not within {PATIENCE} s")


def content(path):
    with h5py.File(path) as file:
        return file.attrs["content_sha256"]


class SweepFolder:
    """The scene and its whole sweep in `folder`, shared by all rounds."""

    def __init__(self, program, folder):
        self.program, self.folder = program, Path(folder)
        self.scene = self.folder / "scene.yaml"
        # A shard of 90 trials takes 2 s on a core of 2026, so it can be killed while it simulates.
        self.scene.write_text(scene_text(trials=240, duration="4 s", bristles=6), encoding="ascii")
        self.whole = self.folder / "whole.h5"
        self.run("sweep", "scene.yaml", *OUTCOMES, "-o", self.whole, "--quiet")

    def run(self, *words):
        subprocess.run(
            [self.program, *map(str, words)],
            check=True,
            cwd=self.folder,
            stdout=subprocess.DEVNULL,
            timeout=PATIENCE,
        )

    def cluster(self, name):
        """Makes the folder of `slipbench cluster`."""
        self.run("cluster", "scene.yaml", "-o", name, "--shards", SHARDS, *OUTCOMES)
        return self.folder / name

    def sweep_process(self, cluster, k):
        """Returns the process that simulates shard k below the folder `cluster`, or None."""
        for entry in os.listdir("/proc"):
            try:
                words = (
                    Path("/proc", entry, "cmdline").read_bytes().decode().split("\0")
                    if entry.isdigit()
                    else []
                )
            except OSError:
                continue
            if f"{k}/{SHARDS}" in words and any(word.startswith(f"{cluster}/") for word in words):
                return int(entry)
        return None

    def kill_in_the_middle(self, cluster, k):
        """Kills shard k once it has begun its first file."""

        def process_with_file():
            return any(
                cluster.glob(f"attempts/{k}.*/shard.h5.partial/batch*")
            ) and self.sweep_process(cluster, k)

        os.kill(wait_for(f"shard {k} simulates", process_with_file), signal.SIGKILL)
        assert not (cluster / f"shards/{k}").exists(), (
            f"shard {k} was finished before it could be killed"
        )

    def merged_is_whole(self, cluster):
        subprocess.run(
            ["bash", cluster / "merge.sh"], check=True, stdout=subprocess.DEVNULL, timeout=PATIENCE
        )
        return content(cluster / "scene.h5") == content(self.whole)
