"""Every flipped bit that changes a value is found. Arguments: the project's root, the program.

250 bits, one per copy: half of them evenly over the file of a small run, most of which is unused,
half over its non-zero bytes. `verify` reads all copies. If it finds nothing, h5py must read every
value, name, type and shape unchanged.
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from digest import file_digest, trial_digest  # noqa: E402

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()
FLIPS = 250


def values_of(path):
    """Returns everything that h5py reads of a file, as text."""
    found = {}

    def visit(name, item):
        for key, value in item.attrs.items():
            value = np.asarray(value)
            found[f"{name}@{key}"] = (
                value.dtype.kind,
                value.shape,
                value.tolist() if value.dtype.kind in "OU" else value.tobytes(),
            )
        if isinstance(item, h5py.Dataset):
            found[name] = (str(item.dtype), item.shape, item[()].tobytes())
        else:
            found[name] = sorted(item)

        if isinstance(item, h5py.Group):
            for key in item:
                visit(f"{name}/{key}", item[key])

    with h5py.File(path) as file:
        visit("", file)
    return found


class FlipsTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.whole = self.folder / "whole.h5"
        subprocess.run(
            [
                PROGRAM,
                "run",
                ROOT / "scenes/papillarray/stage.yaml",
                "--set",
                "duration=0.9 s",
                "motion.start=0.5 s",
                "sensors.pad.rate=100 Hz",
                "sweep={motion.speed: [4 mm/s, 8 mm/s, 16 mm/s]}",
                "--trials",
                "3",
                "--quiet",
                "-o",
                self.whole,
            ],
            check=True,
            stdout=subprocess.DEVNULL,
        )

    def verify(self, *paths):
        result = subprocess.run(
            [PROGRAM, "verify", *paths, "--json"],
            capture_output=True,
            timeout=10 * len(paths),
        )
        self.assertIn(result.returncode, (0, 1, 2))
        return result.returncode, json.loads(result.stdout)["datasets"]

    def test_digests_are_those_of_the_readme(self):
        self.assertEqual(self.verify(self.whole)[0], 0)
        with h5py.File(self.whole) as file:
            self.assertEqual(file.attrs["schema"], 2)
            for demo in file["data"].values():
                self.assertEqual(demo.attrs["sha256"], trial_digest(demo).hex())
            self.assertEqual(file.attrs["content_sha256"], file_digest(file).hex())

    # The reproducer: report and every export accepted the changed times.
    def test_onset_times_are_covered(self):
        with h5py.File(self.whole, "r+") as file:
            file["data/demo_0/labels/pad"].attrs["onset_time_s"] = [1.2345] * 9
        status, (found,) = self.verify(self.whole)
        self.assertEqual(status, 1)
        self.assertEqual(
            {(failure["check"], failure["trial"]) for failure in found["failures"]},
            {("digests", 0), ("digests", None), ("events", 0)},
        )
        for command in (
            ["report", self.whole, "-o", self.folder / "page.html"],
            ["export", self.whole, "--format", "npz", "-o", self.folder / "out"],
        ):
            result = subprocess.run(
                [PROGRAM, *command],
                capture_output=True,
                text=True,
                check=False,
            )
            self.assertEqual(result.returncode, 2)
            self.assertIn("is damaged", result.stderr)

    def test_every_flip_that_changes_a_value_is_found(self):
        whole, expected = self.whole.read_bytes(), values_of(self.whole)
        used = [place for place, byte in enumerate(whole) if byte]
        paths = []
        for k in range(FLIPS):
            places = used if k % 2 else range(len(whole))
            flipped = bytearray(whole)
            flipped[places[k * len(places) // FLIPS]] ^= 1 << k // 2 % 8
            paths.append(self.folder / f"flip-{k}.h5")
            paths[-1].write_bytes(flipped)
        _, datasets = self.verify(*paths)
        self.assertEqual(len(datasets), FLIPS)
        held = [Path(found["file"]) for found in datasets if found.get("holds")]
        self.assertLess(len(held), FLIPS - FLIPS // 4)  # at least half of those in used bytes
        for path in held:
            try:
                values = values_of(path)
            except OSError:  # h5py brings a newer HDF5, which refuses more; a refusal is not silent
                continue
            self.assertEqual(values, expected, path.name)


if __name__ == "__main__":
    unittest.main()
