"""Labels and objects of recordings.

From a column, a value, a folder, a file name, or a table of files.
"""

from __future__ import annotations

import re
import signal
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from slipbench import InputError
from slipbench._import.block import Block, nearest, quoted
from slipbench._import.keys import STATES
from slipbench._import.limits import check_inside
from slipbench._import.source import Source
from slipbench.bin import _core

PLACES = ("column", "value", "folder", "file", "table")
UNKNOWN = _core.unknown_state_name
LONGEST_SEARCH = 1.0  # s


def _stop(*_: object) -> None:
    raise TimeoutError


def limit_searches() -> None:
    """Limits the time of each search() in this process.

    Only for the program's own process: it uses the timer and the signal SIGALRM, which belong to
    the caller of import_recordings() and work in the main thread alone.
    """
    signal.signal(signal.SIGALRM, _stop)


def search(pattern: re.Pattern[str], text: str) -> re.Match[str] | None:
    """Searches for a pattern of a map, which may be made to take for ever.

    Raises TimeoutError after LONGEST_SEARCH if limit_searches() was called.
    """
    if signal.getsignal(signal.SIGALRM) is not _stop:
        return pattern.search(text)
    signal.setitimer(signal.ITIMER_REAL, LONGEST_SEARCH)
    try:
        return pattern.search(text)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


@dataclass(frozen=True)
class File:
    """A source: its path in messages, and its name relative to the folder that the user named."""

    path: str
    name: str


class Lookup:
    """A block `state` or `object` of a map."""

    def __init__(self, block: Block) -> None:
        self.block = block
        self.place = block.only_one(PLACES)
        self.folders: list[
            Path
        ] = []  # in which the table may be, besides those of the map and of the command
        self._tables: dict[Path, dict[str, str]] = {}
        self._used: dict[
            tuple[Path, str], str
        ] = {}  # files by the rows of tables that name them without folders
        if self.place == "file":
            try:
                self._pattern = re.compile(block.need("file"))
            except (re.error, RecursionError, OverflowError) as error:
                reason = (
                    error
                    if isinstance(error, re.error)
                    else "its parts are nested too deeply, or repeat too often"
                )
                block.fail(
                    f"{block.path('file')}: expected a regular expression, found {block.need('file')[:80]!r}: {reason}",
                    "file",
                )
            if self._pattern.groups != 1:
                block.fail(
                    f"{block.path('file')}: expected one group in brackets, found {self._pattern.groups} in {block.get('file')!r}",
                    "file",
                )

    @property
    def column(self) -> str | None:
        """Title of the column with the values; None: one value for the whole file."""
        return self.block.need("column") if self.place == "column" else None

    @property
    def table(self) -> str | None:
        """File name of the table of files; None: no table."""
        return self.block.need("table").need("path") if self.place == "table" else None

    def of_file(self, file: File) -> str:
        """The value of a whole file. Raises InputError if the file has none."""
        if self.place == "value":
            return str(self.block.need("value"))
        full = Path(file.path).absolute()
        if self.place == "folder":
            level: int = self.block.need("folder")
            if level > len(full.parents) or not full.parents[level - 1].name:
                raise InputError(
                    f"{file.path}: has no folder {level} levels above it, as {self.block.path('folder')} requires"
                )
            return full.parents[level - 1].name
        if self.place == "file":
            try:
                match = search(self._pattern, full.name)
            except TimeoutError:
                self.block.fail(
                    f"{self.block.path('file')}: the search in {full.name!r} takes more than {LONGEST_SEARCH:g} s; expected a regular expression without nested repetitions",
                    "file",
                )
            if not match or not match[1]:
                raise InputError(
                    f"{file.path}: the name {full.name!r} does not match {self.block.path('file')}: {self._pattern.pattern}"
                )
            return match[1]
        return self._of_table(file, full)

    def _of_table(self, file: File, full: Path) -> str:
        named = self.block.need("table")
        map_folder = Path(named.node.path).absolute().parent
        for folder in (full.parent, map_folder):
            path = (folder / named.need("path")).resolve()  # one table for all files that share it
            if path.is_file():
                try:
                    check_inside(path, [map_folder, *self.folders])
                except InputError as error:
                    named.fail(f"{named.path('path')}: {error}", "path")
                break
        else:
            named.fail(
                f"{named.path('path')}: there is no file {named.need('path')!r} next to {file.path} or the map",
                "path",
            )
        if path not in self._tables:
            self._tables[path] = self._read(path, named)
        rows = self._tables[path]
        for name in (file.name, full.name, full.stem):
            if name in rows:
                other = self._used.setdefault((path, name), file.name)
                if other != file.name:
                    raise InputError(
                        f"{path}: the row {name!r} means {other} and {file.name}; expected names with their folders"
                    )
                return rows[name]
        raise InputError(f"{file.path}: the table {path} has no row for {full.name!r}")

    @staticmethod
    def _read(path: Path, named: Block) -> dict[str, str]:
        from slipbench._import.text import TextTable

        table = TextTable(str(path))
        titles = [table.find(named.get("file", "file")), table.find(named.need("column"))]
        table.load(titles, titles)
        rows: dict[str, str] = {}
        for row, (name, value) in enumerate(
            zip(table.texts(titles[0]), table.texts(titles[1]), strict=True)
        ):
            if name in rows:
                raise InputError(f"{table.place(row)}: names the file {name!r} twice")
            rows[name] = value
        return rows


