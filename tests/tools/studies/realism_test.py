"""Figures of real devices beside ours. Argument: the program, which is not used."""

import math
import sys
import unittest

import numpy as np

from slipbench import InputError
from slipbench_studies import realism
from slipbench_studies.realism import hexapod
from slipbench_studies.result import Options


class Hexapod(unittest.TestCase):
    def test_it_is_as_near_to_the_recordings_as_it_was_made(self):
        # Bars of the published protocol: the memory that learnt from the recordings is right in 87, 90 and 78 % of the frames here, and the forces of
        # pillars 1 to 8 are .034 N rms from theirs at most.
        figures = hexapod.figures(Options())
        for one, bar in zip(figures, (87.0, 90.0, 78.0), strict=False):
            self.assertGreaterEqual(one.ours, bar)
        self.assertEqual([one.real for one in figures[:1]], [91.8])
        difference = np.array([one.ours - one.real for one in figures[3:11]])
        self.assertLessEqual(math.sqrt((difference**2).mean()), 0.034)


class Choice(unittest.TestCase):
    def test_slow_ones_need_full(self):
        asked, left = realism.asked_for(Options(), "")
        self.assertIn("nib-reconfigurable/table3", asked)
        self.assertEqual(left, ["piezo-fft-gru/table1", "myrmex-tactile-cnn/table2", "biotac-stability-slip/table2", "biotac-stability-slip/table3"])
        self.assertEqual(len(realism.asked_for(Options(full=True), "")[1]), 2)
        self.assertEqual(realism.asked_for(Options(only=("piezo-fft-gru/table1",)), "")[0], ["piezo-fft-gru/table1"])

    def test_recordings_choose_their_study(self):
        only = ("biotac-stability-slip/table2",)
        self.assertEqual(realism.asked_for(Options(only=only, real="r.h5"), "imported from bts3v2")[0], list(only))
        with self.assertRaisesRegex(InputError, "no study"):
            realism.asked_for(Options(only=only, real="r.h5"), "imported from biotacsp-dos")
        with self.assertRaisesRegex(InputError, "did you mean 'hexapod'"):
            realism.asked_for(Options(only=("hexapods",)), "")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
