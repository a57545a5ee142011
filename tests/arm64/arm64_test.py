"""Compiles the program and the tests of its libraries for arm64 and runs them by qemu.

Arguments: the project's root, the program of this machine, the names of the tests' programs.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

ROOT, PROGRAM = (Path(word) for word in sys.argv[1:3])
TESTS = sys.argv[3:]
del sys.argv[1:]

BIN = ROOT / "build/arm64/bin"
EMULATOR = ("qemu-aarch64-static", "-L", ROOT / "build/arm64-system")
STEPS = (
    [ROOT / "tools/setup/arm64.sh"],
    ["cmake", "--preset", "arm64"],
    ["cmake", "--build", "--preset", "arm64", "--parallel", str(os.cpu_count())],
)
# Each takes minutes under emulation.
SLOW = (
    "MeshDistance.GridOfABallOfTrianglesIsABall",
    "FieldEnergy.AFrictionlessFieldNeverGivesMoreThanItTook",
    "Asperities.StrengthGrowsWithTheRootOfLoadAndSpeed",
    "BatchesTest.*",
    "FailureTest.DamagedFilesAreRefusedOrRead",
)
# Without MuJoCo, FFTW and networks, which round by the processor.
SCENE = ROOT / "scenes/papillarray/stage.yaml"


def run(*command, **more):
    """Runs a command that must succeed."""
    done = subprocess.run(
        [str(word) for word in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
        **more,
    )
    if done.returncode != 0:
        raise AssertionError(
            f"{' '.join(map(str, command))}\nended with {done.returncode}:\n{done.stdout}"
        )


@unittest.skipUnless(
    all(map(shutil.which, ("aarch64-linux-gnu-g++", EMULATOR[0], "mmdebstrap"))),
    "a compiler for arm64, qemu or mmdebstrap is missing; Debian 12 has them: tools/setup/setup.sh all",
)
class Arm64Test(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for step in STEPS:
            run(*step, cwd=ROOT)

    def test_libraries(self):
        for name in TESTS:
            with self.subTest(name=name):
                run(*EMULATOR, BIN / name, "--gtest_brief=1", f"--gtest_filter=-{':'.join(SLOW)}")

    def test_content_digest(self):
        """The arrays and attributes of a trial are bit-identical to those of x86-64."""
        digests = []
        with tempfile.TemporaryDirectory() as folder:
            for number, program in enumerate(([PROGRAM], [*EMULATOR, BIN / "slipbench"])):
                path = Path(folder) / f"{number}.h5"
                run(*program, "run", SCENE, "--quiet", "-o", path)
                with h5py.File(path) as file:
                    digests.append(file.attrs["content_sha256"])
        self.assertEqual(*digests)


if __name__ == "__main__":
    unittest.main()
