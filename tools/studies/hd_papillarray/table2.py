"""Table II of the paper.

Closed-loop grasp and lift, with every detector and controller, the oracle and the negative control.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from slipbench import InputError, describe, list_names, parse_quantity
from slipbench._program import counted
from slipbench.bin import _core
from slipbench_studies.grid import Cell, check_only, chosen, run_grid
from slipbench_studies.hd_papillarray.grasp import (
    ROW_STRIDE,
    GraspFigures,
    Spread,
    grasp_figures,
    spread,
)
from slipbench_studies.result import Options, RealFigure, Result, Table
from slipbench_studies.statistics import clopper_pearson

SCENE = "scenes/grasp/lift.yaml"
PUBLISHED_MEMORIES = "tests/detectors/hd/data/published"
DEFAULT_TRIALS = 10
FITTED = "_fitted"  # suffix of a surface's name
DEGREES = 180.0 / math.pi
FELT_EFFECTS = "{anisotropic_friction: {ratio: 0.6}}, {patchy_friction: {sd: 0.2, shortest: 8 mm, longest: 20 mm}}"


@dataclass(frozen=True)
class Choice:
    """A value on an axis of the table.

    Attributes:
        text: text in the table
        overrides: of SCENE
    """

    text: str
    overrides: dict[str, str] = field(default_factory=dict)


PROTOCOLS = {
    "as_recorded": Choice("as_recorded (4 N, 43 mm/s)", {"grip.protocol": "as_recorded"}),
    "as_printed": Choice("as_printed (1 N, 5 mm/s)", {"grip.protocol": "as_printed"}),
}
BOXES = {
    "light": Choice("light box (0.2 kg)", {"box.mass": "0.2 kg"}),
    "heavy": Choice("heavy box (0.5 kg)", {"box.mass": "0.5 kg"}),
}


def _fitted(surface: str, friction: float, effects: str = "") -> Choice:
    """Friction fitted to the published slips of the light boxes only (README.md).

    For felt, along its grain.
    """
    all_effects = (
        f"[{effects}{', ' if effects else ''}{{viscous_friction: {{gain: 0.3, speed: 1 mm/s}}}}]"
    )
    return Choice(
        f"{surface}, fitted to light boxes",
        {
            "surface.material": surface,
            "friction.static": f"{friction:g}",
            "friction.kinetic": f"{0.95 * friction:.4g}",
            "effects": all_effects,
        },
    )


SURFACES = {
    "ptfe": Choice("ptfe", {"surface.material": "ptfe"}),
    "rubber": Choice("rubber", {"surface.material": "rubber"}),
    "felt": Choice("felt", {"surface.material": "felt", "effects": f"[{FELT_EFFECTS}]"}),
    "ptfe_0.2": Choice(
        "ptfe, mu 0.2",
        {"surface.material": "ptfe", "friction.static": "0.2", "friction.kinetic": "0.19"},
    ),
    "ptfe_fitted": _fitted("ptfe", 0.14),
    "rubber_fitted": _fitted("rubber", 0.5),
    "felt_fitted": _fitted("felt", 0.75, FELT_EFFECTS),
}


def loops(memories: str) -> dict[str, Choice]:
    """Detectors and controllers by name.

    Args:
        memories: folder of the published memories
    """

    def controlled(text: str, controller: str, detector: str = "{type: gst_hd}") -> Choice:
        return Choice(text, {"detector": detector, "controller": controller})

    def detected(text: str, detector: str) -> Choice:
        return controlled(text, "{type: step_on_slip}", detector)

    return {
        "oracle": detected("oracle (sees the truth)", "{type: truth}"),
        "gst_hd": detected("gst_hd, shipped memory", "{type: gst_hd}"),
        "gst_hd_published": detected(
            "gst_hd, published memory",
            f"{{type: gst_hd, memories: {json.dumps(memories)}, compat: published_core}}",
        ),
        "gst_hd_rtl": detected("gst_hd_rtl", "{type: gst_hd_rtl}"),
        "force_ratio": detected("detector force_ratio", "{type: force_ratio}"),
        "shear_rate": detected("detector shear_rate", "{type: shear_rate}"),
        "constant_force": controlled("constant_force", "{type: constant_force}"),
        "force_ratio_control": controlled("controller force_ratio", "{type: force_ratio}"),
        "hold_preset": controlled("hold_preset (negative control)", "{type: hold_preset}"),
    }


class GraspCell(NamedTuple):
    """A row of the tables.

    Names of its protocol, box and surface, name and choice of its loop, and whether the loop is
    available.
    """

    protocol: str
    box: str
    surface: str
    loop: str
    loop_choice: Choice
    usable: bool

    def grid(self, draws: int = 1) -> Cell:
        """Returns the cell to simulate, with `draws` trials."""
        overrides: dict[str, str] = {}
        for choice in (
            PROTOCOLS[self.protocol],
            BOXES[self.box],
            SURFACES[self.surface],
            self.loop_choice,
        ):
            overrides |= choice.overrides
        return Cell(
            f"{self.protocol}, {self.box}, {self.surface}, {self.loop}", SCENE, overrides, draws
        )

    @property
    def text(self) -> str:
        """Head of the row."""
        return f"{SURFACES[self.surface].text}: {self.loop_choice.text}"


def grasp_cells(options: Options) -> list[GraspCell]:
    """The cells selected by options.only, in the order of the table: protocol, box, surface, loop.

    Args:
        options: only, memories

    Raises:
        InputError: for an unknown name
    """
    memories = options.memories
    if not memories:
        try:
            memories = str(Path(_core.project_file(f"{PUBLISHED_MEMORIES}/AM.hex")).parent)
        except InputError:
            memories = ""  # the rows state that the package has no memories
    all_loops = loops(memories)
    axes: list[list[str]] = [list(axis) for axis in (PROTOCOLS, BOXES, SURFACES, all_loops)]
    check_only(options.only, [name for axis in axes for name in axis])
    return [
        GraspCell(
            protocol,
            box,
            surface,
            loop,
            all_loops[loop],
            loop != "gst_hd_published" or memories != "",
        )
        for protocol, box, surface, loop in itertools.product(
            *(chosen(axis, options.only) for axis in axes)
        )
    ]


class Published(NamedTuple):
    """The paper's row with data of its recordings.

    Attributes:
        slip_median: mm
        slip: mm, mean and SD
        spin_median: deg
        spin: deg, mean and SD
        ratio: mean and SD of max over ideal force; None: not published
    """

    slip_median: float
    slip: tuple[float, float]
    spin_median: float
    spin: tuple[float, float]
    ratio: tuple[float, float] | None = None


PUBLISHED = {
    ("ptfe", "light"): Published(2.54, (3.56, 2.65), 0.68, (1.36, 2.18), (1.48, 0.29)),
    ("rubber", "light"): Published(0.25, (1.34, 3.35), 0.44, (0.51, 0.22), (1.36, 0.36)),
    ("felt", "light"): Published(0.27, (0.44, 0.41), 0.28, (0.64, 0.68), (1.25, 0.27)),
    ("ptfe", "heavy"): Published(9.09, (8.71, 1.96), 1.30, (2.33, 2.29)),
    ("rubber", "heavy"): Published(1.00, (2.21, 2.48), 0.39, (0.66, 0.56)),
    ("felt", "heavy"): Published(1.36, (1.37, 0.65), 0.33, (0.35, 0.09)),
}

Grasps = Sequence[GraspFigures]
# By key of the JSON: figure of a trial, and factor to the table's unit.
FIGURES: dict[str, tuple[str, float]] = {
    "slip_mm": ("slip", 1e3),
    "marker_slip_mm": ("marker_slip", 1e3),
    "rotation_deg": ("rotation", DEGREES),
    "marker_spin_deg": ("marker_spin", DEGREES),
    "max_over_least": ("true_ratio", 1.0),
    "max_over_ideal_by_paper": ("estimated_ratio", 1.0),
    "counts": ("counts", 1.0),
}


def published_of(cell: GraspCell) -> Published | None:
    """Published figures of the cell's surface and box."""
    return PUBLISHED.get((cell.surface.removesuffix(FITTED), cell.box))


