"""Every command on effects and a sensor that no folder can know by name.

They are those of example_effects.cc and example_sensor.cc, in the catalogues of a program of its own.
Arguments: that program and the shipped program.
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py

PROGRAM, SHIPPED = (str(Path(word).resolve()) for word in sys.argv[1:3])
del sys.argv[1:3]

# Twelve elements, pressed 0.5 mm and then moved by 2.8 mm in the direction of 40 degrees: each is
# stretched by mu k_n d/k_t = 0.42 mm at most, so all slip. mu_static = 0.5, mu_kinetic = 0.4.
SCENE = """slipbench: 1
duration: 1.2 s
time_step: 1 ms
seed: 3
surface: {material: acrylic}
friction: {static: 0.5, kinetic: 0.4}
motion: {kind: stage, compression: 0.5 mm, start: 0.5 s, speed: 4 mm/s, direction: 40 deg}
sensors:
  pad: {type: example_pad, electronics: typical}
"""
# Each effect alone, so that no other one's changes hide a law that `verify` checks by mistake.
EFFECTS = {
    "cone": "[example_cone]",
    "wave": "[example_wave]",
    "weak": "[example_weak_slide]",
    "rate": "[example_rate]",
    "hum": "[example_hum, inertia]",  # named first, installed after the tips
    "body": "[example_body]",
    "most": "[example_rate, example_cone, example_weak_slide, example_wave]",
}
GENERAL = re.compile(r"^Formats of any sensor:\n(.*?)^Formats? of ", re.MULTILINE | re.DOTALL)
OWN = re.compile(r"^Formats? of (?:the|grasps|a) .*?:\n(.*?)(?=^Formats? of |^$)", re.M | re.S)
NAME = re.compile(r"^  ([a-z]\S*) ", re.MULTILINE)


def run(*words, status=0, program=PROGRAM):
    """Runs the program; returns its standard output and error together."""
    done = subprocess.run([program, *map(str, words)], check=False, capture_output=True, text=True)
    if done.returncode != status:
        raise AssertionError(f"{words}: status {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def printed(*words, status=0):
    """What the program prints with --json."""
    text = run(*words, "--json", status=status)
    return json.loads(text[text.index("{") :])


class ExampleParts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.scene = cls.place / "scene.yaml"
        cls.scene.write_text(SCENE)
        cls.data = {name: cls.place / f"{name}.h5" for name in EFFECTS}
        for name, path in cls.data.items():
            cls.recorded(path, EFFECTS[name])

    @classmethod
    def recorded(cls, path, effects):
        sets = [f"effects={effects}", "sweep={motion.speed: [3 mm/s, 4 mm/s]}"]
        run("sweep", cls.scene, "--set", *sets, "-o", path, "--quiet")

    def test_verify_knows_what_an_effect_changes(self):
        for name, path in self.data.items():
            with self.subTest(name):
                run("verify", path)

    def test_verify_finds_what_an_effect_does_not_declare(self):
        path = self.place / "undeclared.h5"
        self.recorded(path, "[undeclared_cone]")
        self.assertRegex(
            run("verify", path, status=1), r"labels/pad/margin.* but 1 - f_t/\(mu_static f_n\)"
        )

    def test_a_pad_has_one_cone(self):
        refused = run(
            *("run", self.scene, "--set", "effects=[example_cone, anisotropic_friction]"), status=2
        )
        self.assertRegex(refused, "example_cone and anisotropic_friction cannot be combined")

    def test_eval_compares_with_a_yardstick(self):
        found = printed("eval", "sum_change", self.data["most"])
        self.assertIn("yardstick", found)
        refused = run("eval", "sum_change", self.data["most"], "--labels", "has_slipped", status=2)
        self.assertRegex(refused, "example_pad.*has_slipped.*papillarray")

    def test_cost_varies_what_the_entries_declare(self):
        rows = printed("cost", self.scene, "--set", "effects=[example_body]", "--budget", "12s")
        series = {row["series"] for row in rows["rows"]}
        self.assertLessEqual({"tolerance", "grid"}, series, "of the effect with a body")
        rows = printed("cost", self.scene, "--set", "effects=[example_cone]", "--budget", "12s")
        self.assertIn("tolerance", {row["series"] for row in rows["rows"]})
        self.assertNotIn("grid", {row["series"] for row in rows["rows"]})
        setting = run(
            "cost", self.scene, "--set", "effects=[example_body]", "--accuracy", "onset=5%"
        )
        self.assertRegex(setting, r"time_step=")

    def test_warnings_know_the_waves(self):
        # Two elements of a unit are 1.5 mm apart, more than half of a wave of 2 mm.
        sets = ("effects=[example_wave]", "sensors.pad.bristles=2")
        said = run("run", self.scene, "--set", *sets)
        self.assertRegex(said, r"effects\.example_wave\.wavelength: 2 mm is not resolved")

    def test_the_report_shows_what_the_entries_declare(self):
        page = self.place / "page.html"
        run("report", self.data["body"], "-o", page)
        text = page.read_text()
        for word in (
            "dimple",
            "Example image",
            "Example vibration",
            "Example spectrum",
            "Example picture.",
            "shear_modulus",
        ):
            with self.subTest(word):
                self.assertIn(word, text)

    def test_a_dataset_names_the_libraries(self):
        with h5py.File(self.data["body"]) as file:
            libraries = file["data/demo_0"].attrs["libraries"]
        for name in ("FFTW", "Example Reader", "user's library"):
            with self.subTest(name):
                self.assertIn(name, libraries)

    def test_every_general_format_takes_it(self):
        text = run("export", "--help")
        formats = NAME.findall(GENERAL.search(text).group(1))
        self.assertGreaterEqual(len(formats), 7, formats)
        for name in formats:
            with self.subTest(name):
                out = self.place / name
                run("export", self.data["most"], "--format", name, "-o", out, "--quiet")
                self.assertTrue(any(out.rglob("*")))

    def test_formats_of_one_device_refuse_it(self):
        formats = NAME.findall("".join(OWN.findall(run("export", "--help"))))
        self.assertIn("myrmex-csv", formats)
        for name in formats:
            with self.subTest(name):
                out = self.place / name
                run("export", self.data["most"], "--format", name, "-o", out, status=2)

    def test_calibration_reads_the_disturbance(self):
        found = printed("calibrate", "--snapshots", self.data["cone"])
        keys = [one["key"] for one in found["keys"]]
        self.assertIn("sensors.pad.electronics.gain.scale", keys)

    def test_the_shipped_program_does_not_know_them(self):
        run("run", self.scene, status=2, program=SHIPPED)


if __name__ == "__main__":
    unittest.main()
