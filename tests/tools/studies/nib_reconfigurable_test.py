"""The nib pad's tables: calibration, reorientation and release.

Calibration: polynomial, split, reference. Reorientation: outcome of a trial. Release: errors,
spectra, laws of friction. Argument: the program, which is not used.
"""

import math
import sys
import unittest
from itertools import pairwise

import numpy as np
import pandas as pd
from slipbench import RandomStream, Scene, parse_quantity
from slipbench_studies.nib_reconfigurable import bench, slip_kinds, table1, table2, table3
from slipbench_studies.result import Options

DEGREE = math.pi / 180.0
TARGET = 0.1  # m


def normals(rows, columns, name):
    return RandomStream(5, 0, name).normals(count=rows * columns).reshape(rows, columns)


class Calibration(unittest.TestCase):
    def test_the_fit_finds_a_quadratic_again(self):
        x = normals(400, 5, "inputs")
        y = np.column_stack([2.0 + x[:, 0] - 3.0 * x[:, 1] * x[:, 2], 1e3 * x[:, 3] ** 2 - 40.0])
        fit = table1.QuadraticFit(x, y, np.arange(200), np.arange(200, 300))
        error = np.abs(fit.predict(x[300:]) - y[300:]).max(axis=0)
        # The least ridge, 1e-8 on columns of size 1, changes a coefficient by that share.
        self.assertLess(error[0], 1e-6)
        self.assertLess(error[1], 1e-3)
        self.assertEqual(fit.ridge[0], 1e-8)

    def test_noise_takes_the_largest_ridge(self):
        # 90 coefficients on 120 rows of noise: least squares has some 2.1 sd, the mean alone 1.0.
        # The validation rows show that.
        x, y = normals(2000, 12, "inputs"), normals(2000, 6, "noise")
        fit = table1.QuadraticFit(x, y, np.arange(120), np.arange(120, 1000))
        self.assertEqual(fit.ridge[0], 1.0)
        self.assertLess(table1.rms(fit.predict(x) - y)[0], 1.2)

    def test_splits_keep_their_parts(self):
        for in_time in (False, True):
            split = table1.split_rows(1000, 300, 100, 150, in_time, RandomStream(1, 0, "split"))
            parts = [split.fit, split.choose, split.test]
            self.assertEqual([len(part) for part in parts], [300, 100, 150])
            everything = np.concatenate(parts)
            self.assertEqual(len(np.unique(everything)), 550)
            self.assertLess(everything.max(), 1000)
            if in_time:  # the last fifth is for judging; of the 800 before it the last quarter is for validation
                for part, (first, end) in zip(parts, pairwise([0, 600, 800, 1000]), strict=True):
                    self.assertTrue(first <= part.min() and part.max() < end)
        with self.assertRaises(ValueError):
            table1.split_rows(100, 50, 30, 30, False, RandomStream(1, 0, "split"))

    def test_the_wrench_is_about_the_pads_origin(self):
        tips = [[-2e-3, 1e-3, 0], [5e-3, 1e-3, 0]]
        force, displacement = (
            [[0, 0, 2], [0.5, -1, 3]],
            [[0, 0, 0], [1e-3, 0, 2e-3]],
        )  # so that the second acts at (6, 1, 2) mm
        # (-2, 1, 0) x (0, 0, 2) = (2, 4, 0); (6, 1, 2) x (0.5, -1, 3) = (3 + 2, 1 - 18, -6 - 0.5),
        # in mN m.
        np.testing.assert_allclose(
            table1.wrench_on_pad(tips, force, displacement),
            [0.5, -1, 5, 7e-3, -13e-3, -6.5e-3],
            atol=1e-15,
        )

    def test_the_reference_is_averaged_as_si(self):
        scene = Scene.load("nib_pad/calibrate_uniform.yaml").set({"duration": "3 s"})
        recording = table1.recording_of(next(iter(scene.sweep(record="contact", seed=1))), 0.5)
        # An image takes 30 ms: 100 in 3 s; 16 of them are complete by 0.5 s and give the unloaded
        # reading.
        self.assertEqual(len(recording.si), 84)
        for row in range(4, 84):
            np.testing.assert_allclose(
                recording.averaged[row],
                recording.wrench[row - 4 : row + 1].mean(axis=0),
                atol=1e-12,
            )
        self.assertGreater(recording.wrench[:, 2].max(), 1.0)
        # Before the pad touches, readings are the unloaded ones plus noise and drift.
        self.assertLess(np.abs(recording.si[0]).max(), 5 * 1.5)


