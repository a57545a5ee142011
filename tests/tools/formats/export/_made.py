"""Datasets of every sensor and of a grasp, exported by the program, for the tests of formats.

The arguments, the project's root, the program and perhaps --quick, are taken from sys.argv here.
--quick: for_each_scene() takes only the first scene.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from bisect import bisect_right
from functools import cache
from pathlib import Path

import numpy as np

ROOT, PROGRAM = Path(sys.argv[1]).resolve(), sys.argv[2]
del sys.argv[1:3]
QUICK = sys.argv[1:2] == ["--quick"]
if QUICK:
    del sys.argv[1]
# Scenes and overrides that shorten them. The first has three trials, the others two each.
SCENES = {
    "papillarray/stage.yaml": {
        "duration": "1.5 s",
        "motion.start": "1 s",
        "sweep": {"motion.speed": ["8 mm/s", "4 mm/s", "2 mm/s"]},
    },
    "nib_pad/linear.yaml": {"duration": "300 ms"},
    "piezo_skin/slide.yaml": {"duration": "1.6 s"},
    "myrmex/slip.yaml": {"duration": "100 ms"},
    "biotac_sp/slip.yaml": {"duration": "300 ms"},
    "grasp/two_skins.yaml": {"duration": "1.7 s", "motion.distance": "1 mm"},
}


class ExportTest(unittest.TestCase):
    """Each test has a folder of its own, `self.folder`."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))


@cache
def datasets():
    """Returns a folder kept until the last test."""
    folder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(folder.cleanup)
    return folder.name


def make(scene):
    """Returns the dataset of a scene with two or three trials, simulated at the first call."""
    path = os.path.join(datasets(), scene.replace("/", "_").removesuffix(".yaml") + ".h5")
    if os.path.exists(path):
        return path
    changes = SCENES.get(scene, {})
    sets = [
        word for key, value in changes.items() for word in ("--set", f"{key}={json.dumps(value)}")
    ]
    verb = ["sweep", "--trials", "1"] if "sweep" in changes else ["run", "--trials", "2"]
    subprocess.run(
        [PROGRAM, *verb, str(ROOT / "scenes" / scene), *sets, "-o", path, "--quiet"], check=True
    )
    return path


def import_table(folder, text, about):
    """Imports a table by a map, with blanks in both names; returns the dataset's path.

    The command is as by a user of another machine.
    """
    logs = folder / "my logs"
    logs.mkdir()
    (logs / "a.csv").write_text(text)
    (folder / "my map.yaml").write_text(about)
    path = str(folder / "recorded.h5")
    subprocess.run(
        [PROGRAM, "import", f"{logs}/", "--map", str(folder / "my map.yaml"), "-o", path],
        check=True,
        capture_output=True,
    )
    return path


def export(dataset, out, *words, status=0):
    """Exports a dataset; returns stdout and stderr."""
    done = subprocess.run(
        [PROGRAM, "export", dataset, "-o", str(out), *words],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == status, (
        f"{words}: ended with {done.returncode}, expected {status}: {done.stderr}"
    )
    return done.stdout, done.stderr


def for_each_scene(format, *words):
    """Decorates a test that takes a dataset and its export in `format`, for each scene."""

    def decorator(test):
        def run(self):
            for scene in list(SCENES)[: 1 if QUICK else None]:
                with self.subTest(scene=scene):
                    out = self.folder / scene.replace("/", "_")
                    export(make(scene), out, "--format", format, *words)
                    test(self, make(scene), out)

        return run

    return decorator


def contents(folder):
    """Returns {name: bytes} of all files below a folder."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def held(times, values, instants):
    """Returns the latest index at or before each instant. Times closer than 1 ns count as equal."""
    times = list(times)
    return np.stack(
        [values[bisect_right(times, instant + 1e-9) - 1].reshape(-1) for instant in instants]
    )
