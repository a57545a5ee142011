"""Readers of NumPy arrays and Parquet tables."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from slipbench import InputError
from slipbench._import.source import Source
from slipbench._program import counted

LARGEST = 2_000_000_000  # bytes of all arrays, which are held in memory


class Columns(Source):
    """Columns in memory, each [T, ...] of numbers or [T] of texts. `left_out`: as in Source."""

    def __init__(self, path: str, columns: dict[str, Any], left_out: dict[str, str] | None = None) -> None:
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
            raise InputError(f"{self.path}: {title} has {column.size} values; expected at most {LARGEST // 8}; split the file")
        values: np.ndarray = column.astype(float)
        if np.isinf(values).any():
            raise InputError(f"{self.place(int(np.argwhere(np.isinf(values))[0][0]))}: {title} contains an infinite value")
        return values

    def texts(self, title: str) -> list[str]:
        column = self._columns[title]
        if column.ndim != 1:
            raise InputError(f"{self.path}: {title} has {column.ndim} dimensions; expected one value per row")
        if column.dtype.kind == "M":
            return ["" if text == "NaT" else text for text in np.datetime_as_string(column).tolist()]
        if column.dtype.kind == "f":
            return ["" if np.isnan(value) else f"{value!r}" for value in column.tolist()]
        if column.dtype.kind == "b":
            return ["true" if value else "false" for value in column.tolist()]  # as YAML writes them
        try:
            return [str(value) for value in column.tolist()]
        except (SystemError, ValueError) as error:  # code points beyond Unicode
            raise InputError(f"{self.path}: {title} contains a text that cannot be read: {error}") from error

    def spacing(self, title: str) -> float:
        column = self._columns[title]
        if column.dtype.kind != "f" or np.isnan(column).all():
            return 0.0
        return float(np.spacing(np.nanmax(np.abs(column))))


def read_npy(path: str) -> Columns:
    """Reads an array [T, N], whose columns are named 1 to N, or a structured array [T], by the
    names of its fields."""
    try:
        array = np.load(path, allow_pickle=False, mmap_mode="r")
    except Exception as error:  # noqa: BLE001  a damaged header raises what Python's parser and tokenizer raise
        raise InputError(f"{path}: cannot be read as an array: {error}") from error
    if not isinstance(array, np.ndarray) or array.ndim == 0 or array.size == 0:
        raise InputError(f"{path}: expected an array with one row per sample")
    if array.dtype.names:
        return Columns(path, {name: array[name] for name in array.dtype.names})
    return Columns(path, {str(k + 1): column for k, column in enumerate(array.reshape(len(array), -1).T)})


def read_npz(path: str) -> Columns:
    """Reads arrays by their names. Arrays with another number of rows than most, such as constants,
    are left out: naming one is an error."""
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
    arrays = {name: array for name, array in arrays.items() if isinstance(array, np.ndarray)}  # skips other members
    rows = Counter(len(array) for array in arrays.values() if array.ndim and array.size)
    if not rows:
        raise InputError(f"{path}: has no array with one row per sample; found: {', '.join(list(arrays)[:10])}")
    most = max(rows, key=lambda count: (rows[count], count))
    kept = {name: array for name, array in arrays.items() if array.ndim and len(array) == most}
    left_out = {
        name: f"has {counted(len(array), 'row') if array.ndim else 'one value without rows'}; expected {most}, as most arrays have"
        for name, array in arrays.items()
        if name not in kept
    }
    return Columns(path, kept, left_out)


def read_parquet(path: str) -> Columns:
    """Reads the columns of a Parquet file; lists of equal length are arrays."""
    import pyarrow.parquet

    try:
        # By a file object: pyarrow takes some names, such as a:b.parquet, for addresses.
        with open(path, "rb") as stream, pyarrow.parquet.ParquetFile(stream) as file:
            columns = _parquet_columns(path, file)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # noqa: BLE001  pages are decoded column by column, and texts when they are converted
        raise InputError(f"{path}: cannot be read as Parquet: {error}") from error
    return Columns(path, columns)


def _parquet_columns(path: str, file: Any) -> dict[str, Any]:
    head = file.metadata
    for title, count in Counter(file.schema_arrow.names).items():
        if count > 1:
            raise InputError(f"{path}: has {count} columns {title!r}; titles must differ; rename one of them")
    if head.num_rows == 0:
        raise InputError(f"{path}: the table has no rows")
    # A small file may have many rows of one value, or a long list in each row.
    values = sum(head.row_group(group).column(k).num_values for group in range(head.num_row_groups) for k in range(head.num_columns))
    values = max(values, head.num_rows * head.num_columns)
    if values * 8 > LARGEST:
        raise InputError(
            f"{path}: the table has {values} values in {counted(head.num_rows, 'row')}; expected at most {LARGEST // 8} values; split the file"
        )
    table = file.read()
    if table.num_rows != head.num_rows:
        raise InputError(f"{path}: is damaged: has {counted(table.num_rows, 'row')}; expected {head.num_rows}, as its footer states")
    return {
        name: _parquet_column(f"{path}: column {name!r}", column)
        for name, column in zip(table.column_names, table.columns, strict=True)
    }


def _parquet_column(where: str, column: Any) -> Any:
    """A column as an array: times as texts, lists of equal length as [T, N]."""
    import pyarrow as pa

    if pa.types.is_timestamp(column.type):
        return np.array(["" if value is None else value.isoformat() for value in column.to_pylist()])
    if pa.types.is_list(column.type) or pa.types.is_fixed_size_list(column.type) or pa.types.is_large_list(column.type):
        try:
            return np.array(column.to_pylist(), dtype=float)
        except ValueError:
            raise InputError(f"{where}: its lists differ in length") from None
    return column.to_numpy()
