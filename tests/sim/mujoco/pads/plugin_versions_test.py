"""plugin_versions_test.py ROOT LIBRARY PINNED [VERSION...]: one path for every MuJoCo, and what the versions agree on."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT, LIBRARY, PINNED, *OTHERS = sys.argv[1:]
ROOT, LIBRARY = Path(ROOT), Path(LIBRARY)
HOLD = """
import mujoco, sys
mujoco.mj_loadPluginLibrary(sys.argv[1])
model = mujoco.MjModel.from_xml_path(sys.argv[2])
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
heights, readings = [], []
while data.time < 10.0:
    mujoco.mj_step(model, data)
    heights.append(data.qpos[2])
    readings.append(data.sensordata.copy())
import numpy as np
np.savez(sys.argv[3], heights=heights, readings=readings)
"""


def python(version, code, *arguments, cwd=None):
    """Runs a program with that MuJoCo; warnings of MuJoCo go to a file in its folder, too."""
    with tempfile.TemporaryDirectory() as folder:
        paths = {"PYTHONPATH": str(ROOT / "build/mujoco" / version), "MUJOCO_GL": "disable", "PYTHONDONTWRITEBYTECODE": "1"}
        return subprocess.run([sys.executable, "-c", code, *map(str, arguments)], cwd=cwd or folder, capture_output=True, text=True,
                              env={**os.environ, **paths})


class Versions(unittest.TestCase):
    def test_needs_no_mujoco_of_its_own(self):
        dynamic = subprocess.run(["readelf", "-d", LIBRARY], check=True, capture_output=True, text=True).stdout
        self.assertEqual(re.findall(r"\(NEEDED\).*\[lib(?:mujoco|fmt|yaml|stdc)[^]]*\]", dynamic), [])

    def test_one_path_holds_a_box_in_every_version(self):
        found = {}
        with tempfile.TemporaryDirectory() as folder:
            for version in (PINNED, *OTHERS):
                out = Path(folder) / f"{version}.npz"
                result = python(version, HOLD, LIBRARY, ROOT / "scenes/mujoco/hold.xml", out)
                self.assertEqual(result.returncode, 0, result.stderr)
                found[version] = dict(np.load(out))
                with self.subTest(version):
                    heights = found[version]["heights"]
                    self.assertGreater(heights[-1], 0.0999)  # hung on springs, from 0.1
                    # From 5 to 10 s: 0.01 um/s.
                    self.assertLess(abs(heights[-1] - heights[len(heights) // 2]) / 5.0, 1e-8)
        if "4.0.0" in found:
            for name in ("heights", "readings"):
                np.testing.assert_allclose(found["4.0.0"][name], found[PINNED][name], rtol=0, atol=1e-9)

    def test_an_unknown_version_is_refused_with_the_nearest(self):
        """A copy of the pinned MuJoCo, of which every "4.0.1" is made "3.9.9"."""
        with tempfile.TemporaryDirectory() as folder:
            package = Path(next(iter(importlib.util.find_spec("mujoco").submodule_search_locations)))
            shutil.copytree(package, Path(folder) / "mujoco", ignore=shutil.ignore_patterns("include", "plugin"))
            library = Path(folder) / "mujoco" / f"libmujoco.so.{PINNED}"
            library.write_bytes(library.read_bytes().replace(f"\0{PINNED}\0".encode(), b"\x003.9.9\0"))
            code = "import mujoco, sys; mujoco.mj_loadPluginLibrary(sys.argv[1]); mujoco.MjModel.from_xml_path(sys.argv[2])"
            result = python("none", f"import sys; sys.path.insert(0, {folder!r}); {code}", LIBRARY, ROOT / "scenes/mujoco/hold.xml", cwd=folder)
        self.assertRegex(result.stdout + result.stderr, "slipbench.field: MuJoCo 3.9.9 is loaded: the plugin stays unknown. Allowed: 3.3.0, .*; the nearest is 3.9.0")
        self.assertIn("slipbench.field not found", result.stderr)

    def test_the_table_is_that_of_the_headers(self):
        folders = [f"{version}={ROOT / 'build/mujoco' / version}" for version in OTHERS]
        command = [sys.executable, ROOT / "tools/program/plugin/layouts.py", "--check"]
        subprocess.run([*command, *folders], check=True)
        for version in OTHERS[:1]:
            other = subprocess.run([*command, f"3.12.0={ROOT / 'build/mujoco' / version}"], capture_output=True, text=True)
            self.assertRegex(other.stderr, r"3\.12\.0: nbody is \d+, and mujoco_layouts.h says 48")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