class Bench(unittest.TestCase):
    def test_spectra_have_a_sine_where_it_is(self):
        # Amplitude 3 in the middle of bin 5 of 150: 0.54 N A/2, minus what the line removes (under
        # 1 %).
        signal = 3.0 * np.cos(2 * np.pi * 5 * np.arange(210) / 150)
        found = bench.spectra(signal)
        self.assertEqual(found.shape, (3, 76))
        np.testing.assert_allclose(found[0, 5], 0.54 * 150 * 3 / 2, rtol=0.01)
        self.assertEqual(len(bench.spectra(signal[:149])), 0)

    def test_white_noise_has_its_share_below_8_hz(self):
        # 4 of 75 bins: 0.053.
        energy = bench.spectra(normals(30_000, 1, "white")[:, 0])[:, 1:] ** 2
        self.assertAlmostEqual(energy[:, :4].sum() / energy.sum(), 4 / 75, delta=0.01)

    def test_laws_change_what_they_say(self):
        text = Scene.load("nib_pad/release.yaml").text
        for name, law in bench.LAWS.items():
            changed = text if law.change is None else law.change(text)
            self.assertEqual(
                "patchy_friction" in changed, name not in ("no_patches", "coulomb"), name
            )
            self.assertEqual(
                "viscous_friction" in changed, not name.startswith(("no_rate", "coulomb")), name
            )
            self.assertEqual("kinetic: 0.585" in changed, name.startswith("coulomb"), name)
            self.assertEqual(changed.count("texture"), text.count("texture"))
        self.assertIn(f"start: {table2.DETECTOR['start']}", text)
        self.assertEqual(parse_quantity(table2.DETECTOR["start"]), table2.START)

    def test_patches_put_the_energy_of_slip_below_8_hz_and_the_rate_law_alone_does_not(self):
        found = {}
        for name in ("scene", "no_patches"):
            cell = table2.Cell(name, table2.SCENE, {"sweep": "{}"}, change=bench.LAWS[name].change)
            found[name] = bench.signature_of(bench.Trace(cell.load().run()), table2.START, False)
        # White noise of 1.2 counts per cluster, 1.7 for their difference, has 8 of its 150 Hz below
        # 8 Hz: 0.053 of the energy, 0.39 counts rms. Patches must give five times either; without
        # them little more than the noise is left.
        share = 8.0 / 150.0
        self.assertGreater(found["scene"].share, 5 * share)
        self.assertGreater(found["scene"].below, 5 * 1.2 * math.sqrt(2 * share))
        self.assertLess(found["no_patches"].share, 3 * share)

    def test_kinds_by_their_bounds(self):
        bound = {"fl": 10.0, "fr": 20.0, "curl": 0.5}
        self.assertEqual(
            [
                slip_kinds.kind_of(*values, bound)
                for values in ((10, 20, 1), (11, 0, 0.4), (0, 21, -0.5))
            ],
            ["none", "linear", "rotational"],
        )
        self.assertEqual(set(slip_kinds.bounds()), set(bound))


class Release(unittest.TestCase):
    def test_errors_are_those_of_the_safe_runs(self):
        # Safe: before 6 mm. Gross: below the force that the pull requires; the other safe one is
        # early.
        runs = pd.DataFrame(
            [
                ("paper", 4.0, 3.0, 1e-3),
                ("paper", 4.0, 6.0, 3e-3),
                ("paper", 4.0, 1.0, 7e-3),
                ("felt", 1.0, math.nan, math.nan),
            ],
            columns=["material", "required", "force", "way"],
        )
        paper = table2.summary_of(runs[runs["material"] == "paper"])
        self.assertEqual((paper["runs"], paper["safe"], paper["early"]), (3, 2, 1))
        self.assertEqual((paper["error_N"], paper["gross_error_N"]), (1.5, 1.0))
        self.assertAlmostEqual(paper["slip_mm"], 2.0)
        self.assertEqual(table2.summary_of(runs)["runs"], 4)
        self.assertEqual(table2.summary_of(runs[runs["material"] == "felt"])["safe"], 0)


# A row of a reorientation: commanded speed sideways and up, height of the arm, grip force, tilt of
# the box in degrees.
BEFORE, RISES = (0, 0, 0, 0, 90), (0, 0.01, 0.05, 4, 50)
TOLD, AT_TARGET, UP = (0.01, 0, 0.06, 4, 30), (0.01, 0, 0.1, 4, 30), (0.01, 0, 0.1, 1, 10)
STANDS, LIES, SLIPPED, LEANS = (
    (0, 0, 0.1, 0, 0),
    (0, 0, 0.1, 0, 90),
    (0, 0.01, 0.06, 0, 85),
    (0, 0, 0.1, 0.2, 1),
)


