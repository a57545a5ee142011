"""plugin_versions_test.py ROOT LIBRARY VERSION...: one path for every supported MuJoCo, the pinned one last, and the refusal of others."""

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

ROOT, LIBRARY, *VERSIONS = sys.argv[1:]
PINNED = VERSIONS[-1]
ROOT, LIBRARY = Path(ROOT), Path(LIBRARY)
HOLD = """
import mujoco, sys
mujoco.mj_loadPluginLibrary(sys.argv[1])
model = mujoco.MjModel.from_xml_path(sys.argv[2])
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
heights = []
while data.time < 10.0:
    mujoco.mj_step(model, data)
    heights.append(data.qpos[2])
import numpy as np
np.savez(sys.argv[3], heights=heights)
"""


def python(version, code, *arguments, cwd=None):
    """Runs a program with that MuJoCo version; MuJoCo's warnings go to a file in its folder."""
    with tempfile.TemporaryDirectory() as folder:
        paths = {
            "PYTHONPATH": str(ROOT / "build/mujoco" / version),
            "MUJOCO_GL": "disable",
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        return subprocess.run(
            [sys.executable, "-c", code, *map(str, arguments)],
            cwd=cwd or folder,
            capture_output=True,
            text=True,
            env={**os.environ, **paths},
        )


class Versions(unittest.TestCase):
    def test_needs_no_mujoco_of_its_own(self):
        dynamic = subprocess.run(
            ["readelf", "-d", LIBRARY], check=True, capture_output=True, text=True
        ).stdout
        self.assertEqual(
            re.findall(r"\(NEEDED\).*\[lib(?:mujoco|fmt|yaml|stdc)[^]]*\]", dynamic), []
        )

    def test_one_path_holds_a_box_in_every_version(self):
        with tempfile.TemporaryDirectory() as folder:
            for version in VERSIONS:
                out = Path(folder) / f"{version}.npz"
                result = python(version, HOLD, LIBRARY, ROOT / "scenes/mujoco/hold.xml", out)
                self.assertEqual(result.returncode, 0, result.stderr)
                with self.subTest(version):
                    heights = np.load(out)["heights"]
                    self.assertGreater(heights[-1], 0.0999)  # hung on springs, from 0.1
                    # From 5 to 10 s: 0.01 um/s.
                    self.assertLess(abs(heights[-1] - heights[len(heights) // 2]) / 5.0, 1e-8)

    def test_another_version_is_refused_with_the_supported_ones(self):
        """A copy of the pinned MuJoCo in which every "4.0.1" is changed to "3.9.9"."""
        with tempfile.TemporaryDirectory() as folder:
            package = Path(
                next(iter(importlib.util.find_spec("mujoco").submodule_search_locations))
            )
            shutil.copytree(
                package, Path(folder) / "mujoco", ignore=shutil.ignore_patterns("include", "plugin")
            )
            library = Path(folder) / "mujoco" / f"libmujoco.so.{PINNED}"
            library.write_bytes(
                library.read_bytes().replace(f"\0{PINNED}\0".encode(), b"\x003.9.9\0")
            )
            code = "import mujoco, sys; mujoco.mj_loadPluginLibrary(sys.argv[1]); mujoco.MjModel.from_xml_path(sys.argv[2])"
            result = python(
                "none",
                f"import sys; sys.path.insert(0, {folder!r}); {code}",
                LIBRARY,
                ROOT / "scenes/mujoco/hold.xml",
                cwd=folder,
            )
        self.assertIn(
            f"slipbench.field: MuJoCo 3.9.9 is loaded, but the plugin has no build for it; supported: {', '.join(VERSIONS)}",
            result.stdout + result.stderr,
        )
        self.assertIn("slipbench.field not found", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