def spread_of(trials: Grasps, key: str) -> Spread:
    """Statistics of a key of FIGURES over trials, in its unit."""
    name, scale = FIGURES[key]
    return spread([scale * getattr(trial, name) for trial in trials])


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _mean_text(mean: float, sd: float) -> str:
    return _number(mean) if math.isnan(sd) else f"{_number(mean)} +- {_number(sd)}"


def _interval_text(interval: tuple[float, float]) -> str:
    return "-" if math.isnan(interval[0]) else f"{interval[0]:.2f} to {interval[1]:.2f}"


def _drops(trials: Grasps) -> list[int]:
    return [k for k, trial in enumerate(trials) if trial.dropped]


def _add_rows(
    table: Table,
    cells: Sequence[GraspCell],
    results: Sequence[Grasps],
    published_row: Callable[[str, Published], list[str] | None],
    loop_row: Callable[[Grasps], list[str]],
) -> None:
    """Adds a row for each loop below its surface, preceded by the published one."""
    for k, (cell, trials) in enumerate(zip(cells, results, strict=True)):
        published = published_of(cell)
        if published is not None and (k == 0 or cells[k - 1].surface != cell.surface):
            row = published_row(f"{cell.surface.removesuffix(FITTED)}: published", published)
            table.rows += [] if row is None else [row]
        row = [cell.text, *(loop_row(trials) if trials else ["no memories: --memories DIR"])]
        table.rows.append(row + ["-"] * (len(table.head) - len(row)))


