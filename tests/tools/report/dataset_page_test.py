"""A dataset's overview and a trial's page in a browser: zeros count and read as 0; replay commands.

dataset_page_test.py PROGRAM
"""

import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "page"))
import chromium  # noqa: E402

PROGRAM = Path(sys.argv.pop(1)).resolve()

# Sixteen taxels of one point each on a plane: the pad slides along X, so that all slip fully at one
# instant. The incipient phase is 0 s in every trial.
SCENE = """slipbench: 1
duration: 0.4 s
surface: {material: rubber}
motion: {kind: stage, gap: 0 mm, compression: 0.5 mm, approach_speed: 20 mm/s, start: 0.1 s, speed: 8 mm/s, acceleration: 1 m/s2}
sensors: {skin: {type: taxels, rate: 200 Hz}}
sweep: {motion.speed: [8 mm/s, 16 mm/s], trials: 4}
"""
EXPONENT = r"\de[-−+]?\d"


class DatasetPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        folder = Path(cls.folder.name)
        (folder / "skin.yaml").write_text(SCENE, encoding="utf-8")
        for words in (["sweep", "skin.yaml", "-o", "skin.h5", "--quiet"], ["report", "skin.h5"]):
            subprocess.run([PROGRAM, *words], check=True, cwd=folder, stdout=subprocess.DEVNULL)
        cls.page = folder / "skin.html"
        cls.browser = cls.enterClassContext(chromium.Chromium())

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def texts(self, selector):
        return self.browser.evaluate(
            f"[...document.querySelectorAll({selector!r})].map(node => node.textContent)"
        )

    def test_a_phase_of_0_s_reaches_gross_slip(self):
        self.browser.open_drawn(self.page, "#all")
        phases = self.browser.evaluate(
            "slipbench.page.trials.map(trial => trial.sensors.skin.incipient_s)"
        )
        self.assertEqual(phases, [0] * 8)
        self.assertIn(
            "From the first micro-slip to gross slip. All trials reach gross slip.",
            self.texts("p.note"),
        )
        # The histogram of eight phases of 0 ms.
        self.assertIn("incipient phase, ms", self.texts("text.title"))
        self.assertEqual(self.browser.complaints(), [])

    def test_what_rounding_leaves_of_zero_reads_as_0(self):
        # A phase of one unit in the last place of a second, and the direction of an angle between
        # two rounded numbers.
        self.browser.open_drawn(self.page, "#all")
        read = self.browser.evaluate(
            "[slipbench.quantity(-1.09e-18, 'rad'), slipbench.quantity(2.2e-16, 's'), slipbench.quantity(3e-6, 'm'),"
            " slipbench.quantity(2e-5, 'N', 3, 1e-4), slipbench.quantity(null, 'rad')]"
        )
        self.assertEqual(read, ["0°", "0 s", "0.003 mm", "0 N", "–"])
        ticks = self.browser.evaluate(
            "(() => { const axis = slipbench.axisOf('x', false, [-0.3, 0.3], [0, 100]); return axis.text(5.6e-17); })()"
        )
        self.assertEqual(ticks, "0")
        for fragment in ("#all", "#trial-0"):
            self.browser.open_drawn(self.page, fragment)
            shown = self.texts("text, td, dd, .v")
            self.assertEqual([text for text in shown if re.search(EXPONENT, text)], [], fragment)
        direction = [
            text for text in self.texts(".readout div") if text.startswith("slip direction")
        ]
        self.assertIn(direction, (["slip direction0°"], ["slip direction–"]))

    def test_what_python_defines_is_run_again_in_python(self):
        self.browser.open_drawn(self.page, "#all")
        command = self.browser.evaluate("slipbench.replayCommand({index: 3})")
        self.assertEqual(command, "slipbench run skin.yaml --trial 3 -o trial-3.h5")
        lines = self.browser.evaluate("""(() => {
          const {page} = slipbench;
          page.no_replay = "scene:5: unknown sensor type 'tip'";
          page.command = "slipbench sweep 'my skin.yaml' --set 'motion.speed=8 mm/s' --trials 7";
          page.overrides = {'motion.speed': '8 mm/s'};
          return [slipbench.replayCommand({index: 3}), slipbench.pythonCommand()];
        })()""")
        scene = 'slipbench.Scene.load("my skin.yaml").set({"motion.speed":"8 mm/s"'
        self.assertEqual(lines[0], scene + ',"sweep.trials":"7"}).run(3, seed=0)')
        self.assertEqual(lines[1], scene + '}).write("skin.h5", draws=7, seed=0)')


if __name__ == "__main__":
    unittest.main()
