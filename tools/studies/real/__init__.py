"""Detectors and yardsticks on public recordings of real sensors."""

from __future__ import annotations

import json
import math
import re
import tempfile
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import slipbench
from slipbench import InputError
from slipbench._program import counted
from slipbench.bin import _core
from slipbench_studies.real.answers import (
    FEWEST,
    STEADY,
    Answer,
    answers_of,
    left_out,
    steady,
    summary,
)
from slipbench_studies.real.sets import SETS, RealSet
from slipbench_studies.result import Chart, Curve, Options, Result, Table

YARDSTICKS = ("deviation", "relative_deviation", "shear_ratio", "sum_change")
# Other detectors of the catalogue that read the channels of a sensor.
CATALOGUE = {
    "papillarray": ("force_ratio", "shear_rate", "gst_hd"),
    "taxels": ("force_ratio", "shear_rate"),
}
CHOSEN = ", chosen threshold"  # behind the name of a yardstick
HEAD = [
    "detector",
    "AUC",
    "AUC, steady",
    "balanced accuracy",
    "slips found",
    "false alarms per minute",
    "delay",
    "threshold",
]


@dataclass
class Recordings:
    """A set that was found.

    Attributes:
        about: its entry of SETS
        folders: files and folders that were imported
        dataset: path of the imported dataset
        sensors: names of its sensors
        recording: recording of each trial
        object: object of each trial; empty: unknown
    """

    about: RealSet
    folders: list[Path]
    dataset: str
    sensors: list[str] = field(default_factory=list)
    recording: dict[int, str] = field(default_factory=dict)
    object: dict[int, str] = field(default_factory=dict)

    @property
    def objects(self) -> list[str]:
        """Names of the objects."""
        return sorted(set(self.object.values()) - {""})


@dataclass(frozen=True)
class Row:
    """A detector on a set.

    Attributes:
        detector: its name, or that of its file
        figures: summary() with groups by recording; empty: it could not run
        threshold: default threshold of a yardstick, as it ships; NaN: another detector, or `thresholds`
        by_object: (lowest, highest) of figures over objects, or intervals by object, with the key
            "interval"
        thresholds: of the yardstick, in its unit, chosen on other recordings; empty: the detector's
            own
        notice: how the recordings were resampled for it; empty: they were not
        failure: why it could not run; empty: it did
    """

    detector: str
    figures: dict[str, Any] = field(default_factory=dict)
    threshold: float = math.nan
    by_object: dict[str, Any] = field(default_factory=dict)
    thresholds: list[float] = field(default_factory=list)
    notice: str = ""
    failure: str = ""


def imported(about: RealSet, folders: list[Path], target: Path) -> Recordings:
    """Imports a set.

    Args:
        about: the set
        folders: files and folders
        target: folder for the dataset

    Returns:
        the recordings

    Raises:
        InputError: the program's own message
    """
    dataset = str(target / f"{about.name}.h5")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the recordings, which `slipbench import` shows
        slipbench.import_recordings(list(folders), dataset, format=about.format, map=about.map)
    found = Recordings(about, folders, dataset)
    with slipbench.open(dataset, check=False) as data:
        found.sensors = list(data[data.trials[0]].sensors)
        for trial in data.trials:
            params = data[trial].params
            found.recording[trial] = about.recording(params, folders)
            found.object[trial] = about.object(params, folders)
    return found


def reason_of(message: str, detector: str) -> str:
    """The message of `detect` without the names of the temporary dataset and of the detector."""
    text = re.sub(r"^.*?: trial \d+: ", "", message.replace("\n", " "))
    return re.sub(r"^detector\.(model|sensor): ", "", text).removeprefix(f"{detector}: ")


def shipped_networks(sensor: str) -> list[Path]:
    """The networks of scenes/learn that read this type of sensor."""
    folder = Path(_core.project_file("scenes")) / "learn"
    return [
        path
        for path in sorted(folder.glob("*.onnx"))
        if json.loads(_core.Engine(str(path)).description)["input"]["sensor"] == sensor
    ]