def displacement_table(title: str, cells: Sequence[GraspCell], results: Sequence[Grasps]) -> Table:
    """Drops, slip and rotation.

    Args:
        title: start of the title
        cells: cells of one protocol and box
        results: trials of each cell

    Returns:
        the table
    """
    table = Table(
        f"{title}: drops, slip and rotation",
        [
            "",
            "dropped",
            "95 %",
            "slip, median mm",
            "95 %",
            "mean +- SD",
            "by markers, median",
            "mean +- SD",
            "turned, median deg",
            "mean +- SD",
            "by markers, median",
            "mean +- SD",
        ],
        note="Statistics of the boxes that were not dropped. Slip: path of the box's middle in the arm's frame since the beginning of the lift; "
        "turned: its rotation in that frame. By markers: computed as in the paper's script. 95 %: interval of the drop rate after Clopper "
        "and Pearson, of the median by order statistics.",
    )

    def published_row(name: str, row: Published) -> list[str]:
        return [
            name,
            "0 of 10",
            "0 to 31 %",
            "-",
            "-",
            "-",
            _number(row.slip_median),
            _mean_text(*row.slip),
            "-",
            "-",
            _number(row.spin_median),
            _mean_text(*row.spin),
        ]

    def loop_row(trials: Grasps) -> list[str]:
        low, high = clopper_pearson(len(_drops(trials)), len(trials))
        slip = spread_of(trials, "slip_mm")
        row = [
            f"{len(_drops(trials))} of {len(trials)}",
            f"{100.0 * low:.0f} to {100.0 * high:.0f} %",
            _number(slip.median),
            _interval_text(slip.interval),
            _mean_text(slip.mean, slip.sd),
        ]
        for key in ("marker_slip_mm", "rotation_deg", "marker_spin_deg"):
            value = spread_of(trials, key)
            row += [_number(value.median), _mean_text(value.mean, value.sd)]
        return row

    _add_rows(table, cells, results, published_row, loop_row)
    return table


def force_table(title: str, cells: Sequence[GraspCell], results: Sequence[Grasps]) -> Table:
    """Grip forces.

    Args:
        title: start of the title
        cells: cells of one protocol and box
        results: trials of each cell

    Returns:
        the table
    """
    table = Table(
        f"{title}: force",
        [
            "",
            "max/least, median",
            "95 %",
            "mean +- SD",
            "n",
            "max/ideal by the paper, median",
            "95 %",
            "mean +- SD",
            "n",
            "counts",
        ],
        note="Statistics of the boxes that were not dropped. Least: m g/(2 mu_s) with the trial's mu_s in upward direction, without patches. By "
        "the paper: largest force up to 10 N over the least sum f_t/mean(f_t/f_n) of the rows classified as incipient; n: number of trials "
        "with such rows. Counts: closing of the gripper after the beginning of the lift, median.",
    )

    def published_row(name: str, row: Published) -> list[str] | None:
        return (
            None
            if row.ratio is None
            else [name, "-", "-", "-", "-", "-", "-", _mean_text(*row.ratio), "-", "-"]
        )

    def loop_row(trials: Grasps) -> list[str]:
        row = []
        for key in ("max_over_least", "max_over_ideal_by_paper"):
            value = spread_of(trials, key)
            row += [
                _number(value.median),
                _interval_text(value.interval),
                _mean_text(value.mean, value.sd),
                str(value.n),
            ]
        return [*row, _number(spread_of(trials, "counts").median)]

    _add_rows(table, cells, results, published_row, loop_row)
    return table


