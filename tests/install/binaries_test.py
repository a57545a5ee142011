"""Binaries for users are hardened, find their libraries, and do not contain build paths.

Arguments: the project's root, the build folder, its folder of modules (lib/slipbench), one static
library that runs in every step.
"""

import platform
import re
import subprocess
import sys
import unittest
from pathlib import Path

ROOT, BUILD, MODULES, STEPPED = (Path(word) for word in sys.argv[1:5])
del sys.argv[1:]

PROGRAMS = [BUILD / "bin/slipbench", BUILD / "bin/slipbench-reader"]
BINARIES = PROGRAMS + sorted(MODULES.glob("*.so"))


def readelf(option, path):
    return subprocess.run(
        ["readelf", "--wide", option, path], capture_output=True, text=True, check=True
    ).stdout


# Functions of libm whose result IEEE 754 or arithmetic defines. All others depend on the processor;
# sim/core/math.h replaces them.
LIBM = set(
    re.findall(
        r"(?:FUNC|IFUNC) .* (\w+)@@",
        readelf("--dyn-syms", f"/lib/{platform.machine()}-linux-gnu/libm.so.6"),
    )
)
LIBM -= {
    "ceil",
    "fegetround",
    "fesetround",
    "fmax",
    "fmin",
    "fmod",
    "ilogb",
    "ldexp",
    "nearbyint",
    "nearbyintf",
    "round",
}


def faults(path):
    """Returns what is wrong with a program or a module, one line each."""
    segments, dynamic = readelf("--program-headers", path), readelf("--dynamic", path)
    found = []
    if "GNU_RELRO" not in segments or not re.search(
        r"\(FLAGS\).*BIND_NOW|\(FLAGS_1\).*NOW", dynamic
    ):
        found.append("its tables of addresses can be written")
    if re.search(r"GNU_STACK.* RWE ", segments):
        found.append("its stack can be run")
    if "(TEXTREL)" in dynamic or not re.search(r"Type: +DYN", readelf("--file-header", path)):
        found.append("it stands at a fixed address")
    for places in re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", dynamic):
        # An empty path means the user's current folder.
        if any(not place.startswith("$ORIGIN/") for place in places.split(":")):
            found.append(f"it looks for libraries in '{places}'")
    # Verilator's runtime converts wide integers by exp2 of integers, which is exact.
    exact = {"exp2"} if path.name == "libslipbench_cores.so" else set()
    rounded = sorted(
        LIBM.intersection(re.findall(r" UND (\w+)@", readelf("--dyn-syms", path))) - exact
    )
    found += [f"it rounds by the processor: {rounded}"] if rounded else []
    bytes_of = path.read_bytes()
    found += [f"it holds {place}" for place in (ROOT, BUILD) if str(place).encode() in bytes_of]
    return found


def checks_its_stack(path):
    return "__stack_chk_fail" in readelf("--symbols", path)


class BinariesTest(unittest.TestCase):
    def test_programs_and_modules(self):
        self.assertGreaterEqual(len(BINARIES), 3)
        for path in BINARIES:
            self.assertEqual(faults(path), [], path)

    def test_what_a_fault_looks_like(self):
        """Programs with each fault.

        The tests' own, compiled with their folder's name, and one linked for this test.
        """
        self.assertEqual(
            faults(BUILD / "bin/install_soft"),
            [
                "its tables of addresses can be written",
                "its stack can be run",
                "it stands at a fixed address",
                "it looks for libraries in '/nowhere:'",
                f"it holds {ROOT}",
            ],
        )

    def test_stacks_are_checked_but_for_steps(self):
        for path in PROGRAMS:
            self.assertTrue(checks_its_stack(path), path)
        self.assertFalse(checks_its_stack(STEPPED))


if __name__ == "__main__":
    unittest.main()