def turn(*rows, standing=False):
    sideways, up, height, force, tilt = np.array(rows, dtype=float).T
    half = 0.5 * (90.0 - tilt) * DEGREE  # a turn about X by b lifts the axis Y by b
    pose = np.zeros((len(rows), 7))
    pose[:, 3], pose[:, 4] = np.cos(half), np.sin(half)
    outcome = {
        "standing": standing,
        "tilt_rad": tilt[-1] * DEGREE,
        "least_tilt_rad": tilt.min() * DEGREE,
    }
    return table3.turn_of(outcome, np.column_stack([sideways, up]), force, height, pose, TARGET)


class Reorientation(unittest.TestCase):
    def test_how_a_trial_ended(self):
        self.assertEqual(turn(BEFORE, RISES, TOLD, STANDS, standing=True).end, "standing")
        self.assertEqual(turn(BEFORE, RISES, SLIPPED, LIES).end, "lost")
        self.assertEqual(
            turn(BEFORE, RISES, SLIPPED, AT_TARGET, LIES).end, "lost"
        )  # although the arm continues
        self.assertEqual(turn(BEFORE, RISES, TOLD, LIES).end, "told_early")
        self.assertEqual(turn(BEFORE, RISES, AT_TARGET, LIES).end, "not_turned")
        self.assertEqual(turn(BEFORE, RISES, TOLD, UP, LIES).end, "fell")
        self.assertEqual(turn(BEFORE, RISES, AT_TARGET, UP, LEANS).end, "not_let_go")
        self.assertEqual(turn(BEFORE, RISES, RISES).end, "not_released")

    def test_tilt_and_force_where_the_release_begins(self):
        found = turn(BEFORE, RISES, (0.01, 0, 0.1, 3, 25), (0.01, 0, 0.1, 1, 5), standing=True)
        self.assertAlmostEqual(found.tilt, 25 * DEGREE)
        self.assertEqual(found.force, 3.0)
        self.assertTrue(math.isnan(turn(BEFORE, RISES).tilt))
        with self.assertRaises(ValueError):
            table3.turn_of({}, np.zeros((2, 2)), np.zeros(3), np.zeros(2), np.zeros((2, 7)), TARGET)

    def test_medians_leave_nan_out(self):
        runs = pd.DataFrame(
            [
                (True, False, 0.1, 0.1, 5.0, "standing", 0.2, 4.0),
                (False, False, 1.0, 0.3, 6.0, "fell", 0.4, 3.0),
                (False, True, 1.5, 1.2, 7.0, "lost", math.nan, math.nan),
            ],
            columns=[
                "standing",
                "dropped",
                "tilt",
                "least_tilt",
                "most_force",
                "end",
                "released_tilt",
                "held_by",
            ],
        )
        found = table3.summary_of(runs)
        self.assertEqual(
            [found[name] for name in ("runs", "standing", "turned_up", "dropped")], [3, 1, 2, 1]
        )
        self.assertEqual(list(found["ends"].values()), [1, 1, 0, 0, 1, 0, 0])
        self.assertEqual((found["tilt"], found["held_by"]), (1.0, 3.5))
        self.assertAlmostEqual(found["released_tilt"], 0.3)

    def test_the_same_on_any_number_of_threads(self):
        one, two = (
            table3.study(Options(trials=1, jobs=jobs, only=("com_low", "fl_slip_x0.5")))
            for jobs in (1, 2)
        )
        self.assertEqual(
            one.charts[0].places,
            [
                "200 g, centre of mass at L/3 from its foot",
                "200 g, FL of slip 0.5 times, 12.5 counts",
            ],
        )
        self.assertEqual(one.figures, two.figures)
        for table in one.tables:
            self.assertTrue(all(len(row) == len(table.head) for row in table.rows))
        cell, firm = one.figures["cells"]
        self.assertEqual(
            (cell["name"], cell["published"], cell["trials"], sum(cell["ends"].values())),
            ("com_low", 11, 1, 1),
        )
        self.assertIn("--set 'box.weight_place=[0 mm, 41.08 mm, 0 mm]'", cell["command"])
        # With half of fl_slip the grip is firm enough for the decrements of turning: the box turns
        # up, whatever follows.
        self.assertLess(firm["median_least_tilt_rad"], table3.TURNED_UP)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
