"""Public recordings of a finger on a printed board, compared with scenes/soft_skin/board.yaml.

Source: github.com/wngfra/FabricSlide, a capacitive finger of 16 taxels that slides 150 mm over bars
    of 10 mm, 20 mm apart, at 5, 10, 20 and 30 mm/s. The constants are the results of the functions
    here for one recording per speed; the program does not contain the recordings.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from slipbench import InputError, Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

Doubles = NDArray[np.float64]

TAXELS = 16
PATTERN = 20e-3  # m
HARMONICS = 6
HALF_WIDTH = 0.35  # of a harmonic's band, in frequencies of the pattern
SCENE = "scenes/soft_skin/board.yaml"

SETUP = (
    "Real: a capacitive finger of 16 taxels at 35.6 Hz over a printed board with bars 20 mm apart, one recording at each of 5, 10, 20 and 30 mm/s. "
    f"Ours: {SCENE} at the same speeds and 36 Hz. Fitted: height, duty and edge of the bars, waviness. Assumed: stiffness, curve and noise of the taxels, "
    "friction, depth."
)
LEVEL, HARMONIC, SLOW, FREQUENCY = 0.57, 0.063, 0.22, 1.0


@dataclass(frozen=True)
class Waves:
    """Figures of a slide over the board, each over all taxels.

    Attributes:
        level_sd: mean of the standard deviation over the mean
        harmonics: median of the power of harmonics 2 to 6 divided by that of the pattern's own
            frequency
        slow: median of the share of power below 0.65 of the pattern's frequency
        frequency: measured pattern frequency divided by speed/20 mm
    """

    level_sd: float
    harmonics: float
    slow: float
    frequency: float


def waves_of(counts: Doubles, rate: float, speed: float) -> Waves:
    """Computes the figures of a slide at a steady speed.

    Args:
        counts: [T, taxels], not tared
        rate: Hz
        speed: m/s

    Returns:
        the figures
    """
    power = (
        np.abs(
            np.fft.rfft((counts - counts.mean(axis=0)) * np.hanning(len(counts))[:, None], axis=0)
        )
        ** 2
    )
    turns = np.fft.rfftfreq(len(counts), 1.0 / rate) * PATTERN / speed

    def band(low: float, high: float) -> Doubles:
        return np.asarray(power[(turns > low) & (turns < high)].sum(axis=0))

    bands = [band(n - HALF_WIDTH, n + HALF_WIDTH) for n in range(1, HARMONICS + 1)]
    near = (turns > 1.0 - HALF_WIDTH) & (turns < 1.0 + HALF_WIDTH)
    of_all = power[near].sum(axis=1)
    return Waves(
        float((counts.std(axis=0) / counts.mean(axis=0)).mean()),
        float(np.median(np.sum(bands[1:], axis=0) / bands[0])),
        float(np.median(band(0.0, 1.0 - HALF_WIDTH) / power[1:].sum(axis=0))),
        float((turns[near] * of_all).sum() / of_all.sum()),
    )


def waves_of_trial(trial: Trial) -> Waves:
    """Figures of the steady part of a trial of board.yaml.

    Raises:
        InputError: there is no finger with 16 counts
    """
    [finger], [pad, *_] = trial.sensors.values(), trial.bodies.values()
    counts = finger.channels.get("counts")
    if counts is None or counts.shape[1:] != (TAXELS,):
        raise InputError("reproduce: realism: the scene has no finger of 16 counts")
    along = pad.velocity[:, 0]
    speed = float(along.max())
    steady = pad.t[along > 0.99 * speed]
    slides = (finger.t >= steady[0]) & (finger.t <= steady[-1])
    return waves_of(counts[slides].astype(float), finger.rate, speed)


def figures(options: Options) -> list[RealFigure]:
    """The recordings' figures with those of board.yaml, means over the four speeds.

    Args:
        options: seed (default: 1), jobs

    Returns:
        the figures

    Raises:
        InputError: a trial fails
    """
    [trials] = run_grid(
        [Cell("board.yaml", SCENE)], options, lambda _, trial: waves_of_trial(trial)
    )
    mean = {
        name: float(np.mean([getattr(one, name) for one in trials]))
        for name in ("level_sd", "harmonics", "slow", "frequency")
    }
    fitted = "fitted with this in view: "
    return [
        RealFigure(
            "sd of a taxel over its level", LEVEL, mean["level_sd"], f"{fitted}height of the bars"
        ),
        RealFigure(
            "power of harmonics over that of the pattern",
            HARMONIC,
            mean["harmonics"],
            f"{fitted}duty and edge",
        ),
        RealFigure(
            "share of power slower than the pattern", SLOW, mean["slow"], f"{fitted}waviness"
        ),
        RealFigure(
            "frequency of the pattern, in speed/20 mm", FREQUENCY, mean["frequency"], "not fitted"
        ),
    ]
