"""Tests meshes of public robot descriptions in pads' models (public_meshes_test.py LIBRARY).

public_meshes.csv lists the meshes. They belong to their owners; get copies of the repositories
named there yourself. SLIPBENCH_MESHES names the folder with the copies, in any arrangement: files
are identified by their checksums. Missing meshes are skipped.
"""

import csv
import hashlib
import os
import sys
import unittest
from pathlib import Path

import mujoco

LIBRARY = sys.argv.pop(1)
TABLE = Path(__file__).with_name("public_meshes.csv")
FOLDER = os.environ.get("SLIPBENCH_MESHES", "")
REFUSALS = {"open": "the mesh is not closed"}


def model(mesh, pad):
    plugin = """<extension><plugin plugin="slipbench.field"><instance name="pad"><config key="pad" value="pad"/><config key="touch" value="object"/>
        <config key="elements" value="[[0, 0, 0, 1000, 200]]"/></instance></plugin></extension>"""
    # Shell: MuJoCo refuses the inertia of open meshes.
    return mujoco.MjModel.from_xml_string(f"""<mujoco>{plugin if pad else ""}<asset><mesh name="mesh" file="{mesh}" inertia="shell"/></asset>
        <worldbody><geom name="object" type="mesh" mesh="mesh" contype="0" conaffinity="0"/>
        <body pos="0 0 9000"><freejoint/><geom size="0.01"/><site name="pad"/></body></worldbody></mujoco>""")


def outcome(mesh):
    try:
        mujoco.MjData(model(mesh, True))
        return "touched", ""
    except (ValueError, mujoco.FatalError) as error:
        return next(
            (word for word, start in REFUSALS.items() if start in str(error)), "another refusal"
        ), str(error)


class PublicMeshes(unittest.TestCase):
    def test_table_has_a_row_for_each_checksum(self):
        with TABLE.open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertGreaterEqual(len(rows), 60)
        self.assertEqual(len({row["sha256"] for row in rows}), len(rows))
        self.assertEqual({row["outcome"] for row in rows} - {"touched", *REFUSALS}, set())

    def test_meshes_that_are_here(self):
        if not FOLDER:
            self.skipTest(
                "SLIPBENCH_MESHES names no folder with copies of the repositories of public_meshes.csv"
            )
        mujoco.mj_loadPluginLibrary(LIBRARY)
        with TABLE.open(encoding="utf-8", newline="") as file:
            rows = {row["sha256"]: row for row in csv.DictReader(file)}
        found = 0
        for path in sorted(Path(FOLDER).rglob("*")):
            if path.suffix.lower() not in (".stl", ".obj", ".msh") or not path.is_file():
                continue
            row = rows.pop(hashlib.sha256(path.read_bytes()).hexdigest(), None)
            if row is None:
                continue
            found += 1
            with self.subTest(row["path"]):
                plain = model(path, False)
                self.assertEqual(
                    (plain.nmeshvert, plain.nmeshface), (int(row["vertices"]), int(row["faces"]))
                )
                word, message = outcome(path)
                self.assertEqual(word, row["outcome"], message)
                if message:
                    self.assertIn(
                        "geom 'object' of the mesh 'mesh' cannot be touched by a pad: ", message
                    )
                    self.assertRegex(message, "mesh editor")
        self.assertGreater(found, 0, f"{FOLDER} holds none of the meshes of {TABLE.name}")
        print(f"{found} meshes tried, {len(rows)} of {TABLE.name} not found")


if __name__ == "__main__":
    unittest.main()