def judged(answers: Sequence[Answer], groups: Sequence[str]) -> dict[str, Any]:
    """summary() with the figure auc_steady: the AUC of the samples that steady() keeps."""
    found = summary(answers, groups)
    found["figures"]["auc_steady"] = summary([steady(one) for one in answers], groups)["figures"][
        "auc"
    ]
    return found


def evaluated(recordings: Recordings, detector: str, yardstick: bool) -> list[Row]:
    """Runs a detector on a set.

    Recordings that are slower than a network reads are interpolated, as with `--resample`, and long
    gaps for every detector.

    Args:
        recordings: the set
        detector: name or file
        yardstick: True: evaluated twice, at its default threshold and, if the labels of the set have
            both classes, at one that is chosen on other objects, or recordings if there are no objects

    Returns:
        its rows
    """
    name = Path(detector).name
    answers: list[Answer] = []
    notice = ""
    own = math.nan  # threshold of a yardstick, at which its score s/(s + threshold) is 0.5
    for sensor in recordings.sensors:
        try:
            detected = slipbench.detect(detector, recordings.dataset, sensor=sensor, resample=True)
        except InputError as error:
            return [Row(name, failure=reason_of(str(error), detector))]
        answers += answers_of(detected)
        # The table states the thresholds of yardsticks.
        notice = notice or re.sub(
            r"(; )?the default threshold of [^;]*; choose [^;]*", "", str(detected["notice"])
        ).replace(f" for {name}", "")
        own = detected["detector"]["parameters"].get("threshold", own)
    if not any(len(one.labels) and one.known.any() for one in answers):
        alarms = sum(int(((one.seen[1:] >= 2) & (one.seen[:-1] < 2)).sum()) for one in answers)
        minutes = sum(one.time[-1] - one.time[0] for one in answers) / 60.0
        return [
            Row(
                name,
                {"alarms": alarms, "minutes": minutes},
                own if yardstick else math.nan,
                notice=notice,
            )
        ]

    def row(title: str, some: list[Answer], threshold: float, thresholds: list[float]) -> Row:
        figures = judged(some, [recordings.recording[one.trial] for one in some])
        return Row(title, figures, threshold, by_object(some, recordings), thresholds, notice)

    rows = [row(name, answers, own if yardstick else math.nan, [])]
    slips = sum(int(one.slips.sum()) for one in answers)
    if not yardstick or slips in (0, sum(int(one.known.sum()) for one in answers)):
        return rows
    objects = recordings.objects
    groups = [
        recordings.object[one.trial] if len(objects) > 1 else recordings.recording[one.trial]
        for one in answers
    ]
    chosen, thresholds = left_out(answers, groups)
    if not chosen:
        return [
            *rows,
            Row(
                name + CHOSEN,
                failure="no threshold: the other recordings have no labelled hold, or no labelled slip",
            ),
        ]
    return [
        *rows,
        row(
            name + CHOSEN,
            chosen,
            math.nan,
            [own * one / (1.0 - one) for one in thresholds if not math.isnan(one)],
        ),
    ]


def by_object(answers: Sequence[Answer], recordings: Recordings) -> dict[str, Any]:
    """Figures by object: intervals for FEWEST objects or more, else lowest and highest value.

    Args:
        answers: of the set
        recordings: the set

    Returns:
        (low, high) by the name of the figure, and "interval": bool; empty for a single object
    """
    names = [recordings.object[one.trial] for one in answers]
    objects = sorted(set(names) - {""})
    if len(objects) < 2:
        return {}
    if len(objects) >= FEWEST:
        found = judged(answers, names)["figures"]
        return {key: (value["low"], value["high"]) for key, value in found.items()} | {
            "interval": True
        }
    each = [
        judged(some, [recordings.recording[one.trial] for one in some])["figures"]
        for some in (
            [one for one, name in zip(answers, names, strict=True) if name == its]
            for its in objects
        )
    ]
    ranges: dict[str, Any] = {"interval": False}
    for key in each[0]:
        values = [one[key]["value"] for one in each if one[key]["value"] is not None]
        if values:
            ranges[key] = (min(values), max(values))
    return ranges


