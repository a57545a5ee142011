"""The card of an export, README.md: what the files hold and how they were made, with the front matter of Hugging Face's dataset cards."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from slipbench import Dataset
from slipbench._export import croissant
from slipbench._export.meanings import LABELS, codes_of
from slipbench._export.request import Output, Request
from slipbench._export.series import Series, body_series, control_series, label_series, sensor_series

BEGINNING = "---\n# Written by slipbench export.\n"
CARDS = (BEGINNING.encode(), croissant.BEGINNING.encode())  # how README.md and croissant.json begin
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


def without_folders(command: str) -> str:
    """The command with the last part of each absolute path, since the folders are those of another machine."""
    return re.sub(r"""(?<![^\s'"=])/[^\s'"]*/""", "", command)


def _series(data: Dataset, request: Request) -> Iterator[Series]:
    """The arrays of the first trial, which every trial has."""
    trial = data[request.trials[0]]
    for sensor in request.sensors:
        yield from sensor_series(trial, sensor)
        yield from label_series(trial, sensor, request.labels)
    yield from body_series(trial)
    yield from control_series(trial)


def _kinds(data: Dataset, request: Request) -> list[str]:
    """Types of the sensors."""
    sensors = data[request.trials[0]].sensors
    return sorted({str(sensors[name].attrs["type"]) for name in request.sensors})


def _title(kinds: list[str]) -> str:
    return f"slipbench recordings of {', '.join(kinds)}"


def _keywords(kinds: list[str], request: Request) -> list[str]:
    return ["robotics", "tactile-sensing", "slip-detection", *kinds, *(["LeRobot"] if request.format == "lerobot" else [])]


def _citation(data: Dataset) -> str:
    return f"The slipbench authors: slipbench, a physics testbench for tactile slip detection, version {data.version}."


def card_text(data: Dataset, request: Request) -> str:
    """README.md of the export that `request` describes."""
    trial = data[request.trials[0]]
    sensors = {name: trial.sensors[name] for name in request.sensors}
    kinds = _kinds(data, request)
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
    tags = "".join(f"- {tag}\n" for tag in _keywords(kinds, request))
    front = f"pretty_name: {_title(kinds)}\n" + (f"license: {request.licence}\n" if request.licence else "")
    front += f"task_categories:\n- robotics\ntags:\n{tags}"
    if request.format == "lerobot":
        front += "configs:\n- config_name: default\n  data_files: data/*/*.parquet\n"
    return (f"{BEGINNING}{front}---\n\n"
            f"# Recordings of {', '.join(kinds)} with labels of slip\n\n"
            f"{len(request.trials)} trials, written by `slipbench export --format {request.format}`.\n\n"
            f"## Sensors\n\n{_row('sensor', 'type', 'rate', 'axes')}{_row(*['---'] * 4)}{rates}\n"
            f"## Arrays\n\nShapes are those of one sample. Codes are listed with their meaning.\n\n"
            f"{_row('of', 'array', 'shape', 'unit', 'meaning')}{_row(*['---'] * 5)}{arrays}{events}\n"
            f"## Origin\n\n{_row('what', 'value')}{_row('---', '---')}{_row('version', f'slipbench {data.version}')}{_row('seed', str(data.seed))}"
            f"{_row('command', f'`{without_folders(data.command)}`')}{_row(f'SHA-256 of trial {request.trials[0]}', f'`{trial.sha256}`')}\n"
            f"The scene:\n\n{_fence(data.scene)}\n"
            f"## Citation\n\n{_citation(data)}\n")


def write_card(data: Dataset, request: Request, output: Output) -> None:
    """Writes README.md and croissant.json among the files of `output`, after all others."""
    Path(output.path("README.md")).write_text(card_text(data, request), encoding="utf-8")
    text = croissant_text(data, request, output.files())
    Path(output.path("croissant.json")).write_text(text, encoding="utf-8")


def croissant_text(data: Dataset, request: Request, files: list[croissant.File]) -> str:
    """croissant.json of the export that `request` describes, which consists of `files`."""
    kinds = _kinds(data, request)
    return croissant.croissant_text(
        name=_title(kinds), description=f"{len(request.trials)} trials of {', '.join(kinds)} with labels of slip, as {request.format}.", version=data.version,
        licence=request.licence, citation=_citation(data), keywords=_keywords(kinds, request), files=files, tables=request.format == "parquet")
