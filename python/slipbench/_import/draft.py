"""`python -m slipbench._import.draft FILE`.

A map for a table of text, from the titles of its columns; started by `slipbench import --draft`.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from slipbench import InputError
from slipbench._import.block import nearest
from slipbench._import.keys import TIME_UNITS
from slipbench._import.recordings import list_files
from slipbench._import.text import TextTable
from slipbench._import.times import is_moment
from slipbench._output import write_whole
from slipbench._program import counted, read_request, run_command, write_result

TABLES = (".csv", ".tsv", ".tab", ".txt", ".dat", ".lvm")
AXES = "xyz"
SLOWEST, FASTEST = 5.0, 50_000.0  # Hz, usual rates of tactile sensors


@dataclass(frozen=True)
class Wanted:
    """A channel that detectors read.

    Attributes:
        name: name of the channel
        axes: True: three axes of each unit; False: one value of each unit
        words: regular expression for the letters of a title without its axis, in lower case
        keys: further keys of the channel in the map
        check: what the user should check; empty: nothing
        measured: `keys` for columns with fractions, which are not counts; empty: as `keys`
    """

    name: str
    axes: bool
    words: str
    keys: str
    check: str = ""
    measured: str = ""


WANTED: dict[str, tuple[Wanted, ...]] = {
    "papillarray": (
        Wanted("force", True, "f$|^f|force", "unit: N", "the unit: N or mN"),
        Wanted("displacement", True, "d$|^d|disp", "unit: mm", "the unit: mm or m"),
    ),
    "magnetic_skin": (
        Wanted(
            "field",
            True,
            "",
            "unit: counts, scale: [0.601 uT, 0.601 uT, 0.968 uT], baseline: 0.2 s",
            "what 1 count is (MLX90393, GAIN_SEL 1), and that nothing touches the skin in the first 0.2 s",
            "unit: uT, baseline: 0.2 s",
        ),
    ),
    "biotac_sp": (
        Wanted("electrodes", False, "^e|e$|elec", "unit: counts"),
        Wanted("pac", False, "^pac", "unit: counts"),
    ),
    "taxels": (
        Wanted("force", True, "f$|^f|force", "unit: N", "the unit: N or mN"),
        Wanted("signal", False, "", "unit: counts", "the unit"),
    ),
    "myrmex": (
        Wanted(
            "taxels",
            False,
            "",
            "unit: counts",
            "add components: N, the number of columns of the array",
        ),
    ),
    "piezo_skin": (Wanted("signal", False, "", "unit: counts", "the unit: counts or V"),),
}


@dataclass(frozen=True)
class Group:
    """Columns of equal titles but for a number and, with `axes`, for x, y and z.

    Attributes:
        patterns: titles with * for the number; three with `axes`
        letters: letters of the first pattern without its axis, in lower case
        units: number of columns of a pattern
        axes: True for columns of three axes
    """

    patterns: tuple[str, ...]
    letters: str
    units: int
    axes: bool


def _pattern_of(titles: list[str]) -> str:
    """The pattern of titles that differ only in numbers: * replaces the numbers that differ."""
    parts = [re.split(r"([0-9]+)", title) for title in titles]
    return "".join(
        column[0] if len(set(column)) == 1 else "*" for column in zip(*parts, strict=True)
    )


def groups_of(titles: list[str]) -> list[Group]:
    """Groups columns by their titles, the largest group first."""
    alike: dict[str, list[str]] = {}
    for title in titles:
        alike.setdefault(re.sub(r"[0-9]+", "0", title), []).append(title)
    groups, used = [], set()
    for shape, first in alike.items():
        for place in [
            place for place, character in enumerate(shape) if character.lower() == AXES[0]
        ]:
            axes = [
                shape[:place] + chr(ord(shape[place]) + step) + shape[place + 1 :]
                for step in range(3)
            ]
            if all(axis in alike and len(alike[axis]) == len(first) for axis in axes):
                letters = re.sub("[^a-z]", "", (shape[:place] + shape[place + 1 :]).lower())
                groups.append(
                    Group(
                        tuple(_pattern_of(alike[axis]) for axis in axes), letters, len(first), True
                    )
                )
                used |= set(axes)
    for shape, found in alike.items():
        if shape not in used:
            groups.append(
                Group((_pattern_of(found),), re.sub("[^a-z]", "", shape.lower()), len(found), False)
            )
    return sorted(groups, key=lambda group: -group.units * len(group.patterns))


def assigned(type: str, groups: list[Group]) -> list[tuple[Wanted, Group]]:
    """The channels of a sensor of this type that the columns contain.

    A channel whose words no group has gets the largest group that is left, if it is the first
    channel of the type.
    """
    left, found = list(groups), []
    for number, wanted in enumerate(WANTED[type]):
        fitting = [group for group in left if group.axes == wanted.axes]
        named = [group for group in fitting if re.search(wanted.words, group.letters)]
        if not named and number == 0 and len(WANTED[type]) == 1:
            named = fitting
        if named:
            found.append((wanted, named[0]))
            left.remove(named[0])
    return found


def time_key(table: TextTable) -> tuple[str, str, str]:
    """The column of times; the value of the map's key `time`; a comment."""
    words = r"(?i).*(time|stamp|elapsed|seconds).*|ts?|(t|sec|secs|msec|usec)?([ _(\[]+(s|ms|us|ns|sec)[)\]]?)?"
    title = next((title for title in table.titles if re.fullmatch(words, title)), "")
    if not title:
        return "", "{rate: 100 Hz}", "Check: the rate, because no column is called time"
    table.load([title], [title])
    cells = [cell for cell in table.texts(title) if cell]
    if cells and is_moment(cells[0]):
        return title, f"{{column: {quoted(title)}}}", "dates or times of day"
    table.load([title], [])
    steps = np.diff(table.values(title))
    step = float(np.median(steps)) if steps.size else 0.0
    rates = {unit: 1.0 / (step * seconds) for unit, seconds in TIME_UNITS.items() if step > 0.0}
    unit_in_title = re.search(r"(?:[_\s(\[]|^)(ns|us|ms|s)[)\]]?$", title)
    unit = (
        unit_in_title[1]
        if unit_in_title
        else next(
            (
                unit
                for unit in ("s", "ms", "us", "ns")
                if SLOWEST <= rates.get(unit, 0.0) <= FASTEST
            ),
            "s",
        )
    )
    return (
        title,
        f"{{column: {quoted(title)}, unit: {unit}}}",
        f"{rates[unit]:.4g} Hz" if unit in rates else "Check: the times do not ascend",
    )


