"""A report's scores of detectors, read in headless Chromium, against numpy's from the arrays.

Arguments: the project's root, the program.
"""

import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "page"))
import chromium  # noqa: E402

PROGRAM = Path(sys.argv.pop(2)).resolve()
ROOT = Path(sys.argv.pop(1)).resolve()


class Page:
    """The tables of a page as rows of cells, and the figures of its cards.

    The figures are {name: (value, note)}.
    """

    def __init__(self, browser):
        self.source = browser.dom()
        self.tables = browser.evaluate(
            "[...document.querySelectorAll('table')].map(table => [...table.rows].map(row => [...row.cells].map(cell => cell.textContent)))"
        )
        cards = browser.evaluate(
            "[...document.querySelectorAll('.figures > div')].map(card => [...card.children].map(part => part.textContent))"
        )
        self.figures = {name: (value, note) for name, value, note in cards}

    def table(self, first):
        """Returns the rows of the first table whose head begins with `first`."""
        head, *rows = next(
            rows for rows in self.tables if rows and rows[0][: len(first)] == list(first)
        )
        return [dict(zip(head, row, strict=True)) for row in rows]


def percent(share):
    return f"{100 * share:.{1 if 0 < share < 0.1 else 0}f} %"


def three_digits(value):
    return f"{float(f'{value:.3g}'):g}"


def scores(trials):
    """Returns recall of slip, balanced accuracy, accuracy and that of the best constant detector.

    They are over all trials' samples in contact.
    """
    truth = numpy.concatenate(
        [trial[f"labels/{trial['control'].attrs['sensor']}/state"][:] for trial in trials]
    )
    seen = numpy.concatenate([trial["control/detector_class"][:] for trial in trials])
    truth, seen = truth[truth > 0], seen[truth > 0]
    recalls = [(seen[truth == state] == state).mean() for state in numpy.unique(truth)]
    return {
        "recall of slip": percent((seen[truth > 1] > 1).mean()),
        "balanced accuracy": percent(numpy.mean(recalls)),
        "of a constant detector": percent(1 / len(recalls)),
        "accuracy": percent((seen == truth).mean()),
        "of the best constant detector": percent(
            max((truth == state).mean() for state in numpy.unique(truth))
        ),
    }


class PageScoresTest(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def page(self, *arguments):
        dataset, report = self.folder / "a.h5", self.folder / "a.html"
        for command in (("run", *arguments, "-o", dataset), ("report", dataset, "-o", report)):
            subprocess.run([PROGRAM, *command], check=True, capture_output=True)
        self.file = h5py.File(dataset)
        self.addCleanup(self.file.close)
        self.trials = [
            self.file["data"][name]
            for name in sorted(self.file["data"], key=lambda name: int(name[5:]))
        ]
        self.outcomes = [json.loads(trial.attrs["outcome"]) for trial in self.trials]
        browser = self.enterContext(chromium.Chromium())
        browser.open_drawn(report)
        return Page(browser)

    def look_at_scores(self, page):
        (row,) = page.table(["recall of slip", "balanced accuracy"])
        for name, text in scores(self.trials).items():
            self.assertEqual(row[name], text, name)
        self.assertEqual(
            [*row][-2:],
            ["accuracy", "of the best constant detector"],
            "accuracy must not be a headline",
        )
        return row

    # The ratio is exceeded long before slip, and the alarm is on when slip begins: the 1 ms after
    # that is not a delay.
    def test_an_early_alarm_has_no_delay(self):
        page = self.page(
            ROOT / "scenes/papillarray/stage.yaml",
            "--set",
            "detector={type: force_ratio, ratio: 0.3}",
        )
        (outcome,) = self.outcomes
        self.assertLess(outcome["false_alarm_time_s"], outcome["judged_slip_time_s"])
        value, note = page.figures["Early alarm"]
        self.assertEqual(value, f"{outcome['false_alarm_time_s']:.3f} s")
        self.assertNotIn("after the onset", note)
        self.assertFalse([name for name in page.figures if name.startswith("Slip detected")])
        row = self.look_at_scores(page)
        self.assertEqual(
            (row["median delay"], row["detected"], row["early"]), ("–", "0 of 1", "1 of 1")
        )

    def test_a_slip_seen_has_its_delay(self):
        page = self.page(
            ROOT / "scenes/papillarray/stage.yaml", "--set", "detector={type: shear_rate}"
        )
        (outcome,) = self.outcomes
        self.assertEqual(outcome["detection"], "seen")
        delay = f"{1e3 * outcome['detection_delay_s']:.1f} ms"
        self.assertEqual(page.figures["Slip detected after"][0], delay)
        self.assertEqual(self.look_at_scores(page)["median delay"], delay)

    # The detector shipped with the scene detects hardly any slip, yet its accuracy is above 90 %.
    def test_grasps_show_what_accuracy_hides(self):
        page = self.page(ROOT / "scenes/grasp/lift.yaml", "--trials", "5")
        row = self.look_at_scores(page)
        self.assertGreater(float(row["accuracy"].split(" ")[0]), 90)
        self.assertLess(float(row["recall of slip"].split(" ")[0]), 50)
        delays = [
            outcome["detection_delay_s"]
            for outcome in self.outcomes
            if outcome["detection"] == "seen"
        ]
        median = "–" if not delays else numpy.median(delays)
        self.assertEqual(re.sub(r" .*", "", row["detected"]), str(len(delays)))
        if delays:
            self.assertIn(row["median delay"], (f"{1e3 * median:.1f} ms", f"{1e3 * median:.0f} ms"))
        (grasps,) = page.table(["", "held", "share"])
        self.assertEqual(grasps["recall of slip"], row["recall of slip"])
        self.assertEqual(grasps["balanced accuracy"], row["balanced accuracy"])
        self.assertEqual(grasps["early"], row["early"])
        self.assertNotIn("detector right", grasps)
        shown = [trial["detector"] for trial in page.table(["", "trial"])]
        self.assertEqual(
            shown, [outcome["detection"].replace("_", " ") for outcome in self.outcomes]
        )

    # One trial with the unchanged oracle, one with a tenth of its classes wrong, some of them long
    # before slip.
    def test_success_curves_go_by_balanced_accuracy(self):
        flips = "sweep={detector.flip: [0, 0.1]}"
        page = self.page(
            ROOT / "scenes/grasp/flips.yaml", "--set", flips, "--trials", "2", "--record", "outcome"
        )
        self.assertEqual([outcome["detection"] for outcome in self.outcomes], ["seen", "early"])
        self.assertIsNone(self.outcomes[1]["reaction_time_s"])
        (grasps,) = page.table(["", "held", "share"])
        self.assertEqual(grasps["early"], "1 of 2")
        self.assertEqual(
            grasps["delay, ms"], three_digits(1e3 * self.outcomes[0]["detection_delay_s"])
        )
        self.assertEqual(
            grasps["reaction, ms"], three_digits(1e3 * self.outcomes[0]["reaction_time_s"])
        )
        self.assertIn("balanced accuracy of the detector, %", page.source)
        self.assertIn("share of slips detected without an early alarm", page.source)
        self.assertNotIn("detector right", page.source.split("<main")[1])


if __name__ == "__main__":
    unittest.main()
