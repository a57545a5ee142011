"""A trial of each effect verifies. Arguments: the project's root, the program."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()
STAGE = ROOT / "scenes/papillarray/stage.yaml"
# Settings that the effect needs.
WITH = {
    "asperities": ["effects=[inertia, asperities]"],
    "roughness": ["effects=[roughness]", "time_step=auto"],
}


def run(path, scene, *options):
    subprocess.run(
        [PROGRAM, "run", scene, "--quiet", *options, "-o", path],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return path


class EffectsTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def expect_to_hold(self, path):
        result = subprocess.run(
            [PROGRAM, "verify", path, "--json"], stdout=subprocess.PIPE, check=False
        )
        (dataset,) = json.loads(result.stdout)["datasets"]
        self.assertEqual([], dataset["failures"], dataset["file"])
        for check in dataset["checks"]:  # contact: only for scenes with bodies
            self.assertTrue(
                check["checked"] > 0 or (check["check"] == "contact" and check["left_out"]),
                dataset["file"],
            )
        self.assertEqual(result.returncode, 0)
        return dataset

    def test_effects(self):
        listed = json.loads(
            subprocess.run(
                [PROGRAM, "list", "effects", "--json"], check=True, stdout=subprocess.PIPE
            ).stdout
        )
        names = [entry["name"] for entry in listed["effects"]]
        self.assertIn("stribeck", names)
        for name in names:
            # At the end the pad lifts off: tips with mass then ring freely.
            settings = (*WITH.get(name, [f"effects=[{name}]"]), "motion.retract=3.5 s")
            path = run(self.folder / f"{name}.h5", STAGE, "--set", *settings)
            dataset = self.expect_to_hold(path)
            (cone,) = (check for check in dataset["checks"] if check["check"] == "cone")
            exempt = name not in (
                "elastic_skin",
                "texture",
                "roughness",
                "viscoelastic",
            )  # these change no friction
            self.assertEqual(exempt, any(name in why for why in cone["left_out"]), name)


if __name__ == "__main__":
    unittest.main()
