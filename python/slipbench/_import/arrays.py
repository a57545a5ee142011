"""Readers of NumPy arrays and Parquet tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from slipbench import InputError
from slipbench._import.source import Source
from slipbench._program import counted

LARGEST = 2_000_000_000  # bytes of all arrays, which are held in memory


class Columns(Source):
    """Columns in memory, each [T, ...] of numbers or [T] of texts. `left_out`: as in Source."""

    def __init__(
        self, path: str, columns: dict[str, Any], left_out: dict[str, str] | None = None
    ) -> None:
        super().__init__(path)
        self._columns = columns
        self.titles = list(columns)
        self.left_out = left_out or {}

    def __len__(self) -> int:
        return len(next(iter(self._columns.values())))

    def values(self, title: str) -> np.ndarray:
        column = self._columns[title]
        if column.dtype.kind not in "biuf":
            raise InputError(f"{self.path}: {title} contains {column.dtype}; expected numbers")
        if column.size * 8 > LARGEST:
            raise InputError(
                f"{self.path}: {title} has {column.size} values; expected at most {LARGEST // 8}; split the file"
            )
        values: np.ndarray = column.astype(float)
        if np.isinf(values).any():
            raise InputError(
                f"{self.place(int(np.argwhere(np.isinf(values))[0][0]))}: {title} contains an infinite value"
            )
        return values

    def texts(self, title: str) -> list[str]:
        column = self._columns[title]
        if column.ndim != 1:
            raise InputError(
                f"{self.path}: {title} has {column.ndim} dimensions; expected one value per row"
            )
        if column.dtype.kind == "M":
            return [
                "" if text == "NaT" else text for text in np.datetime_as_string(column).tolist()
            ]
        if column.dtype.kind == "f":
            return ["" if np.isnan(value) else f"{value!r}" for value in column.tolist()]
        if column.dtype.kind == "b":
            return [
                "true" if value else "false" for value in column.tolist()
            ]  # as YAML writes them
        try:
            return [str(value) for value in column.tolist()]
        except (SystemError, ValueError) as error:  # code points beyond Unicode
            raise InputError(
                f"{self.path}: {title} contains a text that cannot be read: {error}"
            ) from error

    def spacing(self, title: str) -> float:
        column = self._columns[title]
        if column.dtype.kind != "f" or np.isnan(column).all():
            return 0.0
        return float(np.spacing(np.nanmax(np.abs(column))))


def read_npy(path: str) -> Columns:
    """Reads an array [T, N] or a structured array [T].

    The columns are named 1 to N, or by the names of the fields.
    """
    try:
        array = np.load(path, allow_pickle=False, mmap_mode="r")
    except Exception as error:  # noqa: BLE001  a damaged header raises what Python's parser and tokenizer raise
        raise InputError(f"{path}: cannot be read as an array: {error}") from error
    if not isinstance(array, np.ndarray) or array.ndim == 0 or array.size == 0:
        raise InputError(f"{path}: expected an array with one row per sample")
    if array.dtype.names:
        return Columns(path, {name: array[name] for name in array.dtype.names})
    return Columns(
        path, {str(k + 1): column for k, column in enumerate(array.reshape(len(array), -1).T)}
    )


def read_npz(path: str) -> Columns:
    """Reads arrays by their names.

    Arrays with another number of rows than most, such as constants, are left out: naming one is an
    error.
    """
    try:
        with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as file:
            size = sum(member.file_size for member in file.zip.infolist())
            arrays = {} if size > LARGEST else {name: file[name] for name in file.files}
    except Exception as error:  # noqa: BLE001  damage shows in the archive, its compression or a header
        raise InputError(f"{path}: cannot be read as arrays: {error}") from error
    if size > LARGEST:
        raise InputError(
            f"{path}: the arrays have {size / 1e9:.1f} GB; expected at most {LARGEST / 1e9:.0f} GB; split the file"
        )
    arrays = {
        name: array for name, array in arrays.items() if isinstance(array, np.ndarray)
    }  # skips other members
    rows = Counter(len(array) for array in arrays.values() if array.ndim and array.size)
    if not rows:
        raise InputError(
            f"{path}: has no array with one row per sample; found: {', '.join(list(arrays)[:10])}"
        )
    most = max(rows, key=lambda count: (rows[count], count))
    kept = {name: array for name, array in arrays.items() if array.ndim and len(array) == most}
    left_out = {
        name: f"has {counted(len(array), 'row') if array.ndim else 'one value without rows'}; expected {most}, as most arrays have"
        for name, array in arrays.items()
        if name not in kept
    }
    return Columns(path, kept, left_out)


class ParquetTable(Columns):
    """The columns of a Parquet file, of which load() reads the ones that the map names.

    Lists of equal length are arrays. Texts are read as dictionaries: a text that many rows have is
    in memory once. Raises InputError if the file is not a Parquet table.
    """

    def __init__(self, path: str) -> None:
        super().__init__(path, {})
        self._read(self._read_head)

    def __len__(self) -> int:
        return int(self._rows)

    def load(self, titles: Iterable[str], texts: Iterable[str]) -> None:
        titles = list(dict.fromkeys(titles))
        self._read(lambda file: self._read_columns(file, titles))

    def _read(self, work: Callable[[Any], None]) -> None:
        """Calls `work` with the open file. Raises InputError if the file is damaged."""
        import pyarrow.parquet

        texts = getattr(self, "_texts", None)
        try:
            # By a file object: pyarrow takes some names, such as a:b.parquet, for addresses.
            with (
                open(self.path, "rb") as stream,
                pyarrow.parquet.ParquetFile(stream, read_dictionary=texts) as file,
            ):
                work(file)
        except (InputError, MemoryError):
            raise
        except Exception as error:  # noqa: BLE001  pages are decoded column by column, and texts when they are converted
            raise InputError(f"{self.path}: cannot be read as Parquet: {error}") from error

    def _read_head(self, file: Any) -> None:
        self.titles, self._rows = list(file.schema_arrow.names), file.metadata.num_rows
        self._texts = [field.name for field in file.schema_arrow if _has_texts(field.type)]
        for title, count in Counter(self.titles).items():
            if count > 1:
                raise InputError(
                    f"{self.path}: has {count} columns {title!r}; titles must differ; rename one of them"
                )
        if self._rows == 0:
            raise InputError(f"{self.path}: the table has no rows")

    def _read_columns(self, file: Any, titles: list[str]) -> None:
        self._check_size(file, titles)
        for title in titles:
            kind = file.schema_arrow.field(title).type
            if _has_texts(_items(kind)) and not _has_texts(kind):
                raise InputError(
                    f"{self.path}: column {title!r} contains lists of texts; expected numbers, lists of numbers, or texts"
                )
        table = file.read(
            columns=titles
        )  # and other columns whose titles begin with one of these and a point
        if table.num_rows != self._rows:
            raise InputError(
                f"{self.path}: is damaged: has {counted(table.num_rows, 'row')}; expected {self._rows}, as its footer states"
            )
        self._columns = {
            title: _parquet_column(f"{self.path}: column {title!r}", table.column(title))
            for title in titles
        }

    def _check_size(self, file: Any, titles: list[str]) -> None:
        """Raises InputError if the columns are too large according to the footer.

        A small file may have many rows of one value, or a long list in each row.
        """
        head = file.metadata
        leaves = [
            k
            for k in range(head.num_columns)
            if any(
                file.schema.column(k).path == title
                or file.schema.column(k).path.startswith(f"{title}.")
                for title in titles
            )
        ]
        values, size = 0, 0
        for k in leaves:
            parts = [head.row_group(group).column(k) for group in range(head.num_row_groups)]
            count = max(sum(part.num_values for part in parts), self._rows)
            values += count
            # Values of fixed length are decoded one by one; a text is decoded once for each row group.
            size += max(
                count * file.schema.column(k).length,
                sum(part.total_uncompressed_size for part in parts),
            )
        if values * 8 > LARGEST:
            raise InputError(
                f"{self.path}: columns {', '.join(titles[:10])} have {values} values in {counted(self._rows, 'row')}; "
                f"expected at most {LARGEST // 8} values; split the file"
            )
        if size > LARGEST:
            raise InputError(
                f"{self.path}: columns {', '.join(titles[:10])} take {size / 1e9:.3g} GB when they are unpacked; "
                f"expected at most {LARGEST / 1e9:.3g} GB; split the file"
            )


def read_parquet(path: str) -> ParquetTable:
    """Reads the titles of a Parquet file; load() reads its columns."""
    return ParquetTable(path)


def _has_texts(kind: Any) -> bool:
    """True for a column of texts or bytes of any length."""
    import pyarrow as pa

    if pa.types.is_dictionary(kind):
        return _has_texts(kind.value_type)
    tests = (
        pa.types.is_string,
        pa.types.is_large_string,
        pa.types.is_string_view,
        pa.types.is_binary,
        pa.types.is_large_binary,
        pa.types.is_binary_view,
    )
    return any(test(kind) for test in tests)


def _is_list(kind: Any) -> bool:
    import pyarrow as pa

    return bool(
        pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind) or pa.types.is_large_list(kind)
    )


def _items(kind: Any) -> Any:
    """Type of the items of a list of lists; `kind` itself for another type."""
    while _is_list(kind):
        kind = kind.value_type
    return kind


def _parquet_column(where: str, column: Any) -> Any:
    """A column as an array: times as texts, lists of equal length as [T, N]."""
    import pyarrow as pa

    if pa.types.is_timestamp(column.type):
        return np.array(
            ["" if value is None else value.isoformat() for value in column.to_pylist()]
        )
    if pa.types.is_dictionary(column.type) and _has_texts(column.type):
        return np.concatenate([_shared_texts(chunk) for chunk in column.chunks])
    if _is_list(column.type):
        try:
            return np.array(column.to_pylist(), dtype=float)
        except ValueError:
            raise InputError(f"{where}: its lists differ in length") from None
    return column.to_numpy()


def _shared_texts(chunk: Any) -> np.ndarray:
    """The texts of an array with a dictionary, each of which is one object; None if missing."""
    import pyarrow as pa

    words = [*chunk.dictionary.to_pylist(), None]
    indices = (
        chunk.indices.cast(pa.int64()).fill_null(len(words) - 1).to_numpy(zero_copy_only=False)
    )
    found: np.ndarray = np.array(words, dtype=object)[indices]
    return found
