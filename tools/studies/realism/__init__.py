"""How near the bench is to real devices: figures that others measured on one, ours beside them."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, replace
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

import slipbench
from slipbench import InputError, Trial
from slipbench.bin import _core
from slipbench_studies.__main__ import run
from slipbench_studies.grid import Cell, check_only, run_grid
from slipbench_studies.result import Chart, Curve, Options, RealFigure, Result, Table

PILLARS, CENTRE = 9, 4
EDGES, CORNERS = [1, 3, 5, 7], [2, 6, 8]  # nothing is published of pillar 0, a corner
FRAME_STRIDE = 10  # samples at 1 kHz of a detector's frame
MOVES_FROM = 1e-6  # m/s, rad/s of the pad
SCENE_SEED = 2851  # of hexapod.yaml, whose gains are those of this device
GRASPS_A_BOX = 40  # of which the median's scatter is some 10 %
PUBLISHED_RMS = [math.nan, 0.31, 0.12, 0.42, 0.39, 0.22, 0.24, 0.34, 0.16]  # N, an axis of a pillar
FITTED = "fitted with this in view"
PARTS = {"all": 91.8, "without what follows a halt": math.nan, "while the pad moves": math.nan}  # of the frames; published share right, %
MEMORY = "tests/detectors/hd/data/published"


@dataclass(frozen=True)
class Source:
    """A study that holds a published figure of a real device against ours.

    Attributes:
        quick: whether it takes some minutes of CPU
        only: its --only
        trials: of each of its rows, where --trials names none; 0: as many as is usual
        recordings: the format of --real that it needs; empty: none
    """

    quick: bool
    only: tuple[str, ...] = ()
    trials: int = 0
    recordings: str = ""


SOURCES = {
    "hexapod": Source(True),
    "hd-papillarray/table1": Source(True),
    "hd-papillarray/table2": Source(True, ("as_recorded", "oracle", "ptfe_fitted", "rubber_fitted", "felt_fitted"), GRASPS_A_BOX),
    "nib-reconfigurable/table1": Source(True),
    "nib-reconfigurable/table2": Source(True),
    "nib-reconfigurable/table3": Source(True),
    "piezo-fft-gru/table1": Source(False),
    "myrmex-tactile-cnn/table2": Source(False),
    "biotac-stability-slip/table2": Source(False, recordings="bts3v2"),
    "biotac-stability-slip/table3": Source(False, ("sd_trend_no_site", "sorted_sd_no_site"), recordings="biotacsp-dos"),
}


@dataclass
class Sums:
    """What trials of hexapod.yaml add up to.

    Attributes:
        rows: samples
        products: [9, 9] N^2, of the tangential forces of two pillars, x and y
        frames: [3] frames with contact, by PARTS
        right: [3] those that the published memory calls by the paper's label
    """

    rows: int
    products: NDArray[np.float64]
    frames: NDArray[np.int64]
    right: NDArray[np.int64]

    def __add__(self, other: Sums) -> Sums:
        return Sums(self.rows + other.rows, self.products + other.products, self.frames + other.frames, self.right + other.right)


def sums_of(trial: Trial) -> Sums:
    """The sums of one trial of hexapod.yaml, whose detector is the published memory.

    Args:
        trial: a full record

    Returns:
        its forces and its frames

    Raises:
        InputError: where the pad has no forces of nine pillars
    """
    [(name, pad)] = trial.sensors.items()
    force = pad.channels.get("force")
    if force is None or force.shape[1:] != (PILLARS, 3):
        raise InputError("reproduce: realism: the pad of hexapod.yaml has no forces of nine pillars")
    tangential = force[:, :, :2].astype(float)
    control, [body, *_] = trial.control, trial.bodies.values()
    assert control is not None  # the scene names a detector
    times = pad.t[::FRAME_STRIDE] + 1e-9

    def latest(of: NDArray[np.float64]) -> NDArray[np.intp]:
        return np.maximum(np.searchsorted(of, times, "right") - 1, 0)

    truth, seen = trial.labels[name].state_paper[::FRAME_STRIDE], control.detector_class[latest(control.t)]
    moves = np.abs(body.velocity[latest(body.t)][:, [0, 1, 5]]).max(axis=1) > MOVES_FROM
    halt = int(np.flatnonzero(moves)[-1]) + 1 if moves.any() else 0
    touching = (truth > 0) & (seen > 0)
    parts = [touching, touching & (np.arange(len(times)) < halt), touching & moves]
    return Sums(len(force), np.einsum("tpi,tqi->pq", tangential, tangential), np.array([part.sum() for part in parts]),
                np.array([(part & (truth == seen)).sum() for part in parts]))


def hexapod(options: Options) -> list[RealFigure]:
    """What is published of the PapillArray's recordings: the paper, and statistics of their forces (scenes/papillarray/README.md).

    Args:
        options: seed (default: hexapod.yaml's own), jobs

    Returns:
        the figures

    Raises:
        InputError: where the published memory is missing, which is in the source tree alone
    """
    memory = _core.project_file(f"{MEMORY}/AM.hex")
    detector = f"{{type: gst_hd, memories: {json.dumps(os.path.dirname(memory))}, compat: published_core}}"
    seed = SCENE_SEED if options.seed is None else options.seed
    [trials] = run_grid([Cell("hexapod.yaml", "scenes/papillarray/hexapod.yaml", {"detector": detector})], replace(options, seed=seed),
                        lambda _, trial: sums_of(trial))
    sums = trials[0]
    for one in trials[1:]:
        sums = sums + one
    right = 100.0 * sums.right / sums.frames
    rms = np.sqrt(np.diag(sums.products) / (2.0 * sums.rows))
    sizes = np.sqrt(np.diag(sums.products))
    pairs = (sums.products / np.outer(sizes, sizes))[np.tril_indices(PILLARS, -1)]
    return [
        *(RealFigure(f"published memory, frames with contact that are right, {text}, %", real, float(ours), FITTED)
          for (text, real), ours in zip(PARTS.items(), right, strict=True)),
        *(RealFigure(f"force of an axis of pillar {p}, rms, N", PUBLISHED_RMS[p], float(rms[p]), FITTED) for p in range(1, PILLARS)),
        RealFigure("that of the edges over the centre's", 0.82, float(rms[EDGES].mean() / rms[CENTRE]), FITTED),
        RealFigure("that of the corners over the centre's", 0.45, float(rms[CORNERS].mean() / rms[CENTRE]), FITTED),
        RealFigure("correlation of two pillars' forces, mean of the 36 pairs", 0.85, float(pairs.mean()), f"{FITTED}; of the vectors x, y"),
    ]


def figures_of(name: str, options: Options) -> list[RealFigure]:
    """The figures of one of SOURCES.

    Args:
        name: a key of SOURCES
        options: as the command line has them

    Returns:
        figures of real devices beside ours

    Raises:
        InputError: of the study
    """
    if name == "hexapod":
        return hexapod(options)
    source = SOURCES[name]
    its = replace(options, only=source.only, trials=options.trials or source.trials, full=False, output="",
                  real=options.real if source.recordings else "")
    return run(name, its).real


def asked_for(options: Options, truth: str) -> tuple[list[str], list[str]]:
    """The studies to run.

    Args:
        options: only, full, real
        truth: attribute of the dataset of real recordings, which ends in their format; empty: there is none

    Returns:
        names of the studies, and names of those that are left out

    Raises:
        InputError: for an unknown name, or where none is left that judges by these recordings
    """
    check_only(options.only, list(SOURCES))
    names = [name for name in SOURCES if not options.only or name in options.only]

    def left(source: Source) -> bool:
        if source.recordings:
            return not truth.endswith(source.recordings)
        return not options.only and not options.full and not source.quick

    asked = [name for name in names if not left(SOURCES[name])]
    if not asked or (options.real and not any(SOURCES[name].recordings for name in asked)):
        raise InputError("reproduce: realism: no study that is asked for judges by these recordings; allowed: --real of bts3v2, biotacsp-dos")
    return asked, [name for name in names if name not in asked]


def _text(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def study(options: Options) -> Result:
    """realism.

    Args:
        options: real, trials, only, full, seed, jobs

    Returns:
        all figures that studies hold against a published one

    Raises:
        InputError: as asked_for() and the studies
    """
    truth = ""
    if options.real:
        slipbench.open(options.real).close()  # which refuses what is no dataset
        with h5py.File(options.real) as file:
            truth = str(file.attrs.get("truth", ""))
    asked, left_out = asked_for(options, truth)
    table = Table("Real and simulated", ["row", "study", "figure", "real", "ours", "ours/real", "note"])
    figures: list[dict[str, Any]] = []
    charts = []
    for name in asked:
        options.say(name)
        places, points = list[str](), list[tuple[float, float, float]]()
        for one in figures_of(name, options):
            ratio, row = one.ours / one.real, str(len(table.rows) + 1)
            table.rows.append([row, name, one.what, _text(one.real), _text(one.ours), _text(ratio), one.note])
            figures.append({"study": name, "what": one.what, "real": one.real, "ours": one.ours, "ratio": ratio, "note": one.note})
            if not math.isnan(ratio):
                places.append(one.what)
                points.append((ratio, ratio, ratio))
        if len(places) > 1:
            charts.append(Chart(f"{name}, ours over the real figure", "", "our figure over the real one", places, [Curve("ours/real", points)], 1.0, "as real",
                                joined=False))
    return Result(
        title="The bench beside real devices",
        source="Published figures of real devices for which a study of slipbench has one of its own.",
        figures=figures,
        setup=["Seed 1, of hexapod.yaml its own." if options.seed is None else f"Seed {options.seed}.",
               f"Table II of hd-papillarray with {GRASPS_A_BOX} grasps a box, unless --trials says how many; `slipbench reproduce STUDY` says how each is "
               "made."],
        tables=[table],
        charts=charts,
        remarks=[f"Left out: {', '.join(left_out)}. --full runs those that teach for a quarter of an hour, --real FILE the one that takes its "
                 "recordings."] if left_out else [],
    )