class States(Lookup):
    """The block `state` of a map."""

    def __init__(self, block: Block) -> None:
        super().__init__(block)
        self._values: dict[str, str] | None = block.get("values")
        for text, state in (self._values or {}).items():
            if self._number(state) is None:
                block.fail(
                    f"{block.path('values')}.{text}: expected {', '.join(STATES)}, 0, 1, 2, 3 or {UNKNOWN}, found {state!r}",
                    "values",
                )

    @staticmethod
    def _number(text: str) -> int | None:
        if text == UNKNOWN:
            return int(_core.unknown_state)
        if text in STATES:
            return STATES[text]
        return int(float(text)) if re.fullmatch(r"[0-3](\.0*)?", text) else None

    def _state(self, text: str, place: str) -> int:
        if self._values is not None:
            if text not in self._values and re.fullmatch(r"[+-]?\d+\.0*", text):
                text = text.partition(".")[0]  # arrays of floating point hold 1 as 1.0
            if text not in self._values and text.lower() in (
                "true",
                "false",
            ):  # as Python, R or YAML writes it
                text = next((one for one in self._values if one.lower() == text.lower()), text)
            if text not in self._values:
                remedy = (
                    "; write false: and true: for labels that are booleans"
                    if text.lower() in ("true", "false")
                    else ""
                )
                raise InputError(
                    f"{place}: the label {quoted(text)} is not in {self.block.path('values')}{nearest(text, list(self._values))}".replace(
                        " found: ", " found there: "
                    )
                    + remedy
                )
            text = self._values[text]
        number = self._number(text)
        if number is None:
            raise InputError(
                f"{place}: expected a label of 0, 1, 2, 3, {', '.join(STATES)} or {UNKNOWN}, found {quoted(text)}"
                f"; define texts in {self.block.path('values')}"
            )
        return number

    def of_rows(self, file: File, source: Source, kept: np.ndarray) -> np.ndarray:
        """The states of the rows `kept`, uint8; unknown_state where the label says so."""
        if self.column is None:
            return np.full(len(kept), self._state(self.of_file(file), file.path), np.uint8)
        texts = source.texts(self.column)
        known: dict[str, int] = {}
        for row in kept.tolist():
            if texts[row] not in known:
                known[texts[row]] = self._state(
                    texts[row], f"{source.place(row)}: column {self.column}"
                )
        return np.array([known[texts[row]] for row in kept.tolist()], np.uint8)


def object_of(lookup: Lookup, file: File, source: Source) -> str:
    """The object of a recording. Raises InputError if a column has several in a file."""
    if lookup.column is None:
        name = lookup.of_file(file)
    else:
        names = sorted(set(source.texts(lookup.column)))
        if len(names) != 1:
            raise InputError(
                f"{file.path}: column {lookup.column} has {len(names)} objects ({', '.join(names[:5])}); expected one per file"
            )
        name = names[0]
    if not _core.is_plain_name(name):
        raise InputError(f"{file.path}: the object is {name!r}; expected a name")
    return name
