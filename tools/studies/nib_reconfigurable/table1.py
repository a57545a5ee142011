"""Table I of the nib pad's paper.

Forces and moments from the 36 capacitances, under uniform and partial loads.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import linalg
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from slipbench import RandomStream, Trial, describe, parse_quantity
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Chart, Curve, Options, RealFigure, Result, Table

Doubles = NDArray[np.float64]
Rows = NDArray[np.int64]

FIT, CHOOSE, TEST = 3000, 1000, 1000  # rows; the paper: 4000 train, 1000 test
SCENES = {
    "uniform": "scenes/nib_pad/calibrate_uniform.yaml",
    "end face": "scenes/nib_pad/calibrate_end_face.yaml",
    "lying": "scenes/nib_pad/calibrate_lying.yaml",
}
CASES = {
    "uniform": ["uniform"],
    "uniform + end face": ["uniform", "end face"],
    "uniform + lying": ["uniform", "lying"],
    "uniform + both": ["uniform", "end face", "lying"],
}  # loads for training and test, in equal parts
AVERAGED = 5  # images averaged in si, and in the reference
RIDGES = [10.0**k for k in range(-8, 1)]
COMPONENTS = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
HEAD = ["", "Fx, N", "Fy, N", "Fz, N", "Mx, mNm", "My, mNm", "Mz, mNm"]
UNITS = np.array([1.0, 1.0, 1.0, 1e3, 1e3, 1e3])  # of the tables: N and mN m
DIGITS = [2, 2, 2, 1, 1, 1]
PUBLISHED = {
    "paper: uniform": [0.12, 0.11, 0.56, 3.0, 3.1, 1.3],
    "paper: uniform + partial": [0.15, 0.12, 1.2, 5.1, 6.7, 1.5],
}


@dataclass(frozen=True)
class Variant:
    """A single change of the recordings.

    Attributes:
        overrides: overrides of the scenes
        averaged: True: the reference is averaged like si
        apart: number of recordings per image kept: takes this many times as many recordings, and
            keeps one of this many images
    """

    overrides: dict[str, str] = field(default_factory=dict)
    averaged: bool = True
    apart: int = 1


LINEAR = {"sensors.pad.capacitor": "linear"}
VARIANTS = {  # unchanged scenes first
    "as it is": Variant(),
    "linear capacitor": Variant(LINEAR),
    "no noise": Variant({"sensors.pad.electronics": "ideal"}),
    "nibs of one height": Variant({"sensors.pad.height_sd": "0 mm"}),
    "all read at one instant": Variant({"sensors.pad.scan": "simultaneous"}),
    "k_tangential 0.4 N/mm": Variant({"sensors.pad.k_tangential": "0.4 N/mm"}),
    "reference not averaged": Variant(averaged=False),
    "as it is, images 0.3 s apart": Variant(apart=10),
    "linear capacitor, images 0.3 s apart": Variant(LINEAR, apart=10),
}
# Splits of the rows of the main table: variant, and True to divide rows in order of time.
SPLITS = {
    "random split": ("as it is", False),
    "chronological split": ("as it is", True),
    "images 0.3 s apart": ("as it is, images 0.3 s apart", False),
}


def wrench_on_pad(tips: ArrayLike, force: ArrayLike, displacement: ArrayLike) -> Doubles:
    """Load of the object on the pad, in the pad's frame P and about its origin.

    Compression is positive.

    Args:
        tips: [N, 3] m, of the unloaded units
        force: [..., N, 3] N
        displacement: [..., N, 3] m

    Returns:
        [..., 6] Fx, Fy, Fz [N], Mx, My, Mz [N m]
    """
    forces = np.asarray(force, dtype=float)
    places = np.asarray(tips, dtype=float) + np.asarray(displacement, dtype=float)
    return np.concatenate([forces.sum(axis=-2), np.cross(places, forces).sum(axis=-2)], axis=-1)


@dataclass(frozen=True)
class Recording:
    """A calibration: n images from the motion's start.

    Attributes:
        si: [n, 36] counts minus the mean of the images before the motion
        wrench: [n, 6] at the time at which the image is complete
        averaged: [n, 6] mean over the last AVERAGED images
    """

    si: Doubles
    wrench: Doubles
    averaged: Doubles


def joined(recordings: Iterable[Recording]) -> Recording:
    """Concatenates recordings."""
    parts = list(recordings)
    return Recording(
        *(
            np.concatenate([getattr(part, name) for part in parts])
            for name in ("si", "wrench", "averaged")
        )
    )


def running_mean(rows: Doubles, count: int) -> Doubles:
    """Running mean of rows [n, ...] over each row and the rows before it.

    It is over `count` rows in all, or as many as there are.
    """
    sums = np.cumsum(np.concatenate([np.zeros((1, *rows.shape[1:])), rows]), axis=0)
    n = np.arange(1, len(rows) + 1)
    first = np.maximum(n - count, 0)
    return np.asarray((sums[n] - sums[first]) / (n - first)[:, None])


def recording_of(trial: Trial, start: float, every: int = 1) -> Recording:
    """Converts a trial of a calibration scene to a recording.

    Args:
        trial: recorded with record="contact"
        start: s, start of the motion
        every: keeps every `every`-th image

    Returns:
        its images from `start`
    """
    sensor, contact = trial.sensors["pad"], trial.contacts["pad"]
    si = sensor.channels["si"].reshape(-1, 36).astype(float)
    complete = (
        np.arange(1, len(si) + 1) * (len(sensor.t) // len(si)) - 1
    )  # last sample of each image
    tips = np.column_stack([trial.labels["pad"].unit_positions, trial.labels["pad"].unit_heights])
    wrench = wrench_on_pad(tips, contact.force[complete], contact.displacement[complete])
    untouched = int(np.searchsorted(sensor.t[complete], start))
    kept = slice(untouched, None, every)
    return Recording(
        (si - si[:untouched].mean(axis=0))[kept], wrench[kept], running_mean(wrench, AVERAGED)[kept]
    )


@dataclass(frozen=True)
class Split:
    """Row numbers of a recording for training, for choosing the ridge, and for the test."""

    fit: Rows
    choose: Rows
    test: Rows


def _draw(rows: Rows, count: int, stream: RandomStream) -> Rows:
    """Draws `count` of the rows."""
    if len(rows) < count:
        raise ValueError(f"split_rows: {len(rows)} rows; expected {count}")
    left = rows.tolist()
    for i in range(count):
        j = i + stream.integer(len(left) - i)
        left[i], left[j] = left[j], left[i]
    return np.array(left[:count], dtype=np.int64)


def split_rows(
    rows: int, fit: int, choose: int, test: int, in_time: bool, stream: RandomStream
) -> Split:
    """Draws rows of a recording without replacement.

    Args:
        rows: number of rows
        fit: number of training rows
        choose: number of rows for choosing the ridge
        test: number of test rows
        in_time: True: the last fifth is for the test, and the last quarter of the remainder for
            choosing; False: draws from all rows, so that neighbours of test rows may be in training
        stream: random stream

    Returns:
        the three parts

    Raises:
        ValueError: for too few rows
    """
    everything = np.arange(rows)
    if in_time:
        judged = rows - rows // 5
        chosen = judged - judged // 4
        return Split(
            _draw(everything[:chosen], fit, stream),
            _draw(everything[chosen:judged], choose, stream),
            _draw(everything[judged:], test, stream),
        )
    return Split(*np.split(_draw(everything, fit + choose + test, stream), [fit, fit + choose]))


def split_of(sizes: Sequence[int], in_time: bool, stream: RandomStream) -> Split:
    """Splits the rows of several loads, in equal parts, like those of one recording.

    Args:
        sizes: rows of each load
        in_time: as for split_rows()
        stream: random stream

    Returns:
        row numbers in the concatenated loads

    Raises:
        ValueError: for too few rows of a load
    """
    parts = len(sizes)
    splits = [
        split_rows(rows, FIT // parts, CHOOSE // parts, TEST // parts, in_time, stream)
        for rows in sizes
    ]
    firsts = np.concatenate([[0], np.cumsum(sizes)])
    return Split(
        *(
            np.concatenate(
                [first + getattr(one, name) for first, one in zip(firsts, splits, strict=False)]
            )
            for name in ("fit", "choose", "test")
        )
    )


class QuadraticFit:
    """Least-squares fit with a ridge of a polynomial of degree 2, for every component.

    y = b + sum a_i x_i + sum_{i<=j} a_ij x_i x_j.

    Columns are first scaled to mean 0 and standard deviation 1; b is not penalised. With 36 inputs
    there are 703 coefficients per component, which 3,000 rows hardly determine: the ridge is the
    one of RIDGES that is best on rows outside of training; the final fit uses all rows.

    Args:
        x: [n, inputs]
        y: [n, components]
        fit: numbers of the training rows
        choose: numbers of the rows for choosing the ridge

    Attributes:
        ridge: [components] chosen value of each, divided by the number of rows
    """

    def __init__(self, x: Doubles, y: Doubles, fit: Rows, choose: Rows) -> None:
        errors = []
        solved = self._learn(x[fit], y[fit])
        terms = self._columns.transform(x[choose])
        for ridge in RIDGES:
            errors.append((((terms @ solved(ridge) + self._mean) - y[choose]) ** 2).sum(axis=0))
        best = np.argmin(errors, axis=0)
        self.ridge = [RIDGES[k] for k in best]
        both = np.concatenate([fit, choose])
        solved = self._learn(x[both], y[both])
        self._coefficients = np.empty((len(solved(1.0)), y.shape[1]))
        for k in np.unique(best):
            self._coefficients[:, best == k] = solved(RIDGES[k])[:, best == k]

    def _learn(self, x: Doubles, y: Doubles) -> Any:
        """Scales the columns of these rows.

        Returns a function from a ridge to the coefficients [columns, components].
        """
        self._columns = make_pipeline(
            StandardScaler(), PolynomialFeatures(2, include_bias=False), StandardScaler()
        )
        terms = self._columns.fit_transform(x)
        self._mean = y.mean(axis=0)
        gram, right = terms.T @ terms / len(x), terms.T @ (y - self._mean) / len(x)
        return lambda ridge: linalg.solve(gram + ridge * np.eye(len(gram)), right, assume_a="pos")

    def predict(self, x: Doubles) -> Doubles:
        """Predicts [n, components] from the inputs [n, inputs]."""
        return np.asarray(self._columns.transform(x) @ self._coefficients + self._mean)


def rms(error: Doubles) -> Doubles:
    """Root mean square over the rows."""
    return np.asarray(np.sqrt((error**2).mean(axis=0)))


def error_of(loads: Sequence[Recording], in_time: bool, seed: int) -> Doubles:
    """RMS error [6] of a fit to loads, in equal parts, on the test rows."""
    data = joined(loads)
    split = split_of(
        [len(load.si) for load in loads], in_time, RandomStream(seed, 0, "nib_table1.split")
    )
    fit = QuadraticFit(data.si, data.averaged, split.fit, split.choose)
    return rms(fit.predict(data.si[split.test]) - data.averaged[split.test])


def transfer(recordings: dict[str, Recording], seed: int) -> dict[str, tuple[Doubles, Doubles]]:
    """Errors of a fit to uniform loads on each kind of load: RMS error and mean error, [6] each."""
    uniform = recordings["uniform"]
    split = split_of([len(uniform.si)], False, RandomStream(seed, 0, "nib_table1.split"))
    fit = QuadraticFit(uniform.si, uniform.averaged, split.fit, split.choose)
    found = {}
    for name, asked in recordings.items():
        rows = split.test if name == "uniform" else slice(None)
        error = fit.predict(asked.si[rows]) - asked.averaged[rows]
        found[name] = (rms(error), error.mean(axis=0))
    return found


def _row(name: str, values: Iterable[float]) -> list[str]:
    """A row of values in the table's units."""
    return [name, *(f"{value:.{digits}f}" for value, digits in zip(values, DIGITS, strict=True))]


