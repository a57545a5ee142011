"""The card of an export, README.md.

Content and origin of the files, with the front matter of Hugging Face's dataset cards.
"""

from __future__ import annotations

import gzip
import html
import json
import os
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from slipbench import Dataset, StoredTrial
from slipbench._export import croissant
from slipbench._export.layouts import LAYOUTS
from slipbench._export.meanings import LABELS, codes_of
from slipbench._export.request import Output, Progress, Request, check_replaceable
from slipbench._export.series import (
    Series,
    body_series,
    control_series,
    label_series,
    sensor_series,
)
from slipbench._program import counted, printable
from slipbench.bin import _core

BEGINNING = "---\n# Written by slipbench export.\n"
CARDS = (
    BEGINNING.encode(),
    croissant.BEGINNING.encode(),
)  # first bytes of README.md and croissant.json
# Fields in the names of files, for Croissant.
NAMED = {
    "trial": ("sc:Integer", "number of the trial"),
    "class": ("sc:Text", "class of the motion"),
}
# Addresses that GitHub's Markdown makes links of without any mark.
ADDRESS = re.compile(r"://|www\.|@|(mailto|xmpp):", re.IGNORECASE)
PLACES = {"sensors": "sensor", "labels": "labels of", "truth": "body", "control": "control loop"}


def _text(value: object) -> str:
    """A text of the dataset for Markdown: without HTML, links and control characters.

    Words that a renderer makes links of, escaped or not, are code.
    """
    plain = printable(re.sub(r"\s+", " ", str(value)))
    return " ".join(
        _code(word) if ADDRESS.search(word) else _escaped(word) for word in plain.split(" ")
    )


def _escaped(word: str) -> str:
    """A word whose characters have no meaning in Markdown and HTML."""
    return html.escape(re.sub(r"([\\\[\]`$])", r"\\\1", word), quote=False)


def _code(value: object) -> str:
    """A text of the dataset as code, between more backticks than it has in a run."""
    plain = printable(re.sub(r"\s+", " ", str(value)))
    ticks = "`" * (1 + max((len(run) for run in re.findall("`+", plain)), default=0))
    return (
        f"{ticks} {plain} {ticks}"
        if plain.startswith("`") or plain.endswith("`")
        else f"{ticks}{plain}{ticks}"
    )


def _yaml(text: str) -> str:
    """A text as a value of YAML: in quotes if it needs them."""
    return text if re.fullmatch(r"[A-Za-z][A-Za-z0-9_ ,.-]*", text) else json.dumps(text)