def _share(value: float) -> str:
    return f"{100.0 * value:.1f} %"


def _seconds(value: float) -> str:
    return f"{value:.2f} s"


FORMATS = {
    "auc": "{:.3f}".format,
    "auc_steady": "{:.3f}".format,
    "balanced_slip_accuracy": _share,
    "slips_found": _share,
    "false_alarms_per_minute": "{:.1f}".format,
    "slip_delay_median_s": _seconds,
    "recall_of_slip": _share,
    "false_alarm_share": _share,
}
ONE_CLASS_HEAD = [
    "detector",
    "slips found",
    "slip samples called slip",
    "hold samples called slip",
    "false alarms per minute",
    "threshold",
]


def cell(figure: Any, key: str) -> str:
    """A figure with its interval, such as "0.916 [0.870, 0.951]"; "-" if it is undefined."""
    if figure["value"] is None:
        return "-"
    text = FORMATS[key](figure["value"])
    return (
        text
        if figure["low"] is None
        else f"{text} [{FORMATS[key](figure['low'])}, {FORMATS[key](figure['high'])}]"
    )


def threshold_text(row: Row) -> str:
    """The threshold of a yardstick, or where the detector's comes from."""
    if not row.thresholds:
        return "its own" if math.isnan(row.threshold) else f"{row.threshold:.3g}, default"
    low, high = min(row.thresholds), max(row.thresholds)
    return f"{low:.3g}" if f"{low:.3g}" == f"{high:.3g}" else f"{low:.3g} to {high:.3g}"


def row_cells(row: Row) -> list[str]:
    """The cells of a judged detector, in the order of HEAD."""
    figures = row.figures["figures"]
    return [
        row.detector,
        *(cell(figures[key], key) for key in ("auc", "auc_steady", "balanced_slip_accuracy")),
        found_text(row),
        *(cell(figures[key], key) for key in ("false_alarms_per_minute", "slip_delay_median_s")),
        threshold_text(row),
    ]


def found_text(row: Row) -> str:
    """The share of slips that are found, of how many."""
    found = cell(row.figures["figures"]["slips_found"], "slips_found")
    return found if found == "-" else f"{found} of {row.figures['slips']}"


def has_both_classes(row: Row) -> bool:
    """True if the labels of the samples contain slip and hold."""
    return row.figures["figures"]["balanced_slip_accuracy"]["value"] is not None


def one_class_cells(row: Row) -> list[str]:
    """The cells of a judged detector, in the order of ONE_CLASS_HEAD."""
    figures = row.figures["figures"]
    return [
        row.detector,
        found_text(row),
        *(
            cell(figures[key], key)
            for key in ("recall_of_slip", "false_alarm_share", "false_alarms_per_minute")
        ),
        threshold_text(row),
    ]


def notices_text(rows: Sequence[Row]) -> str:
    """How recordings were resampled for detectors, as sentences after a blank."""
    return "".join(f" {row.detector}: {row.notice}." for row in rows if row.notice)


