"""What a study found: tables of text for people, numbers for programs."""

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
        title: above it
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
    """A value with its interval at each of a chart's places.

    Attributes:
        name: in the legend
        points: (value, low, high) at each place; low and high may equal the value; NaN leaves the place out
    """

    name: str
    points: list[tuple[float, float, float]]


@dataclass
class Chart:
    """Curves over places at equal distances.

    Attributes:
        title: above it
        across: name of the axis of the places, with its unit; empty: their labels say enough
        up: name of the axis of the values, with its unit
        places: labels for readers, such as "centre of mass at 2L/3"; no keys of the figures
        curves: at least one
        bar: value of a line across; None: no line
        bar_name: what the legend says of it
        joined: True: the places are in order, along the horizontal axis, and lines join the points; False: each place is a row with its label
            before it
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
    """A figure that others measured on a real device, and ours. `reproduce realism` gathers these from all studies.

    Attributes:
        what: with its unit
        real: NaN where it was not published
        ours: NaN where there is none
        note: what was fitted or assumed; may be empty
    """

    what: str
    real: float
    ours: float
    note: str = ""


@dataclass
class Result:
    """What a study returns.

    Attributes:
        title: "Ablation of the hyperdimensional slip detector"
        source: what is reproduced: paper and place in it
        figures: every number of the tables, unrounded, by name
        setup: how it was measured, a sentence each
        tables: in the order in which they are shown
        charts: shown before the tables
        remarks: what differs from the paper, and why
        real: figures of real devices beside ours
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
    """For options without a listener."""


@dataclass(frozen=True)
class Options:
    """Options of the command line.

    Attributes:
        data: a dataset to use instead of a fresh one; empty: none
        real: a dataset of imported recordings that also judges; empty: none
        seed: of datasets, item memories and draws; None: not given, 1
        jobs: threads; 0: as many as the machine has
        full: whether the study runs at the paper's size
        synthesise: whether the synthesis runs again instead of its stored figures being read
        trials: of each row; 0: as many as is usual
        only: names of rows to keep
        memories: folder of the published classifier; empty: the source tree's
        output: HTML file of the page; empty: none
        resume: whether to go on with the networks that an earlier run has kept beside `output`
        say: hears what is being done
    """

    data: str = ""
    real: str = ""
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
        """The seed, 1 where none is given."""
        return 1 if self.seed is None else self.seed


def plain(value: Any) -> Any:
    """`value` as JSON has it: numpy's scalars and arrays become Python's, tuples lists, NaN and infinities None.

    Args:
        value: mappings, sequences, arrays and scalars within each other

    Returns:
        dicts, lists, texts, numbers, bools and None

    Raises:
        TypeError: where JSON has no such type
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
        result: of that study

    Returns:
        reproduction, title, source, setup, figures, remarks
    """
    return {"reproduction": name, "title": result.title, "source": result.source, "setup": result.setup, "figures": plain(result.figures),
            "remarks": result.remarks}
