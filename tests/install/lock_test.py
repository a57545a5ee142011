"""Locks PyPI packages: requirements*.txt match requirements*.in, and set-up installs nothing else.

Both are in tools/setup. Argument: the project's root.
"""

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

ROOT = Path(sys.argv.pop(1))
SETUP = ROOT / "tools/setup"
SETS = ("requirements", "requirements-test", "requirements-lock")


def asked(name):
    """Returns {package: version} of a .in file."""
    lines = (SETUP / f"{name}.in").read_text(encoding="utf-8").splitlines()
    return dict(
        re.match(r"([\w-]+)==([^\s;]+)", line).groups()
        for line in lines
        if line and not line.startswith(("#", "--"))
    )


def locked(name):
    """Returns {package: (version, number of hashes)} of a .txt file."""
    text = (SETUP / f"{name}.txt").read_text(encoding="utf-8").replace("\\\n", " ")
    entries = [line for line in text.splitlines() if line and not line.lstrip().startswith("#")]
    found = {}
    for entry in entries:
        match = re.fullmatch(
            r"([a-z0-9-]+)==(\S+)(?: ; platform_machine == \"x86_64\")?((?: +--hash=sha256:[0-9a-f]{64})+) *",
            entry,
        )
        assert match, f"{name}.txt: neither pinned nor hashed: {entry}"
        found[match[1]] = (match[2], match[3].count("--hash"))
    return found


def forged_wheel(folder, version):
    """Makes a wheel of mujoco-core that PyPI never had."""
    info = f"mujoco_core-{version}.dist-info"
    members = {
        "mujoco/__init__.py": "",
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: mujoco-core\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: forger\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    record = ""
    with zipfile.ZipFile(folder / f"mujoco_core-{version}-py3-none-any.whl", "w") as wheel:
        for path, text in members.items():
            digest = (
                base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest())
                .decode()
                .rstrip("=")
            )
            record += f"{path},sha256={digest},{len(text)}\n"
            wheel.writestr(path, text)
        wheel.writestr(f"{info}/RECORD", f"{record}{info}/RECORD,,\n")


class LockTest(unittest.TestCase):
    def test_d3_is_the_release(self):
        d3 = ROOT / "tools/page/d3"
        digest = hashlib.sha256((d3 / "d3.min.js").read_bytes()).hexdigest()
        self.assertIn(f"| `d3.min.js` | {digest} |", (d3 / "README.md").read_text(encoding="utf-8"))

    def test_every_package_asked_for_is_pinned_as_asked(self):
        for name in SETS:
            pinned = locked(name)
            self.assertTrue(asked(name))
            for package, version in asked(name).items():
                self.assertEqual(
                    pinned[package][0], version, f"{name}: tools/setup/lock.sh has not run since"
                )

    def test_every_further_mujoco_is_hashed(self):
        lines = (SETUP / "requirements-mujoco.in").read_text(encoding="utf-8").splitlines()
        wanted = [line.split()[0] for line in lines if line and not line.startswith("#")]
        text = (SETUP / "requirements-mujoco.txt").read_text(encoding="utf-8").replace("\\\n", " ")
        entries = [
            re.fullmatch(r"(\S+)((?: +--hash=sha256:[0-9a-f]{64})+) *", line)
            for line in text.splitlines()
        ]
        self.assertTrue(wanted)
        self.assertEqual(
            [entry[1] for entry in entries], wanted, "tools/setup/lock.sh has not run since"
        )

    def test_both_sets_of_the_environment_agree(self):
        built, tested = locked("requirements"), locked("requirements-test")
        self.assertTrue(built.keys() & tested.keys())  # at least numpy, which both need
        for package in built.keys() & tested.keys():
            self.assertEqual(built[package][0], tested[package][0])

    def test_the_environment_holds_nothing_else(self):
        python = ROOT / "build/venv/bin/python"
        if not python.exists():
            self.skipTest("no build/venv")
        # Only its own folder: Debian's, with PyTorch, is also on its path.
        code = (
            "import sysconfig\nfrom importlib import metadata as m\n"
            "for d in m.distributions(path=[sysconfig.get_path('purelib')]): print(d.metadata['Name'], d.version)"
        )
        lines = subprocess.run(
            [python, "-c", code], capture_output=True, text=True, check=True
        ).stdout.splitlines()
        pinned = locked("requirements") | locked("requirements-test")
        for line in lines:
            package, version = line.split()
            package = re.sub(r"[-_.]+", "-", package).lower()
            if package not in ("pip", "setuptools"):  # Python's own, from ensurepip
                self.assertEqual(pinned[package][0], version)

    def test_a_forged_package_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            (folder / "tools").mkdir()
            shutil.copytree(SETUP, folder / "tools/setup")
            (folder / "wheels").mkdir()
            forged_wheel(folder / "wheels", asked("requirements")["mujoco-core"])
            place = {
                "PIP_CONFIG_FILE": os.devnull,
                "PIP_NO_INDEX": "1",
                "PIP_FIND_LINKS": str(folder / "wheels"),
            }
            run = subprocess.run(
                [folder / "tools/setup/setup.sh", "python"],
                env={**os.environ, **place},
                capture_output=True,
                text=True,
                check=False,
            )
            self.assertNotEqual(run.returncode, 0)
            self.assertIn("DO NOT MATCH THE HASHES", run.stdout + run.stderr)
            self.assertFalse(list(folder.glob("build/venv/lib/*/site-packages/mujoco*")))


if __name__ == "__main__":
    unittest.main()
