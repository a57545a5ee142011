"""Slip against hold by the power of one frame, by the motors' level.

The area under the curve, and the frames that are confused.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.signal.windows import hann
from slipbench import InputError, Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.piezo_fft_gru import SCENE
from slipbench_studies.result import Chart, Curve, Options, Result, Table
from slipbench_studies.statistics import Auc, auc, quantile

RATE, WINDOW, HOP = 10e3, 200, 100  # Hz, samples: frames of 20 ms every 10 ms
LOW, HIGH = 50.0, 600.0  # Hz
STIFFNESS = 20e3  # N/m of the scene's sensor along the normal
STILL_SPEED = 1e-9  # m/s, limit for the bench at rest
SETTLING_TIME = 3.0 / (2.0 * math.pi * 3.0)  # s, three time constants of the amplifier's 3 Hz
LIGHT_PRESS = 4.0  # N, below a quarter of the published 2 to 10
SLOW_SLIDE = 10e-3  # m/s, below a fifth of the published 3.3 to 33 mm/s
LEVELS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0)
USUAL_RECORDINGS = 120  # per level
WANTED_AREA = 0.95  # required area without motors
# Steps from a frame to its spectrum after subtracting the mean: plain, as in the paper, which names
# no taper; minus the least-squares line; with a Hann taper.
SPECTRA = ("plain", "detrended", "hann")

# Benches that differ in one setting, without motors: text and overrides.
BENCHES = {
    "deaf_direction": (
        "slides along 135 deg, whose shear generates no charge",
        {"motion.direction": "135 deg"},
    ),
    "fast_press": (
        "pressed on at 2 mm/s instead of 0.7",
        {
            "sweep.motion": "[{clearance: 0 mm, approach_speed: 2 mm/s}, {clearance: 5 mm, approach_speed: 20 mm/s, strokes: 10}]"
        },
    ),
}


@dataclass(frozen=True)
class Reading:
    """Definition of slip and hold of a frame, and of its loudness.

    Attributes:
        text: text in the tables
        spectrum: one of SPECTRA
        by_position: True: label by the 100 Hz position, the paper's; False: a part slips
        one_label: True: only frames with a constant label
    """

    text: str
    spectrum: str = "plain"
    by_position: bool = False
    one_label: bool = False

    def slips(self, frames: pd.DataFrame) -> NDArray[np.bool_]:
        """[F] True for each frame of slip."""
        return np.asarray(frames["slips_by_position" if self.by_position else "slips"].to_numpy())

    def counts(self, frames: pd.DataFrame) -> NDArray[np.bool_]:
        """[F] True for each frame that counts."""
        return (
            frames["one_label"].to_numpy() if self.one_label else np.ones(len(frames), dtype=bool)
        )


# The paper's spectrum first, then the others in SPECTRA, then other labels.
READINGS = {
    "paper": Reading("as in the paper: mean subtracted, no taper named; true label"),
    "detrended": Reading("straight line of each frame off", "detrended"),
    "hann": Reading("Hann's taper", "hann"),
    "one_label": Reading("mean off; frames of one label only", one_label=True),
    "hann_one_label": Reading("Hann's taper; frames of one label only", "hann", one_label=True),
    "position": Reading("as in the paper, label by the 100 Hz position", by_position=True),
    "detrended_position": Reading(
        "straight line subtracted, label by the 100 Hz position", "detrended", by_position=True
    ),
    "hann_position": Reading(
        "Hann's taper, label by the 100 Hz position", "hann", by_position=True
    ),
}

# A frame has the first cause in the list that applies.
HOLD_CAUSES = {
    "stick_between_slips": (
        "a part slipped within the frame, all sticks at its end",
        lambda frames: frames["slipped"],
    ),
    "press": ("the tip is pressed on", lambda frames: frames["pressed"]),
    "shear": (
        "the bench moves, and shear builds up before the slip",
        lambda frames: frames["slid"],
    ),
    "settling": (
        "at rest for less than 159 ms, while the amplifier settles",
        lambda frames: frames["still"] < SETTLING_TIME,
    ),
    "rest": ("at rest for longer", lambda frames: frames["still"] > -1.0),
}
SLIP_CAUSES = {
    "starts_or_stops": (
        "the bench accelerates, brakes or stands (below 0.9 of its speed)",
        lambda frames: ~frames["at_speed"],
    ),
    "slow_and_light": (
        "slower than 10 mm/s and below 4 N",
        lambda frames: (frames["speed"] < SLOW_SLIDE) & (frames["force"] < LIGHT_PRESS),
    ),
    "slow": ("slower than 10 mm/s", lambda frames: frames["speed"] < SLOW_SLIDE),
    "light": ("below 4 N", lambda frames: frames["force"] < LIGHT_PRESS),
    "other": ("faster and heavier", lambda frames: frames["speed"] > -1.0),
}


def band_power(windows: NDArray[Any], tapered: bool) -> NDArray[np.float64]:
    """Power within 50 to 600 Hz, both included, of frames minus their mean.

    Args:
        windows: [F, WINDOW] counts
        tapered: True: apply a Hann window

    Returns:
        [F] counts^2
    """
    taper = hann(WINDOW, sym=False) if tapered else np.ones(WINDOW)
    values = windows.astype(float)
    spectrum = np.fft.rfft((values - values.mean(axis=1, keepdims=True)) * taper, axis=1)
    width = RATE / WINDOW
    kept = spectrum[:, round(LOW / width) : round(HIGH / width) + 1]
    return np.asarray(2.0 * (np.abs(kept) ** 2).sum(axis=1) / (RATE * (taper @ taper)) * width)


def without_trend(windows: NDArray[Any]) -> NDArray[np.float32]:
    """Frames minus their least-squares line.

    Args:
        windows: [F, N] counts

    Returns:
        [F, N] counts
    """
    t = np.arange(windows.shape[1]) - 0.5 * (windows.shape[1] - 1)
    values = windows.astype(float)
    slope = values @ t / (t @ t)
    return np.asarray(
        values - values.mean(axis=1, keepdims=True) - slope[:, None] * t, dtype=np.float32
    )


def frames_of(trial: Trial) -> pd.DataFrame:
    """The frames of a recording of SCENE.

    Args:
        trial: a full record

    Returns:
        one row per frame. Power by each of SPECTRA [counts^2]. Of its last sample: contact, slips
        (of a part), slips_by_position, at_speed (nine tenths of the slide's or more). Of any
        sample: slipped, pressed and slid (the bench moves along the normal, along the surface).
        one_label: all samples have the same label. still: time [s] from the last motion of the
        bench to the frame's end, infinite before any motion. Of the recording: force [N], stiffness
        times compression, and speed [m/s] of the slide
    """
    sensor, labels = trial.sensors["pad"], trial.labels["pad"]
    micro, paper, time = labels.state_micro, labels.state_paper, sensor.t
    signal = sensor.channels["signal"].reshape(-1)
    force, speed = STIFFNESS * trial.params["motion.compression"], trial.params["motion.speed"]
    velocity = [body.velocity for body in trial.bodies.values()]
    normal = np.max([np.abs(one[:, 2].astype(float)) for one in velocity], axis=0)
    sideways = np.max(
        [np.hypot(one[:, 0].astype(float), one[:, 1].astype(float)) for one in velocity], axis=0
    )
    ends = np.arange(WINDOW, len(signal) + 1, HOP)
    last = ends - 1
    rows = ends[:, None] - WINDOW + np.arange(WINDOW)
    windows, touches, slips = signal[rows], micro > 0, micro > 1
    moves = np.where(np.maximum(normal, sideways) > STILL_SPEED, np.arange(len(normal)), -1)
    moved = np.maximum.accumulate(moves)[last]
    return pd.DataFrame(
        {
            "plain": band_power(windows, False),
            "detrended": band_power(without_trend(windows), False),
            "hann": band_power(windows, True),
            "contact": touches[last],
            "slips": slips[last],
            "slips_by_position": paper[last] > 1,
            "at_speed": sideways[last] >= 0.9 * speed,
            "one_label": (
                (touches[rows] == touches[last][:, None]) & (slips[rows] == slips[last][:, None])
            ).all(axis=1),
            "slipped": slips[rows].any(axis=1),
            "pressed": (normal > STILL_SPEED)[rows].any(axis=1),
            "slid": (sideways > STILL_SPEED)[rows].any(axis=1),
            "still": np.where(moved < 0, math.inf, time[last] - time[np.maximum(moved, 0)]),
            "force": force,
            "speed": speed,
        }
    )


def separation(
    frames: pd.DataFrame, spectrum: str, slip: NDArray[np.bool_], hold: NDArray[np.bool_]
) -> Auc | None:
    """Separation of frames of slip and of hold by loudness.

    Args:
        frames: frames of all recordings, with the number of their `recording`
        spectrum: one of SPECTRA
        slip: [F] mask of slip
        hold: [F] mask of hold

    Returns:
        the area with its interval by recording; None if one kind has no frames
    """
    if not slip.any() or not hold.any():
        return None
    power, recording = frames[spectrum].to_numpy(), frames["recording"].to_numpy()
    return auc(power[slip], power[hold], recording[slip], recording[hold])


class Separations(NamedTuple):
    """Areas of slip against all hold, against hold in contact, and against hold in the air."""

    pooled: Auc | None
    contact: Auc | None
    air: Auc | None

    def figures(self) -> dict[str, Any]:
        """Figures by name; None if one kind has no frames."""
        return {
            name: None
            if one is None
            else {
                "auc": one.value,
                "interval_95": one.interval,
                "slip_frames": one.positives,
                "hold_frames": one.negatives,
            }
            for name, one in zip(self._fields, self, strict=True)
        }

    def row(self, name: str) -> list[str]:
        """A row of area_table()."""
        return [
            name,
            *(
                cell
                for one in self
                for cell in (
                    area_cell(one),
                    "-" if one is None else f"{one.interval[0]:.3f} to {one.interval[1]:.3f}",
                )
            ),
        ]


def separations(frames: pd.DataFrame, reading: Reading) -> Separations:
    """Computes the areas of a bench.

    Args:
        frames: as for separation()
        reading: definition of slip, hold and loudness

    Returns:
        the three areas
    """
    counts, slips, contact = (
        reading.counts(frames),
        reading.slips(frames),
        frames["contact"].to_numpy(),
    )
    hold = counts & ~slips
    return Separations(
        *(
            separation(frames, reading.spectrum, counts & slips, some)
            for some in (hold, hold & contact, hold & ~contact)
        )
    )


class CauseFigures(NamedTuple):
    """The frames in contact with a given cause, against all frames in contact of the other class.

    Attributes:
        frames: number of frames
        share: share of the frames of all causes
        rms: counts, median, by the plain spectrum; NaN without frames
        area: by SPECTRA
        missing: by SPECTRA, contribution to the deficit of the area of all causes from 1, as a
            share of the deficit: an area is a mean over frames, so the shares sum to 1
    """

    frames: int
    share: float
    rms: float
    area: dict[str, Auc | None]
    missing: dict[str, float]


def cause_figures(
    frames: pd.DataFrame, causes: Mapping[str, Any], of_slip: bool
) -> dict[str, CauseFigures]:
    """Computes the figures of each cause.

    Args:
        frames: as for separation()
        causes: HOLD_CAUSES or SLIP_CAUSES
        of_slip: True for causes of slip

    Returns:
        figures by name
    """
    contact, slips = frames["contact"].to_numpy(), frames["slips"].to_numpy()
    asked, other = contact & (slips == of_slip), contact & (slips != of_slip)
    cause = np.select(
        [fits(frames).to_numpy() for _, fits in causes.values()], list(range(len(causes))), -1
    )

    def area(some: NDArray[np.bool_], spectrum: str) -> Auc | None:
        return (
            separation(frames, spectrum, some, other)
            if of_slip
            else separation(frames, spectrum, other, some)
        )

    whole = {spectrum: area(asked, spectrum) for spectrum in SPECTRA}
    figures = {}
    for number, name in enumerate(causes):
        own = asked & (cause == number)
        share = float(own.sum() / asked.sum()) if asked.any() else math.nan
        found = {spectrum: area(own, spectrum) for spectrum in SPECTRA}
        missing = {}
        for spectrum, one in found.items():
            all_of_it = whole[spectrum]
            lacks = 0.0 if all_of_it is None else 1.0 - all_of_it.value
            missing[spectrum] = (
                share * (1.0 - one.value) / lacks if one is not None and lacks > 0.0 else 0.0
            )
        figures[name] = CauseFigures(
            int(own.sum()),
            share,
            math.sqrt(quantile(frames["plain"].to_numpy()[own], 0.5)) if own.any() else math.nan,
            found,
            missing,
        )
    return figures


def area_cell(found: Auc | None) -> str:
    """The area; "-" for None."""
    return "-" if found is None else f"{found.value:.3f}"


def area_table(title: str, first: str, note: str = "") -> Table:
    """A table for the rows of Separations.row()."""
    return Table(
        title,
        [
            first,
            "all hold",
            "95 %",
            "hold in contact alone",
            "95 %",
            "hold in the air alone",
            "95 %",
        ],
        note=note,
    )


def _reading_names() -> dict[str, str]:
    """For each of SPECTRA the reading with that spectrum and the true label."""
    return dict(zip(SPECTRA, READINGS, strict=False))


def cause_table(
    frames: pd.DataFrame, causes: Mapping[str, Any], of_slip: bool
) -> tuple[Table, dict[str, Any]]:
    """Table of causes, and its figures.

    Args:
        frames: without motors
        causes: HOLD_CAUSES or SLIP_CAUSES
        of_slip: True for causes of slip

    Returns:
        both
    """
    table = Table(
        "Slip that is classified as hold in contact, without motors"
        if of_slip
        else "Hold in contact that is classified as slip, without motors",
        [
            "frames in which",
            "frames",
            "share",
            "rms, counts, median",
            "AUC",
            "of what is missing from 1",
            "line off: AUC",
            "of what is missing",
            "Hann: AUC",
            "of what is missing",
        ],
        note=""
        if of_slip
        else "A frame has the first cause that applies. The area is a mean over frames, so the contributions of the causes to "
        "its deficit from 1 add up. In the published ranges no slide is without a signal, because all slides are along X.",
    )
    figures = {}
    for name, cause in cause_figures(frames, causes, of_slip).items():
        cells = [
            cell
            for spectrum in SPECTRA
            for cell in (
                area_cell(cause.area[spectrum]),
                f"{100.0 * cause.missing[spectrum]:.0f} %",
            )
        ]
        table.rows.append(
            [
                causes[name][0],
                str(cause.frames),
                f"{100.0 * cause.share:.1f} %",
                "-" if math.isnan(cause.rms) else f"{cause.rms:.1f}",
                *cells,
            ]
        )
        areas = {}
        for spectrum, reading in _reading_names().items():
            found = cause.area[spectrum]
            areas[reading] = {
                "auc": None if found is None else found.value,
                "share_of_missing": cause.missing[spectrum],
            }
        figures[name] = {"frames": cause.frames, "share": cause.share, **areas}
    return table, figures


def remarks_on(curve: Mapping[str, Any], causes: Mapping[str, Any]) -> list[str]:
    """Remarks with the numbers of the current run.

    Args:
        curve: areas of the paper's reading by level
        causes: figures of HOLD_CAUSES

    Returns:
        one or two sentences each
    """

    def text(value: float | None) -> str:
        return "-" if value is None else f"{value:.3f}"

    def along(against: str) -> str:
        return ", ".join(
            text(None if one[against] is None else one[against]["auc"]) for one in curve.values()
        )

    def missing(cause: str) -> float:
        return 100.0 * float(causes[cause]["paper"]["share_of_missing"])

    def areas(cause: str) -> str:
        return ", ".join(
            text(causes[cause][reading]["auc"]) for reading in _reading_names().values()
        )

    return [
        "The motors run while the tip slides. In half of the recordings another motor, which does not move the tip, runs from a random instant on. From "
        f"level {LEVELS[0]:g} to {LEVELS[-1]:g} the area is {along('contact')} against hold in contact, and {along('air')} against hold in the air.",
        f"A steady press is a constant after the amplifier. When it begins and ends, the signal decays with {1000.0 * SETTLING_TIME / 3.0:.0f} ms: over 20 ms nearly a straight line, which"
        f" leaks into all bins of a window without a taper. Without motors, pressing and settling are {missing('press'):.0f} and {missing('settling'):.0f} % of the deficit of hold in contact; their"
        f" areas as in the paper, with the line subtracted and with Hann's taper: {areas('press')}; {areas('settling')}.",
        f"Instants of a slide at which all sticks lie within frames of its vibration: {missing('stick_between_slips'):.0f} % of the deficit, areas {areas('stick_between_slips')}. By the position label they are slip, "
        "and so is the shear before the first slip.",
    ]


def point_of(found: Auc | None) -> tuple[float, float, float]:
    """A point of a curve; one half for None."""
    return (0.5, 0.5, 0.5) if found is None else (found.value, *found.interval)


def joined(recordings: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """Concatenates the frames of recordings, with the number of each `recording`."""
    return pd.concat(
        [frames.assign(recording=number) for number, frames in enumerate(recordings)],
        ignore_index=True,
    )


def study(options: Options) -> Result:
    """piezo-fft-gru/slip_against_hold.

    Args:
        options: trials, seed, jobs

    Returns:
        areas by the motors' level, and the confused frames

    Raises:
        InputError: for an odd number of recordings, or fewer than four
    """
    count = options.trials or USUAL_RECORDINGS
    if count < 4 or count % 2:
        raise InputError(
            f"reproduce: --trials {count}: half of the recordings of a level have contact, and an interval needs two; allowed: even numbers, "
            "4 or more"
        )
    cells = [
        Cell(f"motor level {level:g}", SCENE, {"motion.vibration": f"{level:g}"}, count // 2)
        for level in LEVELS
    ]
    cells += [
        Cell(text, SCENE, {"motion.vibration": "0", **overrides}, count // 2)
        for text, overrides in BENCHES.values()
    ]
    runs = [
        joined(recordings)
        for recordings in run_grid(cells, options, lambda _, trial: frames_of(trial))
    ]
    silent = runs[0]

    areas = {
        reading: {
            f"{level:g}": separations(frames, one)
            for level, frames in zip(LEVELS, runs, strict=False)
        }
        for reading, one in READINGS.items()
    }
    curve = area_table(
        "Area under the curve against the motors' level",
        "motor level",
        f"The line is at {WANTED_AREA}, the required area at level 0. Intervals are by recording (Obuchowski), because the frames of one recording "
        "depend on each other.",
    )
    curve.rows = [one.row(level) for level, one in areas["paper"].items()]
    chart = Chart(
        "Slip against hold by one frame",
        "level of the motors' vibration (motion.vibration, without a unit)",
        "area under the ROC curve",
        list(areas["paper"]),
        [
            Curve(name, [point_of(one[k]) for one in areas["paper"].values()])
            for k, name in enumerate(("all hold", "in contact alone", "in the air alone"))
        ],
        bar=WANTED_AREA,
        bar_name="bar at level 0",
    )
    readings = area_table(
        "Other readings of the paper, no motors",
        "reading of a frame",
        "The curve shows the first row: the spectrum of the paper, which states that the mean is subtracted and names no taper, with the "
        'true label. The row with the position label is the reading of the paper. The others are alternatives. "Frames of one label" '
        "omits frames within which contact or slip begins or ends.",
    )
    readings.rows = [areas[name]["0"].row(one.text) for name, one in READINGS.items()]
    hold, hold_figures = cause_table(silent, HOLD_CAUSES, False)
    slip, slip_figures = cause_table(silent, SLIP_CAUSES, True)
    benches = area_table("What the bench decides, no motors", "bench")
    benches.rows.append(areas["paper"]["0"].row("as above"))
    bench_figures: dict[str, dict[str, Any]] = {}
    for (name, (text, _)), frames in zip(BENCHES.items(), runs[len(LEVELS) :], strict=True):
        bench_figures[name] = {}
        for (spectrum, reading), suffix in zip(
            _reading_names().items(), ("", "; line off", "; Hann's taper"), strict=True
        ):
            found = separations(frames, Reading("", spectrum))
            bench_figures[name][reading] = found.figures()
            benches.rows.append(found.row(text + suffix))
    curves = {
        reading: {level: one.figures() for level, one in by_level.items()}
        for reading, by_level in areas.items()
    }
    return Result(
        title="Slip against hold by the power of one frame of the piezoelectric skin",
        source='The frames of "Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor", section IV-A: 20 ms '
        "every 10 ms at 10 kHz, 50 to 600 Hz. The paper prints no such curve.",
        figures={
            "curve": curves,
            "hold_causes": hold_figures,
            "slip_causes": slip_figures,
            "bench": bench_figures,
        },
        charts=[chart],
        tables=[curve, readings, hold, slip, benches],
        setup=[
            f"{count} recordings per level from {SCENE}, half of them with a slip, seed {options.draws_seed}: the same draws at every level.",
            "Power: within 50 to 600 Hz, both included, of the frame minus its mean. The label of a frame is that of its last sample; slip means that a "
            "part of the contact slips (rule micro), so that a frame of partial slip is slip.",
        ],
        remarks=remarks_on(curves["paper"], hold_figures),
    )
