"""Section V.E of the piezo paper.

The delay of the FFT-GRU, relative to the position label and to the true first slip.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from slipbench_studies.piezo_fft_gru.bench import BENCH_LEVEL, PUBLISHED_SPECTRA, RULES, Recording
from slipbench_studies.piezo_fft_gru.networks import (
    GRU_32,
    SOURCE,
    USUAL_RECORDINGS,
    Validations,
    cell,
    figures_of,
    motors_right,
    on_all,
    on_slip,
    recordings_for,
    setup_of,
    size_of,
)
from slipbench_studies.result import Options, Result, Table
from slipbench_studies.statistics import mean_sd, quantile

NAME = "piezo-fft-gru/delay"


def alarm_delay(time: ArrayLike, called: ArrayLike, onset: float) -> float:
    """Time from `onset` to the start of the alarm.

    This is the alarm that is active at the onset, else the next one.

    It is negative for an active alarm. The paper's mean of 8.5 ms is computed this way: its delays
    may be negative.

    Args:
        time: [T] s, of each frame
        called: [T] 1: slip
        onset: s

    Returns:
        s; NaN: no active or later alarm
    """
    at, alarm = np.asarray(time), np.asarray(called) == 1
    frame = int(
        np.searchsorted(at, onset, "right")
    )  # the last complete frame determines the answer at the onset
    if frame > 0 and alarm[frame - 1]:
        silent = np.flatnonzero(~alarm[:frame])
        return float(at[silent[-1] + 1 if silent.size else 0] - onset)
    later = np.flatnonzero(alarm[frame:])
    return float(at[frame + later[0]] - onset) if later.size else math.nan


@dataclass
class Alarms:
    """Alarms over recordings.

    In `delay`, the first alarm of a recording decides, and an early one has no delay.

    Attributes:
        delay: s, of the recordings whose first alarm is at or after the onset
        near: s, alarm_delay() of the recordings with slip, if it exists
        early: number of recordings whose first alarm is before the onset
        missed: number of recordings with slip and without an alarm
        silent: number of recordings with slip and without alarm_delay()
        false_alarms: number of recordings without slip and with an alarm
        slipping: number of recordings with slip
        recordings: number of all recordings
    """

    delay: list[float] = field(default_factory=list)
    near: list[float] = field(default_factory=list)
    early: int = 0
    missed: int = 0
    silent: int = 0
    false_alarms: int = 0
    slipping: int = 0
    recordings: int = 0

    def add(self, time: ArrayLike, called: ArrayLike, onset: float) -> None:
        """Adds a recording.

        Args:
            time: [T] s, of each frame
            called: [T] 1: slip
            onset: s; NaN: no slip
        """
        self.recordings += 1
        alarms = np.asarray(time)[np.asarray(called) == 1]
        if math.isnan(onset):
            self.false_alarms += alarms.size > 0
            return
        self.slipping += 1
        if alarms.size == 0:
            self.missed += 1
        elif alarms[0] < onset:
            self.early += 1
        else:
            self.delay.append(float(alarms[0] - onset))
        near = alarm_delay(time, called, onset)
        if math.isnan(near):
            self.silent += 1
        else:
            self.near.append(near)

    def figures(self) -> dict[str, Any]:
        """Figures for the JSON of the study."""
        return {
            "first": spread_of(self.delay).json(),
            "early": self.early,
            "missed": self.missed,
            "slipping": self.slipping,
            "false_alarms": self.false_alarms,
            "near": spread_of(self.near).json(),
            "silent": self.silent,
        }

    def cells(self) -> list[str]:
        """The last six columns of the table of delays."""
        near = spread_of(self.near)
        mean = (
            f"{1e3 * near.mean:.1f} +- {1e3 * near.sd:.1f}, {1e3 * near.greatest:.0f}"
            if self.near
            else "-"
        )
        early, missed, silent = (
            share(part, self.slipping) for part in (self.early, self.missed, self.silent)
        )
        return [spread_of(self.delay).cell(), early, missed, near.cell(), mean, silent]


class Spread(NamedTuple):
    """Statistics of times, s. NaN for too few times."""

    mean: float
    sd: float
    median: float
    p10: float
    p90: float
    greatest: float

    def json(self) -> dict[str, float]:
        """Figures by name, with the unit."""
        return {f"{name}_s": value for name, value in self._asdict().items()}

    def cell(self) -> str:
        """Median, 10 and 90 % in ms, as "12 (3 to 40)"; "-" without times."""
        text = f"{1e3 * self.median:.0f} ({1e3 * self.p10:.0f} to {1e3 * self.p90:.0f})"
        return "-" if math.isnan(self.median) else text


def spread_of(times: Sequence[float]) -> Spread:
    """Statistics of times, s."""
    return Spread(
        *mean_sd(times),
        quantile(times, 0.5),
        quantile(times, 0.1),
        quantile(times, 0.9),
        max(times, default=math.nan),
    )


def share(part: int, whole: int) -> str:
    """As "3 of 100"."""
    return f"{part} of {whole}"


def label_table(recordings: Iterable[Recording]) -> tuple[Table, dict[str, Any]]:
    """Lead of the position label over the true first slip.

    Args:
        recordings: recordings of the bench

    Returns:
        the table and its figures
    """
    times = [(one.label_time, one.slip_time) for one in recordings]
    early = [
        slip - label for label, slip in times if not math.isnan(label) and not math.isnan(slip)
    ]
    no_slip = sum(math.isnan(slip) and not math.isnan(label) for label, slip in times)
    no_label = sum(math.isnan(label) and not math.isnan(slip) for label, slip in times)
    spread = spread_of(early)
    mean = f"{1e3 * spread.mean:.1f} +- {1e3 * spread.sd:.1f}" if early else "-"
    table = Table(
        "The position label itself: how long before the true first slip it begins, ms",
        ["median (10 to 90 %)", "mean +- sd", "labelled, no slip", "slip, not labelled"],
        [[spread.cell(), mean, str(no_slip), str(no_label)]],
    )
    return table, {
        "early": spread.json(),
        "recordings": len(early),
        "labelled_without_slip": no_slip,
        "slip_without_label": no_label,
    }


def study(options: Options) -> Result:
    """piezo-fft-gru/delay.

    Args:
        options: data, trials, full, seed, jobs, output, resume

    Returns:
        delays of the FFT-GRU by both labels, and the lead of the position label

    Raises:
        InputError: as size_of() and recordings_for(), or for saved networks of another run
    """
    size = size_of(options, USUAL_RECORDINGS)
    recordings = recordings_for(options, size, [BENCH_LEVEL], [PUBLISHED_SPECTRA])
    validations = Validations(options, size)
    asked = {rule: validations.queue_folds(recordings, GRU_32, rule) for rule in RULES}
    validations.run(NAME)

    delays = Table(
        "Delay, ms: median (10 to 90 %)",
        [
            "learnt by",
            "counted from",
            "first alarm",
            "early",
            "missed",
            "alarm at or after",
            "mean +- sd, greatest",
            "none",
        ],
        [
            [
                "paper",
                "position label",
                "-",
                "-",
                "-",
                "-",
                "8.5 +- 23.7, 58",
                "7 of 3,200 recordings",
            ]
        ],
        note="First alarm: the first frame of a recording that is classified as slip decides. If it is before the instant from which the delay counts, it "
        "is early and has no delay. Alarm at or after: the beginning of the alarm that is active at that instant, which gives a negative delay, or of "
        "the first alarm after it.",
    )
    frames = Table(
        "The same networks by frame",
        [
            "learnt and judged by",
            "all recordings",
            "with contact",
            "motors alone, % right",
            "motors alone, false alarms",
        ],
        [["paper, position label", "98.7, -", "98.2, 0.978", "99.9", "-"]],
    )
    figures: dict[str, Any] = {}
    for rule, number in asked.items():
        name, calls, counts = (
            f"{RULES[rule]} label",
            validations.calls(number),
            validations.counts(number),
        )
        labelled, true = Alarms(), Alarms()
        for one, called in zip(recordings, calls, strict=True):
            labelled.add(one.time, called, one.label_time)
            true.add(one.time, called, one.slip_time)
        delays.rows += [
            [name, "position label", *labelled.cells()],
            [name, "true first slip", *true.cells()],
        ]
        alarms = share(true.false_alarms, true.recordings - true.slipping)
        frames.rows.append(
            [
                name,
                on_all(counts).cell(),
                on_slip(counts).cell(),
                cell(motors_right(counts)),
                alarms,
            ]
        )
        figures[RULES[rule]] = {
            "from_position_label": labelled.figures(),
            "from_true_slip": true.figures(),
            "frames": figures_of(counts),
        }
    label, figures["label"] = label_table(recordings)
    return Result(
        title="Delay with which the FFT-GRU detects a slip of the piezoelectric skin",
        source=f"Section V.E of {SOURCE}",
        figures=figures,
        tables=[delays, label, frames],
        setup=setup_of(options, size, len(recordings)),
        remarks=[
            "The paper's delay counts from its own label, which reports slip as soon as the bench moves by more than 10 um in 10 ms, while the layer still "
            "shears before it slips. A detector that follows this label reports slip too early.",
            "A frame is complete every 10 ms, so a delay is 5 ms longer on average for any network.",
        ],
    )
