"""plugin_versions_test.py ROOT LIBRARY PINNED [VERSION...]: one path for every MuJoCo, and what the versions agree on."""

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

    def test_without_a_build_both_versions_are_named(self):
        for version in OTHERS[:1]:
            with tempfile.TemporaryDirectory() as folder:
                alone = shutil.copy(LIBRARY, folder)
                shutil.copy(LIBRARY.with_name(f"libslipbench_mujoco-{PINNED}.so"), folder)
                code = "import mujoco, sys; mujoco.mj_loadPluginLibrary(sys.argv[1]); mujoco.MjModel.from_xml_path(sys.argv[2])"
                result = python(version, code, alone, ROOT / "scenes/mujoco/hold.xml", cwd=folder)
            self.assertIn(f"slipbench.field: MuJoCo {version} is loaded, and the plugin is built for {PINNED}: it stays unknown", result.stdout + result.stderr)
            self.assertIn("slipbench.field not found", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