def tables_of(recordings: Recordings, rows: Sequence[Row]) -> list[Table]:
    """The tables of a set: figures by recording, by object, and what could not run.

    Args:
        recordings: the set
        rows: networks, detectors of the catalogue and yardsticks

    Returns:
        the tables that have rows
    """
    about, objects = recordings.about, recordings.objects
    groups = len(set(recordings.recording.values()))
    one_class = [row for row in rows if "figures" in row.figures and not has_both_classes(row)]
    with_figures = [row for row in rows if "figures" in row.figures and has_both_classes(row)]
    tables = []
    if one_class:
        tables.append(
            Table(
                f"{about.name}: {counted(groups, 'recording')} with one class",
                ONE_CLASS_HEAD,
                [one_class_cells(row) for row in one_class],
                f"{about.repository}; slip is known {about.known}. All samples with a known label have the same one, so no accuracy is defined and no "
                f"threshold can be chosen. In brackets: 95 % intervals by recording.{notices_text(one_class)}",
            )
        )
    if with_figures:
        chosen = "objects" if len(objects) > 1 else "recordings"
        tables.append(
            Table(
                f"{about.name}: {counted(groups, 'recording')}",
                HEAD,
                [row_cells(row) for row in with_figures],
                f"{about.repository}; slip is known {about.known}. In brackets: 95 % intervals by recording"
                + (
                    "."
                    if groups >= FEWEST
                    else f", only of AUC, since there are fewer than {FEWEST} recordings."
                )
                + " Yardsticks have their default threshold; those with a chosen threshold come last, the best first, and their thresholds are "
                f"chosen on other {chosen}. A slip is found if slip is reported in it or up to 0.5 s before, but not by an alarm that is on since "
                "the hold before a slip whose onset is unknown. The delay is that of slips with a known onset. Steady: samples whose label has been "
                f"the same for {STEADY:g} s.{notices_text(with_figures)}",
            )
        )
    ranged = [row for row in with_figures if row.by_object]
    if ranged:
        keys = (
            "auc",
            "auc_steady",
            "balanced_slip_accuracy",
            "slips_found",
            "false_alarms_per_minute",
        )
        cells = [
            [
                row.detector,
                *(
                    f"{FORMATS[key](row.by_object[key][0])} to {FORMATS[key](row.by_object[key][1])}"
                    if None not in row.by_object.get(key, (None,))
                    else "-"
                    for key in keys
                ),
            ]
            for row in ranged
        ]
        what = (
            "95 % intervals by object"
            if ranged[0].by_object["interval"]
            else f"lowest and highest value of {counted(len(objects), 'object')}"
        )
        tables.append(
            Table(
                f"{about.name}: by object",
                ["detector", *HEAD[1:6]],
                cells,
                f"{what}: {', '.join(objects)}.",
            )
        )
    unlabelled = [row for row in rows if "minutes" in row.figures]
    if unlabelled:
        tables.append(
            Table(
                f"{about.name}: {counted(groups, 'recording')} without labels",
                ["detector", "alarms", "per minute"],
                [
                    [
                        row.detector,
                        str(row.figures["alarms"]),
                        f"{row.figures['alarms'] / row.figures['minutes']:.1f}",
                    ]
                    for row in unlabelled
                ],
                f"{about.repository}; slip is {about.known}. Each detector has its own threshold.{notices_text(unlabelled)}",
            )
        )
    failed = [row for row in rows if row.failure]
    if failed:
        tables.append(
            Table(
                f"{about.name}: not evaluated",
                ["detector", "reason"],
                [[row.detector, row.failure] for row in failed],
            )
        )
    return tables


def best_first(rows: Sequence[Row]) -> list[Row]:
    """Detectors in their order, then yardsticks with a chosen threshold by falling steady AUC."""

    def place(row: Row) -> float:
        area = row.figures["figures"]["auc_steady"]["value"] if row.thresholds else None
        return -math.inf if not row.thresholds else math.inf if area is None else -area

    return sorted(rows, key=place)


def chart_of(recordings: Recordings, rows: Sequence[Row]) -> list[Chart]:
    """The areas under the curves of a set with their intervals; empty if none is defined."""
    # The area of a yardstick does not depend on its threshold, so its second row is not drawn.
    shown = [
        row
        for row in rows
        if "figures" in row.figures
        and row.figures["figures"]["auc"]["value"] is not None
        and not row.thresholds
    ]
    if not shown:
        return []

    def curve(name: str, key: str) -> Curve:
        points: list[tuple[float, float, float]] = []
        for row in shown:
            one = row.figures["figures"][key]
            value = math.nan if one["value"] is None else one["value"]
            points.append(
                (
                    value,
                    value if one["low"] is None else one["low"],
                    value if one["high"] is None else one["high"],
                )
            )
        return Curve(name, points)

    return [
        Chart(
            f"{recordings.about.name}: area under the ROC curve",
            "",
            "AUC",
            [row.detector for row in shown],
            [
                curve("all labelled samples", "auc"),
                curve(f"label steady for {STEADY:g} s", "auc_steady"),
            ],
            bar=0.5,
            bar_name="chance",
            joined=False,
        )
    ]


