"""Accuracy of the bench: figures that others measured on real devices, compared with ours."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import h5py
import slipbench
from slipbench import InputError
from slipbench_studies.__main__ import run
from slipbench_studies.grid import check_only
from slipbench_studies.realism import (
    biotac_19,
    fabric,
    hexapod,
    myrmex,
    papillarray,
    piezo_skin,
    uskin,
)
from slipbench_studies.result import Chart, Curve, Options, RealFigure, Result, Table

GRASPS_A_BOX = 40  # the median of so many grasps scatters by some 10 %


@dataclass(frozen=True)
class Device:
    """A device whose figures are not from a reproduced table of a paper.

    Attributes:
        figures: computes ours beside the real ones
        setup: the real device and its recordings, our scene with its rate, and what is assumed
    """

    figures: Callable[[Options], list[RealFigure]]
    setup: str


OWN = {
    "hexapod": Device(hexapod.figures, hexapod.SETUP),
    "papillarray": Device(papillarray.figures, papillarray.SETUP),
    "uskin": Device(uskin.figures, uskin.SETUP),
    "fabric": Device(fabric.figures, fabric.SETUP),
    "piezo_skin": Device(piezo_skin.figures, piezo_skin.SETUP),
    "biotac_19": Device(biotac_19.figures, biotac_19.SETUP),
    "myrmex": Device(myrmex.figures, myrmex.SETUP),
}


@dataclass(frozen=True)
class Source:
    """A study that compares a published figure of a real device with ours.

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
    "papillarray": Source(True),
    "uskin": Source(True),
    "fabric": Source(True),
    "piezo_skin": Source(True),
    "biotac_19": Source(True),
    "myrmex": Source(True),
    "hd-papillarray/table1": Source(True),
    "hd-papillarray/table2": Source(
        True, ("as_recorded", "oracle", "ptfe_fitted", "rubber_fitted", "felt_fitted"), GRASPS_A_BOX
    ),
    "nib-reconfigurable/table1": Source(True),
    "nib-reconfigurable/table2": Source(True),
    "nib-reconfigurable/table3": Source(True),
    "piezo-fft-gru/table1": Source(False),
    "myrmex-tactile-cnn/table2": Source(False),
    "biotac-stability-slip/table2": Source(False, recordings="bts3v2"),
    "biotac-stability-slip/table3": Source(
        False, ("sd_trend_no_site", "sorted_sd_no_site"), recordings="biotacsp-dos"
    ),
}


def figures_of(name: str, options: Options) -> tuple[list[RealFigure], list[str]]:
    """Figures of one of SOURCES, and their setup.

    Args:
        name: a key of SOURCES
        options: as the command line has them

    Returns:
        figures of real devices beside ours; the set-up, a line each

    Raises:
        InputError: the study fails
    """
    if name in OWN:
        return OWN[name].figures(options), [OWN[name].setup]
    source = SOURCES[name]
    its = replace(
        options,
        only=source.only,
        trials=options.trials or source.trials,
        full=False,
        output="",
        real=options.real if source.recordings else "",
    )
    result = run(name, its)
    return result.real, result.setup


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
        raise InputError(
            "reproduce: realism: no selected study uses these recordings; expected --real with bts3v2, biotacsp-dos"
        )
    return asked, [name for name in names if name not in asked]


def _text(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.3g}"


def study(options: Options) -> Result:
    """The study realism.

    Args:
        options: real, trials, only, full, seed, jobs

    Returns:
        all figures that studies hold against a published one

    Raises:
        InputError: as asked_for() and the studies
    """
    truth = ""
    if options.real:
        slipbench.open(options.real).close()  # rejects a file that is not a dataset
        with h5py.File(options.real) as file:
            truth = str(file.attrs.get("truth", ""))
    asked, left_out = asked_for(options, truth)
    table = Table(
        "Real and simulated", ["row", "study", "figure", "real", "ours", "ours/real", "note"]
    )
    figures: list[dict[str, Any]] = []
    charts = []
    setup = [
        "Seed 1; hexapod and uskin use the seeds of their scenes."
        if options.seed is None
        else f"Seed {options.seed}.",
        f"Table II of hd-papillarray with {GRASPS_A_BOX} grasps per box, unless --trials sets another number.",
    ]
    for name in asked:
        options.say(name)
        places, points = list[str](), list[tuple[float, float, float]]()
        real, lines = figures_of(name, options)
        setup += [f"{name}: {line}" for line in lines]
        for one in real:
            ratio, row = one.ours / one.real, str(len(table.rows) + 1)
            table.rows.append(
                [row, name, one.what, _text(one.real), _text(one.ours), _text(ratio), one.note]
            )
            figures.append(
                {
                    "study": name,
                    "what": one.what,
                    "real": one.real,
                    "ours": one.ours,
                    "ratio": ratio,
                    "note": one.note,
                }
            )
            if not math.isnan(ratio):
                places.append(one.what)
                points.append((ratio, ratio, ratio))
        if len(places) > 1:
            charts.append(
                Chart(
                    f"{name}, ours over the real figure",
                    "",
                    "our figure over the real one",
                    places,
                    [Curve("ours/real", points)],
                    1.0,
                    "as real",
                    joined=False,
                )
            )
    return Result(
        title="The bench compared with real devices",
        source="Published figures of real devices compared with figures of slipbench's studies.",
        figures=figures,
        setup=setup,
        tables=[table],
        charts=charts,
        remarks=[
            f"Omitted: {', '.join(left_out)}. --full runs the studies that train for a quarter of an hour, --real FILE the study that needs these recordings."
        ]
        if left_out
        else [],
    )
