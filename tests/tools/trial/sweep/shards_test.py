"""A sweep divided into shards and merged has the content digest of the undivided one.

Arguments: the project's root, the program.
"""

import json
import re
import resource
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
from short_sweep import scene_text

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()

TRIALS = 21

# Variants of the file: outcomes alone, a control loop, the scene's own split, materials, trials of
# several costs, failures.
SWEEPS = {
    "stage": (),
    "outcome": ("--record", "outcome"),
    "detector": ("--set", "detector={type: force_ratio}", "--record", "outcome"),
    "split": ("--set", "split={by: speed, shares: [0.4, 0.3, 0.3]}"),
    "materials": ("--set", "sweep={surface.material: [acrylic, felt, ptfe, rubber], trials: 3}"),
    "costs": (
        "--set",
        "sweep={duration: [200 ms, 300 ms, 400 ms], sensors.pad.bristles: [1, 6], trials: 2}",
    ),
    # The second cell exceeds the range of a float.
    "failures": (
        "--set",
        "sweep={sensors.pad.electronics: [ideal, [{offset: {scale: 1e50}}]], trials: 3}",
    ),
}

GRASP = (
    "--set",
    "duration=2 s",
    "motion.distance=10 mm",
    "sweep={box.mass: [50 g, 100 g], trials: 2}",
)


def bytes_of(path):
    return path.read_bytes()


def content(path):
    with h5py.File(path) as file:
        return file.attrs["content_sha256"]


class ShardsTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.scene = self.folder / "scene.yaml"
        self.scene.write_text(scene_text(trials=7), encoding="ascii")

    def run_program(self, *words, status=0, **options):
        result = subprocess.run(
            [PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=300, **options
        )
        self.assertEqual(result.returncode, status, f"{words}: {result.stderr}")
        return result

    def sweep(self, name, *words, scene=None, status=0):
        out = self.folder / name
        self.run_program("sweep", scene or self.scene, *words, "-o", out, "--quiet", status=status)
        return out

    def shards(self, count, *words, scene=None, statuses=(0,)):
        shards = []
        for k in range(1, count + 1):
            out = self.folder / f"shard-{k}.h5"
            result = subprocess.run(
                [
                    PROGRAM,
                    "sweep",
                    scene or self.scene,
                    *words,
                    "--shard",
                    f"{k}/{count}",
                    "-o",
                    out,
                    "--quiet",
                    "--jobs",
                    str(1 + k % 2),
                ],
                capture_output=True,
                text=True,
            )
            self.assertIn(result.returncode, statuses, result.stderr)
            shards.append(out)
        return shards

    def wait_for_a_trial(self, folder, process):
        """Waits until `process` has written a part of a batch."""
        while process.poll() is None:
            if any(path.stat().st_size > 100_000 for path in folder.glob("batch*")):
                return
            time.sleep(0.002)
        self.fail("it ended before it had finished a trial")

    def assert_refused(self, told, *words, status=2):
        result = self.run_program(*words, status=status)
        self.assertRegex(result.stderr + result.stdout, told)

    def check_same_content(self, count, *words, scene=None, status=0):
        whole = self.sweep("whole.h5", *words, scene=scene, status=status)
        shards = self.shards(count, *words, scene=scene, statuses=(0, status))
        merged = self.folder / "merged.h5"
        self.run_program("verify", *shards)
        self.run_program("merge", *reversed(shards), "-o", merged)
        self.assertEqual(content(whole), content(merged))
        return shards

    def test_merged_shards_are_the_undivided_sweep(self):
        for name, words in SWEEPS.items():
            with self.subTest(name):
                self.check_same_content(3, *words, status=int(name == "failures"))

    def test_so_are_those_of_grasps(self):
        self.check_same_content(2, *GRASP, scene=ROOT / "scenes/grasp/lift.yaml")

    def test_a_shard_each_trial(self):
        self.check_same_content(TRIALS, "--record", "outcome")

    def test_one_shard_alone(self):
        self.check_same_content(1, "--record", "outcome")

    def test_every_trial_is_in_one_shard_and_costs_are_shared_out(self):
        words = SWEEPS["costs"]
        shards = self.shards(3, *words)
        held = []
        costs = []
        for shard in shards:
            with h5py.File(shard) as file:
                params = [json.loads(demo.attrs["params"]) for demo in file["data"].values()]
                held += [int(name.removeprefix("demo_")) for name in file["data"]]
                costs.append(sum(one["duration"] * one["sensors.pad.bristles"] for one in params))
        self.assertEqual(sorted(held), list(range(12)))
        # 3 durations, 1 or 6 bristles, twice each: dealt out in order of falling cost, two shards
        # differ by at most the costliest trial.
        self.assertLessEqual(max(costs) - min(costs), 0.4 * 6 + 1e-9)

    def test_a_shard_says_which_it_is(self):
        shard = self.shards(3, "--record", "outcome")[1]
        with h5py.File(shard) as file:
            self.assertEqual(file.attrs["sweep_shard"], "2/3")
            self.assertEqual(file.attrs["sweep_trials"], TRIALS)
            self.assertTrue(file.attrs["command"].endswith(" --record outcome --shard 2/3"))

    def test_a_shard_that_was_stopped_goes_on(self):
        words = ("--trials", "200", "--jobs", "1")
        whole = self.folder / "whole.h5"
        self.run_program("sweep", self.scene, *words, "-o", whole, "--quiet", "--shard", "1/2")
        out = self.folder / "shard.h5"
        killed = subprocess.Popen(
            [PROGRAM, "sweep", self.scene, *words, "-o", out, "--quiet", "--shard", "1/2"]
        )
        self.wait_for_a_trial(self.folder / "shard.h5.partial", killed)
        killed.terminate()  # finished batches are kept; kill_test.py kills at any instant
        self.assertNotEqual(killed.wait(), 0)
        self.assert_refused(
            "another run",
            "sweep",
            self.scene,
            *words,
            "-o",
            out,
            "--quiet",
            "--shard",
            "2/2",
            "--resume",
        )
        self.run_program(
            "sweep", self.scene, *words, "-o", out, "--quiet", "--shard", "1/2", "--resume"
        )
        self.assertEqual(content(whole), content(out))

    def test_what_no_shard_is(self):
        out = ("-o", self.folder / "out.h5")
        for text in ("0/3", "4/3", "3", "1/0", "a/b", "1/3/5", "-1/3", "01/3"):
            with self.subTest(text):
                self.assert_refused(
                    f"--shard.*'{text}'.*k/n", "sweep", self.scene, "--shard", text, *out
                )
        self.assert_refused("--shard.* 1/22, .* 21 trials",
                            "sweep", self.scene, "--shard", "1/22", *out)  # fmt: skip
        self.assert_refused("--shard.* -o", "sweep", self.scene, "--shard", "1/2")
        self.assertFalse((self.folder / "out.h5").exists())

    def test_what_is_not_whole_or_not_of_one_sweep(self):
        outcome = ("--record", "outcome")
        one, two, three = self.shards(3, *outcome)
        merged = self.folder / "merged.h5"
        self.assert_refused("shard 2 of 3", "merge", one, three, "-o", merged)
        self.assert_refused("shards 1, 3 of 3", "merge", two, "-o", merged)
        self.assert_refused("shard 2 of 3", "verify", one, three, status=1)
        whole = self.sweep("whole.h5", *outcome)
        self.assert_refused(f"{whole}.*shard", "merge", one, two, whole, "-o", merged)
        self.assert_refused(f"{two}.*shards", "merge", one, two, three, "-o", two)
        others = {
            "seed 8,": ("--seed", "8"),
            "shard 2/4": ("--shard", "2/4"),
            'overrides {"motion.start":"90 ms"}': ("--set", "motion.start=90 ms"),
        }
        for difference, words in others.items():
            with self.subTest(difference):
                part = () if "--shard" in words else ("--shard", "2/3")
                other = self.sweep("other.h5", *outcome, *words, *part)
                told = f"{re.escape(str(one))}.*{re.escape(difference)}"
                self.assert_refused(told, "merge", one, other, three, "-o", merged)
                self.assert_refused(told, "verify", one, other, three, status=1)
                other.unlink()
        self.assertFalse(merged.exists())
        self.assertEqual([path.name for path in self.folder.glob("*partial*")], [])

    @staticmethod
    def first_digest(path):
        """Returns the number of a file's first trial, and its stored digest."""
        with h5py.File(path) as file:
            number = min(int(name.removeprefix("demo_")) for name in file["data"])
            return number, file[f"data/demo_{number}"].attrs["sha256"].encode()

    def test_a_trial_that_stands_twice(self):
        one, two = self.shards(2, "--record", "outcome")
        copy = self.folder / "copy.h5"
        copy.write_bytes(bytes_of(one))
        merged = self.folder / "merged.h5"
        result = self.run_program("merge", one, two, copy, "-o", merged, "--json")
        self.assertEqual(json.loads(result.stdout)["duplicates"], 11)  # shard 1/2 of 21 trials
        self.assertEqual(content(merged), content(self.sweep("whole.h5", "--record", "outcome")))
        self.assertEqual(
            json.loads(self.run_program("verify", one, two, copy, "--json").stdout)["sweep"][
                "duplicates"
            ],
            11,
        )
        number, digest = self.first_digest(copy)
        copy.write_bytes(bytes_of(copy).replace(digest, b"0" * 64))
        self.assert_refused(f"trial {number} ", "merge", one, two, copy, "-o", merged)

    def test_a_damaged_list_of_digests_is_not_merged(self):
        one, two = self.shards(2, "--record", "outcome")
        two.write_bytes(bytes_of(two).replace(self.first_digest(two)[1], b"0" * 64))
        self.assert_refused("damaged", "merge", one, two, "-o", self.folder / "merged.h5")
        self.assertEqual([path.name for path in self.folder.glob("merged*")], [])

    def test_a_damaged_trial_is_not_merged(self):
        one, two = self.shards(2)
        with h5py.File(two, "r+") as file:
            number = min(int(name.removeprefix("demo_")) for name in file["data"])
            file[f"data/demo_{number}/labels/pad/force"][3, 0, 0] += 1.0
        self.assert_refused(
            f"/data/demo_{number}: is damaged", "merge", one, two, "-o", self.folder / "merged.h5"
        )
        self.assertEqual([path.name for path in self.folder.glob("merged*")], [])

    def test_a_killed_merge_is_begun_again(self):
        one, two = self.shards(2, "--record", "outcome")
        merged = self.folder / "merged.h5"
        size = one.stat().st_size + two.stat().st_size
        limit = size // 4  # bytes a file may have, as on a full disk
        self.run_program("merge", one, two, "-o", merged, status=2,
                         preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))  # fmt: skip
        self.assertEqual([path.name for path in self.folder.glob("merged*")], [])

    def test_finished_batches_of_the_target_are_kept(self):
        one, two = self.shards(2, "--record", "outcome")
        merged = self.folder / "merged.h5"
        stopped = subprocess.Popen(
            [PROGRAM, "sweep", self.scene, "--trials", "2000", "-o", merged, "--quiet"],
            stderr=subprocess.DEVNULL,
        )
        self.wait_for_a_trial(self.folder / "merged.h5.partial", stopped)
        stopped.terminate()
        self.assertNotEqual(stopped.wait(), 0)
        self.assert_refused(
            "of finished trials of an unfinished sweep", "merge", one, two, "-o", merged
        )
        self.assertTrue((self.folder / "merged.h5.partial/batch.h5").exists())

    def test_verify_tells_of_the_shards(self):
        shards = self.shards(2)
        result = json.loads(self.run_program("verify", *shards, "--json").stdout)
        self.assertEqual([dataset["shard"] for dataset in result["datasets"]], ["1/2", "2/2"])
        self.assertEqual(
            result["sweep"],
            {
                "shards": 2,
                "trials": TRIALS,
                "duplicates": 0,
                "within_rounding": 0,
                "holds": True,
                "failures": [],
            },
        )
        self.assertNotIn(
            "sweep", json.loads(self.run_program("verify", shards[0], "--json").stdout)
        )


if __name__ == "__main__":
    unittest.main()
