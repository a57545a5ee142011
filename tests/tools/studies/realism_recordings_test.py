"""Figures of a uSkin's and a finger's recordings.

Estimators on known signals, and our scenes' limits.

Argument: the program, which is not used.
"""

import math
import sys
import unittest

import numpy as np
from slipbench_studies.realism import fabric, uskin
from slipbench_studies.result import Options

RATE = 40.0
TIME = np.arange(400) / RATE  # 10 s


def hold(shear, level=1.0):
    """A grip from 2 to 8 s whose taxels read a constant z = 100, times `shear` [16, 2]."""
    counts = np.zeros((len(TIME), 16, 3))
    grips = (TIME >= 2.0) & (TIME < 8.0)
    counts[grips] = 100.0 * np.concatenate([shear, np.ones((16, 1))], axis=1)
    counts[grips] *= np.broadcast_to(level, TIME.shape)[grips, None, None]
    return uskin.Recording(TIME, counts, True)


class Uskin(unittest.TestCase):
    def test_estimators_of_a_grip(self):
        # All taxels read (0.3, 0.4) of z: sums of 16 z over 16 z/2. A single pattern has all the
        # power.
        grip = hold(np.tile([0.3, 0.4], (16, 1)))
        self.assertAlmostEqual(uskin.normal_over_shear(grip), 2.0, 12)
        self.assertAlmostEqual(uskin.common_share([grip]), 1.0, 12)
        self.assertAlmostEqual(uskin.level_sd(grip), 0.0, 12)
        self.assertAlmostEqual(uskin.peak_over_level(grip), 1.0, 12)
        [first, last] = TIME[uskin.last_second(grip)][[0, -1]]
        self.assertAlmostEqual(first, 7.975 - 1.5, 9)  # of the last sample before 8 s
        self.assertAlmostEqual(last, 7.975 - 0.5, 9)
        # 1 + 0.1 sqrt(2) sin over whole periods has a standard deviation of 0.1.
        self.assertAlmostEqual(
            uskin.level_sd(
                hold(
                    np.zeros((16, 2)), 1.0 + 0.1 * math.sqrt(2.0) * np.sin(2.0 * np.pi * TIME / 2.0)
                )
            ),
            0.1,
            12,
        )

    def test_patterns_that_differ_share_the_power(self):
        # Two recordings of equal length with orthogonal patterns of strength 3 and 1: the first has
        # 9/10 of the power.
        one, other = np.zeros((16, 2)), np.zeros((16, 2))
        one[0, 0], other[5, 1] = 3.0, 1.0
        self.assertAlmostEqual(uskin.common_share([hold(one), hold(other)]), 0.9, 12)

    def test_noise_of_a_running_mean(self):
        # White noise of sd 2.2 over six samples has 2.2/sqrt(6) = 0.898; 4,000 samples of 16
        # taxels, 667 of them independent: the relative sd of the median is below 1 %.
        noise = (
            np.random.default_rng(1).normal(0.0, 2.2, (4000, 16, 3))
            + np.linspace(0.0, 50.0, 4000)[:, None, None]
        )
        for axis in uskin.noise_of(uskin.smoothed(noise)):
            self.assertAlmostEqual(axis, 2.2 / math.sqrt(6.0), delta=0.04)

    def test_creeping_boxes_are_within_the_bars(self):
        # Ratio 4 to 10 (real 6.9), pattern 0.75 (0.88), level 0.05 to 0.2 (0.10), noise as
        # measured. A tolerance of 10 % allows for the sd over 800 samples, six of which count as
        # one: 133 independent ones, 6 % per taxel, and the median of 16.
        ratio, share, level, _, x, y, z = (one.ours for one in uskin.figures(Options()))
        self.assertTrue(4.0 <= ratio <= 10.0, ratio)
        self.assertGreaterEqual(share, 0.75)
        self.assertTrue(0.05 <= level <= 0.2, level)
        for ours, real in zip((x, y, z), uskin.NOISE, strict=True):
            self.assertAlmostEqual(ours / real, 1.0, delta=0.1)


class Fabric(unittest.TestCase):
    def test_waves_of_a_slide(self):
        # 8 patterns at 20 mm/s, one per second: 100 + 40 cos + 10 cos of the second harmonic: sd
        # sqrt(800 + 50) = 29.2, and 1/16 of the power.
        phase = 2.0 * np.pi * np.arange(int(8 * RATE)) / RATE
        waves = fabric.waves_of(
            np.repeat(
                (100.0 + 40.0 * np.cos(phase) + 10.0 * np.cos(2.0 * phase))[:, None], 16, axis=1
            ),
            RATE,
            20e-3,
        )
        self.assertAlmostEqual(waves.level_sd, math.sqrt(850.0) / 100.0, 9)
        self.assertAlmostEqual(
            waves.harmonics, 1.0 / 16.0, 4
        )  # Hann's window ends at 0: a thousandth leaks
        self.assertLess(waves.slow, 1e-3)
        self.assertAlmostEqual(waves.frequency, 1.0, 3)

    def test_our_board_is_within_the_bars(self):
        level, harmonics, slow, frequency = (one.ours for one in fabric.figures(Options()))
        self.assertTrue(0.3 <= level <= 0.7, level)
        self.assertTrue(0.03 <= harmonics <= 0.15, harmonics)
        self.assertTrue(0.1 <= slow <= 0.3, slow)
        self.assertAlmostEqual(frequency, 1.0, delta=0.01)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
