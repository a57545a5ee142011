"""Figures of Table II for a grasp.

The paper's estimate of the forces, the slip seen by its markers, and the figures of a trial.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from slipbench import State, Trial
from slipbench_studies.statistics import mean_sd, median, median_interval

# Constants of the paper's script.
MOST_FORCE = 10.0  # N
WINDOW = 4  # rows
SLIPS = 3  # rows per window
ROW_STRIDE = (
    15  # frames at 100 Hz between rows of the published log: four rows are 0.6 s in the paper
)

MARKER_BEFORE, MARKER_AFTER = 51, 101  # samples averaged in getSlides.m
# Vector from the gripper's marker to the box's in X, Y, Z before the lift [m]: mean of the 30
# published recordings of light boxes. The orientation of their X and Y relative to the gripper is
# not given.
MARKER_LINE = (3.3e-3, -1.7e-3, -135.4e-3)


class EstimatedForces(NamedTuple):
    """The paper's estimate of the forces of one grasp.

    Attributes:
        most: N, largest sum of all pillars' normal forces up to MOST_FORCE, over all rows; NaN if
            there is none
        ideal: N; NaN if no row counts as incipient slip
    """

    most: float
    ideal: float

    @property
    def ratio(self) -> float:
        """`most` divided by `ideal`."""
        return self.most / self.ideal


def _incipient_rows(states: NDArray[np.uint8]) -> list[int]:
    incipient = states == State.INCIPIENT
    slipping = incipient | (states == State.GROSS)
    found: list[int] = []
    first = 0
    while first + WINDOW < len(states):
        part = slice(first, first + WINDOW)
        if slipping[part].sum() >= SLIPS and incipient[part].any():
            found += (first + np.flatnonzero(incipient[part])).tolist()
            first += WINDOW
        else:
            first += 1
    return found


def _ideal_force(row: NDArray[np.float64]) -> float:
    shear, normal = np.hypot(row[:, 0], row[:, 1]), row[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = shear / normal
    counts = (shear != 0.0) & (normal != 0.0) & (ratio < 1.0)
    return float(shear.sum() / ratio[counts].mean()) if counts.any() else math.nan


def _least(values: list[float]) -> float:
    return min((value for value in values if not math.isnan(value)), default=math.nan)


def estimated_forces(force: ArrayLike, classes: ArrayLike, stride: int) -> EstimatedForces:
    """Estimates the forces as getGripForce.m of the published repository does.

    The repository is JT2106/Hyperdimensional-computing-tactile-sensing.

    Rows are every `stride`-th sample, the first of them number stride - 1; rows with a non-finite
    value are omitted. A window of four consecutive rows counts if at least three rows are incipient
    or gross and one is incipient. After a window that counts the next one follows it, otherwise the
    window moves by one row; none begins at the fourth row from the end. Over the incipient rows in
    the windows that count, ideal = min of sum f_t / mean(f_t/f_n), where zeros and ratios of 1 or
    more are excluded from the mean.

    Args:
        force: [T, N, 3] N, z normal
        classes: [T] code of State
        stride: samples per row

    Returns:
        most and ideal
    """
    rows = np.asarray(force, dtype=float)[stride - 1 :: stride]
    states = np.asarray(classes, dtype=np.uint8)[stride - 1 :: stride]
    finite = np.isfinite(rows).all(axis=(1, 2))
    rows, states = rows[finite], states[finite]
    sums = rows[:, :, 2].sum(axis=1)
    usable = sums[sums <= MOST_FORCE]
    return EstimatedForces(
        float(usable.max()) if len(usable) else math.nan,
        _least([_ideal_force(rows[k]) for k in _incipient_rows(states)]),
    )


class MarkerSlip(NamedTuple):
    """Slip of the box as measured by two markers of a motion capture system.

    As in getSlides.m of that repository.

    Attributes:
        along: m, |displacement of the box's marker relative to the gripper's along Z|
        spin: rad, |change of the angle between Z and the line from the gripper's marker to the
            box's|
    """

    along: float
    spin: float


def _polar_angle(line: NDArray[np.float64]) -> float:
    return math.atan2(math.hypot(line[0], line[1]), line[2])


def marker_slip(arm: ArrayLike, box: ArrayLike, lift: int) -> MarkerSlip:
    """Difference between the means before number `lift` and at the end.

    They are over MARKER_BEFORE samples up to number `lift` and over the last MARKER_AFTER.

    Assumes the box's marker in its middle, and the gripper's at the position in the published
    recordings: MARKER_LINE.

    Args:
        arm: [T, 7] poses
        box: [T, 7] poses
        lift: index of the sample at which the lift begins

    Returns:
        displacement and rotation

    Raises:
        ValueError: for fewer than MARKER_AFTER samples, or none up to `lift`
    """
    way = np.asarray(box, dtype=float)[:, :3] - np.asarray(arm, dtype=float)[:, :3]
    if len(way) < MARKER_AFTER or not 0 <= lift < len(way):
        raise ValueError(
            f"{len(way)} samples and a lift at {lift}; allowed: {MARKER_AFTER} samples or more, the lift among them"
        )
    start = way[max(0, lift + 1 - MARKER_BEFORE) : lift + 1].mean(axis=0)
    moved = way[-MARKER_AFTER:].mean(axis=0) - start
    line = np.array(MARKER_LINE)
    return MarkerSlip(abs(float(moved[2])), abs(_polar_angle(line + moved) - _polar_angle(line)))


class Spread(NamedTuple):
    """Statistics of one quantity; NaN values are ignored.

    Attributes:
        n: number of values
        median: NaN without values
        interval: distribution-free 95 % interval of the median; NaN for fewer than six values
        mean: NaN without values
        sd: NaN for fewer than two values
    """

    n: int
    median: float
    interval: tuple[float, float]
    mean: float
    sd: float


def spread(values: ArrayLike) -> Spread:
    """Statistics of values; NaN values are ignored."""
    array = np.asarray(values, dtype=float)
    array = array[~np.isnan(array)]
    return Spread(len(array), median(array), median_interval(array), *mean_sd(array))


@dataclass(frozen=True)
class GraspFigures:
    """Figures of a trial.

    All except `dropped` are NaN if the box was not held, or if the figure is undefined.

    Attributes:
        dropped: dropped or not lifted
        slip: m
        rotation: rad
        marker_slip: m
        marker_spin: rad
        true_ratio: greatest force divided by the least that holds the box
        estimated_ratio: the same ratio by the paper's script
        counts: closing of the gripper after the lift began
    """

    dropped: bool = False
    slip: float = math.nan
    rotation: float = math.nan
    marker_slip: float = math.nan
    marker_spin: float = math.nan
    true_ratio: float = math.nan
    estimated_ratio: float = math.nan
    counts: float = math.nan


def grasp_figures(trial: Trial, start: float) -> GraspFigures:
    """The figures of a trial of lift.yaml.

    Args:
        trial: a full record
        start: s, start of the lift
    """
    outcome = trial.outcome
    if outcome["dropped"] or not outcome["lifted"]:
        return GraspFigures(dropped=True)
    [sensor] = trial.sensors.values()
    control = trial.control
    assert control is not None  # the scene names a detector
    begun = int(np.searchsorted(sensor.t, start, "right")) - 1
    markers = marker_slip(trial.bodies["arm"].pose, trial.bodies["box"].pose, begun)
    return GraspFigures(
        slip=outcome["slip_translation_m"],
        rotation=outcome["slip_rotation_rad"],
        marker_slip=markers.along,
        marker_spin=markers.spin,
        true_ratio=outcome["max_grip_force_N"] / outcome["ideal_grip_force_N"],
        estimated_ratio=estimated_forces(
            sensor.channels["force"], control.detector_class, ROW_STRIDE
        ).ratio,
        counts=float(control.measured_position[-1]) - float(control.measured_position[begun]),
    )
