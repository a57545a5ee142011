"""Figures of the piezoelectric skin, the BioTac and the Myrmex compared with real ones.

Argument: the program, which is not used.
"""

import math
import sys
import unittest

import numpy as np
from slipbench_studies.realism import biotac_19, myrmex, piezo_skin
from slipbench_studies.result import Options


class PiezoSkin(unittest.TestCase):
    def test_the_log_spectrum_of_white_noise_varies_by_its_law(self):
        # A bin of white noise of variance s^2 is exponentially distributed about 2 s^2/rate: its dB
        # have an sd of 5.57 and lie 2.51 dB (Euler's constant in dB) below. 2,000 frames that share
        # 156 of 256 samples under Hann, so at least 1,000 independent ones, of 100 bins: within 1
        # %.
        spectra = piezo_skin.log_spectra(np.random.default_rng(1).normal(0.0, 3.0, 200_000))
        self.assertEqual(spectra.shape, (1998, 129))
        self.assertAlmostEqual(piezo_skin.NOISE_SD, 5.570, places=3)
        self.assertAlmostEqual(spectra[:, 10:110].std(axis=0).mean(), 5.570, delta=0.06)
        self.assertAlmostEqual(
            spectra[:, 10:110].mean(), 10.0 * math.log10(2.0 * 9.0 / 1e4) - 2.507, delta=0.06
        )

    def test_slip_is_bounded_by_how_much_a_bin_varies(self):
        # If half of the frames are 12 dB above the others, the sd is sqrt(6^2 + 5.57^2) = 8.19 dB.
        self.assertAlmostEqual(piezo_skin.bound_on_slip(math.hypot(6.0, piezo_skin.NOISE_SD)), 12.0)

    def test_it_is_as_near_to_the_real_skin_as_it_was_made(self):
        figures = piezo_skin.figures(Options(jobs=2))
        self.assertEqual(len(figures), 12)
        for one in figures:
            if "sd over frames" in one.what:
                self.assertLessEqual(abs(one.ours - one.real), 2.0, one.what)
            else:
                self.assertLessEqual(one.ours, 17.0, one.what)


class BioTac19(unittest.TestCase):
    def test_the_spectrum_is_one_sided_and_rectified(self):
        # A vibration of 400 counts that never crosses the middle is unchanged by rectification:
        # 1,000 + 400 sin, 25 periods of 275 Hz in 200 samples. Its mean square 80,000 falls into
        # bin 32 of 8.59 Hz and its neighbours; Hann's taper is 1.5 bins wide: 80,000/(1.5 * 8.59)
        # counts^2/Hz at the maximum.
        time = np.arange(22_000) / 2200.0
        slide = biotac_19.slide_of(
            3048.0 + 400.0 * np.sin(2.0 * np.pi * 275.0 * time), np.array([2600.0, 2640.0])
        )
        top = int(slide.spectrum.argmax())
        self.assertEqual(top + biotac_19.FIRST_BIN, 32)
        self.assertAlmostEqual(
            slide.spectrum[top], 10.0 * math.log10(80_000.0 / (1.5 * 2200.0 / 256.0)), places=2
        )
        self.assertAlmostEqual(slide.pac_sd, 400.0 / math.sqrt(2.0), delta=0.1)
        self.assertEqual(slide.pdc_sd, 20.0)

    def test_a_level_counts(self):
        self.assertAlmostEqual(biotac_19.rms_difference(biotac_19.REAL_SPECTRUM + 3.0), 3.0)

    def test_it_is_as_near_to_the_slides_as_it_was_made(self):
        spectrum, pac, pdc = biotac_19.figures(Options(jobs=1))
        self.assertLessEqual(spectrum.ours, 6.0)
        self.assertLessEqual(abs(math.log2(pac.ours / pac.real)), 1.0)
        self.assertTrue(10.0 <= pdc.ours <= 40.0)


class Myrmex(unittest.TestCase):
    def test_noise_is_that_of_loaded_taxels(self):
        # 2,000 differences of sd 4 sqrt(2): within 5/sqrt(4000) = 8 %, less for the median of ten.
        # The idle taxels have twice the noise.
        random = np.random.default_rng(1)
        missing = np.hstack(
            [random.normal(1000.0, 4.0, (2000, 10)), random.normal(0.0, 8.0, (2000, 10))]
        )
        self.assertAlmostEqual(myrmex.noise_of(missing), 100.0 * 4.0 / 4095.0, delta=0.008)

    def test_growth_is_from_the_early_load(self):
        time = np.arange(0.0, 5.0, 0.01)
        self.assertAlmostEqual(myrmex.growth_of(100.0 + 10.0 * (time >= 3.0), time), 10.0)

    def test_the_scene_shows_its_creep_and_its_noise(self):
        # Under a steady load f grows from .3 to 4 s by log10(4/.3) = 1.125 decades of 10 %,
        # relative to the 1 + .1 (1 - e^-.3 + 1 - e^-3 + 1 - e^-30 ...) = 1.22 at .3 s: 9.2 %. The
        # curve is straight to a tenth of that, and the plate is pressed on during the first .07 s.
        noise, growth = myrmex.figures(Options(jobs=1))
        self.assertAlmostEqual(growth.ours, 9.2, delta=1.0)
        # .1 % of 4,095 counts plus rounding, 1/12 of a count squared: .1003 %; the median of 36
        # taxels of 2,000 differences.
        self.assertAlmostEqual(noise.ours, 0.1003, delta=0.004)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