def cell_figures(cell: GraspCell, trials: Grasps, seed: int) -> dict[str, Any]:
    """Figures of a row.

    Args:
        cell: the row
        trials: trials of the row; empty if it could not run
        seed: seed of the trials

    Returns:
        names, number of trials, and for one or more trials: number of dropped boxes, interval of
        the drop rate, the statistics of each of FIGURES, and the command
    """
    figures: dict[str, Any] = {
        "protocol": cell.protocol,
        "box": cell.box,
        "surface": cell.surface,
        "loop": cell.loop,
        "trials": len(trials),
    }
    if not trials:
        return figures
    figures |= {
        "dropped": _drops(trials),
        "drop_rate_95": clopper_pearson(len(_drops(trials)), len(trials)),
    }
    for key in FIGURES:
        value = spread_of(trials, key)
        figures[key] = {
            "n": value.n,
            "median": value.median,
            "median_95": value.interval,
            "mean": value.mean,
            "sd": value.sd,
        }
    return figures | {"command": f"{cell.grid().command(seed)} --trials {len(trials)}"}


def real_figure(cell: GraspCell, trials: Grasps) -> RealFigure | None:
    """The published slip with that of the oracle's loop.

    None for other loops, protocols and surfaces.
    """
    published = published_of(cell)
    if published is None or cell.protocol != "as_recorded" or cell.loop != "oracle":
        return None
    seen = (
        "friction assumed"
        if not cell.surface.endswith(FITTED)
        else "fitted to it"
        if cell.box == "light"
        else "not seen by the fit"
    )
    return RealFigure(
        f"slip of the {cell.box} box, {cell.surface.removesuffix(FITTED)}, median, mm",
        published.slip_median,
        spread_of(trials, "slip_mm").median,
        f"{seen}; with the oracle instead of the detector",
    )


def _described(name: str, kind: str) -> dict[str, Any]:
    return next(one for one in describe(name) if one["kind"] == kind)


def lift_start() -> float:
    """Start of the lift of SCENE [s]: default of the motion's parameter `settle`."""
    return float(
        parse_quantity(
            next(
                one["default"]
                for one in _described("lift", "motion")["parameters"]
                if one["name"] == "settle"
            )
        )
    )


def setup_lines(trials: int, seed: int) -> list[str]:
    """Setup of the measurement.

    Args:
        trials: number of trials per row
        seed: seed of the trials
    """
    names = list_names()
    materials = [
        _described(one["name"], "material") for one in names["materials"] if one["name"] in SURFACES
    ]
    assumed = []
    for one in names["grasp"]:
        values = [
            f"{spec['name']} {spec['default']}"
            for spec in _described(one["name"], "part of a grasp")["parameters"]
            if spec["source"].startswith("assumed")
        ]
        assumed.append(f"Assumed, {one['name']}: {', '.join(values)}.")
    return [
        f"{SCENE}, seed {seed}, {counted(trials, 'trial')} per row. Rows differ only in what they name. Trial k has the same box, position and loop phase in every row.",
        "Rows of detectors use the controller step_on_slip. constant_force, the controller force_ratio and hold_preset use no detector; for the "
        "paper's estimate gst_hd with the shipped memory runs in parallel.",
        f"Rows of the paper's script: one in {ROW_STRIDE} frames of 100 Hz; assumed, because its window of four rows is 0.6 s in the paper. The script requires three"
        " slips of four, the text of the paper half.",
        "Published: Table II (light boxes; the script gives the same means and SDs from the recordings), and the medians, the heavy boxes and the drops of the "
        "recordings, github.com/JT2106/Hyperdimensional-computing-tactile-sensing, data/grip force control.",
        "Rows `_fitted`: only friction is fitted, to the published median slips of the light boxes; heavy boxes were not used. The gain of viscous_friction"
        " is assumed, for boxes that slip slowly.",
        "Assumed for felt: anisotropic_friction 0.6 with horizontal grain, so that the box hangs by the smaller friction; patches of 0.2, 8 mm to 20 mm. "
        "Assumed for the hard case: mu_s 0.2, mu_k 0.19. Assumed for the lift: settle 1.5 s.",
        *(
            f"{one['name']}: mu_s {one['mu_static']:g}, mu_k {one['mu_kinetic']:g}, {one['source']}."
            for one in materials
        ),
        *assumed,
    ]