def _row(*cells: str) -> str:
    """A row of cells in Markdown, with bars escaped."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def _head(*cells: str) -> str:
    return _row(*cells) + _row(*["---"] * len(cells))


def _fence(text: str) -> str:
    """A code block with a fence longer than any run of backticks in the text."""
    ticks = "`" * max(3, 1 + max((len(run) for run in re.findall("`+", text)), default=0))
    return f"{ticks}yaml\n{printable(text, lines=True).rstrip()}\n{ticks}\n"


def _meaning(series: Series) -> str:
    text = LABELS.get(series.name, "") if series.kind in ("labels", "control") else ""
    key = ", ".join(f"{code} {word}" for word, code in codes_of(series).items())
    return f"{text}{': ' if text and key else ''}{key}"


def without_folders(command: str) -> str:
    """The command with absolute paths shortened to their last part.

    Their folders are on another machine.
    """
    command = re.sub(
        r"""'([\w.]+=)?/(?:[^']*/)?([^'/]+)/*'""", r"'\1\2'", command
    )  # quoted names contain blanks
    return re.sub(r"""(?<![^\s'"=,[])/(?:[^\s'",\]]*/)?([^\s'",\]/]+)/*""", r"\1", command)


def _first(data: Dataset, request: Request) -> dict[str, StoredTrial]:
    """For each exported sensor, the first trial that has it.

    Imported trials may differ in their sensors.
    """
    found: dict[str, StoredTrial] = {}
    for number in request.trials:
        trial = data[number]
        for sensor in request.sensors:
            if sensor in trial.sensors:
                found.setdefault(sensor, trial)
        if len(found) == len(request.sensors):
            break
    kind = LAYOUTS[request.format].sensor
    return {
        sensor: trial
        for sensor, trial in found.items()
        if kind in ("", trial.sensors[sensor].attrs["type"])
    }


def _series(data: Dataset, request: Request) -> Iterator[Series]:
    """The arrays in the files."""
    holds = LAYOUTS[request.format].holds
    trial = data[request.trials[0]]
    series: list[Series] = []
    for sensor, has in _first(data, request).items():
        series += [
            *sensor_series(has, sensor),
            *(
                _with_all_codes(data, request, one)
                for one in label_series(has, sensor, request.labels)
            ),
        ]
    yield from filter(holds, [*series, *body_series(trial), *control_series(trial)])


def _with_all_codes(data: Dataset, request: Request, series: Series) -> Series:
    """Labels with the codes of all trials.

    A recording has the code of unknown labels only if it has such labels.
    """
    if series.name != "state_recorded":
        return series
    codes = codes_of(series)
    for number in request.trials:
        if (group := data[number].labels.get(series.owner)) is not None:
            for name in group:
                codes |= json.loads(str(group[name].attrs.get("codes", "{}")))
    return replace(series, codes=json.dumps(codes))


def _kinds(data: Dataset, request: Request) -> list[str]:
    """Types of the sensors."""
    return sorted(
        {
            str(trial.sensors[sensor].attrs["type"])
            for sensor, trial in _first(data, request).items()
        }
    )


def _with_labels(data: Dataset, request: Request) -> str:
    """Returns the part of a sentence that states that the files have labels of slip."""
    has = LAYOUTS[request.format].has_labels or any(
        one.kind == "labels" for one in _series(data, request)
    )
    return " with labels of slip" if has else ""


def _title(kinds: list[str]) -> str:
    return f"slipbench recordings of {', '.join(kinds)}"


def _keywords(kinds: list[str], request: Request) -> list[str]:
    return [
        "robotics",
        "tactile-sensing",
        "slip-detection",
        *kinds,
        *(["LeRobot"] if request.format == "lerobot" else []),
    ]


def _citation(data: Dataset) -> str:
    return f"The slipbench authors: slipbench, a physics testbench for tactile slip detection, version {data.version}."


def _sensor_rows(data: Dataset, request: Request) -> str:
    rows, first = "", _first(data, request)
    common = request.rate
    if request.format == "robomimic" and common is None:  # all sensors have the rate of the slowest
        common = min(float(trial.sensors[name].attrs["rate_hz"]) for name, trial in first.items())
    for name in first:
        sensors = [
            found[name] for number in request.trials if name in (found := data[number].sensors)
        ]
        rates = sorted({common or float(sensor.attrs["rate_hz"]) for sensor in sensors})
        rows += _row(
            _code(name),
            _text(sensors[0].attrs["type"]),
            ", ".join(f"{rate:g} Hz" for rate in rates),
            _text(sensors[0].attrs.get("frame", "")),
        )
    return f"## Sensors\n\n{_head('sensor', 'type', 'rate', 'axes')}{rows}\n"


def _array_rows(data: Dataset, request: Request) -> str:
    """Table of the dataset's arrays in the files; empty if there are none."""
    rows, first = "", _first(data, request)
    for one in _series(data, request):
        rule = (
            f"; rule: {first[one.owner].labels[one.owner].attrs['rule']}"
            if one.name == "state_recorded"
            else ""
        )
        unit = "code" if one.codes else "dimensionless" if one.unit in ("", "1") else one.unit
        of = f"{PLACES[one.kind]} {_code(one.owner)}" if one.owner else PLACES[one.kind]
        is_image = one.kind == "sensors" and _core.is_image(
            str(first[one.owner].sensors[one.owner].attrs["type"]), one.name
        )
        rows += _row(
            of,
            _code(one.name),
            str(LAYOUTS[request.format].shape(one, is_image)),
            _text(unit),
            _text(_meaning(one) + rule),
        )
    for name, trial in first.items():
        if name in trial.labels and "events" in trial.labels[name]:
            kind = trial.labels[name]["events"]["kind"]
            key = Series(
                "labels",
                name,
                "kind",
                "1",
                str(kind.attrs["codes"]),
                ("kind",),
                (),
                kind[:],
                kind[:],
            )
            if LAYOUTS[request.format].holds(key):
                rows += _row(
                    f"events of {_code(name)}", "`kind`", "[]", "code", _text(_meaning(key))
                )
    if not rows:
        return ""
    return f"## Arrays\n\nShapes are those of one sample. Codes are listed with their meaning.\n\n{_head('of', 'array', 'shape', 'unit', 'meaning')}{rows}\n"


def _column_rows(request: Request) -> str:
    columns = LAYOUTS[request.format].columns(request)
    rows = "".join(_row(_code(one.name), one.unit, one.meaning) for one in columns)
    return f"## Columns\n\n{_head('column', 'unit', 'meaning')}{rows}\n" if rows else ""


def _options(request: Request) -> str:
    """The options that change the values in the files."""
    words = [f"--format {request.format}"]
    words += [f"--labels {request.labels}"] if request.labels else []
    words += (
        [f"--label-speed '{1e3 * request.label_speed:g} mm/s'"]
        if request.label_speed is not None
        else []
    )
    words += [f"--rate '{request.rate:g} Hz'"] if request.rate is not None else []
    return " ".join([*words, *(["--points"] if request.points else [])])


def card_text(data: Dataset, request: Request) -> str:
    """README.md of the export that `request` describes."""
    first = data[request.trials[0]]
    kinds = _kinds(data, request)
    tags = "".join(f"- {_yaml(tag)}\n" for tag in _keywords(kinds, request))
    front = f"pretty_name: {_yaml(_title(kinds))}\n" + (
        f'license: "{request.licence}"\n' if request.licence else ""
    )
    front += f"task_categories:\n- robotics\ntags:\n{tags}"
    if request.format == "lerobot":
        front += "configs:\n- config_name: default\n  data_files: data/*/*.parquet\n"
    files = "".join(_row(f"`{name}`", text) for name, text in LAYOUTS[request.format].files.items())
    scene = f"The scene:\n\n{_fence(data.scene)}\n" if data.scene else ""
    return (
        f"{BEGINNING}{front}---\n\n"
        f"# Recordings of {_text(', '.join(kinds))}{_with_labels(data, request)}\n\n"
        f"{counted(len(request.trials), 'trial')}, written by `slipbench export {_options(request)}`.\n\n"
        f"{_sensor_rows(data, request)}"
        f"## Files\n\n{_head('file', 'content')}{files}\n"
        f"{_array_rows(data, request)}{_column_rows(request)}"
        f"## Origin\n\n{_head('what', 'value')}{_row('version', f'slipbench {_text(data.version)}')}{_row('seed', str(data.seed))}"
        f"{_row('command', _code(without_folders(data.command)))}{_row(f'SHA-256 of trial {request.trials[0]}', _code(first.sha256))}\n"
        f"{scene}"
        f"## Citation\n\n{_text(_citation(data))}\n"
    )


def check_card(request: Request) -> None:
    """Raises InputError if a file of another kind has the name of the card or of croissant.json.

    Call before writing the data.
    """
    for name, beginning in zip(("README.md", "croissant.json"), CARDS, strict=True):
        check_replaceable(Path(request.out) / name, "a dataset card of slipbench", beginning)


def write_card(data: Dataset, request: Request, output: Output) -> None:
    """Writes README.md and croissant.json, after all other files.

    They describe the files of `output` and those of the program.
    """
    output.write("README.md", card_text(data, request))
    written = [
        (Path(os.path.relpath(file, request.out)).as_posix(), file) for file in request.files
    ]
    text = croissant_text(data, request, [*written, *output.files()])
    output.write("croissant.json", text)


def _first_line(path: str) -> str:
    """The first line of a table, which may be compressed."""
    with gzip.open(path, "rt") if path.endswith(".gz") else open(path, encoding="utf-8") as file:
        return file.readline().rstrip("\n")


def _column(request: Request, states: dict[str, str], name: str) -> croissant.Column:
    """Describes a column of a table written by the program.

    `states`: meanings of the label arrays.
    """
    for one in LAYOUTS[request.format].columns(request):
        if one.pattern and re.fullmatch(one.pattern, name):
            return croissant.Column(
                name, one.type, f"{one.meaning}; unit {one.unit}" if one.unit else one.meaning
            )
    return (
        croissant.Column(name, "sc:Integer", states[name])
        if name in states
        else croissant.Column(name, "sc:Float", "")
    )


def _written_tables(
    data: Dataset, request: Request, files: list[croissant.File]
) -> Iterator[croissant.Table]:
    """Tables with a header written by the program: one for all files with the same columns."""
    layout = LAYOUTS[request.format]
    found: dict[tuple[str, str], list[str]] = {}
    for name, path in files:
        match = re.fullmatch(layout.table + r"(\.gz)?", name) if layout.table else None
        if match:
            found.setdefault(
                (match.groupdict().get("table", "recordings"), _first_line(path)), []
            ).append(name)
    named = {
        group: (
            kind,
            text,
            re.sub(r"\(\?P<\w+>", "(?:", layout.table.replace(f"(?P<{group}>", "(")),
        )
        for group, (kind, text) in NAMED.items()
        if f"?P<{group}>" in layout.table
    }
    states = {one.name: _meaning(one) for one in _series(data, request) if one.kind == "labels"}
    names = [table for table, _ in found]
    for number, ((table, header), some) in enumerate(found.items()):
        yield croissant.Table(
            table if names.count(table) == 1 else f"{table}-{number}",
            some,
            [_column(request, states, name) for name in header.split(",")],
            "text/csv",
            named,
        )


def _parquet_tables(request: Request, files: list[croissant.File]) -> Iterator[croissant.Table]:
    if request.format == "parquet":
        for name, path in files:
            if name.endswith(".parquet"):
                yield croissant.Table(
                    name.removesuffix(".parquet"), [name], croissant.parquet_columns(path)
                )
    if request.format == "lerobot":
        frames = [file for file in files if file[0].startswith("data/")]
        yield croissant.Table(
            "frames",
            [name for name, _ in frames],
            croissant.parquet_columns(frames[0][1]),
            "application/x-parquet",
        )


def croissant_text(data: Dataset, request: Request, files: list[croissant.File]) -> str:
    """croissant.json of the export that `request` describes, for `files`."""
    kinds, files = _kinds(data, request), sorted(files)
    return croissant.croissant_text(
        name=_title(kinds),
        description=f"{counted(len(request.trials), 'trial')} of {', '.join(kinds)}{_with_labels(data, request)}, as {request.format}.",
        version=data.version,
        licence=request.licence,
        citation=_citation(data),
        keywords=_keywords(kinds, request),
        files=files,
        tables=[*_parquet_tables(request, files), *_written_tables(data, request, files)],
    )


def write(data: Dataset, request: Request, progress: Progress) -> list[str]:
    """Writes the card for the files that the program has written.

    Returns the names of all files.
    """
    with Output(request.out, "a dataset card of slipbench", *CARDS) as output:
        write_card(data, request, output)
        progress.check()
        return [*request.files, *output.publish()]
