"""The Myrmex paper's tables on artificial trials: windows, splits, figures; true onset.

Also the third sensor's rule. Argument: the program, which is not used.
"""

import math
import sys
import unittest
from collections import Counter

import numpy as np
from slipbench import InputError
from slipbench.learning import MASKED
from slipbench_studies.myrmex_tactile_cnn import bench, networks, table2
from slipbench_studies.myrmex_tactile_cnn.bench import ContactGate, OnsetRule, Pad, SlipSpan
from slipbench_studies.result import Options

DETACHED, STICK, SLIP = 0, 1, 2
NON_SLIP = 1  # code of a pad's state


def windows(object_name, rotational, slips, rows):
    """A trial of rows (time, to_onset, label, drawn)."""
    time, to_onset, label, drawn = zip(*rows, strict=True)
    words = len(networks.WORDS)
    return networks.Windows(
        object_name,
        rotational,
        slips,
        np.array(time),
        np.array(to_onset),
        np.tile(np.array(label, np.uint8)[:, None], words),
        np.tile(np.array(drawn)[:, None], words),
        np.zeros(len(rows), np.uint8),
        np.zeros((len(rows), 144, 32), np.float32),
    )


def trials():
    """Six trials, two per object.

    One slips, with ten stable windows up to 0.1 s before its onset at 1 s and three slipping ones;
    one holds, with eight stable windows. The latest five stable windows of the first are late.
    """
    made = []
    for name in networks.OBJECTS:
        rotational = name == "remote"
        stable = [(0.1 * k, 1.0 - 0.1 * k, 0, k % 2 == 0) for k in range(10)]
        made.append(
            windows(
                name,
                rotational,
                True,
                stable
                + [(1.0 + 0.1 * k, -0.1 * k, 2 if rotational else 1, True) for k in range(3)],
            )
        )
        made.append(
            windows(name, rotational, False, [(0.1 * k, math.nan, 0, True) for k in range(8)])
        )
    return made


def label_at(some, place):
    return int(some[place.trial].label[place.window, 0])