def remarks_on(cells: Sequence[GraspCell], results: Sequence[Grasps], seed: int) -> list[str]:
    """Remarks on the current rows and on the whole table.

    Args:
        cells: the rows
        results: trials of each row
        seed: seed of the trials
    """
    rows = list(zip(cells, results, strict=True))
    idle = [
        f"{cell.protocol} {cell.box} {cell.surface}"
        for cell, trials in rows
        if cell.loop == "hold_preset" and not _drops(trials)
    ]
    oracle = [
        (cell, trials) for cell, trials in rows if cell.loop == "oracle" and cell.box == "light"
    ]
    light = sum(len(trials) for _, trials in oracle)
    lost = [
        f"{cell.grid().command(seed)} --trials {k + 1} --trial {k}"
        for cell, trials in oracle
        for k in _drops(trials)
    ]
    remarks = []
    if light:
        remarks.append(
            f"The oracle drops {len(lost)} of {light} light boxes: {'; '.join(lost)}."
            if lost
            else f"The oracle drops none of {light} light boxes."
        )
    if idle:
        remarks.append(
            "The negative control, which never tightens, drops no box either, so these rows do not test a detector's drops: "
            f"{'; '.join(idle)}."
        )
    return [
        *remarks,
        "Outliers dominate the published means: rubber has nine trials of 0.15 to 0.41 mm and one of 10.86 mm. The largest slip of PTFE, 8.49 mm, is a jump"
        " of the gripper's marker (median without it: 2.24 mm), and another box moves long after the lift. Compare medians.",
        "The published rotations are those of a line of 135 mm between two markers: 1 to 2 mm of lateral play make 0.4 to 0.9 deg.",
        "max/ideal by the paper is nearly the last force over the least force in a row classified as incipient, because sum f_t/mean(f_t/f_n) is sum f_n if"
        " all ratios are equal. It contains little information about m g/(2 mu).",
        "The paper states 1 N, 5 mm/s and 50 mm/s2; the published HDL holds 4 N, and the boxes in the recordings rise at 43 mm/s.",
    ]


def study(options: Options) -> Result:
    """hd-papillarray/table2.

    Args:
        options: trials, only, memories, seed, jobs

    Returns:
        drops, slip, rotation and force of each loop, by protocol, box and surface

    Raises:
        InputError: for an unknown name of --only, or a trial that cannot run
    """
    seed, trials = options.draws_seed, options.trials or DEFAULT_TRIALS
    cells, start = grasp_cells(options), lift_start()
    found = iter(
        run_grid(
            [cell.grid(trials) for cell in cells if cell.usable],
            options,
            lambda _, trial: grasp_figures(trial, start),
        )
    )
    results: list[Grasps] = [next(found) if cell.usable else [] for cell in cells]
    tables = []
    for (protocol, box), rows in itertools.groupby(
        zip(cells, results, strict=True), lambda row: (row[0].protocol, row[0].box)
    ):
        part, trials_of_part = zip(*rows, strict=True)
        title = f"{PROTOCOLS[protocol].text}, {BOXES[box].text}"
        tables += [
            displacement_table(title, part, trials_of_part),
            force_table(title, part, trials_of_part),
        ]
    real = [real_figure(cell, grasps) for cell, grasps in zip(cells, results, strict=True)]
    return Result(
        title="Grasp and lift with slip detection in the loop",
        source='Table II and section IV-D of "Ultra-Fast Lightweight Incipient Slip Detection Using Hyperdimensional Computing With the PapillArray Tactile '
        'Sensor"',
        figures={
            "cells": [
                cell_figures(cell, grasps, seed)
                for cell, grasps in zip(cells, results, strict=True)
            ]
        },
        setup=setup_lines(trials, seed),
        tables=tables,
        remarks=remarks_on(cells, results, seed),
        real=[one for one in real if one is not None],
    )
