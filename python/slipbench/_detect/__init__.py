"""Alarms of a detector in recordings, and their tables as Parquet."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from slipbench._commands import PathLike, _paths
from slipbench._output import NewFiles
from slipbench._scene import overrides_of
from slipbench.bin import _core

_KEY = {b"slipbench_detect": b"1"}  # metadata of tables that this command has written
_PLACE = ("recording", "trial", "object")


def detect(
    detector: str,
    recordings: PathLike | Sequence[PathLike],
    output: PathLike = "",
    *,
    parameters: Mapping[str, Any] | None = None,
    sensor: str = "",
    resample: bool = False,
) -> dict[str, Any]:
    """Runs a detector on recordings, with or without labels, like `slipbench detect`.

    The alarms are the same as those of `evaluate()` on the same recordings.

    Args:
        detector: a detector's name in a scene, including custom ones, FILE.onnx, or a folder of
            memories
        recordings: path of a dataset's first file, or several of them
        output: FILE.csv, FILE.parquet, FILE.json or FILE.html; empty: no file
        parameters: parameters of the detector, by name
        sensor: the sensor that it reads; empty: the only one
        resample: interpolates recordings that are slower than the detector reads, and across gaps
            of more than 0.1 s

    Returns:
        The output of `slipbench detect --json`. "trials" has for each trial its "alarms", a list of
        {"begin_s", "end_s", "probability"}, and its "samples": "time_s" in s, "state" and "label"
        as words, "probability" from 0 to 1 or None. "worst" holds indices into "trials", the worst
        first. "files" lists the written files.

    Raises:
        InputError: a recording or detector is unreadable, they do not fit each other, or `output`
            cannot be written
        ModuleNotFoundError: FILE.parquet without the package pyarrow
    """
    files = [os.fspath(path) for path in _paths(recordings, "recordings")]
    target = os.fspath(output)
    parquet = target.endswith(".parquet")
    if parquet:
        import pyarrow  # noqa: F401  # fails before the work if it is missing
    text, written = _core.detect(
        detector, overrides_of(parameters), files, sensor, "" if parquet else target, resample
    )
    result: dict[str, Any] = json.loads(text)
    result["files"] = write_parquet(target, result) if parquet else written
    return result


def samples_path(path: str) -> str:
    """FILE_samples.parquet for FILE.parquet."""
    return str(Path(path).with_name(Path(path).stem + "_samples.parquet"))


def write_parquet(path: str, result: Mapping[str, Any]) -> list[str]:
    """Writes the alarms, one row each, and in a second file the samples, one row each.

    Both files get their names once both are complete.

    Args:
        path: FILE.parquet
        result: result of detect()

    Returns:
        the names of both files

    Raises:
        InputError: a file cannot be written, or exists and is not a table of this command
    """
    from pyarrow import parquet as pq

    alarms, samples = _schemas()
    targets = [path, samples_path(path)]
    for name in targets:
        _check_target(name)
    try:
        # File objects: pyarrow takes some names, such as a:b.parquet, for addresses.
        with (
            NewFiles() as files,
            pq.ParquetWriter(files.create(Path(targets[0])), alarms) as alarm_file,
            pq.ParquetWriter(files.create(Path(targets[1])), samples) as sample_file,
        ):
            for trial in result["trials"]:
                alarm_file.write_table(_alarms_of(trial, alarms))
                sample_file.write_table(_samples_of(trial, samples))
            alarm_file.close()
            sample_file.close()
            files.publish()
    except OSError as error:
        raise _core.InputError(f"cannot write {path}: {error.strerror or error}") from error
    return targets


def _schemas() -> tuple[Any, Any]:
    """The schemas of the alarms and of the samples."""
    import pyarrow as pa

    text, number = pa.string(), pa.float64()
    place = list(zip(_PLACE, (text, pa.int64(), text), strict=True))
    alarms = [
        ("alarm", pa.int64()),
        ("begin_s", number),
        ("end_s", number),
        ("probability", number),
    ]
    samples = [
        ("time_s", number),
        ("state", text),
        ("slip", pa.bool_()),
        ("probability", number),
        ("label", text),
    ]
    return tuple(pa.schema([*place, *own], metadata=_KEY) for own in (alarms, samples))


def _check_target(name: str) -> None:
    """Raises InputError for a link, and for a file that is not a table of this command."""
    import pyarrow as pa
    from pyarrow import parquet as pq

    if Path(name).is_symlink():
        raise _core.InputError(
            f"cannot write {name}: it is a symbolic link, which would be replaced, not followed; give a file or a new name"
        )
    if not Path(name).exists():
        return
    try:
        with open(name, "rb") as file:
            earlier = _KEY.items() <= (pq.read_schema(file).metadata or {}).items()
    except (OSError, pa.ArrowInvalid):
        earlier = False
    if not earlier:
        raise _core.InputError(
            f"cannot write {name}: it exists and is not a table of slipbench detect; choose another -o"
        )


def _alarms_of(trial: Mapping[str, Any], schema: Any) -> Any:
    import pyarrow as pa

    where = {name: trial[name] for name in _PLACE}
    rows = [{**where, "alarm": k + 1, **alarm} for k, alarm in enumerate(trial["alarms"])]
    return pa.Table.from_pylist(rows, schema)


def _samples_of(trial: Mapping[str, Any], schema: Any) -> Any:
    import pyarrow as pa

    columns = trial["samples"]
    count = len(columns["time_s"])
    return pa.table(
        {
            **{name: [trial[name]] * count for name in _PLACE},
            "time_s": columns["time_s"],
            "state": columns["state"],
            "slip": [state in ("incipient", "gross") for state in columns["state"]],
            "probability": columns["probability"],
            "label": columns["label"] or [None] * count,
        },
        schema=schema,
    )