def study(options: Options) -> Result:
    """The study real.

    Args:
        options: recordings: the folder; only: names of sets

    Returns:
        figures of each set that was found

    Raises:
        InputError: no folder, no known set in it, or a set that cannot be imported
    """
    if not options.recordings:
        raise InputError(
            "reproduce: real needs --recordings DIR, a folder with public recordings; docs/results/real_recordings.md lists them"
        )
    folder = Path(options.recordings)
    if not folder.is_dir():
        raise InputError(f"reproduce: --recordings {options.recordings}: expected a folder")
    names = [about.name for about in SETS]
    if unknown := sorted(set(options.only) - set(names)):
        raise InputError(
            f"reproduce: --only {unknown[0]}: expected sets of recordings: {', '.join(names)}"
        )
    places = {
        about.name: about.find(folder)
        for about in SETS
        if not options.only or about.name in options.only
    }
    if not any(places.values()):
        raise InputError(
            f"reproduce: {options.recordings}: contains no known set; expected one of: "
            + "; ".join(f"{about.name}: {about.layout}" for about in SETS if about.name in places)
        )
    figures: dict[str, Any] = {}
    tables: list[Table] = []
    charts: list[Chart] = []
    with tempfile.TemporaryDirectory() as scratch:
        for about in SETS:
            if not places.get(about.name):
                continue
            options.say(f"{about.name}: importing")
            try:
                recordings = imported(about, places[about.name], Path(scratch))
            except InputError as error:
                raise InputError(
                    f"{error}; --only evaluates other sets than {about.name}"
                ) from error
            rows: list[Row] = []
            for detector, yardstick in [
                *((str(path), False) for path in shipped_networks(about.sensor)),
                *((name, False) for name in CATALOGUE.get(about.sensor, ())),
                *((name, True) for name in YARDSTICKS),
            ]:
                options.say(f"{about.name}: {Path(detector).name}")
                rows += evaluated(recordings, detector, yardstick)
            rows = best_first(rows)
            tables += tables_of(recordings, rows)
            charts += chart_of(recordings, rows)
            figures[about.name] = {
                "recordings": len(set(recordings.recording.values())),
                "objects": recordings.objects,
                "detectors": {
                    row.detector: {
                        **row.figures,
                        "by_object": row.by_object,
                        "thresholds": row.thresholds,
                        "threshold": None if math.isnan(row.threshold) else row.threshold,
                        "notice": row.notice,
                        "failure": row.failure,
                    }
                    for row in rows
                },
            }
    missing = [about for about in SETS if about.name in places and not places[about.name]]
    if missing:
        tables.append(
            Table(
                "Sets that were not found",
                ["set", "repository", "files"],
                [[about.name, about.repository or "none known", about.layout] for about in missing],
            )
        )
    return Result(
        "Detectors on public recordings of real sensors",
        "not from a paper: public recordings, docs/results/real_recordings.md",
        figures,
        [
            "Networks have the threshold of their file, yardsticks their default threshold. A second row of a yardstick has the threshold with the greatest "
            "balanced accuracy on the other objects, or on the other recordings of a set without objects.",
            "Intervals are 95 % intervals by recording: bootstrap, and Obuchowski for AUC. Samples with unknown labels are in no figure.",
        ],
        tables,
        charts,
        remarks=[
            "No set states the path of the object by sample, so the slipped distance at the alarm is unknown."
        ],
    )
