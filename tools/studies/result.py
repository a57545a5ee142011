"""Result of a study: tables of text for users, numbers for programs."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any

import numpy as np


@dataclass
class Table:
    """A table of text.

    Attributes:
        title: title of the table
        head: names of its columns
        rows: each with as many cells as the head
        note: a sentence below the title; may be empty
    """

    title: str
    head: list[str]
    rows: list[list[str]] = field(default_factory=list)
    note: str = ""


@dataclass
class Curve:
    """A value with its interval at each position of a chart.

    Attributes:
        name: name in the legend
        points: (value, low, high) at each position; low and high may equal the value; NaN omits the
            position
    """

    name: str
    points: list[tuple[float, float, float]]


@dataclass
class Chart:
    """Curves over equally spaced positions.

    Attributes:
        title: title of the chart
        across: name of the axis of the positions, with its unit; empty: the labels suffice
        up: name of the axis of the values, with its unit
        places: labels, such as "centre of mass at 2L/3"; not keys of the figures
        curves: at least one
        bar: value of a reference line; None: no line
        bar_name: its name in the legend
        joined: True: the positions are in order on the horizontal axis, and lines join the points;
            False: each position is a row with its label
    """

    title: str
    across: str
    up: str
    places: list[str]
    curves: list[Curve]
    bar: float | None = None
    bar_name: str = ""
    joined: bool = True


@dataclass(frozen=True)
class RealFigure:
    """A published figure of a real device, with ours.

    `reproduce realism` collects these figures from all studies.

    Attributes:
        what: quantity with its unit
        real: NaN: not published
        ours: NaN: none
        note: what was fitted or assumed; may be empty
    """

    what: str
    real: float
    ours: float
    note: str = ""


@dataclass
class Result:
    """Result of a study.

    Attributes:
        title: "Ablation of the hyperdimensional slip detector"
        source: the paper, and the table in it
        figures: every number of the tables, unrounded, by name
        setup: setup of the measurement, one sentence each
        tables: in order
        charts: shown before the tables
        remarks: differences from the paper, with their causes
        real: figures of real devices with ours
    """

    title: str
    source: str
    figures: Any
    setup: list[str] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    charts: list[Chart] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    real: list[RealFigure] = field(default_factory=list)


def say_nothing(_: str) -> None:
    """Default of Options.say: discards progress messages."""


@dataclass(frozen=True)
class Options:
    """Options of the command line.

    Attributes:
        data: a dataset to use instead of a simulated one; empty: none
        real: a dataset of imported recordings for training and test; empty: none
        recordings: folder with public recordings, not imported; empty: none
        seed: seed of datasets, item memories and draws; None: not given, 1
        jobs: threads; 0: one per core
        full: True: run at the paper's size
        synthesise: True: run the synthesis again instead of reading its stored figures
        trials: trials per row; 0: the usual number
        only: names of rows to keep
        memories: folder of the published classifier; empty: the source tree's
        output: HTML file of the page; empty: none
        resume: True: continue with the networks that an earlier run saved next to `output`
        say: receives progress messages
    """

    data: str = ""
    real: str = ""
    recordings: str = ""
    seed: int | None = None
    jobs: int = 0
    full: bool = False
    synthesise: bool = False
    trials: int = 0
    only: tuple[str, ...] = ()
    memories: str = ""
    output: str = ""
    resume: bool = False
    say: Callable[[str], None] = say_nothing

    @property
    def draws_seed(self) -> int:
        """The seed, 1 by default."""
        return 1 if self.seed is None else self.seed


def plain(value: Any) -> Any:
    """Converts `value` for JSON.

    Scalars and arrays of numpy become Python's, tuples lists, NaN and infinities None.

    Args:
        value: nested mappings, sequences, arrays and scalars

    Returns:
        dicts, lists, texts, numbers, bools and None

    Raises:
        TypeError: JSON has no such type
    """
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, str | bool | int) or value is None:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, Sequence):
        return [plain(one) for one in value]
    raise TypeError(f"{type(value).__name__} in the figures of a study; allowed: what JSON has")


def result_object(name: str, result: Result) -> dict[str, Any]:
    """The object of `--json` and of the written file.

    Args:
        name: PAPER/TABLE
        result: result of that study

    Returns:
        reproduction, title, source, setup, figures, remarks
    """
    return {
        "reproduction": name,
        "title": result.title,
        "source": result.source,
        "setup": result.setup,
        "figures": plain(result.figures),
        "remarks": result.remarks,
    }
