"""Table III of the nib pad's paper.

A box turned up by rotational slip and released, over weights, centres of mass and surfaces.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from slipbench import Trial, describe, parse_quantity
from slipbench._program import counted
from slipbench_studies.grid import Cell, check_only, chosen, run_grid
from slipbench_studies.result import Chart, Curve, Options, RealFigure, Result, Table
from slipbench_studies.statistics import clopper_pearson, median

SCENE = "scenes/nib_pad/reorient.yaml"
PUBLISHED_RUNS = 11
UPRIGHT = math.radians(5.0)  # same limit as the outcome's `standing`
TURNED_UP = math.radians(20.0)
LAG = 1e-3  # m, of the arm behind its command, at 10 mm/s

# Outcomes of a trial. The arm distinguishes the phases: it rises while the grip is adjusted and the
# box turns, and moves sideways in the release.
ENDS = {
    "standing": "standing",
    "lost": "lost",  # neither pad had contact, before the release
    "told_early": "released early",  # released below TargetPoint as upright, but tilt never below TURNED_UP
    "not_turned": "not turned",  # the same at TargetPoint: the box hung in the grip or lay
    "fell": "fell",  # released, tilt below TURNED_UP at some time, and not upright at the end
    "not_let_go": "not detached",  # upright at the end, but in contact with a pad or not supported by the table
    "not_released": "not released",  # the arm rose until the end of the trial
}


@dataclass(frozen=True)
class Box:
    """A row of the table.

    Attributes:
        text: text in the table
        published: successes of PUBLISHED_RUNS; None: our own variation
        overrides: overrides of the scene
    """

    text: str
    published: int | None = None
    overrides: dict[str, str] = field(default_factory=dict)


def defaults() -> dict[str, str]:
    """Default parameters of the controller `reorient` from `slipbench describe`, by name."""
    return {one["name"]: one["default"] for one in describe("reorient")[0]["parameters"]}


def boxes() -> dict[str, Box]:
    """All rows by name.

    With 118 g in the middle of the box and 200 g at y, the common centre of mass is 200/318 y from
    the middle; a sixth of 155 mm requires 41.08 mm.
    """

    def surface(material: str, friction: str) -> dict[str, str]:
        return {
            "surface.material": material,
            "friction.static": friction,
            "friction.kinetic": friction,
        }

    rows = {
        "200g": Box("200 g in the middle, paper", 10),
        "100g": Box("100 g in the middle, paper", 9, {"box.weight": "100 g"}),
        "300g": Box("300 g in the middle, paper", 7, {"box.weight": "300 g"}),
        "com_low": Box(
            "200 g, centre of mass at L/3 from its foot",
            11,
            {"box.weight_place": "[0 mm, 41.08 mm, 0 mm]"},
        ),
        "com_high": Box(
            "200 g, centre of mass at 2L/3", 3, {"box.weight_place": "[0 mm, -41.08 mm, 0 mm]"}
        ),
        "masonite": Box("200 g in the middle, masonite", 10, surface("masonite", "0.5")),
        "wavy": Box(
            "200 g in the middle, friction of wavy acrylic, without its waves",
            10,
            surface("wavy_acrylic", "0.55"),
        ),
    }
    usual = defaults()
    thresholds = {
        "fl_slip": ("FL of slip", ""),
        "fr_slip": ("FR of slip", ""),
        "fr_quiet": ("quiet time", " s"),
        "fr_upright": ("FR when upright", ""),
        "released_normal": ("normal force of release", " N"),
    }
    for name, (text, unit) in thresholds.items():
        for factor in ("0.5", "2"):
            value = float(factor) * parse_quantity(usual[name])
            rows[f"{name}_x{factor}"] = Box(
                f"200 g, {text} {factor} times, {value:g}{unit or ' counts'}",
                None,
                {f"controller.{name}": f"{value:g}{unit}"},
            )
    rows["stick_slip"] = Box(
        "200 g, kinetic friction 0.9 times the static one", None, {"friction.kinetic": "0.585"}
    )
    return rows


def tilt_of(pose: ArrayLike) -> NDArray[np.float64]:
    """Angle between a body's axis Y and the vertical.

    Args:
        pose: [..., 7] position and quaternion w x y z; the upward component of Y is 2 (y z + w x)

    Returns:
        [...] rad, 0 to pi/2
    """
    w, x, y, z = np.moveaxis(np.asarray(pose, dtype=float)[..., 3:], -1, 0)
    return np.asarray(np.arccos(np.minimum(1.0, np.abs(2.0 * (y * z + w * x)))))


class Turn(NamedTuple):
    """Outcome of a trial.

    A key of ENDS, and tilt [rad] and grip force [N] at the start of the release, NaN without a
    release.
    """

    end: str
    tilt: float
    force: float


def turn_of(
    outcome: dict[str, Any],
    arm: ArrayLike,
    grip_force: ArrayLike,
    arm_height: ArrayLike,
    box_pose: ArrayLike,
    target: float,
) -> Turn:
    """Determines the outcome of a trial.

    Args:
        outcome: the trial's standing, tilt_rad, least_tilt_rad
        arm: [T, 2] m/s, speed that the controller commands: sideways, up
        grip_force: [T] N, mean of both pads
        arm_height: [T] m
        box_pose: [T, 7] of the box
        target: m, rise of TargetPoint

    Returns:
        the outcome, and tilt and force at the start of the release

    Raises:
        ValueError: the arrays have no rows, or different numbers of rows
    """
    sideways, up = (
        np.asarray(arm, dtype=float).T if np.ndim(arm) == 2 else (np.empty(0), np.empty(0))
    )
    force, height, pose = (
        np.asarray(one, dtype=float) for one in (grip_force, arm_height, box_pose)
    )
    rows = len(sideways)
    if rows == 0 or not len(force) == len(height) == len(pose) == rows:
        raise ValueError(
            f"turn_of: {rows} rows of the arm, {len(force)} of force, {len(height)} and {len(pose)} of poses; the numbers must be equal"
        )
    begun = np.flatnonzero(sideways != 0.0)
    released = int(begun[0]) if begun.size else rows
    rising = np.logical_or.accumulate(up[:released] > 0.0)
    lost = bool((rising & (force[:released] == 0.0)).any())
    tilt, held = (
        (float(tilt_of(pose[released])), float(force[released]))
        if released < rows
        else (math.nan, math.nan)
    )
    if outcome["standing"]:
        end = "standing"
    elif lost:
        end = "lost"
    elif released == rows:
        end = "not_released"
    elif outcome["tilt_rad"] < UPRIGHT:
        end = "not_let_go"
    elif outcome["least_tilt_rad"] < TURNED_UP:
        end = "fell"
    else:
        end = "told_early" if height[released] - height[0] < target - LAG else "not_turned"
    return Turn(end, tilt, held)


def run_of(trial: Trial, target: float) -> dict[str, Any]:
    """Data that the study keeps of a trial.

    Args:
        trial: a full record of the scene
        target: m, rise of TargetPoint

    Returns:
        standing, dropped, end; tilt, least_tilt, released_tilt [rad]; most_force, held_by [N]
    """
    outcome, control = trial.outcome, trial.control
    assert control is not None  # the scene has a controller
    turn = turn_of(
        outcome,
        control.arm,
        control.grip_force,
        trial.bodies["arm"].pose[:, 2],
        trial.bodies["box"].pose,
        target,
    )
    return {
        "standing": outcome["standing"],
        "dropped": outcome["dropped"],
        "tilt": outcome["tilt_rad"],
        "least_tilt": outcome["least_tilt_rad"],
        "most_force": outcome["max_grip_force_N"],
        "end": turn.end,
        "released_tilt": turn.tilt,
        "held_by": turn.force,
    }


def summary_of(runs: pd.DataFrame) -> dict[str, Any]:
    """Summary of the runs of a row.

    Args:
        runs: one row each, columns as in run_of()

    Returns:
        numbers of runs: runs, standing, turned_up, dropped, ends by name; medians without NaN:
        tilt, least_tilt, released_tilt [rad], most_force, held_by [N]
    """
    return {
        "runs": len(runs),
        "standing": int(runs["standing"].sum()),
        "turned_up": int((runs["least_tilt"] < TURNED_UP).sum()),
        "dropped": int(runs["dropped"].sum()),
        "ends": {end: int((runs["end"] == end).sum()) for end in ENDS},
        **{
            name: median(runs[name])
            for name in ("tilt", "least_tilt", "most_force", "released_tilt", "held_by")
        },
    }


def _degrees(value: float) -> str:
    return "-" if math.isnan(value) else f"{math.degrees(value):.1f} deg"


def _newtons(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f} N"


def study(options: Options) -> Result:
    """nib-reconfigurable/table3.

    Args:
        options: trials, only, seed, jobs

    Returns:
        success of each row

    Raises:
        InputError: for an unknown name of --only
    """
    rows = boxes()
    check_only(options.only, list(rows))
    rows = {name: rows[name] for name in chosen(list(rows), options.only)}
    trials, seed = options.trials or PUBLISHED_RUNS, options.draws_seed
    target = parse_quantity(defaults()["target"])
    cells = [Cell(name, SCENE, row.overrides, trials) for name, row in rows.items()]
    runs = run_grid(cells, options, lambda _, trial: run_of(trial, target))

    success = Table(
        "Success, by cell",
        [
            "cell",
            "published",
            "here (95 %)",
            "turned up",
            "dropped",
            "tilt at the end, median",
            "least tilt, median",
            "peak grip force, median",
        ],
        note="Rows without a published figure differ from the first cell, 200 g on paper, in "
        "one number.",
    )
    ends = Table(
        "What became of the boxes, by cell",
        ["cell", *ENDS.values(), "tilt when released, median", "grip force then, median"],
    )
    figures, real, ours, theirs = [], [], [], []
    for cell, (name, row), of_cell in zip(cells, rows.items(), runs, strict=True):
        s = summary_of(pd.DataFrame(of_cell))
        n, standing = s["runs"], s["standing"]
        low, high = clopper_pearson(standing, n)
        success.rows.append(
            [
                row.text,
                "" if row.published is None else f"{row.published} of {PUBLISHED_RUNS}",
                f"{standing} of {n} ({100 * low:.0f} to {100 * high:.0f} %)",
                f"{s['turned_up']} of {n}",
                f"{s['dropped']} of {n}",
                _degrees(s["tilt"]),
                _degrees(s["least_tilt"]),
                _newtons(s["most_force"]),
            ]
        )
        ends.rows.append(
            [
                row.text,
                *map(str, s["ends"].values()),
                _degrees(s["released_tilt"]),
                _newtons(s["held_by"]),
            ]
        )
        figures.append(
            {
                "name": name,
                "command": cell.command(seed),
                "published": row.published,
                "trials": n,
                "standing": standing,
                "standing_share_95": [low, high],
                "turned_up": s["turned_up"],
                "dropped": s["dropped"],
                "ends": s["ends"],
                "median_tilt_rad": s["tilt"],
                "median_least_tilt_rad": s["least_tilt"],
                "median_max_grip_force_N": s["most_force"],
            }
        )
        ours.append((100.0 * standing / n, 100.0 * low, 100.0 * high))
        published = math.nan if row.published is None else 100.0 * row.published / PUBLISHED_RUNS
        theirs.append((published, published, published))
        if row.published is not None:
            real.append(
                RealFigure(
                    f"boxes turned up and released, {row.text}, %",
                    published,
                    ours[-1][0],
                    "thresholds assumed, with these runs in view",
                )
            )
    return Result(
        title="Reorientation of a box by rotational slip, and its release",
        source='Table III and section VI of "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation", IEEE RA-L 2020',
        figures={"cells": figures},
        setup=[
            f"{SCENE}, seed {seed}, {counted(trials, 'trial')} per cell, which differ by the draws of `scatter`, the patches and the noise.",
            "Success: at the end of the trial the box is upright to 5 degrees, the table carries it, and no pad touches it.",
            "Turned up: at some time the box was less than 20 degrees from upright, whatever followed.",
            "The paper's rows of weights, of centres of mass and of surfaces share one cell, 200 g in the middle on paper: 10 of 11.",
            "Intervals: 95 %, exact (Clopper and Pearson).",
        ],
        charts=[
            Chart(
                "Success, by cell",
                "",
                "boxes turned up and released, %",
                [row.text for row in rows.values()],
                [Curve("here (95 %)", ours), Curve("paper", theirs)],
                joined=False,
            )
        ],
        tables=[success, ends],
        remarks=[
            "The height of the grip above the edge is l sin(theta). It stops growing at theta = 90 degrees, when a box of 54 mm, held in its middle 137.5 "
            "mm from the end, still leans by 11 degrees. From there its weight turns it upright: the weight is beyond the edge from 19 degrees on with the "
            "centre of mass in the middle, from 28 at L/3, from 15 at 2L/3.",
            "Lost: no pad touched the box any more before the release began. Released early: the release began below TargetPoint, and the box was never "
            "less than 20 degrees from upright. Not turned: the same at TargetPoint. Fell: less than 20 degrees at some time, but not upright at the end. "
            "Not detached: upright, but a pad touched the box. Not released: the arm rose to the end of the trial.",
            "The paper gives no thresholds; `slipbench describe reorient` states the source of each parameter of the controller, and the last rows show the"
            " effect of halving or doubling it.",
            "In the paper both fingers have sensors, and the controller waits until both touch; here only the pad of one finger has electronics.",
        ],
        real=real,
    )