class WindowsOfTrials(unittest.TestCase):
    def test_the_class_is_stable_then_the_kind_then_nothing(self):
        time = np.array([1.999, 2.0, 2.5, 3.0, 3.001])
        self.assertEqual(
            networks.kinds_at(time, SlipSpan(2.0, 3.0), 2).tolist(), [0, 2, 2, 2, MASKED]
        )
        self.assertEqual(
            networks.kinds_at(time, SlipSpan(math.nan, 3.0), 1).tolist(), [0, 0, 0, 0, MASKED]
        )

    def test_late_ones_are_those_of_the_last_half_second(self):
        one = windows(
            "glass",
            False,
            True,
            [(0.0, to_onset, 0, True) for to_onset in (0.5, 0.501, 0.0, math.nan)],
        )
        self.assertEqual(
            one.late.tolist(), [True, False, False, False]
        )  # the onset itself slips, and the last trial holds

    def test_balanced_windows_are_as_many_of_each_class(self):
        # Two objects translate, one turns: 6 and 3 windows, so three of each.
        some = trials()
        places = networks.balanced_windows(some, "true", False, 1)
        self.assertEqual(Counter(label_at(some, place) for place in places), {0: 3, 1: 3, 2: 3})
        self.assertTrue(all(some[place.trial].drawn[place.window, 0] for place in places))
        self.assertEqual(places, sorted(places))

    def test_balanced_windows_are_late_where_they_are_asked_to_be(self):
        some = trials()
        stable = [
            place
            for place in networks.balanced_windows(some, "true", True, 1)
            if label_at(some, place) == 0
        ]
        self.assertEqual(len(stable), 3)
        self.assertTrue(all(some[place.trial].late[place.window] for place in stable))

    def test_balanced_windows_leave_out_turned_copies(self):
        some = trials()
        some[2].turn[:] = 3  # the only turning trial, which then belongs to no class
        self.assertEqual(networks.balanced_windows(some, "true", False, 1), [])

    def test_folds_leak_by_window_alone(self):
        some = trials()
        places = networks.balanced_windows(some, "true", False, 1)
        by_window = networks.window_folds(some, places, "true", "window", 3, 1)
        self.assertEqual(
            set(
                Counter(
                    zip((label_at(some, place) for place in places), by_window, strict=True)
                ).values()
            ),
            {1},
        )  # 9 of class and fold
        for split in ("trial", "object"):
            fold_of = networks.window_folds(some, places, "true", split, 2, 1)
            pairs = {(place.trial, fold) for place, fold in zip(places, fold_of, strict=True)}
            self.assertEqual(len(pairs), len({trial for trial, _ in pairs}))
        by_object = networks.window_folds(some, places, "true", "object", 0, 1)
        self.assertEqual(
            by_object, [place.trial // 2 for place in places]
        )  # two trials of an object

    def test_input_of_each_kind(self):
        # Taxel i has 100 i + k in bin k: its static value is 100 i, the mean over 144 taxels 100 x
        # 143/2.
        one = windows("remote", True, True, [(1.25, 0.5, 0, True)])
        one.spectra[0] = 100.0 * np.arange(144)[:, None] + np.arange(32)

        def input_of(what):
            return networks.network_input(one, np.array([0]), what)

        self.assertTrue((input_of("spectra") == one.spectra.reshape(1, -1)).all())
        self.assertEqual(input_of("high_pass").shape, (1, 144 * 28))
        self.assertEqual(
            input_of("high_pass")[0, [0, 28]].tolist(), [4.0, 104.0]
        )  # bin 4 of 15.625 Hz is 62.5 Hz
        self.assertEqual(input_of("static_image")[0, 2], 200.0)
        self.assertEqual(input_of("load").tolist(), [[7150.0]])
        self.assertEqual(input_of("clock").tolist(), [[1.25]])
        self.assertEqual(input_of("clock_placement").tolist(), [[1.25, 1.0, 0.0, 1.0, 0.0]])
        for what in (
            "spectra",
            "high_pass",
            "static_image",
            "load",
            "clock",
            "placement",
            "clock_placement",
        ):
            self.assertEqual(len(networks.network_input(one, np.zeros(0, np.intp), what)), 0)


class Networks(unittest.TestCase):
    def test_networks_are_the_recipes_with_as_many_bins_as_are_told(self):
        # conv 3x3 of 32 channels on 32 bins has (9 x 32 + 1) 32 parameters, on 28 bins (9 x 28 + 1)
        # 32: 9 x 4 x 32 fewer.
        def parameters(row, inputs):
            return sum(one.numel() for one in row.network(inputs).parameters())

        rows = table2.all_rows()
        self.assertEqual(
            parameters(rows["net_3"], 144 * 32) - parameters(rows["net_3_high_pass"], 144 * 28),
            9 * 4 * 32,
        )
        self.assertEqual(parameters(rows["clock"], 1), 2 * 32 + 33 * 3)
        self.assertEqual(len(rows), 17)

    def test_accuracy_is_the_mean_of_the_classes_that_occur(self):
        # 3 of 4 stable, 1 of 2 translations: mean 5/8; no rotation is judged.
        counts = np.array([[3, 0, 1], [1, 1, 0], [0, 0, 0]])
        self.assertEqual(networks.accuracy(counts), 0.625)
        self.assertEqual(networks.share(counts, 0, 2), 0.25)
        self.assertTrue(math.isnan(networks.share(counts, 2, 0)))
        self.assertTrue(math.isnan(networks.accuracy(np.zeros((3, 3), int))))

    def test_one_trial_of_a_cell_is_refused(self):
        with self.assertRaisesRegex(InputError, "--trials 1.*2 or more"):
            networks.size_of(Options(trials=1))
        self.assertEqual(
            networks.size_of(Options(trials=2, full=True)).turned, 11
        )  # with the image as recorded the paper's 12 angles

    def test_every_window_of_the_folds_that_are_asked_for_is_judged(self):
        some = trials()
        clock = networks.Row("clock", "a clock", inputs="clock")
        validations = networks.Validations(Options(jobs=1), networks.Size(2, 100, 0), some)
        one, none, every = (
            validations.queue(clock, split, count, last)
            for split, count, last in (("window", 3, 1), ("object", 0, 0), ("window", 3, 3))
        )
        validations.run("myrmex-tactile-cnn/table2")
        self.assertEqual(
            [int(validations.figures(number).all.sum()) for number in (one, none, every)], [3, 0, 9]
        )
        self.assertEqual(
            validations.figures(every).stable["late"], (0, 0)
        )  # judged where whole trials are judged
        self.assertTrue(math.isnan(table2.forward_ms(clock)))


def times():
    """500 Hz for 4 s."""
    return np.arange(2000) / 500.0


def falling():
    """A sum of 100 that falls from 3 s on by 50 a second."""
    return np.where(times() < 3.0, 100.0, 100.0 - 50.0 * (times() - 3.0))


def pad(states):
    """An array of two taxels that carry 3 N and 1 N, with one sample per second."""
    unit_state = np.array(states, np.uint8)
    touches = unit_state[:, 0] != DETACHED
    return Pad(
        np.arange(len(states), dtype=float),
        np.where(touches[:, None], 3000.0, 4095.0).repeat(2, axis=1).astype(np.float32),
        (touches[:, None] * np.array([3.0, 1.0])).astype(np.float32),
        unit_state,
        np.where(touches, NON_SLIP, 0).astype(np.uint8),
    )


class Onset(unittest.TestCase):
    def test_it_is_where_the_sum_leaves_its_level_for_good(self):
        # Immediately without a threshold: the first sample below 100 is at 3.002 s. It is below by
        # 10 after 0.2 s.
        at_once = OnsetRule(0.0, 0.0)
        self.assertAlmostEqual(
            bench.decrease_onset(times(), falling(), at_once, 1.0, 2.0, 4.0), 3.002, delta=1e-9
        )
        self.assertAlmostEqual(
            bench.decrease_onset(times(), falling(), at_once, 1.0, 2.0, 4.0, 9.99), 3.2, delta=1e-9
        )
        self.assertTrue(
            math.isnan(bench.decrease_onset(times(), falling(), at_once, 1.0, 2.0, 2.9))
        )  # not before the end
        dips = falling()
        dips[1200] = 0.0
        self.assertAlmostEqual(
            bench.decrease_onset(times(), dips, at_once, 1.0, 2.0, 4.0), 3.002, delta=1e-9
        )  # a dip is no onset

    def test_the_threshold_counts_the_noise_of_the_rest(self):
        # +1 and -1 alternating: sd 1, with n - 1 of 500 samples sqrt(500/499). Permanently three of
        # these below 100 - 50 (t - 3) +- 1: on the upper samples, 4.003 below the line, so from
        # 3.0801 s on; even samples are upper ones, and 3.082 s (k = 1541) is a lower one before the
        # next upper one.
        noisy = falling() + np.where(np.arange(2000) % 2 == 0, 1.0, -1.0)
        self.assertAlmostEqual(
            bench.decrease_onset(times(), noisy, OnsetRule(0.0, 3.0), 1.0, 2.0, 4.0),
            3.082,
            delta=1e-9,
        )
        # A mean over two samples (3 ms hold two) has no noise, and for a ramp it is the value at
        # the middle: 1 ms late.
        self.assertAlmostEqual(
            bench.decrease_onset(times(), noisy, OnsetRule(0.003, 3.0), 1.0, 2.0, 4.0, 10.0),
            3.202,
            delta=1e-9,
        )

    def test_the_backward_mean_leaves_out_what_is_a_window_old(self):
        # 3 samples of 0.1 s are within 0.3 s; 0.3 - 0.3 is 0 and 0.7 - 0.4 is less than 0.3 by
        # rounding, so it is kept.
        time = np.array([0.0, 0.1, 0.2, 0.3])
        self.assertEqual(
            bench.backward_mean(time, [1.0, 2.0, 3.0, 4.0], 0.3).tolist(), [1.0, 1.5, 2.0, 3.0]
        )
        self.assertEqual(
            bench.backward_mean([0.4, 0.7], [1.0, 3.0], 0.3).tolist(),
            [1.0, 2.0 if 0.7 - 0.4 < 0.3 else 3.0],
        )

    def test_true_slip_begins_where_half_of_the_load_slips_for_good_on_both_pads(self):
        one = pad(
            [
                (STICK, SLIP),
                (SLIP, STICK),
                (STICK, SLIP),
                (SLIP, STICK),
                (SLIP, SLIP),
                (SLIP, SLIP),
                (DETACHED, DETACHED),
            ]
        )
        other = pad(
            [
                (STICK, STICK),
                (SLIP, SLIP),
                (SLIP, SLIP),
                (STICK, SLIP),
                (SLIP, STICK),
                (SLIP, SLIP),
                (SLIP, SLIP),
            ]
        )
        # Slipping taxels carry at least half of both arrays' force at 1 s, and from 4 s on; contact
        # is lost at 6 s.
        self.assertEqual(bench.true_slip(one, other, 0.0), SlipSpan(4.0, 5.0))
        self.assertTrue(
            math.isnan(bench.true_slip(pad([(STICK, STICK)]), pad([(SLIP, SLIP)]), 0.0).onset)
        )
        self.assertEqual(
            bench.slipping_share(one.force, one.unit_state)[[0, 6]].tolist(), [0.25, 0.0]
        )
        # The other pad touches to the end, with 1,095 counts missing at each of its two taxels.
        self.assertEqual(bench.contact_end(one, other, ContactGate(False, 0.0, 205.0)), 6.0)
        self.assertEqual(bench.contact_end(one, one, ContactGate(False, 0.0, 205.0)), 5.0)
        self.assertEqual(
            bench.contact_end(one, other, ContactGate(False, 0.0, 1100.0)), 0.0
        )  # no taxel has so many missing
        self.assertEqual(
            bench.contact_end(one, one, ContactGate(True, 0.0, 1100.0)), 5.0
        )  # but both together
        # A mean of two samples: at 6 s of 2,190 and 0.
        self.assertEqual(bench.contact_end(one, one, ContactGate(True, 2.0, 1090.0)), 6.0)
        self.assertEqual(bench.contact_end(one, one, ContactGate(True, 2.0, 1100.0)), 5.0)
        self.assertEqual(bench.sum_of_contacts(one.counts)[0], 2.0 * 1095.0)

    def test_the_side_is_where_the_body_is_held_and_how_its_mass_lies(self):
        # Z of a cylinder turned by -90 degrees about X is Y of the world: 15 + 10 mm.
        params = {
            "shape": "cylinder",
            "mass": 0.3,
            "position": [0.0, 15e-3, 0.0],
            "rotation": [-0.5 * math.pi, 0.0, 0.0],
            "bore": 0.027,
            "centre_of_mass": [0.0, 0.0, 10e-3],
        }
        placed = bench.placed_of({f"bodies.object.{name}": value for name, value in params.items()})
        self.assertAlmostEqual(placed.side, 25e-3, delta=1e-15)
        self.assertEqual((placed.name, placed.mass, placed.rotational), ("glass", 0.3, True))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
