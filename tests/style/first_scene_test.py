"""The first scene of README.md suits its sensor and its detector.

The two changes that scenes/README.md shows as bad examples do not.

Arguments: the project's root and the program.
"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from steps import commands

ROOT, PROGRAM = Path(sys.argv.pop(1)), sys.argv.pop(1)


class FirstSceneTest(unittest.TestCase):
    def run_with(self, *settings):
        """Runs the scene; returns its outcome and the texts of its warnings."""
        steps = list(commands((ROOT / "README.md").read_text(encoding="utf-8")))
        [text] = [step[2] for step in steps if step[:2] == ("file", "first.yaml")]
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "first.yaml").write_text(text, encoding="utf-8")
            sets = [word for setting in settings for word in ("--set", setting)]
            done = subprocess.run(
                [PROGRAM, "run", "first.yaml", "--json", *sets],
                cwd=folder,
                capture_output=True,
                text=True,
                check=True,
            )
        result = json.loads(done.stdout)
        return result["trials"][0]["outcome"], done.stderr

    def test_the_detector_sees_the_slip_and_the_sensor_its_forces(self):
        outcome, warnings = self.run_with()
        self.assertEqual(warnings, "")
        self.assertEqual(outcome["detection"], "seen")
        self.assertIn(
            f"slip {1e3 * outcome['detection_delay_s']:.0f} ms after",
            (ROOT / "scenes/README.md").read_text(encoding="utf-8"),
        )

    def test_bad_examples(self):
        _, warnings = self.run_with("surface.material=rubber")
        self.assertIn("values beyond its range in 1836 of 3000 samples", warnings)
        outcome, _ = self.run_with("detector.loading=20 mN")
        self.assertEqual(outcome["detection"], "early")


if __name__ == "__main__":
    unittest.main()
