"""A sweep ends if a file that its scene names is replaced while its trials run.

Arguments: the source tree, the program.
"""

import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv.pop(2)).resolve()
SCENES = Path(sys.argv.pop(1)).resolve() / "scenes"


class ChangedFilesTest(unittest.TestCase):
    def changed(self, scene, named, other, *settings):
        """Returns the sweep's error when the scene's file `named` becomes `other`.

        This happens after the first trial; the folder is a copy of the scene's.
        """
        with tempfile.TemporaryDirectory() as made:
            folder = Path(made)
            shutil.copytree(scene.parent, folder / "scenes")
            shutil.copy(named, folder / "scenes" / named.name)
            command = [
                PROGRAM,
                "run",
                scene.name,
                "--set",
                *settings,
                "--trials",
                "20000",
                "--jobs",
                "1",
                "-o",
                folder / "out.h5",
            ]
            with subprocess.Popen(
                command,
                cwd=folder / "scenes",
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            ) as sweep:
                while sweep.poll() is None and not (folder / "out.h5.partial").exists():
                    time.sleep(0.01)
                (folder / "other").write_bytes(other)
                (folder / "other").rename(folder / "scenes" / named.name)
                _, error = sweep.communicate(timeout=60)
            self.assertEqual(sweep.returncode, 2, error)
            return error

    def test_a_network(self):
        network = SCENES / "learn/piezo_slip.onnx"  # a network for another sensor
        own = SCENES / "learn/papillarray_slip.onnx"
        detector = f"detector={{type: network, model: {own.name}, sensor: pad}}"
        error = self.changed(
            SCENES / "papillarray/stage.yaml", own, network.read_bytes(), "duration=0.5 s", detector
        )
        self.assertIn(f"{own.name} has changed during the run", error)

    def test_a_model(self):
        model = SCENES / "bodies/block.xml"
        error = self.changed(
            SCENES / "bodies/sliding_block.yaml",
            model,
            model.read_bytes() + b"\n",
            "duration=0.1 s",
        )
        self.assertIn("block.xml has changed during the run", error)


if __name__ == "__main__":
    unittest.main()
