"""plugin_versions_test.py ROOT LIBRARY VERSION...

One library in several releases of MuJoCo, the pinned one last: explicit and implicit pads, the
committed layouts, the refusal of an unknown release and the command that adds it. Releases must be
in build/mujoco (tools/setup/setup.sh mujoco or mujoco-all).
"""

import hashlib
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
KNOWN = re.findall(
    r'^{"([\d.]+)"', (ROOT / "sim/mujoco/releases/layouts.h").read_text(encoding="utf-8"), re.M
)
# Two pads hold a box of 100 g, explicit for 10 s, implicit for 2 s.
HOLD = """
import mujoco, sys
import numpy as np
assert mujoco.mj_versionString() == sys.argv[4], mujoco.__file__
mujoco.mj_loadPluginLibrary(sys.argv[1])

def heights(text, seconds):
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    result = []
    while data.time < seconds:
        mujoco.mj_step(model, data)
        result.append(data.qpos[2])
    return result

def implicit(text):
    for old, new in (
        ('integrator="implicitfast"', 'integrator="discrete" noslip_iterations="0" iterations="20" cone="elliptic"'),
        ('<config key="touch"', '<config key="solver" value="implicit"/><config key="touch"'),
        ('<freejoint name="box"/>', '<freejoint name="box"/><site name="held"/>'),
        ("<actuator>", "<tendon>" + "".join(f'<spatial damping="1e-9"><site site="{pad}"/><site site="held"/></spatial>'
                                            for pad in ("left_pad", "right_pad")) + "</tendon><actuator>"),
    ):
        assert old in text
        text = text.replace(old, new)
    return text

text = open(sys.argv[2]).read()
found = {"explicit": heights(text, 10.0)}
if tuple(map(int, mujoco.__version__.split(".")[:2])) >= (3, 14):
    found["implicit"] = heights(implicit(text), 2.0)
np.savez(sys.argv[3], **found)
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

    def test_one_library_holds_a_box_in_every_version(self):
        digests = set()
        with tempfile.TemporaryDirectory() as folder:
            for version in VERSIONS:
                out = Path(folder) / f"{version}.npz"
                result = python(
                    version, HOLD, LIBRARY, ROOT / "scenes/mujoco/hold.xml", out, version
                )
                self.assertEqual(result.returncode, 0, result.stderr)
                found = np.load(out)
                for solver, heights in found.items():
                    with self.subTest(version=version, solver=solver):
                        self.assertGreater(heights[-1], 0.0999)  # hung on springs, from 0.1
                        # In the second half: 1e-6 um/s.
                        half = len(heights) // 2
                        speed = (heights[-1] - heights[half]) / (5e-4 * (len(heights) - 1 - half))
                        self.assertLess(abs(speed), 1e-12)
                digests.add(hashlib.sha256(found["explicit"].tobytes()).hexdigest())
        self.assertEqual(len(digests), 1, "heights of explicit pads are bit-identical")

    def test_layouts_are_those_of_the_headers(self):
        tool = ROOT / "tools/plugin/update_layouts.py"
        said = subprocess.run(
            [sys.executable, tool, "--check"], capture_output=True, text=True, check=False
        )
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertLessEqual(set(VERSIONS), set(re.findall(r"[\d.]+\d", said.stdout)))

    def test_an_unknown_version_is_refused_with_the_command_that_adds_it(self):
        """A copy of the pinned MuJoCo in which every "4.0.1" is changed to "9.9.9"."""
        with tempfile.TemporaryDirectory() as folder:
            package = Path(
                next(iter(importlib.util.find_spec("mujoco").submodule_search_locations))
            )
            copy = Path(folder) / "mujoco"
            shutil.copytree(package, copy, ignore=shutil.ignore_patterns("plugin"))
            library = copy / f"libmujoco.so.{PINNED}"
            library.write_bytes(
                library.read_bytes().replace(f"\0{PINNED}\0".encode(), b"\x009.9.9\0")
            )
            plugin = Path(folder) / LIBRARY.name
            shutil.copy(LIBRARY, plugin)
            shutil.copytree(LIBRARY.parent / "mujoco_layout", Path(folder) / "mujoco_layout")
            code = "import mujoco, sys; mujoco.mj_loadPluginLibrary(sys.argv[1]); mujoco.MjModel.from_xml_path(sys.argv[2])"
            load = f"import sys; sys.path.insert(0, {folder!r}); {code}"
            model = ROOT / "scenes/mujoco/hold.xml"
            refused = python("none", load, plugin, model, cwd=folder)
            said = refused.stdout + refused.stderr
            self.assertIn(
                f"slipbench.field: the plugin does not know MuJoCo 9.9.9 (known: {', '.join(KNOWN)}).",
                said,
            )
            self.assertIn("slipbench.field not found", refused.stderr)
            command = re.search(r"cc -shared -fPIC .*layout\.c'", said)[0]
            subprocess.run(command, shell=True, check=True)
            added = python("none", load, plugin, model, cwd=folder)
            self.assertEqual(added.returncode, 0, added.stdout + added.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
