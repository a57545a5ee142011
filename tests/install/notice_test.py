"""NOTICE.md names exactly what the program links, loads, is compiled from and inlines.

Arguments: the project's root, the build folder, the folder of its modules (lib/slipbench), the
libraries that a module loads by name (joined by ":"), the foreign files that are inlined.
"""

import hashlib
import os
import platform
import re
import subprocess
import sys
import unittest
from functools import cache
from pathlib import Path

ROOT, BUILD, MODULES = (Path(word) for word in sys.argv[1:4])
LOADED_BY_NAME = [Path(word).name for word in sys.argv[4].split(":") if word]
INLINED = [Path(word) for word in sys.argv[5:]]
del sys.argv[1:]

# Identifiers in use, from https://spdx.org/licenses.
LICENCES = {
    "Apache-2.0",
    "Artistic-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSD-Attribution-HPND-disclaimer",
    "BSL-1.0",
    "GPL-2.0-only",
    "GPL-2.0-or-later",
    "GPL-3.0-or-later",
    "ISC",
    "LGPL-2.0-or-later",
    "LGPL-2.1-or-later",
    "LGPL-3.0-only",
    "LGPL-3.0-or-later",
    "LicenseRef-public-domain",
    "MIT",
    "MPL-2.0",
    "OLDAP-2.8",
    "Python-2.0",
    "Unicode-DFS-2016",
    "Zlib",
    "bzip2-1.0.6",
    "curl",
}
EXCEPTIONS = {"GCC-exception-3.1", "Linux-syscall-note"}
PROGRAMS = ("bin/slipbench", "bin/slipbench-reader")
PINS = {
    name: version
    for listing in ("requirements", "requirements-test", "requirements-mujoco")
    for name, version in re.findall(
        r"^([a-z-]+)==(\S+)",
        (ROOT / f"tools/setup/{listing}.txt").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
}
D3 = ROOT / "tools/page/d3"
# Libraries whose names contain the architecture; NOTICE.md has those of both.
BY_ARCHITECTURE = {
    "x86_64": {"ld-linux-x86-64.so.2", "libopenvino_intel_cpu_plugin.so"},
    "aarch64": {"ld-linux-aarch64.so.1", "libopenvino_arm_cpu_plugin.so"},
}
ELSEWHERE = {
    name
    for machine, names in BY_ARCHITECTURE.items()
    if machine != platform.machine()
    for name in names
}
SONAME = re.compile(r"[\w.+-]+\.so(?:\.[\w.]+)?")


def rows(text):
    """Returns (names, packages, version, licence) of every table."""
    cells = [
        [cell.strip() for cell in line.strip("| \n").split("|")]
        for line in text.splitlines()
        if line.startswith("| ")
    ]
    return [
        (re.split(r", ", names), re.split(r", ", packages), version, licence)
        for names, packages, version, licence in cells
        if licence != "licence"
    ]


@cache
def version_of(package):
    """Returns the installed version: whole for a pinned package, two numbers for a Debian one,
    because updates of Debian 12 change the others.
    """
    if package.startswith("PyPI: "):
        return PINS[package.removeprefix("PyPI: ")]
    if package == "npm: d3":
        return re.match(
            r"// https://d3js\.org v(\S+) ", (D3 / "d3.min.js").read_text(encoding="utf-8")
        )[1]
    listed = subprocess.run(
        ["dpkg-query", "--show", "--showformat=${Version}\n", package],
        capture_output=True,
        text=True,
        check=False,
    ).stdout
    return (re.findall(r"^(?:\d+:)?(\d+(?:\.\d+)?)", listed) or ["none"])[0]


def output(*command):
    return subprocess.run(command, cwd=BUILD, capture_output=True, text=True, check=True).stdout


@cache
def loaded():
    """Returns the libraries that the programs and modules load, without our own."""
    found = set()
    for program in PROGRAMS:
        for line in output("ldd", BUILD / program).splitlines():
            name = Path(line.split()[0]).name
            if not name.startswith("linux-vdso"):
                found.add(name)
    for module in MODULES.glob("*.so"):
        found.update(re.findall(r"\(NEEDED\).*\[(.*)\]", output("readelf", "--dynamic", module)))
    # The plugin's builds work with other versions of MuJoCo, which belong to their users.
    found = {
        name
        for name in found
        if not name.startswith("libmujoco.so.") or name in output("ldd", BUILD / PROGRAMS[0])
    }
    return found | set(LOADED_BY_NAME)


@cache
def compiled_in():
    """Returns Debian packages of the headers and sources outside the tree that the product is
    compiled from.
    """
    files = set()
    ours = False
    packages = {
        "libpython3-dev"
    }  # Python's headers come from Debian, or from another Python that the module is built for
    if not (ROOT / "build/mujoco").exists():
        packages.add("PyPI: mujoco")  # then the plugin for the earlier release is not built
    for line in output("ninja", "-t", "deps").splitlines():
        if not line.startswith(" "):
            ours = bool(line) and "#deps" in line and not line.startswith("tests/")
        elif ours:
            path = os.path.normpath(BUILD / line.strip())
            if path.startswith("/usr/"):
                files.add(path)
            elif "/site-packages/nanobind/" in path:
                packages.add("PyPI: nanobind")
            elif "/build/mujoco/" in path:
                packages.add("PyPI: mujoco")
    files = {path for path in files if not re.search(r"/python3\.\d+/", path)}
    for listing in Path("/var/lib/dpkg/info").glob("*.list"):
        if not files.isdisjoint(listing.read_text(encoding="utf-8").splitlines()):
            packages.add(listing.stem.split(":")[0])
    return packages


def findings(text):
    """Returns what `text` does not name, and what it names without use, one line each."""
    names = {name for row in rows(text) for name in row[0]}
    packages = {package for row in rows(text) for package in row[1]}
    libraries = {name for name in names if SONAME.fullmatch(name)}
    inlined = {path.name for path in INLINED}
    scripts = {name for name in names if name.endswith((".js", ".css"))}
    found = [f"{name} is loaded and not named" for name in loaded() - libraries]
    found += [f"{name} is named and not loaded" for name in libraries - loaded() - ELSEWHERE]
    found += [f"{name} is inlined and not named" for name in inlined - scripts]
    found += [f"{name} is named and not inlined" for name in scripts - inlined]
    found += [f"{package} is compiled in and not named" for package in compiled_in() - packages]
    for row_names, row_packages, version, licence in rows(text):
        if not any(name in libraries | scripts for name in row_names):
            found += [
                f"{package} is named and not compiled in"
                for package in row_packages
                if package not in compiled_in()
            ]
        words = re.sub(
            r"\bWITH ([\w.-]+)", lambda end: "" if end[1] in EXCEPTIONS else end[1], licence
        )
        if any(word not in LICENCES for word in re.split(r" AND | OR ", words.strip())):
            found.append(f"{licence} is not a licence of SPDX")
        for package in row_packages:
            if (
                not package.startswith(("PyPI: ", "npm: "))
                and not Path(f"/usr/share/doc/{package}/copyright").exists()
            ):
                found.append(f"{package} has no copyright file here")
            elif version != version_of(package):
                found.append(f"{package} is {version_of(package)} here, not {version}")
    return sorted(found)


@unittest.skipUnless(
    platform.freedesktop_os_release().get("VERSION_ID") == "12",
    "NOTICE.md names the packages of Debian 12",
)
class NoticeTest(unittest.TestCase):
    text = (ROOT / "NOTICE.md").read_text(encoding="utf-8")

    def test_names_everything_and_nothing_else(self):
        self.assertEqual(findings(self.text), [])

    def test_each_omission_is_found(self):
        """Tables without a row of each kind, with an extra row, and with an unknown licence are
        refused.
        """

        def without(start):
            return "".join(
                line for line in self.text.splitlines(True) if not line.startswith(start)
            )

        for start, finding in (
            ("| libfftw3.so.3", "libfftw3.so.3 is loaded and not named"),
            ("| libsasl2.so.2", "libsasl2.so.2 is loaded and not named"),
            ("| libtbb.so.12", "libtbb.so.12 is loaded and not named"),
            ("| d3.min.js", "d3.min.js is inlined and not named"),
            ("| CLI11", "libcli11-dev is compiled in and not named"),
            ("| nanobind", "PyPI: nanobind is compiled in and not named"),
            ("| Eigen", "libeigen3-dev is compiled in and not named"),
        ):
            self.assertEqual(findings(without(start)), [finding])
        verilator = [line for line in self.text.splitlines(True) if "| verilator |" in line]
        text = self.text
        for line in verilator:
            text = text.replace(line, "")
        self.assertEqual(findings(text), ["verilator is compiled in and not named"])
        self.assertEqual(
            findings(self.text + "| libgone.so.1 | libc6 | 2.36 | MIT |\n"),
            ["libgone.so.1 is named and not loaded"],
        )
        self.assertEqual(
            findings(self.text + "| a work | libcurl4 | 7.88 | MIT |\n"),
            ["libcurl4 is named and not compiled in"],
        )
        self.assertEqual(
            findings(self.text + "| libc.so.6 | libc6 | 2.36 | BSD |\n"),
            ["BSD is not a licence of SPDX"],
        )
        self.assertEqual(
            findings(self.text + "| libc.so.6 | libgone1 | 1.0 | MIT |\n"),
            ["libgone1 has no copyright file here"],
        )
        self.assertEqual(
            findings(self.text + "| libc.so.6 | libc6 | 2.35 | MIT |\n"),
            ["libc6 is 2.36 here, not 2.35"],
        )

    def test_names_the_pinned_wheels(self):
        mujoco, openvino = PINS["mujoco-core"], PINS["openvino"]
        self.assertIn(f"| libmujoco.so.{mujoco} | PyPI: mujoco-core | {mujoco} |", self.text)
        self.assertIn(f"| PyPI: openvino | {openvino} |", self.text)

    def test_the_pages_carry_the_licence_of_their_script(self):
        self.assertEqual([path.name for path in INLINED], ["d3.min.js"])
        self.assertTrue(
            (D3 / "d3_licence.txt")
            .read_text(encoding="utf-8")
            .startswith(f"D3 {version_of('npm: d3')},")
        )
        self.assertIn(
            f"| `d3.min.js` | {hashlib.sha256((D3 / 'd3.min.js').read_bytes()).hexdigest()} |",
            (D3 / "README.md").read_text(encoding="utf-8"),
        )


if __name__ == "__main__":
    unittest.main()
