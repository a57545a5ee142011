"""Build backend of `pip install`: scikit-build-core, and a check of the system before the build.

A package without MuJoCo or networks would install and then fail in use. So the build needs
everything: the wheels of MuJoCo and OpenVINO are requirements of the build, pinned in
tools/setup/requirements.in, and missing Debian packages end it before anything large is downloaded.
"""

import subprocess
import sys
from pathlib import Path

from scikit_build_core import build as backend

ROOT = Path(__file__).resolve().parents[1]
SETUP = ROOT / "tools/setup"

build_editable = backend.build_editable
build_sdist = backend.build_sdist
build_wheel = backend.build_wheel
get_requires_for_build_sdist = backend.get_requires_for_build_sdist
prepare_metadata_for_build_editable = backend.prepare_metadata_for_build_editable
prepare_metadata_for_build_wheel = backend.prepare_metadata_for_build_wheel


def pinned():
    """Returns the requirements of tools/setup/requirements.in."""
    lines = (SETUP / "requirements.in").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def check_system():
    """Ends the build, with the command that installs them, if Debian packages are missing.

    Elsewhere than on Debian CMake reports missing libraries.
    """
    found = subprocess.run(
        [SETUP / "setup.sh", "missing", "build"], capture_output=True, text=True, check=False
    )
    missing = found.stdout.split()
    if found.returncode == 0 and missing:
        sys.exit(
            f"slipbench: `pip install` compiles slipbench, and Debian packages are missing for that. Run this as root, then try again:\n"
            f"  apt-get update && apt-get install --yes --no-install-recommends {' '.join(missing)}"
        )


def get_requires_for_build_wheel(config_settings=None):
    check_system()
    return [*backend.get_requires_for_build_wheel(config_settings), *pinned()]


def get_requires_for_build_editable(config_settings=None):
    check_system()
    return [*backend.get_requires_for_build_editable(config_settings), *pinned()]
