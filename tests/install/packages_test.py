"""Everything that the build looks for is found, and tools/setup/packages.txt names its package.

Without this test a package could be missing from the list unnoticed, if others bring it along or
the build leaves out a part without it. Arguments: the project's root, the build folder.
"""

import os
import platform
import re
import shutil
import sys
import sysconfig
import unittest
from pathlib import Path

ROOT, BUILD = (Path(word) for word in sys.argv[1:3])
del sys.argv[1:]

INSTALLED = Path("/var/lib/dpkg/info")
# Called by scripts and tests; CMake does not look for them. Only `./slipbench test --all` installs
# chromium.
PROGRAMS = (
    "c++",
    "cmake",
    "git",
    "ninja",
    "shellcheck",
    "valgrind",
    *(("chromium",) if shutil.which("chromium") else ()),
)
# PyTorch loads this. Debian installs the reference BLAS by default, which is several times slower.
BLAS = Path(f"/usr/lib/{platform.machine()}-linux-gnu/libblas.so.3")
# Packages whose names contain a version; Debian's defaults bring them.
BY_DEFAULT = {r"g\+\+-\d+.*": "g++", r"libpython3\.\d+-dev": "python3-dev"}
# Libraries that CMake's own HDF5 module looks for in addition.
NOT_OURS = re.compile(r"HDF5_(?!C_LIBRARY_hdf5$).*")
# Not from a Debian package, or searched without a name in the cache.
NO_PACKAGE = {"MuJoCo", "OpenVINO", "Python", "Python3", "Threads"}


def named():
    release = re.search(
        r'^VERSION_ID="?([^"\n]*)',
        Path("/etc/os-release").read_text(encoding="utf-8"),
        re.MULTILINE,
    )[1]
    lines = (ROOT / "tools/setup/packages.txt").read_text(encoding="utf-8").splitlines()
    return {
        words[1]
        for line in lines
        if (words := line.split())
        and re.fullmatch(rf"(build|test|all)(@{re.escape(release)})?", words[0])
    }


def sought():
    """Returns what our own CMake files look for: packages, programs, libraries."""
    texts = [
        path.read_text(encoding="utf-8")
        for pattern in ("cmake/*.cmake", "**/CMakeLists.txt")
        for path in ROOT.glob(pattern)
        if not path.is_relative_to(ROOT / "build")
    ]
    return (
        set(re.findall(r"find_(?:package|program|library|path|file)\((\w[\w-]*)", "\n".join(texts)))
        - NO_PACKAGE
    )


def places():
    """Returns {name looked for: its files and folders in CMake's cache}."""
    entries = re.findall(
        r"^([\w-]+):(?:FILEPATH|PATH)=(/.*)",
        (BUILD / "CMakeCache.txt").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    found = {
        name: [
            path
            for key, path in entries
            if not NOT_OURS.fullmatch(key) and f"{key}_".lower().startswith(f"{name}_".lower())
        ]
        for name in sought()
    }
    found |= {name: [shutil.which(name) or name] for name in PROGRAMS}
    found |= {"Python.h": [f"{sysconfig.get_path('include')}/Python.h"], BLAS.name: [str(BLAS)]}
    return {name: [path for path in paths if Path(path).exists()] for name, paths in found.items()}


def owners():
    """Returns the Debian packages of each file or folder.

    Only of files and folders that belong to one package alone.
    """
    found = {}
    for listing in INSTALLED.glob("*.list"):
        package = listing.stem.split(":")[0]
        package = next(
            (brings for name, brings in BY_DEFAULT.items() if re.fullmatch(name, package)), package
        )
        for path in listing.read_text(encoding="utf-8").splitlines():
            found.setdefault(path, set()).add(package)
    return {path: packages for path, packages in found.items() if len(packages) == 1}


@unittest.skipUnless(INSTALLED.is_dir(), "no Debian")
class PackagesTest(unittest.TestCase):
    def test_nothing_is_left_out(self):
        self.assertEqual([name for name, found in places().items() if not found], [])

    def test_each_package_is_named(self):
        known, owner = named(), owners()
        missing = set()
        for name, found in places().items():
            for path in found:
                # The second is the owner of the target of update-alternatives.
                packages = owner.get(path) or owner.get(os.path.realpath(path)) or set()
                missing.update(f"{name}: {package}" for package in packages - known)
        self.assertEqual(sorted(missing), [])


if __name__ == "__main__":
    unittest.main()
