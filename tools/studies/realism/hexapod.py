"""The PapillArray's published recordings on a hexapod.

They are compared with scenes/papillarray/hexapod.yaml.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from slipbench import InputError, Trial
from slipbench.bin import _core
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

PILLARS, CENTRE = 9, 4
EDGES, CORNERS = [1, 3, 5, 7], [2, 6, 8]  # no data published for pillar 0, a corner
FRAME_STRIDE = 10  # samples at 1 kHz per frame of a detector
MOVES_FROM = 1e-6  # m/s, rad/s; motion of the pad
SCENE_SEED = 2851  # of hexapod.yaml, whose gains match this device
PUBLISHED_RMS = [
    math.nan,
    0.31,
    0.12,
    0.42,
    0.39,
    0.22,
    0.24,
    0.34,
    0.16,
]  # N, per axis of a pillar
FITTED = "fitted with this in view"
PARTS = {
    "all": 91.8,
    "without what follows a halt": math.nan,
    "while the pad moves": math.nan,
}  # of the frames; published share of right ones, %
MEMORY = "tests/detectors/hd/data/published"
SETUP = (
    "Real: a PapillArray on a hexapod against acrylic at 1 kHz; statistics of its forces and a memory trained on it are published, the recordings are "
    "not. Ours: scenes/papillarray/hexapod.yaml, 200 sequences of 4 s at 1 kHz, one device. Fitted: tilt, shares of motions, gains, heights, no "
    "coupling. Assumed: directions, accelerations, compressions."
)


@dataclass
class Sums:
    """Sums over trials of hexapod.yaml.

    Attributes:
        rows: number of samples
        products: [9, 9] N^2, products of the tangential forces of two pillars, x and y
        frames: [3] number of frames with contact, by PARTS
        right: [3] number of those that the published memory classifies like the paper's label
    """

    rows: int
    products: NDArray[np.float64]
    frames: NDArray[np.int64]
    right: NDArray[np.int64]

    def __add__(self, other: Sums) -> Sums:
        return Sums(
            self.rows + other.rows,
            self.products + other.products,
            self.frames + other.frames,
            self.right + other.right,
        )


def sums_of(trial: Trial) -> Sums:
    """Sums of one trial of hexapod.yaml, whose detector is the published memory.

    Args:
        trial: a full record

    Returns:
        sums of its forces and frames

    Raises:
        InputError: the pad has no forces of nine pillars
    """
    [(name, pad)] = trial.sensors.items()
    force = pad.channels.get("force")
    if force is None or force.shape[1:] != (PILLARS, 3):
        raise InputError(
            "reproduce: realism: the pad of hexapod.yaml has no forces of nine pillars"
        )
    tangential = force[:, :, :2].astype(float)
    control, [body, *_] = trial.control, trial.bodies.values()
    assert control is not None  # the scene names a detector
    times = pad.t[::FRAME_STRIDE] + 1e-9

    def latest(of: NDArray[np.float64]) -> NDArray[np.intp]:
        return np.maximum(np.searchsorted(of, times, "right") - 1, 0)

    truth, seen = (
        trial.labels[name].state_paper[::FRAME_STRIDE],
        control.detector_class[latest(control.t)],
    )
    moves = np.abs(body.velocity[latest(body.t)][:, [0, 1, 5]]).max(axis=1) > MOVES_FROM
    halt = int(np.flatnonzero(moves)[-1]) + 1 if moves.any() else 0
    touching = (truth > 0) & (seen > 0)
    parts = [touching, touching & (np.arange(len(times)) < halt), touching & moves]
    return Sums(
        len(force),
        np.einsum("tpi,tqi->pq", tangential, tangential),
        np.array([part.sum() for part in parts]),
        np.array([(part & (truth == seen)).sum() for part in parts]),
    )


def figures(options: Options) -> list[RealFigure]:
    """Published figures of the PapillArray's recordings, with ours.

    From the paper, and statistics of their forces (scenes/papillarray/README.md).

    Args:
        options: seed (default: hexapod.yaml's own), jobs

    Returns:
        the figures

    Raises:
        InputError: the published memory is missing, which exists in the source tree only
    """
    memory = _core.project_file(f"{MEMORY}/AM.hex")
    detector = (
        f"{{type: gst_hd, memories: {json.dumps(os.path.dirname(memory))}, compat: published_core}}"
    )
    seed = SCENE_SEED if options.seed is None else options.seed
    [trials] = run_grid(
        [Cell("hexapod.yaml", "scenes/papillarray/hexapod.yaml", {"detector": detector})],
        replace(options, seed=seed),
        lambda _, trial: sums_of(trial),
    )
    sums = trials[0]
    for one in trials[1:]:
        sums = sums + one
    right = 100.0 * sums.right / sums.frames
    rms = np.sqrt(np.diag(sums.products) / (2.0 * sums.rows))
    sizes = np.sqrt(np.diag(sums.products))
    pairs = (sums.products / np.outer(sizes, sizes))[np.tril_indices(PILLARS, -1)]
    return [
        *(
            RealFigure(
                f"published memory, correctly classified frames in contact, {text}, %",
                real,
                float(ours),
                FITTED,
            )
            for (text, real), ours in zip(PARTS.items(), right, strict=True)
        ),
        *(
            RealFigure(
                f"force of an axis of pillar {p}, rms, N", PUBLISHED_RMS[p], float(rms[p]), FITTED
            )
            for p in range(1, PILLARS)
        ),
        RealFigure(
            "that of the edges over the centre's",
            0.82,
            float(rms[EDGES].mean() / rms[CENTRE]),
            FITTED,
        ),
        RealFigure(
            "that of the corners over the centre's",
            0.45,
            float(rms[CORNERS].mean() / rms[CENTRE]),
            FITTED,
        ),
        RealFigure(
            "correlation of two pillars' forces, mean of the 36 pairs",
            0.85,
            float(pairs.mean()),
            f"{FITTED}; of the vectors x, y",
        ),
    ]
