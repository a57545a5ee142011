"""Slip against hold by one frame of the piezoelectric skin: artificial frames, and the full curve.

The curve is tested from end to end with few recordings. Argument: the program, which is not used.
"""

import math
import sys
import unittest
from types import SimpleNamespace

import numpy as np
from slipbench import InputError
from slipbench_studies.piezo_fft_gru import slip_against_hold
from slipbench_studies.result import Options

SAMPLES = 1000  # nine frames of 200, one every 100


def frames(signal):
    """Returns frames of a signal that is a function of time [s].

    The tip is in contact from sample 150 on and slips from 650 on except the last sample; by the
    position it slips from 600 on. The bench presses until 300, slides from 600 on, at its speed of
    20 mm/s from 700 on; 0.25 mm deep.
    """
    number = np.arange(SAMPLES)
    t = 1e-4 * number
    micro = np.where(
        number < 150, 0, np.where((number >= 650) & (number < SAMPLES - 1), 3, 1)
    ).astype(np.uint8)
    paper = np.where(number < 150, 0, np.where(number >= 600, 3, 1)).astype(np.uint8)
    velocity = np.zeros((SAMPLES, 6), dtype=np.float32)
    velocity[:300, 2] = -5e-4
    velocity[600:, 0], velocity[700:, 0] = 10e-3, 20e-3
    return slip_against_hold.frames_of(
        SimpleNamespace(
            sensors={
                "pad": SimpleNamespace(
                    t=t, channels={"signal": np.asarray(signal(t), dtype=np.float32)[:, None]}
                )
            },
            labels={"pad": SimpleNamespace(state_micro=micro, state_paper=paper)},
            bodies={"pad": SimpleNamespace(velocity=velocity)},
            params={"motion.compression": 0.25e-3, "motion.speed": 20e-3},
        )
    )


class Frames(unittest.TestCase):
    def test_they_say_what_happens_within_them(self):
        found = frames(np.zeros_like)
        self.assertEqual(len(found), 9)
        np.testing.assert_allclose(found["force"], 5.0, rtol=1e-12)  # 20 N/mm times 0.25 mm
        np.testing.assert_allclose(found["speed"], 20e-3, rtol=1e-12)

        def those(column):
            return np.flatnonzero(found[column]).tolist()

        # Frame k has the samples 100 k to 100 k + 199.
        self.assertEqual(those("contact"), list(range(9)))  # contact by sample 199
        self.assertEqual(those("pressed"), [0, 1, 2])  # 299 is the last one of the press
        self.assertEqual(those("slid"), [5, 6, 7, 8])
        self.assertEqual(
            those("at_speed"), [6, 7, 8]
        )  # frame 5 ends with sample 699, at 10 of 20 mm/s
        self.assertEqual(those("slipped"), [5, 6, 7, 8])
        self.assertEqual(those("slips"), [5, 6, 7])  # the last sample of frame 8 sticks
        self.assertEqual(those("slips_by_position"), [5, 6, 7, 8])
        self.assertEqual(
            those("one_label"), [2, 3, 4, 7]
        )  # contact begins within 0 and 1; slip begins within 5 and 6 and ends within 8
        self.assertAlmostEqual(found["still"][3], (499 - 299) * 1e-4, delta=1e-12)
        self.assertEqual(found["still"][5], 0.0)

    def test_they_measure_the_band(self):
        # A line of amplitude 4 in the middle of a bin has the power 4^2/2 with any taper: its
        # density spreads over Hann's three bins, all within the band, and is divided by the taper's
        # own power. The subtracted straight line removes almost nothing: the tone is at bin 6,
        # where a line's share is small.
        tone = frames(lambda t: 100.0 + 4.0 * np.cos(2.0 * math.pi * 300.0 * t))
        np.testing.assert_allclose(tone["plain"], 8.0, atol=1e-3)
        np.testing.assert_allclose(tone["hann"], 8.0, atol=1e-3)
        np.testing.assert_allclose(tone["detrended"], 8.0, atol=0.05)

    def test_a_ramp_depends_on_the_spectrum(self):
        # A ramp of 1,000 counts/s rises by D = 20 counts over a frame. Its harmonics k have the rms
        # D/(sqrt(2) pi k): over 12 bins the power D^2/(2 pi^2) sum 1/k^2. Hann's taper gives y_k =
        # x_k/2 - (x_k-1 + x_k+1)/4 for the harmonics x_k = 1/k, x_0 = 0: 3/8 of the first and -1/(2
        # k (k^2 - 1)) of the others, over the taper's power 3/8. With the straight line subtracted
        # nothing is left. (Samples instead of a line have 1/sin instead of 1/angle: at most pi
        # 12/200, 0.6 % of the last.)
        ramp = frames(lambda t: 1000.0 * t)
        k = np.arange(1, 13)
        scale = 400.0 / (2.0 * math.pi**2)
        tapered = np.array([3 / 8, *(1 / (2 * k[1:] * (k[1:] ** 2 - 1)))])
        np.testing.assert_allclose(ramp["plain"], scale * (1 / k**2).sum(), rtol=0.01)
        np.testing.assert_allclose(ramp["hann"], scale * (tapered**2).sum() / (3 / 8), rtol=0.01)
        self.assertLess(ramp["detrended"].max(), 1e-6 * scale)


class SlipAgainstHold(unittest.TestCase):
    def test_the_parts_of_the_curve_add_up(self):
        result = slip_against_hold.study(Options(trials=4, jobs=2))
        self.assertEqual(len(result.tables), 5)
        for table in result.tables:
            self.assertEqual({len(row) for row in table.rows}, {len(table.head)}, table.title)
        for curve in result.charts[0].curves:
            self.assertEqual(len(curve.points), len(result.charts[0].places))
        levels = result.figures["curve"]["paper"]
        self.assertEqual(len(levels), 6)
        for areas in levels.values():
            every, contact, air = areas["pooled"], areas["contact"], areas["air"]
            # All three groups have slip; hold is with or without contact: the pooled area is the
            # mean of both, weighted by frames.
            self.assertEqual(every["slip_frames"], contact["slip_frames"])
            n, m = contact["hold_frames"], air["hold_frames"]
            self.assertEqual(every["hold_frames"], n + m)
            self.assertAlmostEqual(
                every["auc"], (n * contact["auc"] + m * air["auc"]) / (n + m), delta=1e-12
            )
        for causes, counted in (("hold_causes", "hold_frames"), ("slip_causes", "slip_frames")):
            found = result.figures[causes].values()
            self.assertEqual(
                sum(cause["frames"] for cause in found), levels["0"]["contact"][counted]
            )
            self.assertAlmostEqual(sum(cause["share"] for cause in found), 1.0, delta=1e-9)
            for reading in ("paper", "hann"):
                self.assertAlmostEqual(
                    sum(cause[reading]["share_of_missing"] for cause in found), 1.0, delta=1e-9
                )

    def test_it_needs_two_recordings_of_each_kind_and_as_many_of_both(self):
        for trials in (2, 5):  # five would run as four
            with self.assertRaisesRegex(
                InputError, f"--trials {trials}: .*even numbers, 4 or more"
            ):
                slip_against_hold.study(Options(trials=trials))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
