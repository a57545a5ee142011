"""The reference of the dataset format matches written files.

Arguments: the project's root, the program.

Every array, attribute and outcome of a file has a row in a page of tools/dataset
with the file's shape, type and unit, and every row occurs in a file.
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()

# All sensors, on a stage, on bodies and in grasps; with a detector, with a guided arm, with the
# outcome alone.
RUNS = (
    ("papillarray/stage.yaml", "--set", "detector={type: force_ratio}", "duration=3 s"),
    ("grasp/two_skins.yaml", "--set", "duration=2 s", "motion.distance=10 mm"),
    ("grasp/lift.yaml", "--record", "outcome"),
    ("nib_pad/reorient.yaml", "--set", "duration=3 s"),
    ("myrmex/slip.yaml", "--set", "duration=1 s"),
    ("biotac_sp/grasp.yaml",),
)


def rows_of(text):
    """Returns the rows of all tables below a heading that is a path.

    They are {(path, kind, name, sensor): the row's cells by column}.
    """
    rows, path, columns = {}, None, None
    for line in text.splitlines():
        if line.startswith("#"):
            heading = re.fullmatch(r"### `(.*)`", line)
            path, columns = heading and heading[1], None
        elif not line.startswith("|"):
            columns = None
        elif path and columns is None:
            columns = line.strip("| ").split(" | ")
        elif path and "---" not in line:
            cells = dict(zip(columns, line.strip("| ").split(" | "), strict=True))
            kind = next(kind for kind in ("array", "attribute", "key") if kind in cells)
            for name in re.findall(r"`([^`]+)`", cells[kind]):
                rows[path, kind, name, cells.get("sensor", "all")] = cells
    return rows


def shape_fits(wanted, shape):
    extents = [extent for extent in wanted.strip("[]").split(",") if extent]
    return len(extents) == len(shape) and all(
        extent == str(found)
        for extent, found in zip(extents, shape, strict=True)
        if extent.isdigit()
    )


def attribute_text(value):
    return "text" if isinstance(value, str) or value.dtype == object else str(value.dtype)


# The second of two trials exceeds the range of a float.
WITH_A_FAILURE = [
    "--trials",
    "2",
    "--set",
    "sweep={sensors.pad.electronics: [ideal, [{offset: {scale: 1e50}}]]}",
]
RUNS += (("papillarray/stage.yaml", *WITH_A_FAILURE),)
# A part of a sweep, with a split defined by its scene.
SHARD = (
    "--shard",
    "1/1",
    "--record",
    "outcome",
    "--set",
    "split={by: trial, shares: [0.8, 0.1, 0.1]}",
    "duration=1 s",
    "motion.start=500 ms",
)
RUNS += (("papillarray/stage.yaml", *SHARD),)


class ReferenceTest(unittest.TestCase):
    def setUp(self):
        self.rows = rows_of(
            "\n".join(
                page.read_text(encoding="utf-8") for page in (ROOT / "tools/dataset").glob("*.md")
            )
        )
        self.held = set()

    def look_up(self, path, kind, name, sensor="all"):
        key = next(
            (
                key
                for key in ((path, kind, name, sensor), (path, kind, name, "all"))
                if key in self.rows
            ),
            None,
        )
        self.assertIsNotNone(
            key, f"a file holds the {kind} {name} in {path}, the reference does not"
        )
        self.held.add(key)
        return self.rows[key]

    def look_at_array(self, path, name, sensor, array):
        row = self.look_up(path, "array", name, sensor)
        self.assertTrue(
            shape_fits(row["shape"], array.shape), f"{path}/{name}: {row['shape']} is {array.shape}"
        )
        self.assertEqual(
            row["type"], "text" if array.dtype.kind == "S" else array.dtype, f"{path}/{name}"
        )
        self.assertEqual(row.get("unit"), array.attrs.get("unit"), f"{path}/{name}")

    def look_at_attribute(self, path, name, value):
        kind, _, shape = self.look_up(path, "attribute", name)["type"].partition(" ")
        self.assertEqual(kind, attribute_text(value), f"{path}: {name}")
        self.assertTrue(shape_fits(shape, getattr(value, "shape", ())), f"{path}: {name}: {shape}")

    def look_at(self, file):
        def visit(name, member):
            path = re.sub(
                r"(sensors|labels|truth)/[^/]+",
                r"\1/<name>",
                re.sub(r"demo_\d+", "demo_<k>", "/" + name),
            )
            if isinstance(member, h5py.Dataset):
                group, _, array = path.rpartition("/")
                if group.endswith("/events"):
                    group, array = group.removesuffix("/events"), "events/" + array
                sensor = member.parent.attrs["type"] if "/sensors/" in group else "all"
                self.look_at_array(group, array, sensor, member)
            else:
                for attribute, value in member.attrs.items():
                    self.look_at_attribute(path, attribute, value)
                    if attribute == "outcome":
                        for key in json.loads(value):
                            self.look_up("outcome", "key", key)

        visit("", file)
        file.visititems(visit)

    def test_reference_and_files_name_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            for scene, *options in RUNS:
                out = Path(folder) / "out.h5"
                verb = "sweep" if "--shard" in options else "run"
                result = subprocess.run(
                    [PROGRAM, verb, ROOT / "scenes" / scene, *options, "-o", out],
                    stdout=subprocess.DEVNULL,
                )
                self.assertEqual(result.returncode, int(options == WITH_A_FAILURE))
                with h5py.File(out) as file:
                    self.look_at(file)
            source = Path(folder) / "bts3v2_palm_45.csv"
            names = [f"{finger}_biotac_{e}" for finger in ("ff", "mf", "th") for e in range(1, 25)]
            source.write_text(
                ",".join(["object", "slipped", *names]) + "\ncoke,1" + ",3000" * 72 + "\n",
                encoding="ascii",
            )
            # A recording with times, whose sensor stores how even they are.
            simulated, tables = Path(folder) / "simulated.h5", Path(folder) / "tables"
            stage = [PROGRAM, "run", ROOT / "scenes/papillarray/stage.yaml", "-o", simulated]
            for command in (
                stage,
                [PROGRAM, "export", simulated, "--format", "training-csv", "-o", tables],
            ):
                subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
            for recording, written_as in ((source, "bts3v2"), (tables, "training-csv")):
                out.unlink()
                subprocess.run(
                    [PROGRAM, "import", recording, "--format", written_as, "-o", out],
                    stdout=subprocess.DEVNULL,
                    check=True,
                )
                with h5py.File(out) as file:
                    self.look_at(file)
        self.assertEqual(
            set(), set(self.rows) - self.held, "the reference names what no file holds"
        )


if __name__ == "__main__":
    unittest.main()
