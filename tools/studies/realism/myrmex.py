"""Loaded cells of an industrial foam array, compared with scenes/myrmex/creep.yaml."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from slipbench import Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

Floats = NDArray[np.float64]

SCENE = "scenes/myrmex/creep.yaml"
FULL_SCALE = 4095.0  # counts, at rest
LOADED = 100.0  # counts below rest, minimum for a loaded taxel
HELD_FROM = 10.0  # s in SCENE, start of the noise interval: creep per sample is negligible then
GROWS_FROM, GROWS_TO = 0.3, 4.0  # s after contact
REAL_NOISE = 0.11  # % of the range: Weiss arrays, loaded cells, 0.07 to 0.15
SETUP = (
    f"Real: industrial foam arrays (Weiss) held by a hand or a gripper; for the Myrmex nothing is published. Ours: {SCENE}, a block held for half a minute "
    "on 16 x 16 taxels at 100 Hz, with the noise and creep of the scene. Assumed: creep of 10 % per decade, stiffness and thickness of the foam."
)
REAL_GROWTH = 80.0  # %: held Weiss arrays, 29 to 180; the geometric middle of their factors


def noise_of(missing: Floats) -> float:
    """Noise of loaded taxels, from differences of successive samples.

    Args:
        missing: [T, taxels] counts below rest, under a nearly constant load

    Returns:
        standard deviation relative to the converter's range, %, median of the loaded taxels
    """
    loaded = missing.mean(axis=0) > LOADED
    return float(
        100.0
        / FULL_SCALE
        * np.median(np.diff(missing[:, loaded], axis=0).std(axis=0))
        / np.sqrt(2.0)
    )


def growth_of(sum_of_missing: Floats, time: Floats) -> float:
    """Growth of the sum of a statically loaded array.

    Args:
        sum_of_missing: [T] counts below rest, of all taxels
        time: [T] s after contact

    Returns:
        % from GROWS_FROM to GROWS_TO, each a mean over 0.1 s
    """
    early, late = (
        sum_of_missing[(time >= at) & (time < at + 0.1)].mean() for at in (GROWS_FROM, GROWS_TO)
    )
    return float(100.0 * (late / early - 1.0))


def _read(trial: Trial) -> tuple[float, float]:
    [(name, pad)] = trial.sensors.items()
    missing = FULL_SCALE - pad.channels["taxels"].astype(float).reshape(len(pad.t), -1)
    touch = pad.t[np.flatnonzero(np.asarray(trial.labels[name].state))[0]]
    # At rest the converter clips half of the noise, which would count as load.
    loaded = missing[-1] > LOADED
    return noise_of(missing[pad.t > HELD_FROM]), growth_of(
        missing[:, loaded].sum(axis=1), pad.t - touch
    )


def figures(options: Options) -> list[RealFigure]:
    """Known figures of such arrays (sensors/myrmex/README.md), with ours.

    Args:
        options: seed, jobs

    Returns:
        the figures
    """
    [[(noise, growth)]] = run_grid(
        [Cell("creep.yaml", SCENE)], options, lambda _, trial: _read(trial)
    )
    return [
        RealFigure(
            "noise of a loaded taxel, % of the range",
            REAL_NOISE,
            noise,
            "set by the scene; the default is 0.88, that of a comparable cell at rest",
        ),
        RealFigure(
            "growth of a held array's sum, 0.3 to 4 s, %",
            REAL_GROWTH,
            growth,
            "creep of 10 % a decade, assumed; the real figure includes hand and grip, and is 29 to 180",
        ),
    ]
