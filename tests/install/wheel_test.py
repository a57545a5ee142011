"""Builds the wheels and tries each as a user would, in a bare Debian 12 or 13.

wheel_test.py ROOT BUILD: wheels of build_wheels.py run with python3-venv alone, under
wheel_user.py. The Python lines of the pages in python must print the same as in the
build.
"""

import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT, BUILD = (Path(word) for word in sys.argv[1:3])
HERE = Path(__file__).parent
SETTINGS = {**os.environ, "PYTHONPATH": str(BUILD / "python"), "MUJOCO_GL": "disable"}
PREPARE = "apt-get -qq update && apt-get -qq install --yes --no-install-recommends python3-venv >/dev/null && python3 -m venv /user"


class Wheels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.here = Path(cls.folder.name)
        subprocess.run([ROOT / "tools/setup/setup.sh", "wheel"], check=True)
        subprocess.run(
            [sys.executable, ROOT / "python/build_wheels.py", "-o", cls.here], check=True
        )
        said = subprocess.run(
            [sys.executable, HERE / "wheel_user.py", ROOT],
            cwd=cls.here,
            env=SETTINGS,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        ).stdout
        cls.build = json.loads(said.splitlines()[-1])

    def tried(self, release, tag):
        (wheel,) = self.here.glob(f"slipbench-*-{tag}-manylinux_2_36_{platform.machine()}.whl")
        self.assertLess(wheel.stat().st_size, 60e6)
        bare = [ROOT / "tools/setup/bare_debian.sh", "-r", release, "-d", self.here / release]
        made = subprocess.run([*bare, "sh", "-c", PREPARE], check=False)
        if made.returncode == 3 and shutil.which("mmdebstrap"):
            self.skipTest("no bare Debian can be made here")
        self.assertEqual(made.returncode, 0)
        for file in (wheel, HERE / "wheel_user.py"):
            (self.here / release / "root/user" / file.name).write_bytes(file.read_bytes())
        said = subprocess.run(
            [*bare, "/user/bin/python", "/user/wheel_user.py", "/tree", f"/user/{wheel.name}"],
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        ).stdout
        found = json.loads(said.splitlines()[-1])
        print(release, found["figures"])
        self.assertEqual(found["said"], self.build["said"])

    def test_debian_12(self):
        self.tried("bookworm", "cp311-cp311")

    def test_debian_13(self):
        self.tried("trixie", "cp312-abi3")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
