"""Common interface of all readers: columns by their titles, and the location of each row."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from slipbench import InputError
from slipbench._import.block import nearest, quoted
from slipbench._import.times import formatted_moment, is_moment, moment_of
from slipbench._program import counted

MISSING = (
    "",
    "nan",
    "-nan",
    "+nan",
    "na",
    "n/a",
    "null",
    "none",
    "-",
)  # cells without a value, in lower case
RANGE = " .. "


class Source:
    """Columns by their titles. A column has one value, or an array of any shape, per row.

    Attributes:
        path: path of the file
        titles: titles of its columns
        thousands: thousands separator in its cells; empty: none
        left_out: for each column of the file without a title, the reason for messages: "holds 7
            rows"
        in_folder: True if the file was found in a folder, where the map can select files
    """

    titles: list[str]
    thousands = ""
    left_out: dict[str, str]
    in_folder = False

    def __init__(self, path: str) -> None:
        self.path = path
        self.titles = []
        self.left_out = {}

    def __len__(self) -> int:
        raise NotImplementedError

    def load(self, titles: Iterable[str], texts: Iterable[str]) -> None:
        """Reads the columns `titles`, if they were not read with the header.

        Those of the subset `texts` are read as texts.
        """

    def values(self, title: str) -> np.ndarray:
        """A column as float64 [T, ...]; a missing value is NaN.

        Raises InputError for a cell that is not a number.
        """
        raise NotImplementedError

    def texts(self, title: str) -> list[str]:
        """A column as texts."""
        raise NotImplementedError

    def spacing(self, title: str) -> float:
        """Spacing of numbers at the largest value of a column; 0 if the column is exact."""
        return 0.0

    def clock(self) -> np.ndarray | None:
        """Times of the rows in ns of the recorder's clock; None: no clock."""
        return None

    def place(self, row: int) -> str:
        """Location of a row, "FILE:LINE" or "FILE: row 7"."""
        return f"{self.path}: {self.row_text(row)}"

    def row_text(self, row: int) -> str:
        """A row without its file: "row 7", "line 8", "message 7"."""
        return f"row {row + 1}"

    def title_place(self) -> str:
        """Location of the titles."""
        return self.path

    def title_hint(self) -> str:
        """Returns the hint of an error about an unknown title."""
        return ""

    def layout_hint(self) -> str:
        """Returns the end of an error that names the file's content outside of cells.

        Empty: unknown.
        """
        return ""

    def _folder_hint(self) -> str:
        return (
            "; if the folder also contains other files, files: '*_a.csv' in the map selects files by name"
            if self.in_folder
            else ""
        )

    def find(self, title: str) -> str:
        """Returns `title`. Raises InputError unless there is exactly one such column."""
        if title in self.left_out:
            raise InputError(f"{self.title_place()}: {title!r} {self.left_out[title]}")
        if title not in self.titles:
            raise InputError(
                f"{self.title_place()}: has no column {quoted(title)}{nearest(title, self.titles)}{self.title_hint()}{self._folder_hint()}"
            )
        if self.titles.count(title) > 1:
            raise InputError(
                f"{self.title_place()}: has {self.titles.count(title)} columns {title!r}; titles that the map names must differ; "
                "columns of a table have numbers with header: false and the line of titles in skip"
            )
        return title

    def find_all(self, columns: list[str], where: str) -> tuple[list[str], int]:
        """Resolves the `columns` of a channel to titles, in the order of its values.

        Args:
            columns: titles, "A .. B", and titles with *
            where: the key, for messages

        Returns:
            The titles, and the number of components by *: 1 without.
        """
        starred = [title for title in columns if "*" in title and title not in self.titles]
        if not starred:
            return [one for title in columns for one in self._resolved(title)], 1
        if len(starred) < len(columns):
            raise InputError(f"{where}: titles with and without * cannot be in one list")
        groups = [self._matches(title) for title in starred]
        self._check_alike(starred, groups)
        return [title for row in zip(*groups, strict=True) for _, title in row], len(starred)

    def _resolved(self, title: str) -> list[str]:
        """The titles meant by a title or by "A .. B"."""
        if RANGE not in title or title in self.titles:
            return [self.find(title)]
        first, last = (self.titles.index(self.find(end)) for end in title.split(RANGE, 1))
        if last < first:
            raise InputError(
                f"{self.title_place()}: {title!r} is reversed; name the first column first"
            )
        return [self.find(one) for one in self.titles[first : last + 1]]

    def _check_alike(
        self, starred: list[str], groups: list[list[tuple[tuple[int, ...], str]]]
    ) -> None:
        """Raises InputError unless each title with * means columns of the same numbers."""
        for title, group in zip(starred, groups, strict=True):
            if len(group) != len(groups[0]):
                raise InputError(
                    f"{self.title_place()}: {starred[0]!r} is {counted(len(groups[0]), 'column')} and {title!r} is {len(group)}; "
                    "expected as many"
                )
        for row in zip(*groups, strict=True):
            for numbers, title in row:
                if numbers != row[0][0]:
                    raise InputError(
                        f"{self.title_place()}: the column {title!r} would be paired with {row[0][1]!r}; expected columns of the "
                        "same numbers for each title with *"
                    )

    def _matches(self, title: str) -> list[tuple[tuple[int, ...], str]]:
        """The numbers matched by each *, and the title, in ascending order of numbers."""
        if re.search(r"\*[*0-9]", title):  # several divisions of the digits would match
            raise InputError(
                f"{self.title_place()}: {title!r}: a * stands for a whole number; expected another character than * or a digit after it"
            )
        pattern = re.compile(r"([0-9]{1,18}+)".join(re.escape(part) for part in title.split("*")))
        found = [
            (tuple(int(number) for number in match.groups()), one)
            for one in self.titles
            if (match := pattern.fullmatch(one))
        ]
        for one, reason in self.left_out.items():
            if pattern.fullmatch(one):
                raise InputError(f"{self.title_place()}: {one!r}, which {title!r} means, {reason}")
        if not found:
            raise InputError(
                f"{self.title_place()}: no column is called {title!r} with a number for each *{nearest(title, self.titles)}"
                f"{self.title_hint()}{self._folder_hint()}"
            )
        return [(numbers, self.find(one)) for numbers, one in sorted(found)]


