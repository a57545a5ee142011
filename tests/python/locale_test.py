"""Shipped scenes under a locale with a decimal comma.

The data are bit-identical to those of the C locale.

usage: locale_test.py SCENES [unittest's arguments]
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCENES = Path(sys.argv.pop(1))
# Run in a process of its own, since a locale belongs to the process. The first trial of each scene.
RUN = """
import json, locale, sys
locale.setlocale(locale.LC_ALL, sys.argv[1])
import slipbench
locale.setlocale(locale.LC_ALL, sys.argv[1])
assert (locale.localeconv()["decimal_point"] == ",") == (sys.argv[1] != "C")
found = {}
for path in sys.argv[2:]:
    try:
        found[path] = slipbench.Scene.load(path).run().sha256
    except slipbench.InputError as error:
        found[path] = str(error)
print(json.dumps(found))
"""
# Scenes whose step, model file or messages once passed numbers through the locale: bodies, a hand
# with meshes, a grasp; and a stage.
FEW = ["biotac_sp/grasp.yaml", "bodies/held_box.yaml", "grasp/lift.yaml", "papillarray/stage.yaml"]


class Locale(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        try:
            subprocess.run(
                ["localedef", "-i", "de_DE", "-f", "UTF-8", f"{self.folder.name}/de_DE.UTF-8"],
                check=True,
                capture_output=True,
            )
        except (OSError, subprocess.CalledProcessError) as error:
            self.skipTest(f"no locale with a decimal comma can be made here: {error}")

    def digests(self, locale, paths):
        environment = {**os.environ, "LOCPATH": self.folder.name}
        result = subprocess.run(
            [sys.executable, "-c", RUN, locale, *map(str, paths)],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def check(self, paths):
        expected = self.digests("C", paths)
        self.assertEqual(self.digests("de_DE.UTF-8", paths), expected)
        return expected

    def test_a_few_scenes(self):
        expected = self.check([SCENES / name for name in FEW])
        for path, digest in expected.items():
            self.assertRegex(digest, "^[0-9a-f]{64}$", path)

    def test_every_scene(self):
        for folder in sorted({path.parent for path in SCENES.rglob("*.yaml")}):
            with self.subTest(folder=folder):
                self.check(sorted(folder.glob("*.yaml")))


if __name__ == "__main__":
    unittest.main()