def has_fractions(table: TextTable, group: Group) -> bool:
    """True if the columns of a group contain numbers that are not whole."""
    titles = table.find_all(list(group.patterns), "channels")[0]
    table.load(titles, [])
    return any(np.any(table.values(title) % 1.0 > 0.0) for title in titles)


def quoted(text: str) -> str:
    """A text in YAML, in quotes if necessary."""
    return (
        text
        if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", text)
        and text.lower() not in ("y", "n", "yes", "no", "on", "off", "true", "false", "null")
        else json.dumps(text, ensure_ascii=False)
    )


def _channel_lines(table: TextTable, wanted: Wanted, group: Group) -> list[str]:
    """The lines of the map for a channel."""
    components = (
        f"components: {len(group.patterns)}, "
        if group.axes and not any("*" in pattern for pattern in group.patterns)
        else ""
    )
    columns = ", ".join(quoted(pattern) for pattern in group.patterns)
    units = counted(group.units, "unit" if group.axes else "value")
    keys = wanted.measured if wanted.measured and has_fractions(table, group) else wanted.keys
    return [
        *([f"  # Check: {wanted.check}"] if wanted.check else []),
        f"  {wanted.name}: {{{keys}, {components}columns: [{columns}]}}  # {units}",
    ]


def drafted(table: TextTable, type: str) -> str:
    """The text of a map for the table.

    Raises:
        InputError: no columns fit a channel of this type.
    """
    if type == "papillarray" and "S0_P0_DX" in table.titles:
        raise InputError(
            f"{table.title_place()}: is a log of the vendor's software, which needs no map; import it with --format papillarray-csv"
        )
    title, time, comment = time_key(table)
    groups = groups_of([one for one in table.titles if one != title])
    channels = assigned(type, groups)
    if not channels:
        needed = " or ".join(
            f"{'x, y and z of ' if wanted.axes else ''}{wanted.name}" for wanted in WANTED[type]
        )
        raise InputError(
            f"{table.title_place()}: no columns were found for {needed} of a {type}, such as "
            f"{'x0, y0, z0, x1, ...' if WANTED[type][0].axes else 'e1, e2, ...'}; found: {', '.join(table.titles[:10])}; write the map by hand"
            f"{table.title_hint()}"
        )
    lines = [
        f"# Drafted by `slipbench import --draft {type}` from the titles of {Path(table.path).name}.",
        "sensor: pad",
        f"type: {type}",
        f"time: {time}  # {comment}",
        "channels:",
    ]
    for wanted, group in channels:
        lines += _channel_lines(table, wanted, group)
    rest = [
        pattern
        for group in groups
        if group not in [one for _, one in channels]
        for pattern in group.patterns
    ]
    if rest:
        lines.append(f"# Not read: {', '.join(rest[:20])}{' and more' if len(rest) > 20 else ''}")
    return "\n".join(lines) + "\n"


def run(sources: list[str], type: str, output: str) -> int:
    """Drafts the map of the first table and writes it to `output`; empty: prints it.

    Returns the exit status.
    """
    if type not in WANTED:
        raise InputError(
            f"import: --draft {type}: drafts maps for sensors of known types{nearest(type, sorted(WANTED))}"
        )
    path = list_files(sources)[0].path
    if Path(path).is_dir() or Path(path).suffix not in TABLES:
        raise InputError(
            f"{path}: --draft reads tables of text, {', '.join(TABLES)}; write the map by hand, or use an included map for bags"
        )
    if output and Path(output).exists():
        raise InputError(
            f"{output}: exists already, and may have been edited; give another file, or remove it"
        )
    text = drafted(TextTable(path), type)
    if not output:
        return write_result(lambda: print(text, end=""))
    write_whole(Path(output), text.encode())
    program = os.environ.get("SLIPBENCH_CALLED_AS", "slipbench")
    command = f"{program} import {shlex.join(sources)} --map {shlex.quote(output)} -o {shlex.quote(str(Path(output).with_suffix('.h5')))}"
    return write_result(
        lambda: print(f"{text}written: {output}\nnext: check the map, then {command}")
    )


def main(request: dict[str, Any]) -> int:
    """Runs the request; returns the exit status."""
    return run_command(
        lambda: run(request["sources"], request["type"], request["output"]),
        needs="import --draft",
        install=request["install"],
        target=request["output"],
    )


if __name__ == "__main__":
    sys.exit(main(read_request()))
