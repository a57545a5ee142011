"""Fig. 12 of the nib pad's paper: no slip, linear and rotational slip by FL, FR and curl."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from slipbench import InputError, Trial, describe, parse_quantity
from slipbench._program import counted
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.nib_reconfigurable.bench import HOP, WINDOW, Trace
from slipbench_studies.result import Chart, Curve, Options, Result, Table
from slipbench_studies.statistics import auc, quantile

SLIP_WAY = 2e-3  # m, displacement of the lever from which a run counts as slip (paper)
SLIP_TIME = 0.5  # s, duration after that whose windows count
SAID = ("none", "linear", "rotational")
MATERIALS = ("paper", "masonite", "wavy_acrylic")
KINDS = {"linear slip": "linear", "rotational slip": "rotational", "no slip": "none"}

Score = Callable[[pd.DataFrame], "pd.Series[float]"]
# text, bar, score, kinds of the positives and of the negatives
QUESTIONS: list[tuple[str, float, Score, tuple[str, ...], tuple[str, ...]]] = [
    (
        "rotational against linear by FR/FL",
        0.97,
        lambda runs: runs["fr"] / runs["fl"],
        ("rotational",),
        ("linear",),
    ),
    (
        "linear against rotational by FL/FR",
        0.97,
        lambda runs: runs["fl"] / runs["fr"],
        ("linear",),
        ("rotational",),
    ),
    (
        "rotational against linear by curl",
        0.97,
        lambda runs: runs["curl"],
        ("rotational",),
        ("linear",),
    ),
    (
        "rotational against linear by curl FR/FL",
        0.97,
        lambda runs: runs["curl"] * runs["fr"] / runs["fl"],
        ("rotational",),
        ("linear",),
    ),
    (
        "slip against none by FL + FR",
        0.93,
        lambda runs: runs["fl"] + runs["fr"],
        ("linear", "rotational"),
        ("none",),
    ),
    (
        "slip against none by the larger of FL and FR",
        0.93,
        lambda runs: runs[["fl", "fr"]].max(axis=1),
        ("linear", "rotational"),
        ("none",),
    ),
    ("linear slip against none by FL", 0.93, lambda runs: runs["fl"], ("linear",), ("none",)),
    (
        "rotational slip against none by FR",
        0.93,
        lambda runs: runs["fr"],
        ("rotational",),
        ("none",),
    ),
]


def bounds() -> dict[str, float]:
    """The bounds fl, fr [counts] and curl of the detector nib_slip_kind."""
    return {
        one["name"]: parse_quantity(one["default"])
        for one in describe("nib_slip_kind")[0]["parameters"]
        if one["name"] in ("fl", "fr", "curl")
    }


def kind_of(fl: float, fr: float, curl: float, bound: dict[str, float]) -> str:
    """Result of nib_slip_kind for features: "none", "linear" or "rotational".

    Args:
        fl: counts, magnitude of the linear mode over 0 to 6 Hz
        fr: counts, of the rotational mode
        curl: curl of the normalised shear
        bound: from bounds()
    """
    if fl <= bound["fl"] and fr <= bound["fr"]:
        return "none"
    return "rotational" if abs(curl) >= bound["curl"] else "linear"


def run_of(trial: Trial, rotational: bool, bound: dict[str, float]) -> dict[str, Any]:
    """Figures of one run.

    Args:
        trial: a full record of either scene
        rotational: True for a trial of rotational slip
        bound: from bounds()

    Returns:
        material; kind "none", "linear" or "rotational"; fl, fr [counts], |curl|: means over the
        windows that end within the slip; said: result of nib_slip_kind for these means

    Raises:
        InputError: no window ends within the slip
    """
    trace = Trace(trial)
    times = [parse_quantity(point[0]) for point in trial.params["controls.pull"]]
    moved = trace.moved(trace.at(times[0]), SLIP_WAY)
    if moved is None:
        first, last = trace.at(times[0] + SLIP_TIME), trace.at(times[-1] + SLIP_TIME)
    else:
        first, last = moved, trace.at(trace.time[moved] + SLIP_TIME)
    ends = np.arange(WINDOW - 1, len(trace.time), HOP)
    ends = ends[(ends >= first) & (ends <= last)]
    if not ends.size:
        raise InputError("no window ends within the slip; use a longer duration")
    values = trace.estimates("nib_slip_kind", {})[1]
    fl, fr, curl = (float(values[name][ends].mean()) for name in ("fl_0_6", "fr_0_6", "curl"))
    return {
        "material": trial.params["surface.material"],
        "kind": "none" if moved is None else "rotational" if rotational else "linear",
        "fl": fl,
        "fr": fr,
        "curl": abs(curl),
        "said": kind_of(fl, fr, curl, bound),
    }


def _quartiles(values: pd.Series[float], digits: int) -> str:
    """Median and quartiles."""
    if values.empty:
        return "-"
    middle, low, high = (quantile(values, p) for p in (0.5, 0.25, 0.75))
    return f"{middle:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def study(options: Options) -> Result:
    """nib-reconfigurable/slip_kinds.

    Args:
        options: trials, seed, jobs

    Returns:
        areas of each question, and the features
    """
    trials = options.trials or 1
    scenes = ("scenes/nib_pad/linear.yaml", "scenes/nib_pad/rotational.yaml")
    bound = bounds()
    found = run_grid(
        [Cell(scene, scene, draws=trials) for scene in scenes],
        options,
        lambda cell, trial: run_of(trial, cell.scene == scenes[1], bound),
    )
    runs = pd.DataFrame(found[0] + found[1])

    table = Table(
        "Separation",
        ["question", "bar", "AUC", "95 %", "n"],
        note="Exact, by ranks; intervals after DeLong.",
    )
    figures: list[dict[str, Any]] = []
    for text, bar, score, positive, negative in QUESTIONS:
        above, below = (score(runs[runs["kind"].isin(kinds)]) for kinds in (positive, negative))
        if above.empty or below.empty:
            table.rows.append([text, f"{bar:.2f}", "-", "-", f"{len(above)} and {len(below)}"])
            continue
        area = auc(above, below)
        table.rows.append(
            [
                text,
                f"{bar:.2f}",
                f"{area.value:.3f}",
                f"{area.interval[0]:.3f} to {area.interval[1]:.3f}",
                f"{area.positives} and {area.negatives}",
            ]
        )
        figures.append(
            {
                "question": text,
                "bar": bar,
                "auc": area.value,
                "interval_95": area.interval,
                "positives": area.positives,
                "negatives": area.negatives,
            }
        )
    features = Table(
        "Features, median and quartiles",
        [
            "plate",
            "runs",
            "n",
            "FL, counts",
            "FR, counts",
            "|curl|",
            "reported: none",
            "linear",
            "rotational",
        ],
        note="Result of nib_slip_kind with its assumed bounds for the means in the row.",
    )
    for material in MATERIALS:
        for name, kind in KINDS.items():
            some = runs[(runs["material"] == material) & (runs["kind"] == kind)]
            features.rows.append(
                [
                    material,
                    name,
                    str(len(some)),
                    _quartiles(some["fl"], 0),
                    _quartiles(some["fr"], 0),
                    _quartiles(some["curl"], 2),
                    *(str(int((some["said"] == said).sum())) for said in SAID),
                ]
            )
    areas = [(one["auc"], *one["interval_95"]) for one in figures]
    return Result(
        title="No slip, linear and rotational slip of the nib pad",
        source='Fig. 12 and section IV-B of "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation"',
        figures={"auc": figures},
        setup=[
            f"{scenes[0]} and rotational.yaml, seed {options.draws_seed}, {counted(trials, 'run')} per cell: electronics typical (drift and noise), pads mounted with scatter of position, yaw and tilt.",
            "Slip: the lever has moved by 2 mm since the beginning of the pull (paper). FL, FR: magnitude over 0 to 6 Hz. Curl: of the normalised shear. "
            "Means over the windows that end within 0.5 s after these 2 mm; for runs without slip over those that end between 0.5 s after the beginning of "
            "the pull and 0.5 s after its end.",
        ],
        charts=[
            Chart(
                "Separation",
                "",
                "area under the ROC curve, with 95 % interval",
                [one["question"] for one in figures],
                [Curve("AUC", areas)],
                joined=False,
            )
        ],
        tables=[table, features],
    )