def _figures(values: Iterable[float]) -> dict[str, Any]:
    return dict(zip(COMPONENTS, values, strict=True))


def record_loads(options: Options) -> dict[str, dict[str, Recording]]:
    """The recordings of each variant and load.

    Raises InputError and KeyboardInterrupt as run_grid().
    """
    start = next(
        parse_quantity(one["default"])
        for one in describe("wander")[0]["parameters"]
        if one["name"] == "start"
    )
    places, cells = [], []
    for variant, changes in VARIANTS.items():
        for load, scene in SCENES.items():
            cell = Cell(variant, scene, changes.overrides)
            cells.append(replace(cell, draws=changes.apart * cell.load().trials()))
            places.append((variant, load))
    found = run_grid(
        cells,
        options,
        lambda cell, trial: recording_of(trial, start, VARIANTS[cell.name].apart),
        record="contact",
    )
    recordings: dict[str, dict[str, Recording]] = {variant: {} for variant in VARIANTS}
    for (variant, load), parts in zip(places, found, strict=True):
        recording = joined(parts)
        recordings[variant][load] = (
            recording
            if VARIANTS[variant].averaged
            else replace(recording, averaged=recording.wrench)
        )
    return recordings


def study(options: Options) -> Result:
    """nib-reconfigurable/table1.

    Args:
        options: seed, jobs

    Returns:
        errors of the fits, of a fit to uniform loads on other loads, and their causes
    """
    seed = options.draws_seed
    recordings = record_loads(options)
    options.say("fits")
    figures: dict[str, Any] = {"rms": {}, "of_uniform": {}, "loads": {}, "causes": {}}

    main = Table(
        "RMS error of a second-order polynomial of the 36 capacitances",
        HEAD,
        [_row(name, values) for name, values in PUBLISHED.items()],
        "Random: test rows are drawn from all rows, so the training set may contain their neighbours, which are 30 ms away and share four of the "
        "five averaged images. Chronological: the test set is the last fifth of each load, for a cylinder the last two of its ten positions. 0.3 s"
        " apart: a calibration ten times as long, of which every tenth image is kept, so that no test row has such a neighbour; random split.",
    )
    for how, (variant, in_time) in SPLITS.items():
        figures["rms"][how] = {}
        for case, loads in CASES.items():
            error = UNITS * error_of([recordings[variant][load] for load in loads], in_time, seed)
            main.rows.append(_row(f"{case}, {how}", error))
            figures["rms"][how][case] = _figures(error)

    asked = Table(
        "A fit to uniform loads, tested on other loads: RMS error, and mean error of Fz",
        [*HEAD, "Fz too high by, N"],
    )
    for load, (error, bias) in transfer(recordings["as it is"], seed).items():
        asked.rows.append([*_row(load, UNITS * error), f"{bias[2]:.2f}"])
        figures["of_uniform"][load] = {**_figures(UNITS * error), "Fz_bias": bias[2]}

    ranges = Table(
        "Loads of the recordings: 1st and 99th percentile",
        HEAD,
        [["paper, range", "+-3.5", "+-3.5", "0 to 15", "+-50", "+-50", "+-50"]],
    )
    for load, recording in recordings["as it is"].items():
        ends = np.quantile(UNITS * recording.wrench, [0.01, 0.99], axis=0).T
        ranges.rows.append(
            [
                load,
                *(
                    f"{low:.{digits}f} to {high:.{digits}f}"
                    for (low, high), digits in zip(ends, [1, 1, 1, 0, 0, 0], strict=True)
                ),
            ]
        )
        figures["loads"][load] = _figures(ends.tolist())

    causes = Table(
        "Influences, with one change at a time:  random split, RMS error of Fz in N and of Mx and My in mNm",
        [
            "",
            "Fz: uniform",
            "+ end face",
            "+ lying",
            "Mx: uniform",
            "+ end face",
            "+ lying",
            "My: uniform",
            "+ end face",
            "+ lying",
        ],
    )
    for variant, of_variant in recordings.items():
        errors = {
            case: UNITS * error_of([of_variant[load] for load in CASES[case]], False, seed)
            for case in list(CASES)[:3]
        }
        causes.rows.append(
            [
                variant,
                *(f"{error[k]:.{DIGITS[k]}f}" for k in (2, 3, 4) for error in errors.values()),
            ]
        )
        figures["causes"][variant] = {case: _figures(error) for case, error in errors.items()}

    first = figures["rms"]["random split"]["uniform"]
    fz = [
        (value, value, value)
        for value in (of["uniform"]["Fz"] for of in figures["causes"].values())
    ]
    lying = [
        (value, value, value)
        for value in (of["uniform + lying"]["Fz"] for of in figures["causes"].values())
    ]
    return Result(
        title="Calibration of the nib pad",
        source='Table I and section IV-A of "Dynamically Reconfigurable Tactile Sensor for Robotic Manipulation", IEEE RA-L 2020',
        figures=figures,
        setup=[
            f"Data: new recordings of {SCENES['uniform']}, {SCENES['end face']} and {SCENES['lying']}, seed {seed}: 5,000 images of si or more each, electronics typical.",
            f"Fit: 703 coefficients per component on {FIT} rows. The ridge is the best of nine powers of ten on {CHOOSE} other rows of the training set, then both "
            f"sets are used for the fit; the test set has {TEST} rows. Several loads share these numbers in equal parts. The paper has 4000 and 1000 rows, and "
            "does not state how it limited 703 coefficients.",
            "Reference: the true forces on all nibs and their moments about the pad's origin, through the same mean of five images as si.",
        ],
        charts=[
            Chart(
                "What decides the error of Fz",
                "",
                "RMS error of Fz, N",
                [name.replace("k_tangential", "tangential stiffness") for name in VARIANTS],
                [Curve("fit of uniform loads", fz), Curve("fit of uniform and lying loads", lying)],
                joined=False,
            )
        ],
        tables=[main, asked, ranges, causes],
        real=[
            RealFigure(
                f"calibrated {name}, rms error, {'N' if k < 3 else 'N mm'}",
                PUBLISHED["paper: uniform"][k],
                first[name],
                "electronics assumed; random split of one recording",
            )
            for k, name in enumerate(COMPONENTS)
        ],
    )
