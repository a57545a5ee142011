"""Parquet: one file per sensor, with one column per value, for pandas, polars and DuckDB."""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Iterator
from typing import Any, BinaryIO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from slipbench import Dataset, InputError, StoredTrial
from slipbench._export.card import CARDS, check_card, without_folders, write_card
from slipbench._export.request import Output, Progress, Request, split_of
from slipbench._export.series import Series, body_series, control_series, sensor_at

Columns = dict[str, NDArray[Any]]
About = dict[str, dict[str, str]]  # metadata of columns: unit, and codes as JSON, word to number


def encodings(schema: pa.Schema) -> dict[str, Any]:
    """Options of the writer.

    Byte-stream split for floating-point columns, whose size zstd then halves; dictionaries for the
    others.
    """
    fractions = [_leaf(field) for field in schema if _holds_fractions(field.type)]
    others = [_leaf(field) for field in schema if not _holds_fractions(field.type)]
    return {
        "compression": "zstd",
        "column_encoding": dict.fromkeys(fractions, "BYTE_STREAM_SPLIT"),
        "use_dictionary": others,
    }


def _is_list(kind: pa.DataType) -> bool:
    return bool(pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind))


def _holds_fractions(kind: pa.DataType) -> bool:
    return _holds_fractions(kind.value_type) if _is_list(kind) else bool(pa.types.is_floating(kind))


def _leaf(field: pa.Field) -> str:
    path, kind = field.name, field.type
    while _is_list(kind):
        path, kind = f"{path}.list.element", kind.value_type
    return str(path)


def abandon(writer: pq.ParquetWriter, file: BinaryIO) -> None:
    """Closes an unfinished file, which will be removed.

    pyarrow's destructor must not try to complete it: the file is closed, or the disk full.
    """
    writer.is_open = False
    with contextlib.suppress(OSError):  # a full disk: the buffer cannot be written
        file.close()


class _Files:
    """Files that grow trial by trial, one row group each."""

    def __init__(self, output: Output, origin: dict[str, str]) -> None:
        self._output, self._origin = output, origin
        self._writers: dict[str, pq.ParquetWriter] = {}
        self._files: list[BinaryIO] = []

    def append(self, name: str, trial: int, columns: Columns, about: About) -> None:
        rows = len(next(iter(columns.values())))
        arrays = {"trial": np.full(rows, trial, np.int32), **columns}
        schema = pa.schema(
            [
                pa.field(key, pa.from_numpy_dtype(values.dtype), metadata=about.get(key))
                for key, values in arrays.items()
            ],
            metadata=self._origin,
        )
        if name not in self._writers:
            # A file object: pyarrow takes some names, such as a:b.parquet, for addresses.
            self._files.append(self._output.create(f"{name}.parquet"))
            self._writers[name] = pq.ParquetWriter(
                self._files[-1], schema, write_statistics=["trial", "t"], **encodings(schema)
            )
        elif not self._writers[name].schema.equals(schema):
            raise InputError(
                f"trial {trial}: {name} has other columns than in the previous trials; export one trial at a time with --trial"
            )
        self._writers[name].write_table(
            pa.Table.from_arrays([pa.array(values) for values in arrays.values()], schema=schema)
        )

    def close(self) -> None:
        for writer, file in zip(self._writers.values(), self._files, strict=True):
            writer.close()
            file.close()

    def abandon(self) -> None:
        """Closes the unfinished files, which will be removed."""
        for writer, file in zip(self._writers.values(), self._files, strict=False):
            abandon(writer, file)


def _columns(series: list[Series], t: NDArray[np.float64]) -> tuple[Columns, About]:
    columns: Columns = {"t": t}
    about: About = {"t": {"unit": "s"}}
    for one in series:
        prefix = "label_" if one.kind == "labels" else ""
        if not one.is_sampled_at(t):
            columns[f"{one.name}_t"] = one.t
            about[f"{one.name}_t"] = {"unit": "s"}
        for i, name in enumerate(one.columns):
            columns[prefix + name] = one.values[:, i]
            about[prefix + name] = {"unit": one.unit} | ({"codes": one.codes} if one.codes else {})
    return columns, about


