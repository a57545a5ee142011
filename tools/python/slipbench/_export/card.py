"""The card of an export, README.md: what the files hold and how they were made, with the front matter of Hugging Face's dataset cards."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from slipbench import Dataset
from slipbench._export.meanings import LABELS, codes_of
from slipbench._export.request import Output, Request
from slipbench._export.series import Series, body_series, control_series, label_series, sensor_series

BEGINNING = "---\n# Written by slipbench export.\n"
PLACES = {"sensors": "sensor", "labels": "labels of", "truth": "body", "control": "control loop"}


def _row(*cells: str) -> str:
    """A line of a table, in which a bar and the end of a line have no meaning."""
    return "| " + " | ".join(re.sub(r"\s+", " ", cell).replace("|", "\\|") for cell in cells) + " |\n"


def _fence(text: str) -> str:
    """A block of code that no run of backticks inside of the text ends."""
    ticks = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{ticks}yaml\n{text.rstrip()}\n{ticks}\n"


def _meaning(series: Series) -> str:
    text = LABELS.get(series.name, "") if series.kind in ("labels", "control") else ""
    key = ", ".join(f"{code} {word}" for word, code in codes_of(series).items())
    return f"{text}{': ' if text and key else ''}{key}"


def _without_folders(command: str) -> str:
    """The command with the last part of each path, since the folders are those of another machine."""
    return re.sub(r"(?<!\S)/\S*/", "", command)


def _series(data: Dataset, request: Request) -> Iterator[Series]:
    """The arrays of the first trial, which every trial has."""
    trial = data[request.trials[0]]
    for sensor in request.sensors:
        yield from sensor_series(trial, sensor)
        yield from label_series(trial, sensor, request.labels)
    yield from body_series(trial)
    yield from control_series(trial)


def card_text(data: Dataset, request: Request) -> str:
    """README.md of the export that `request` describes."""
    trial = data[request.trials[0]]
    sensors = {name: trial.sensors[name] for name in request.sensors}
    kinds = sorted({str(sensor.attrs["type"]) for sensor in sensors.values()})
    rates = "".join(_row(f"`{name}`", str(sensor.attrs["type"]), f"{request.rate or float(sensor.attrs['rate_hz']):g} Hz", str(sensor.attrs.get("frame", "")))
                    for name, sensor in sensors.items())
    arrays, events = "", ""
    for one in _series(data, request):
        unit = "code" if one.codes else "dimensionless" if one.unit in ("", "1") else one.unit
        arrays += _row(f"{PLACES[one.kind]} `{one.owner}`" if one.owner else PLACES[one.kind], f"`{one.name}`", str(list(one.shape)), unit, _meaning(one))
    for name in request.sensors:
        if name in trial.labels and "events" in trial.labels[name]:
            kind = trial.labels[name]["events"]["kind"]
            key = Series("labels", name, "kind", "1", str(kind.attrs["codes"]), ("kind",), (), kind[:], kind[:])
            events += _row(f"events of `{name}`", "`kind`", "[]", "code", _meaning(key))
    tags = "".join(f"- {tag}\n" for tag in ["robotics", "tactile-sensing", "slip-detection", *kinds])
    return (f"{BEGINNING}pretty_name: slipbench recordings of {', '.join(kinds)}\ntask_categories:\n- robotics\ntags:\n{tags}---\n\n"
            f"# Recordings of {', '.join(kinds)} with labels of slip\n\n"
            f"{len(request.trials)} trials, written by `slipbench export --format {request.format}`.\n\n"
            f"## Sensors\n\n{_row('sensor', 'type', 'rate', 'axes')}{_row(*['---'] * 4)}{rates}\n"
            f"## Arrays\n\nShapes are those of one sample. Codes are listed with their meaning.\n\n"
            f"{_row('of', 'array', 'shape', 'unit', 'meaning')}{_row(*['---'] * 5)}{arrays}{events}\n"
            f"## Origin\n\n{_row('what', 'value')}{_row('---', '---')}{_row('version', f'slipbench {data.version}')}{_row('seed', str(data.seed))}"
            f"{_row('command', f'`{_without_folders(data.command)}`')}{_row(f'SHA-256 of trial {request.trials[0]}', f'`{trial.sha256}`')}\n"
            f"The scene:\n\n{_fence(data.scene)}\n"
            f"## Citation\n\nThe slipbench authors: slipbench, a physics testbench for tactile slip detection, version {data.version}.\n")


def write_card(data: Dataset, request: Request, output: Output) -> None:
    """Writes README.md among the files of `output`."""
    Path(output.path("README.md")).write_text(card_text(data, request), encoding="utf-8")
