"""Spectra of a real piezoelectric skin over slip and hold, compared with scenes/piezo_skin."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from slipbench import Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

Floats = NDArray[np.float64]

RATE, WINDOW, HOP = 10e3, 256, 100  # Hz, samples: 129 bins, a frame every 10 ms
TRIALS = 12
SCENES = {
    "scenes/piezo_skin/slide.yaml": "typical",
    "scenes/piezo_skin/humming.yaml": "motors hum at rest, too",
}
SETUP = (
    f"Real: a piezoelectric skin at 10 kHz, mean and sd over frames of {WINDOW} samples, slip and hold together, of 129 bins in dB with an unknown offset. "
    f"Ours: {' and '.join(SCENES)}, {TRIALS} trials each at 10 kHz, a frame every 10 ms. Fitted: the noise, by its ratio to slip. Assumed: the amplitude of slip in newtons; "
    "for the bounds on slip, that half of the frames slip."
)
# dB, standard deviation over frames of slip and hold together, mean over the bins from the first to before the second: thayral/tactile-slip-demo,
# by an author of the paper, whose levels carry an unknown offset.
REAL_SD = {(1, 17): 8.01, (17, 65): 6.10, (65, 128): 5.90}
REAL_BIN_SD = {2: 9.53, 16: 6.74, 64: 5.81}  # dB: the same of single bins
NOISE_SD = (
    10.0 / math.log(10.0) * math.pi / math.sqrt(6.0)
)  # dB, of a bin of white noise: the logarithm of an exponential distribution


def log_spectra(signal: Floats) -> Floats:
    """Log spectra of frames.

    Args:
        signal: [T] samples at RATE

    Returns:
        [F, 129] dB of the squared unit per Hz, of frames less their mean under Hann's taper
    """
    taper = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(WINDOW) / WINDOW)
    frames = np.lib.stride_tricks.sliding_window_view(signal, WINDOW)[::HOP]
    spectra = np.fft.rfft((frames - frames.mean(axis=1, keepdims=True)) * taper, axis=1)
    return np.asarray(
        10.0 * np.log10(2.0 * np.abs(spectra) ** 2 / (RATE * (taper**2).sum()) + 1e-12)
    )


def bound_on_slip(sd: float) -> float:
    """Upper bound of the level of slip above that of hold, if a bin varies by `sd` [dB] over frames of which half slip.

    Levels of two kinds D apart vary by D/2, and each frame by NOISE_SD.

    Args:
        sd: dB, more than NOISE_SD

    Returns:
        dB
    """
    return 2.0 * math.sqrt(sd**2 - NOISE_SD**2)


def slip_and_hold(trial: Trial) -> tuple[Floats, Floats]:
    """Log spectra of the frames that slip throughout and of those held in contact throughout, by the paper's label.

    Args:
        trial: a full record with one piezo_skin

    Returns:
        two of [F, 129] dB
    """
    [(name, pad)] = trial.sensors.items()
    spectra = log_spectra(pad.channels["signal"].astype(float).ravel())
    labels = trial.labels[name]
    first = HOP * np.arange(len(spectra))
    ends = np.stack([first, first + WINDOW - 1])
    slips = (np.asarray(labels.state_paper)[ends] > 1).all(axis=0)
    held = (np.asarray(labels.state_paper)[ends] == 1).all(axis=0)
    return spectra[slips], spectra[held]


def figures_of(kinds: Sequence[tuple[Floats, Floats]], text: str) -> list[RealFigure]:
    """Computes figures from the log spectra of slip and hold.

    Args:
        kinds: of each recording, as slip_and_hold() returns them
        text: what was simulated

    Returns:
        how much bands vary, and by how much slip lies above hold
    """
    slip, hold = (np.concatenate([one[k] for one in kinds]) for k in (0, 1))
    sd = np.concatenate([slip, hold]).std(axis=0)
    above = slip.mean(axis=0) - hold.mean(axis=0)
    fitted = f"{text}; the noise is fitted"
    return [
        *(
            RealFigure(
                f"{text}: sd over frames of slip and hold, bins {low} to {end - 1}, dB",
                real,
                float(sd[low:end].mean()),
                fitted,
            )
            for (low, end), real in REAL_SD.items()
        ),
        *(
            RealFigure(
                f"{text}: slip over hold in contact, bin {b}, dB",
                bound_on_slip(real),
                float(above[b]),
                f"{text}; the real figure is an upper bound",
            )
            for b, real in REAL_BIN_SD.items()
        ),
    ]


def figures(options: Options) -> list[RealFigure]:
    """Returns the figures of a real skin's spectra (sensors/piezo_skin/README.md), real and simulated.

    Args:
        options: seed, jobs

    Returns:
        the figures
    """
    cells = [Cell(text, scene, draws=TRIALS) for scene, text in SCENES.items()]
    recordings = run_grid(cells, options, lambda _, trial: slip_and_hold(trial))
    return [
        one
        for kinds, text in zip(recordings, SCENES.values(), strict=True)
        for one in figures_of(kinds, text)
    ]
