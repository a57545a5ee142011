"""Reader of text tables.

Detects separator and decimal mark, pandas parses, errors name file and line.
"""

from __future__ import annotations

import csv
import io
import re
import warnings
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pandas as pd

from slipbench import InputError
from slipbench._import.block import character_text, quoted, unlike_ascii
from slipbench._import.source import MISSING, Source
from slipbench._program import counted

SEPARATORS = ("\t", ";", "|", ",", " ")  # in order of preference; the last stands for any blanks
NAMES = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas", " ": "blanks", "": ""}
SAMPLE = 100  # lines used to detect separator and decimal mark
LARGEST = 2_000_000_000  # bytes of a table, which is held in memory
LONGEST = 1_000_000  # characters of a line
EITHER = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")  # a decimal comma, or a thousands separator
# Possessive, so that a long cell of digits is not divided in every way.
NUMBER = re.compile(r"[+-]?(\d++(\.\d*+)?|\.\d++)([eE][+-]?\d++)?")
COMMA_NUMBER = re.compile(r"[+-]?(\d+,\d+|,\d+)([eE][+-]?\d+)?")
THOUSANDS = {
    mark: re.compile(rf"[+-]?\d{{1,3}}({re.escape(mark)}\d{{3}})+(?!\d)") for mark in ",.'"
}
ARDUINO = re.compile(
    r"\d{1,2}:\d{2}:\d{2}[.,]\d{1,6} -> "
)  # a time of Arduino's serial monitor, before the received text
# "a:1" for Arduino's serial plotter. The limits keep the search linear in long lines.
NAMED_NUMBER = re.compile(r"(?<!\w)[A-Za-z_]\w{0,63} ?: ?[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
MINUS = "\N{MINUS SIGN}"
# First bytes of files that are not tables of text: what they are, and how to read them.
_CONVERT = "convert it to .npz by numpy.savez"
OTHER_FILES = (
    (b"MATLAB 5.0 MAT-file", "a MATLAB file", f"read it by scipy.io.loadmat, and {_CONVERT}"),
    (b"\x89HDF\r\n", "an HDF5 file, such as MATLAB 7.3 writes", f"read it by h5py, and {_CONVERT}"),
    (b"\xd0\xcf\x11\xe0", "an Excel file", "save it as .csv"),
    (
        b"PK\x03\x04",
        "a zip archive, such as Excel's .xlsx",
        "save a table as .csv, or unpack the archive",
    ),
    (b"\x1f\x8b", "compressed by gzip", "unpack it by gunzip"),
    (b"\x28\xb5\x2f\xfd", "compressed by zstd", "unpack it by unzstd"),
    (b"BZh", "compressed by bzip2", "unpack it by bunzip2"),
    (b"PAR1", "a Parquet file", "rename it to .parquet"),
    (b"\x93NUMPY", "an array of numpy", "rename it to .npy"),
    (b"\x89MCAP", "an MCAP file", "rename it to .mcap"),
    (b"#ROSBAG", "a bag of ROS 1", "rename it to .bag"),
    (b"SQLite format 3", "an SQLite database", "give the folder with the bag's metadata.yaml"),
    (b"TDSm", "a TDMS file of LabVIEW", f"read it by the package npTDMS, and {_CONVERT}"),
    (b"%PDF-", "a PDF document", "save the table as .csv in the program that made it"),
    (b"\x80\x02", "a pickle file of Python", f"load it, and {_CONVERT}"),
    (b"\x80\x03", "a pickle file of Python", f"load it, and {_CONVERT}"),
    (b"\x80\x04", "a pickle file of Python", f"load it, and {_CONVERT}"),
    (b"\x80\x05", "a pickle file of Python", f"load it, and {_CONVERT}"),
)
JSON = re.compile(rb'(\xef\xbb\xbf)?\s*(\{\s*"|\[\s*[\[{])')  # the beginning of a file in JSON
TEXT_KINDS = "expected a table of text (.csv, .tsv, .txt, .dat, .lvm), Parquet, .npz, .npy or a bag"


csv.field_size_limit(LARGEST)  # the length of lines is checked


def decoded(path: str) -> str:
    """The text of a file in UTF-8, UTF-16 with or without a byte order mark, or Latin 1."""
    if Path(path).stat().st_size > LARGEST:
        raise InputError(f"{path}: the table has more than {LARGEST / 1e9:.0f} GB; split the file")
    data = Path(path).read_bytes()
    for beginning, what, remedy in OTHER_FILES:
        if data.startswith(beginning):
            raise InputError(f"{path}: is {what}; {TEXT_KINDS}; {remedy}")
    if JSON.match(data):
        raise InputError(
            f"{path}: is a JSON file; {TEXT_KINDS}; read it by pandas.read_json, and save it by to_csv"
        )
    encodings = ["utf-8-sig", "latin-1"]
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encodings = ["utf-16"]
    elif data[1:200:2].count(0) > 80 or (len(data) > 3 and data[1] == data[3] == 0):
        encodings = ["utf-16-le"]
    for encoding in encodings:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text.replace("\r\n", "\n").replace("\r", "\n")
    raise InputError(f"{path}: is not text: it has bytes of value 0; {TEXT_KINDS}")


def cells_of(line: str, separator: str) -> list[str]:
    """The cells of a line, without quotes and surrounding blanks."""
    if separator == " ":
        line, separator = " ".join(line.split()), " "
    if not separator:
        return [line.strip().strip('"')]
    return [
        cell.strip()
        for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    ]


def filled(cells: list[str]) -> int:
    """Number of cells without trailing empty ones."""
    count = len(cells)
    while count and not cells[count - 1]:
        count -= 1
    return count


def find_separator(lines: list[str]) -> str:
    """The separator for which most lines have as many cells as the first.

    Empty: a single column.
    """
    best, most = "", 0
    for separator in SEPARATORS:
        counts = [filled(cells_of(line, separator)) for line in lines]
        agree = sum(count == counts[0] for count in counts)
        if counts[0] > 1 and agree > max(most, 1 if len(counts) > 1 else 0, len(counts) // 2):
            best, most = separator, agree
    if not best and len(lines) > 1:
        # No separator fits most lines: use that of the header, so that rows are rejected by their
        # number of cells. A single title may have blanks.
        for one in SEPARATORS:
            if filled(cells_of(lines[0], one)) > 1 and (
                one != " " or filled(cells_of(lines[1], one)) > 1
            ):
                return one
    return best


def find_decimal(lines: list[str], separator: str) -> str:
    """The decimal mark of the cells: a comma if cells have one and no cell has a point."""
    cells = [cell for line in lines for cell in cells_of(line, separator)]
    commas = any(COMMA_NUMBER.fullmatch(cell) for cell in cells)
    points = any("." in cell and NUMBER.fullmatch(cell) for cell in cells)
    return "," if commas and not points else "."


class TextTable(Source):
    """A text table with its header; load() reads the columns.

    Args:
        path: path of the file
        separator: between cells, "blanks" or "tab"; empty: detected
        decimal: decimal mark; empty: detected
        thousands: thousands separator; empty: none
        header: True if the first line holds titles
        skip: number of skipped first lines, or numbers of skipped lines
        comment: beginning of skipped lines; "none": none are skipped
    """

    def __init__(
        self,
        path: str,
        separator: str = "",
        decimal: str = "",
        thousands: str = "",
        header: bool = True,
        skip: int | list[int] = 0,
        comment: str = "#",
    ) -> None:
        super().__init__(path)
        skipped = set(range(1, skip + 1)) if isinstance(skip, int) else set(skip)
        all_lines = list(enumerate(decoded(path).split("\n"), 1))
        every = [one for one in all_lines if one[1].strip() and one[0] not in skipped]
        # Written by Excel.
        if every and (named := re.fullmatch(r"sep=(.)", every[0][1].strip())):
            separator, every = separator or named[1], every[1:]
        rows = [
            one for one in every if comment == "none" or not one[1].lstrip().startswith(comment)
        ]
        self._check_lines(rows, header)
        self._find_marks(rows[:SAMPLE], separator, decimal, thousands, header)
        self._find_titles(every[: every.index(rows[0])], rows[0], header, comment)
        if header and self._header_line == rows[0][0]:
            rows = rows[1:]
        rows = self._with_empty_rows(rows, all_lines, skipped)
        self._numbers = [number for number, _ in rows]
        self._lines = [line for _, line in rows]
        self._find_labview_header(all_lines)
        self._frame = pd.DataFrame()

    def _check_lines(self, rows: list[tuple[int, str]], header: bool) -> None:
        """Raises InputError for a file without lines, or with a line that is too long."""
        if not rows:
            raise InputError(
                f"{self.path}:1: the file has no rows; expected {'titles and ' if header else ''}one row per sample"
            )
        number, longest = max(rows, key=lambda one: len(one[1]))
        if len(longest) > LONGEST:
            raise InputError(
                f"{self.path}:{number}: the line has more than {LONGEST} characters; expected a table of text"
            )

    def _find_marks(
        self,
        rows: list[tuple[int, str]],
        separator: str,
        decimal: str,
        thousands: str,
        header: bool,
    ) -> None:
        """Sets the separator of cells, the decimal mark and the thousands separator.

        Raises InputError if they contradict each other or cannot be distinguished in `rows`.
        """
        sample = [line for _, line in rows]
        self._separator = {"tab": "\t", "blanks": " "}.get(separator, separator) or find_separator(
            sample
        )
        if len(self._separator) > 1:
            raise InputError(
                f"separator: expected one character, tab or blanks, found {separator!r}"
            )
        self.thousands = thousands
        self._decimal = (
            decimal
            or {",": ".", ".": ","}.get(thousands, "")
            or find_decimal(sample[1:] if header else sample, self._separator)
        )
        if self._decimal == "," and not decimal and not thousands and self._separator != ";":
            self._refuse_doubtful(rows)
        if self._decimal == thousands:
            raise InputError(
                f"decimal and thousands: expected two marks, found {thousands!r} for both"
            )

    def _find_titles(
        self, above: list[tuple[int, str]], first_row: tuple[int, str], header: bool, comment: str
    ) -> None:
        """Sets the titles and their line. `above`: the lines before the first row."""
        self._header_line, line = first_row
        first = cells_of(line, self._separator)
        count = filled(first)
        if header and above and all(self._is_number(cell) for cell in first[:count]):
            # numpy.savetxt writes the titles as a comment.
            titles = cells_of(above[-1][1].lstrip().removeprefix(comment).strip(), self._separator)
            if filled(titles) == count and not any(self._is_number(cell) for cell in titles):
                first, self._header_line = titles, above[-1][0]
        # A column without a title, such as the index of pandas, is named by its number.
        self.titles = [first[k] if header and first[k] else str(k + 1) for k in range(count)]
        self._numeric_header = (
            header and bool(first) and all(self._is_number(cell) for cell in self.titles)
        )

    def _with_empty_rows(
        self, rows: list[tuple[int, str]], all_lines: list[tuple[int, str]], skipped: set[int]
    ) -> list[tuple[int, str]]:
        """The rows, with the lines between them that have separators alone.

        A sample without values, which counts if times follow from a rate.
        """
        if self._separator not in ("\t", "") or not rows:
            return rows
        empty = [
            (number, line)
            for number, line in all_lines
            if rows[0][0] < number < rows[-1][0]
            and number not in skipped
            and not line.strip()
            and self._separator in line
        ]
        return sorted(rows + empty)

    def _find_labview_header(self, all_lines: list[tuple[int, str]]) -> None:
        """Sets the last line of LabVIEW's header if it was read as a part of the table."""
        ends = [number for number, line in all_lines if line.startswith("***End_of_Header***")]
        # A file has a header, then each segment.
        self._labview = ends[:2][-1] if ends and self._header_line < ends[0] else None

    def _refuse_doubtful(self, lines: list[tuple[int, str]]) -> None:
        """Raises InputError if all commas in cells could be decimal marks or mark thousands."""
        commas = [
            (number, cell)
            for number, line in lines
            for cell in cells_of(line, self._separator)
            if COMMA_NUMBER.fullmatch(cell)
        ]
        if all(EITHER.fullmatch(cell) for _, cell in commas):
            number, cell = commas[0]
            raise InputError(
                f"{self.path}:{number}: {cell!r} has a decimal comma or a mark between thousands, which cannot be distinguished; set decimal: ',' "
                f"or thousands: ',' in the map"
            )

    def _is_number(self, cell: str) -> bool:
        return bool(NUMBER.fullmatch(cell.replace(self._decimal, ".")))

    def place(self, row: int) -> str:
        return f"{self.path}:{self._numbers[row]}" if row < len(self._numbers) else self.path

    def row_text(self, row: int) -> str:
        return f"line {self._numbers[row]}"

    def title_place(self) -> str:
        return f"{self.path}:{self._header_line}"

    def layout_hint(self) -> str:
        sample = self._lines[:SAMPLE]
        monitor = [match[0] for line in sample if (match := ARDUINO.match(line.strip()))]
        if len(monitor) > len(sample) // 2:
            return (
                f"; lines begin with {monitor[0].strip()!r}, like times of Arduino's serial monitor: replace ' -> ' by the separator, or record "
                f"without timestamps"
            )
        plotter = [NAMED_NUMBER.search(line) for line in sample]
        if (
            plotter
            and plotter[0]
            and all(not NAMED_NUMBER.sub("", line).strip(" \t,;") for line in sample)
        ):
            return (
                f"; cells such as {plotter[0][0]!r} are a name and a number, like output for Arduino's serial plotter: write only the numbers, and "
                f"the names as titles"
            )
        return ""

    def title_hint(self) -> str:
        if hint := self.layout_hint():
            return hint
        if self._numeric_header:
            return "; the first line contains numbers: a table without titles needs header: false, which calls the columns 1, 2, 3"
        if self._labview is not None:
            return f"; the file begins with a header of LabVIEW, and the titles are in line {self._labview + 1}: skip: {self._labview}"
        if not self._separator:
            return "; read as one column"
        return f"; read with {NAMES.get(self._separator, repr(self._separator))} between the cells"

    def load(self, titles: Iterable[str], texts: Iterable[str]) -> None:
        """Reads columns.

        Args:
            titles: titles of all needed columns
            texts: those of `titles` to read as texts
        """
        if not self._lines:
            raise InputError(f"{self.title_place()}: the table has titles but no rows")
        count = len(self.titles)
        texts = set(texts)
        widths = [self._width(line) for line in self._lines]
        width = max(widths)
        if self._separator == " " and min(widths) < count:
            row = widths.index(min(widths))
            raise InputError(
                f"{self.place(row)}: has {counted(widths[row], 'cell')}; expected {count}: with blanks as separators the missing cell is unknown"
            )
        wanted = {title: k for k, title in enumerate(self.titles) if title in set(titles)}
        places = {title: k for title, k in wanted.items() if k < width}
        beyond = range(count, width)  # columns without a title, which must be empty
        kinds = {k: str for k in range(width) if k in beyond or self.titles[k] in texts}
        frame = self._read(width, sorted([*places.values(), *beyond]), kinds)
        for k in beyond:
            for row in np.flatnonzero((frame[k].astype(str).str.strip() != "").to_numpy())[:1]:
                self._refuse_cells(int(row))
        self._frame = frame.rename(columns={k: title for title, k in places.items()})
        for title in wanted.keys() - places.keys():  # no row is long enough
            self._frame[title] = ""

    def _read(self, width: int, used: list[int], kinds: dict[int, type[str]]) -> pd.DataFrame:
        """Reads the columns `used` of a table of `width` columns; `kinds`: those that are texts."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                frame = pd.read_csv(
                    io.StringIO("\n".join(self._lines) + "\n"),
                    header=None,
                    names=list(range(width)),
                    index_col=False,
                    usecols=used,
                    sep=r"\s+" if self._separator == " " else self._separator or "\0",
                    decimal=self._decimal,
                    dtype=kinds,
                    na_filter=False,
                    skip_blank_lines=False,
                    skipinitialspace=True,
                    float_precision="round_trip",
                    low_memory=False,
                    engine="c",
                )
        except (
            pd.errors.ParserError,
            pd.errors.EmptyDataError,
            ValueError,
            OverflowError,
        ) as error:
            raise InputError(
                f"{self.path}: cannot be read as a table: {str(error).strip()}"
            ) from error
        if len(frame) != len(self._lines):
            raise InputError(
                f"{self.path}: the table has {counted(len(self._lines), 'line')} and {counted(len(frame), 'row')}; expected one row per line, "
                f"without line breaks inside quotes"
            )
        return frame

    def _width(self, line: str) -> int:
        if '"' in line or not self._separator:
            return len(cells_of(line, self._separator))
        return len(line.split()) if self._separator == " " else line.count(self._separator) + 1

    def _refuse_cells(self, row: int) -> None:
        cells = cells_of(self._lines[row], self._separator)
        cause = self.layout_hint() or self._row_hint(cells)
        raise InputError(
            f"{self.place(row)}: has {counted(filled(cells), 'cell')}; expected {len(self.titles)}{cause}"
        )

    def _row_hint(self, cells: list[str]) -> str:
        if (
            self._separator == ","
            and len(cells) > len(self.titles)
            and all(re.fullmatch(r"[+-]?\d+", cell) for cell in cells if cell)
        ):
            return "; commas seem to be both the separator and the decimal mark, which cannot be distinguished"
        if all(
            filled(cells_of(line, self._separator)) == len(self.titles) + 1
            for line in self._lines[:SAMPLE]
        ):
            return "; where rows begin with a name that has no title, as R writes them, use header: false and skip the titles"
        return ""

    def __len__(self) -> int:
        return len(self._lines)

    def values(self, title: str) -> np.ndarray:
        column = self._frame[title]
        if column.dtype.kind in "iuf":
            values: np.ndarray = column.to_numpy(float)
        else:
            values = self._numbers_of(title, column.astype(str).to_list())
        infinite = np.flatnonzero(np.isinf(values))
        if infinite.size:
            row = int(infinite[0])
            self._refuse(
                title, row, cells_of(self._lines[row], self._separator)[self.titles.index(title)]
            )
        return values

    def _numbers_of(self, title: str, cells: list[str]) -> np.ndarray:
        values = np.empty(len(cells))
        for row, cell in enumerate(cells):
            text = cell.strip().replace(MINUS, "-")
            if self.thousands and THOUSANDS[self.thousands].match(text):
                text = text.replace(self.thousands, "")
            if self._decimal == ",":
                text = text.replace(".", "\0").replace(
                    ",", "."
                )  # a point separates thousands in such a table
            if NUMBER.fullmatch(text):
                values[row] = float(text)
            elif text.lower() in MISSING:
                values[row] = np.nan
            else:
                self._refuse(title, row, cell)
        return values

    def _refuse(self, title: str, row: int, cell: str) -> None:
        cause = self.layout_hint() or self._cell_hint(row, cell)
        raise InputError(
            f"{self.place(row)}: column {self.titles.index(title) + 1}, {title}: expected a number, found {quoted(cell)}{cause}"
        )

    def _cell_hint(self, row: int, cell: str) -> str:
        if row == 0 and all(
            not self._is_number(one) for one in cells_of(self._lines[0], self._separator)
        ):
            return f"; skip a row of units by skip: [{self._numbers[0]}]"
        if odd := unlike_ascii(cell):
            return f", which has {', '.join(map(character_text, odd[:5]))}"
        if re.fullmatch(r"[+-]?\d{1,3}([,.' ]\d{3})+([.,]\d*)?", cell.strip()):
            return "; set the mark between thousands in the map: thousands: ','"
        if re.fullmatch(r"[+-]?[\d.]+[dD][+-]?\d+", cell.strip()):
            return "; write the exponent with E"
        return ""

    def texts(self, title: str) -> list[str]:
        return [cell.strip() for cell in self._frame[title].astype(str).to_list()]