def resolution_of(cells: Iterable[str]) -> float:
    """Resolution of numbers as written: 0.001 for "1.250", 1 for "7"."""
    least = np.inf
    for cell in set(
        re.sub(r"\d", "0", cell) if "e" not in cell.lower() else cell for cell in cells
    ):
        mantissa, _, exponent = cell.lower().replace(",", ".").partition("e")
        decimals = len(mantissa.partition(".")[2])
        least = min(least, float(f"1e{int(exponent or 0) - decimals}"))
    return float(least)


def stamps_of(
    source: Source, title: str, scale: float | None, pattern: str = ""
) -> tuple[np.ndarray, float]:
    """The times of a column.

    Args:
        source: the table
        title: title of the column
        scale: its unit in seconds; None: not stated in the map; the column may be ISO 8601 or a
            time of day
        pattern: strptime pattern of a date or a time of day; empty: ISO 8601

    Returns:
        Times [T] s, NaN if missing, and their resolution [s].
    """
    texts = source.texts(title)
    filled = [text for text in texts if text.lower() not in MISSING]
    if pattern or (filled and is_moment(filled[0])):
        if scale is not None:
            raise InputError(
                f"{source.place(0)}: column {title!r} has times as {quoted(filled[0])}, which have no unit and no scale"
            )
        return _moments(source, title, texts, pattern)
    times = source.values(title) * (scale or 1.0)
    filled = [text.replace(source.thousands, "") for text in filled] if source.thousands else filled
    numbers = [text for text in filled if re.fullmatch(r"[+-]?[\d.,]+([eE][+-]?\d{1,3})?", text)]
    return times, max(resolution_of(numbers) if numbers else 0.0, source.spacing(title)) * (
        scale or 1.0
    )


def _moments(
    source: Source, title: str, texts: list[str], pattern: str
) -> tuple[np.ndarray, float]:
    """Times of a column of dates or times of day, NaN if missing, and their resolution [s]."""
    times, resolution = np.full(len(texts), np.nan), np.inf
    for row, text in enumerate(texts):
        if text.lower() in MISSING:
            continue
        try:
            if pattern:
                times[row] = formatted_moment(text, pattern)
            else:
                times[row], written = moment_of(text)
                resolution = min(resolution, written)
        except ValueError as error:
            expected = (
                f"a time in the format of time.format, {pattern!r}"
                if pattern
                else "a time in ISO 8601 such as 2026-02-03T10:00:00.01, or a time of day such as 10:00:00.01"
            )
            hint = source.layout_hint()
            if pattern:
                hint = f": {str(error)[:200]}{hint}"
            raise InputError(
                f"{source.place(row)}: column {title}: expected {expected}, found {quoted(text)}"
                + (
                    hint
                    or "; define the format of times by time.format, such as '%d.%m.%Y %H:%M:%S.%f'"
                )
            ) from None
    if pattern:
        # The fraction may be anywhere in such a text: its digits are those of the microseconds.
        micro = np.round(times[~np.isnan(times)] % 1.0 * 1e6).astype(int)
        resolution = 10.0 ** -next(
            digits for digits in range(7) if not (micro % 10 ** (6 - digits)).any()
        )
    return times, resolution if np.isfinite(resolution) else 0.0
