"""Public slides of a BioTac with 19 electrodes, compared with scenes/biotac_sp/slide.yaml."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch
from slipbench import InputError, Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

Floats = NDArray[np.float64]

SCENE = "scenes/biotac_sp/slide.yaml"
PAC_RATE, SEGMENT = 2200.0, 256  # Hz; samples per segment of Welch's spectrum with a Hann taper
FIRST_BIN = 2  # 17 Hz
PAC_MIDDLE = 2048.0  # counts, without vibration
SLIDES_FROM, SLIDES_TO = 1.5, 9.0  # s, in SCENE
# dexrob/BioTac_slide_20_50, ten materials, two slides each, 25 mm/s, rectified about an unknown
# baseline, without the first 0.3 s: mean log spectrum of pac, dB of counts^2/Hz, from FIRST_BIN to
# 1,048 Hz.
REAL_SPECTRUM = np.array([
    23.2, 20.4, 16.2, 12.6, 10.0, 8.9, 8.1, 7.3, 5.4, 2.9, 0.9, -0.5, -1.2, -2.2, -3.0, -3.9, -4.7, -5.1, -5.1, -4.9,
    -5.1, -5.3, -5.9, -6.4, -7.1, -7.2, -6.9, -6.9, -7.0, -6.9, -6.8, -6.6, -6.6, -6.7, -6.8, -6.7, -6.9, -7.1, -7.0, -6.5,
    -5.9, -5.3, -4.8, -4.8, -5.4, -6.5, -7.8, -9.3, -10.4, -11.0, -11.3, -11.8, -12.0, -12.3, -12.6, -12.6, -12.4, -12.2, -11.9, -11.7,
    -11.0, -10.3, -9.6, -9.0, -8.7, -8.6, -8.7, -9.0, -9.5, -10.1, -10.6, -11.3, -11.8, -12.1, -12.2, -12.6, -12.9, -13.0, -13.0, -13.2,
    -13.4, -13.7, -14.0, -14.3, -14.6, -14.8, -15.1, -15.1, -15.3, -15.6, -15.9, -16.2, -16.4, -16.5, -16.6, -16.7, -16.8, -16.8, -17.1, -17.2,
    -17.1, -17.3, -17.2, -17.3, -17.4, -17.5, -17.5, -17.4, -17.4, -17.2, -17.1, -16.9, -16.7, -16.4, -16.3, -16.2, -16.2, -16.1, -16.2, -16.3,
    -16.2])  # fmt: skip
REAL_MATERIALS = 2.6  # dB, rms difference of a slide's log spectrum from that mean, averaged over the 20 slides; range 0.8 to 4.5
REAL_PAC_SD, REAL_PDC_SD = 92.0, 24.0  # counts, median of the slides
SETUP = (
    "Real: a BioTac with 19 electrodes, two slides at 25 mm/s over each of ten materials, pac at 2.2 kHz, pdc at 100 Hz, rectified about an unknown "
    f"value at rest. Ours: {SCENE}, a slide of 8 s, pac at 2.2 kHz, pdc at 100 Hz, rectified about the known value at rest. Fitted: roughness, the exponent"
    " of its waves, unevenness of the board. Assumed: laws and stiffness of the BioTac SP, counts at rest, friction, depth."
)
FITTED = "roughness, its exponent and the board's unevenness are fitted"


@dataclass
class Slide:
    """Figures of a slide.

    Attributes:
        spectrum: as REAL_SPECTRUM
        pac_sd: counts, rectified
        pdc_sd: counts
    """

    spectrum: Floats
    pac_sd: float
    pdc_sd: float


def slide_of(pac: Floats, pdc: Floats) -> Slide:
    """Figures of a slide, rectified like the recordings.

    Args:
        pac: [T] counts at PAC_RATE
        pdc: [R] counts

    Returns:
        the figures
    """
    rectified = np.abs(pac - PAC_MIDDLE)
    spectrum = welch(rectified, PAC_RATE, nperseg=SEGMENT)[1]
    return Slide(
        10.0 * np.log10(spectrum[FIRST_BIN : FIRST_BIN + len(REAL_SPECTRUM)]),
        float(rectified.std()),
        float(pdc.std()),
    )


def rms_difference(spectrum: Floats) -> float:
    """Root mean square of a log spectrum minus REAL_SPECTRUM, including the level [dB].

    Args:
        spectrum: as REAL_SPECTRUM

    Returns:
        dB
    """
    return float(np.sqrt(((spectrum - REAL_SPECTRUM) ** 2).mean()))


def _read(trial: Trial) -> Slide:
    [(name, pad)] = trial.sensors.items()
    if pad.type != "biotac_19":
        raise InputError(
            f"reproduce: realism: expected a biotac_19 in {SCENE}, found {pad.type} '{name}'"
        )
    slides = (pad.t > SLIDES_FROM) & (pad.t <= SLIDES_TO)
    return slide_of(
        pad.channels["pac"][slides].astype(float).ravel(),
        pad.channels["pdc"][slides].astype(float).ravel(),
    )


def figures(options: Options) -> list[RealFigure]:
    """Known figures of the recordings (sensors/biotac_sp/README.md), with ours.

    Args:
        options: seed, jobs

    Returns:
        the figures

    Raises:
        InputError: the scene has another sensor
    """
    [[slide]] = run_grid([Cell("slide.yaml", SCENE)], options, lambda _, trial: _read(trial))
    return [
        RealFigure(
            "log spectrum of pac, 17 to 1,048 Hz: rms difference, dB",
            REAL_MATERIALS,
            rms_difference(slide.spectrum),
            f"from the mean of ten materials; {FITTED}; the real figure is that of a single material",
        ),
        RealFigure("sd of pac, rectified, counts", REAL_PAC_SD, slide.pac_sd, FITTED),
        RealFigure("sd of pdc, counts", REAL_PDC_SD, slide.pdc_sd, FITTED),
    ]