def _sensor_tables(
    number: int, trial: StoredTrial, sensor: str, request: Request
) -> Iterator[tuple[str, Columns, About]]:
    """A sensor's table with its labels, then one for each channel with its own rate."""
    channels, labels = sensor_at(number, trial, sensor, request.labels, request.rate)
    t = trial.sensors[sensor]["t"][:] if request.rate is None else channels[0].t
    series = [*channels, *labels]
    yield sensor, *_columns([one for one in series if len(one.t) == len(t)], t)
    for one in series:
        if len(one.t) != len(t):
            yield f"{sensor}-{one.name}", *_columns([one], one.t)


def _tables(
    number: int, trial: StoredTrial, request: Request
) -> Iterator[tuple[str, Columns, About]]:
    for sensor in request.sensors:
        yield from _sensor_tables(number, trial, sensor, request)
        if sensor in trial.labels and "events" in trial.labels[sensor]:
            events = trial.labels[sensor]
            yield (
                f"{sensor}-events",
                {name: events[f"events/{name}"][:] for name in ("t", "unit", "kind")},
                {"t": {"unit": "s"}, "kind": {"codes": str(events["events/kind"].attrs["codes"])}},
            )
    for body in trial.bodies:
        series = [one for one in body_series(trial) if one.owner == body]
        yield f"body-{body}", *_columns(series, series[0].t)
    loop = list(control_series(trial))
    if loop:
        yield "control", *_columns(loop, loop[0].t)


def _origin(data: Dataset, request: Request) -> dict[str, str]:
    """Metadata of every file.

    `trials_sha256`: SHA-256 of the trials' digests in the order of trials.parquet, one per line.
    """
    digests = "".join(f"{data[number].sha256}\n" for number in request.trials)
    return {
        "slipbench": data.version,
        "seed": str(data.seed),
        "command": without_folders(data.command),
        "scene": data.scene,
        "trials_sha256": hashlib.sha256(digests.encode()).hexdigest(),
    }


def _flat(value: Any) -> Any:
    return json.dumps(value) if isinstance(value, (dict, list)) else value


def _trials_table(data: Dataset, request: Request, origin: dict[str, str]) -> pa.Table:
    """Table with one row per trial: part, swept values, outcome."""
    parts = split_of(data)
    rows: list[dict[str, Any]] = []
    for number in request.trials:
        trial = data[number]
        rows.append(
            {
                "trial": number,
                "split": parts.get(number),
                "seed": trial.seed,
                "sha256": trial.sha256,
                **{key: _flat(value) for key, value in trial.params.items()},
                **{key: _flat(value) for key, value in trial.outcome.items()},
            }
        )
    names = dict.fromkeys(key for row in rows for key in row)
    arrays = []
    for name in names:
        values = [row.get(name) for row in rows]
        if (
            len({type(value) for value in values if value is not None} - {int, float}) > 0
            and len({type(value) for value in values if value is not None}) > 1
        ):
            values = [
                None if value is None else str(value) for value in values
            ]  # a number in one trial, a word in another
        array = pa.array(values, pa.int64() if name in ("trial", "seed") else None)
        # Readers cannot compare a column of type null; a value that no trial has is a missing
        # number, or a missing part of the split.
        arrays.append(
            array.cast(pa.string() if name == "split" else pa.float64())
            if pa.types.is_null(array.type)
            else array
        )
    return pa.Table.from_arrays(arrays, names=list(names), metadata=origin)


def write(data: Dataset, request: Request, progress: Progress) -> list[str]:
    """Writes trials.parquet, a card and a file for each sensor, its events, each body and the loop.

    Returns their names.
    """
    check_card(request)
    with Output(request.out, "a Parquet file", b"PAR1", *CARDS) as output:
        origin = _origin(data, request)
        files = _Files(output, origin)
        try:
            for done, number in enumerate(request.trials, 1):
                for name, columns, about in _tables(number, data[number], request):
                    files.append(name, number, columns, about)
                progress.update(done, output.size())
            files.close()
        except BaseException:
            files.abandon()
            raise
        table = _trials_table(data, request, origin)
        with output.create("trials.parquet") as file:
            pq.write_table(table, file, compression="zstd")
        write_card(data, request, output)
        progress.check()
        return output.publish()
