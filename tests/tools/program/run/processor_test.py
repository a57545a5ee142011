"""Every shipped scene gives the same bytes whether or not the C library may use AVX2 and FMA; FFTW and OpenVINO ask the processor
themselves, and are not masked. Arguments: the project's root, the program."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()
OLD = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4"}


def sines(environment):
    return subprocess.run([sys.executable, "-c", "import math; print([math.sin(.001 * k) for k in range(9999)])"], env=environment, stdout=subprocess.PIPE,
                          check=True).stdout


class ProcessorTest(unittest.TestCase):
    def test_shipped_scenes(self):
        if sines(OLD) == sines(None):
            self.skipTest("this processor has no FMA, or this C library does not round by it")
        for scene in sorted((ROOT / "scenes").glob("*/*.yaml")):
            with self.subTest(scene=scene), tempfile.TemporaryDirectory() as folder:
                paths = [Path(folder) / name for name in ("new.h5", "old.h5")]
                for path, environment in zip(paths, (None, OLD)):
                    subprocess.run([PROGRAM, "run", scene, "--quiet", "-o", path], env=environment, check=True, stdout=subprocess.DEVNULL)
                self.assertTrue(paths[0].read_bytes() == paths[1].read_bytes())


if __name__ == "__main__":
    unittest.main()
