"""A trial of every shipped scene verifies.

It gives equal results with and without AVX2 and FMA in the C library.

Results are bit-identical if only the project's own code computes, and within 1e-9 if MuJoCo, FFTW
or a network does (attribute `libraries`). FFTW and OpenVINO query the processor themselves and are
not masked. Arguments: the project's root, the program,
and scenes such as papillarray/stage, if not all of them.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()
NAMES = sys.argv[1:] or ["*/*"]
del sys.argv[1:]
OLD = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}
ROUNDING = 1e-9


def sines(environment):
    return subprocess.run(
        [sys.executable, "-c", "import math; print([math.sin(.001 * k) for k in range(9999)])"],
        env=environment,
        stdout=subprocess.PIPE,
        check=True,
    ).stdout


def contents(path):
    """Returns {place: array or attribute} of all trials.

    Also returns whether foreign libraries computed in one.
    """
    found, libraries = {}, False
    with h5py.File(path) as file:

        def visit(name, thing):
            nonlocal libraries
            for key, value in thing.attrs.items():
                libraries |= key == "libraries"
                if "sha256" not in key:
                    found[f"{name}@{key}"] = value
            if isinstance(thing, h5py.Dataset):
                found[name] = thing[()]

        file["data"].visititems(visit)
    return found, libraries


def numbers(value):
    """Yields the numbers in JSON, in order."""
    if isinstance(value, dict):
        return [number for key in sorted(value) for number in numbers(value[key])]
    return [float(value)] if isinstance(value, (int, float)) else []


def distance(place, one, other):
    """Returns the largest difference of two arrays, for directions the angle between them.

    It is relative to the larger number or the largest in the array, beyond one unit in the last
    place of a float32. So slip_angle and slip_centre, which are rounding noise without motion, are
    compared by their distance.
    """
    if place.endswith("@outcome"):
        one, other = (np.array(numbers(json.loads(text))) for text in (one, other))
    if not np.issubdtype(np.asarray(one).dtype, np.floating):
        return 0.0 if np.array_equal(one, other) else np.inf
    if np.shape(one) != np.shape(other) or not np.array_equal(np.isnan(one), np.isnan(other)):
        return np.inf
    a, b = (np.asarray(values, np.float64)[~np.isnan(one)].ravel() for values in (one, other))
    apart = np.abs(a - b)
    if place.endswith("/slip_direction"):
        apart = np.abs((apart + np.pi) % (2 * np.pi) - np.pi)
    if np.asarray(one).dtype == np.float32:
        apart = np.maximum(apart - np.finfo(np.float32).eps * np.maximum(np.abs(a), np.abs(b)), 0.0)
    largest = max(np.abs(a[np.isfinite(a)]).max(initial=0.0), np.finfo(float).tiny)
    with np.errstate(invalid="ignore"):
        return float(np.nan_to_num(apart / largest, nan=0.0).max(initial=0.0))


class ProcessorTest(unittest.TestCase):
    def expect_to_verify(self, path):
        result = subprocess.run(
            [PROGRAM, "verify", path, "--json"], stdout=subprocess.PIPE, check=False
        )
        (dataset,) = json.loads(result.stdout)["datasets"]
        self.assertEqual([], dataset["failures"])
        for check in dataset["checks"]:  # contact: only for scenes with bodies
            self.assertTrue(
                check["checked"] > 0 or (check["check"] == "contact" and check["left_out"]), check
            )
        self.assertEqual(result.returncode, 0)

    def test_shipped_scenes(self):
        rounds = sines(OLD) != sines(None)
        exact = compared = 0
        scenes = sorted(
            {scene for name in NAMES for scene in (ROOT / "scenes").glob(f"{name}.yaml")}
        )
        self.assertGreaterEqual(len(scenes), len(NAMES))
        for scene in scenes:
            with self.subTest(scene=scene), tempfile.TemporaryDirectory() as folder:
                paths = [Path(folder) / name for name in ("new.h5", "old.h5")]
                environments = (None, OLD) if rounds else (None,)
                for path, environment in zip(paths, environments, strict=False):
                    subprocess.run(
                        [PROGRAM, "run", scene, "--quiet", "-o", path],
                        env=environment,
                        check=True,
                        stdout=subprocess.DEVNULL,
                    )
                self.expect_to_verify(paths[0])
                if not rounds:
                    continue
                (new, libraries), (old, _) = (contents(path) for path in paths)
                if not libraries:
                    exact += 1
                    self.assertTrue(paths[0].read_bytes() == paths[1].read_bytes())
                    continue
                compared += 1
                self.assertEqual(new.keys(), old.keys())
                far = {place: distance(place, new[place], old[place]) for place in new}
                self.assertEqual({place: one for place, one in far.items() if one > ROUNDING}, {})
        if not rounds:
            self.skipTest(
                "only verified: this processor has no FMA, or this C library does not round by it"
            )
        self.assertGreater(min(exact, compared), 10 if NAMES == ["*/*"] else 0)

    def test_what_is_apart(self):
        """Changes one number of many, in the units of distance()."""
        forces = np.linspace(0.5, 1.0, 100)
        self.assertLess(distance("data/demo_0/force", forces, forces * (1 + 1e-10)), ROUNDING)
        self.assertGreater(
            distance("data/demo_0/force", forces, forces + 1e-8 * (forces == 1.0)), ROUNDING
        )
        self.assertEqual(distance("data/demo_0/state", np.uint8([1, 2]), np.uint8([1, 3])), np.inf)
        self.assertLess(
            distance("labels/pad/slip_direction", np.array([np.pi]), np.array([-np.pi])), ROUNDING
        )
        self.assertGreater(
            distance("labels/pad/slip_angle", np.array([np.pi]), np.array([-np.pi])), ROUNDING
        )
        self.assertGreater(
            distance("data/demo_0@outcome", '{"force": 1.0}', '{"force": 1.00001}'), ROUNDING
        )


if __name__ == "__main__":
    unittest.main()
