"""Training interrupted before its first validation: while it reads, and in its first steps.

Arguments: the source tree, the program.
"""

import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv.pop(2)).resolve()
SOURCE = Path(sys.argv.pop(1)).resolve()
SPEEDS = "sweep={motion.speed: [1 mm/s, 2 mm/s, 4 mm/s, 8 mm/s], trials: 6}"


class InterruptionTest(unittest.TestCase):
    def test_nothing_is_left(self):
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made)
            scene = SOURCE / "scenes/papillarray/stage.yaml"
            subprocess.run(
                [
                    PROGRAM,
                    "sweep",
                    scene,
                    "--set",
                    "duration=3 s",
                    SPEEDS,
                    "-o",
                    "data.h5",
                    "--quiet",
                ],
                cwd=folder,
                check=True,
                timeout=60,
            )
            command = [
                PROGRAM,
                "train",
                "data.h5",
                "--recipe",
                "papillarray_gru",
                "--steps",
                "100000",
                "-o",
                "slip.onnx",
            ]
            for seconds, way in (
                (0.3, signal.SIGINT),
                (0.8, signal.SIGTERM),
                (1.5, signal.SIGHUP),
                (3.0, signal.SIGTERM),
            ):
                # A signal ignored at the program's start stays ignored.
                with subprocess.Popen(
                    command,
                    cwd=folder,
                    stderr=subprocess.PIPE,
                    text=True,
                    preexec_fn=lambda way=way: signal.signal(way, signal.SIG_DFL),
                ) as training:
                    training.stderr.readline()  # "reading data.h5": signal handling starts a moment later
                    time.sleep(seconds)
                    training.send_signal(way)
                    _, error = training.communicate(timeout=60)
                self.assertEqual(training.returncode, 130, error)
                self.assertIn("interrupted; nothing is kept", error)
                self.assertEqual([path.name for path in folder.iterdir()], ["data.h5"])


if __name__ == "__main__":
    unittest.main()
