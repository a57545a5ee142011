"""LeRobotDataset v3.0: one dataset per rate, one episode per trial."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, replace
from dataclasses import field as dataclass_field
from itertools import pairwise
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from slipbench import Arrays, Dataset, InputError, StoredTrial
from slipbench._data import check_evenly_spaced, check_units
from slipbench._export.card import card_text, croissant_text
from slipbench._export.parquet import abandon, encodings
from slipbench._export.request import Progress, Request, locked_folder, make_folder, split_of
from slipbench._export.series import (
    TIME_ROUNDING,
    Series,
    body_series,
    control_series,
    grid,
    label_series,
    sensor_series,
)
from slipbench._output import create_locked, sync_folder
from slipbench._program import counted

VERSION = "v3.0"
ROBOT = "slipbench"  # identifies datasets of this program
FILES_A_CHUNK = 1000
FILE_BYTES = 100_000_000
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
CARDS = ("README.md", "croissant.json")
STEP_TOLERANCE = 1e-4  # s, tolerance_s of LeRobot: each step of `timestamp` must be 1/fps within it
RATE_TOLERANCE = (
    0.01  # tolerated relative error of a recorder's clock, as everywhere in the program
)


@dataclass(frozen=True)
class Feature:
    """A column of the dataset.

    Attributes:
        name: name of the column
        columns: names of its values; for a table, the names along each axis
        values: [frames, values of a frame]
        shape: of a frame's values if they are a table; empty: a row
        about: metadata of the column in the data files: unit, and codes as JSON, word to number
    """

    name: str
    columns: list[str] | dict[str, list[str]] | None
    values: NDArray[Any]
    shape: tuple[int, ...] = ()
    about: dict[str, str] = dataclass_field(default_factory=dict)

    @property
    def described(self) -> dict[str, Any]:
        """Entry of meta/info.json."""
        return {
            "dtype": self.values.dtype.name,
            "shape": list(self.shape or self.values.shape[1:]),
            "names": self.columns,
        }

    @property
    def field(self) -> pa.Field:
        """Field of the data files."""
        kind, width = pa.from_numpy_dtype(self.values.dtype), self.values.shape[1]
        of_frame = (
            pa.list_(pa.list_(kind))
            if self.shape
            else kind
            if width == 1
            else pa.list_(kind, width)
        )  # tables as lerobot stores them
        return pa.field(self.name, of_frame, metadata=self.about)

    @property
    def array(self) -> pa.Array:
        """The values for the data files."""
        flat = pa.array(self.values.reshape(-1))
        if self.shape:
            rows, columns = self.shape
            of_rows = pa.ListArray.from_arrays(
                np.arange(len(self.values) * rows + 1, dtype=np.int32) * columns, flat
            )
            return pa.ListArray.from_arrays(
                np.arange(len(self.values) + 1, dtype=np.int32) * rows, of_rows
            )
        return (
            flat
            if self.values.shape[1] == 1
            else pa.FixedSizeListArray.from_arrays(flat, self.values.shape[1])
        )


@dataclass(frozen=True)
class Stats:
    """Statistics of a feature in one episode or in all, each [values of a frame].

    NaN is ignored; a value without any number has zeros.

    Attributes:
        frames: number of frames
        numbers: number of finite values, the weights of episodes
    """

    frames: int
    numbers: NDArray[np.float64]
    of: dict[str, NDArray[np.float64]]

    @staticmethod
    def measured(values: NDArray[Any]) -> Stats:
        """Statistics of one episode. Quantiles are linearly interpolated."""
        ordered = np.sort(values, axis=0)  # NaN sorts last
        numbers = np.sum(~np.isnan(ordered), axis=0)
        last, columns = np.maximum(numbers - 1, 0), np.arange(values.shape[1])
        of = {"min": ordered[0], "max": ordered[last, columns]}
        wide = np.nan_to_num(values.astype(np.float64), nan=0.0)
        of["mean"] = wide.sum(axis=0) / np.maximum(numbers, 1)
        of["std"] = np.sqrt(
            (np.square(wide - of["mean"]) * ~np.isnan(values)).sum(axis=0) / np.maximum(numbers, 1)
        )
        for name, share in QUANTILES.items():
            place = share * last
            low = np.floor(place).astype(int)
            below, above = (
                ordered[low, columns].astype(np.float64),
                ordered[np.minimum(low + 1, last), columns].astype(np.float64),
            )
            of[name] = below + (place - low) * (above - below)
        return Stats(
            len(values),
            numbers.astype(np.float64),
            {name: np.where(numbers > 0, one, 0).astype(np.float64) for name, one in of.items()},
        )

    @staticmethod
    def together(some: list[Stats]) -> Stats:
        """Statistics of all episodes, as lerobot computes them.

        Quantiles are means of the episodes' quantiles.
        """
        weights = np.stack([one.numbers for one in some])
        total = weights.sum(axis=0)
        shares = weights / np.maximum(total, 1)
        of = {name: np.stack([one.of[name] for one in some]) for name in some[0].of}
        mean = (shares * of["mean"]).sum(axis=0)
        joined = {
            "min": np.where(weights > 0, of["min"], np.inf).min(axis=0),
            "max": np.where(weights > 0, of["max"], -np.inf).max(axis=0),
            "mean": mean,
            "std": np.sqrt(
                (shares * (np.square(of["std"]) + np.square(of["mean"] - mean))).sum(axis=0)
            ),
        }
        joined |= {name: (shares * of[name]).sum(axis=0) for name in QUANTILES}
        return Stats(
            sum(one.frames for one in some),
            total,
            {name: np.where(total > 0, one, 0) for name, one in joined.items()},
        )

    def lists(self, shape: list[int]) -> dict[str, Any]:
        """Dict with lerobot's names, in the shape of the feature."""
        of = {name: one.reshape(shape).tolist() for name, one in self.of.items()}
        return {
            **{name: of[name] for name in ("min", "max", "mean", "std")},
            "count": [self.frames],
            **{name: of[name] for name in QUANTILES},
        }


def _task(scene: str) -> str:
    """The scene's description."""
    found = re.search(r"^description:\s*+(.+)$", scene, re.MULTILINE)
    return found[1].strip().strip("'\"") if found else "touch and slip"


def _joined(name: str, some: list[Series], prefix: bool) -> Feature:
    columns = [
        f"{one.owner}_{column}" if prefix else column for one in some for column in one.columns
    ]
    return Feature(
        name, columns, np.concatenate([one.values for one in some], axis=1).astype(np.float32)
    )


def _has_points(trial: StoredTrial, sensor: str) -> bool:
    """True if the sensor has the force of each unit and the positions of its units are known."""
    group, labels = trial.sensors[sensor], trial.labels.get(sensor)
    return (
        labels is not None
        and "unit_positions" in labels.attrs
        and "force" in group
        and group["force"].shape[1:] == (len(labels.attrs["unit_positions"]), 3)
    )


def _points(trial: StoredTrial, sensor: str, series: list[Series]) -> Feature:
    """Position and force of each unit as the sensor measures them, in the pad frame.

    Units of a sensor without displacements stay at rest.
    """
    check_units(
        f"--points: sensor {sensor}",
        trial.sensors[sensor].units,
        {"force": "N", "displacement": "m"},
    )
    labels, measured = (
        trial.labels[sensor].attrs,
        {one.name: one.values for one in series if (one.kind, one.owner) == ("sensors", sensor)},
    )
    places = np.column_stack([labels["unit_positions"], labels["unit_heights"]])
    force = measured["force"].reshape(-1, *places.shape)
    moved = (
        places + measured["displacement"].reshape(force.shape)
        if "displacement" in measured
        else np.broadcast_to(places, force.shape)
    )
    values = np.concatenate([moved, force], axis=2).astype(np.float32)
    names = {
        "unit": [str(unit) for unit in range(len(places))],
        "value": ["x [m]", "y [m]", "z [m]", "fx [N]", "fy [N]", "fz [N]"],
    }
    return Feature(
        f"observation.tactile.{sensor}", names, values.reshape(len(values), -1), values.shape[1:]
    )


def _check_points(trial: StoredTrial, request: Request, progress: Progress) -> list[str]:
    """The sensors with a feature of points; a note names the others.

    Raises InputError if there are none.
    """
    found = [sensor for sensor in request.sensors if _has_points(trial, sensor)]
    without = "the forces or the positions of the units are not recorded"
    if not found:
        raise InputError(
            f"--points: {', '.join(request.sensors)}: {without}; --points needs a simulated sensor with a channel `force` "
            "[units, 3], such as papillarray"
        )
    for sensor in request.sensors:
        if sensor not in found:
            progress.note(f"{sensor} has no points: {without}")
    return found


def _features(trial: StoredTrial, series: list[Series]) -> Iterator[Feature]:
    """The features of an episode besides its counts: observations and truth."""
    carriers = {"pad", *trial.sensors}
    loop = {one.name: one for one in series if one.kind == "control"}
    if "measured_position" in loop:
        yield _joined("observation.state", [loop["measured_position"]], False)
    moving = [
        one
        for one in series
        if one.kind == "truth" and one.name == "velocity" and one.owner in carriers
    ]
    if "command" in loop:
        yield _joined("action", [loop["command"]], False)
    elif moving:
        yield _joined("action", moving, True)
    for one in series:
        group = {
            "sensors": "observation",
            "labels": "labels",
            "truth": "truth",
            "control": "control",
        }[one.kind]
        about = {"unit": one.unit} | ({"codes": one.codes} if one.codes else {})
        yield Feature(
            ".".join(filter(None, (group, one.owner, one.name))),
            list(one.columns),
            one.values,
            about=about,
        )


class _Writer:
    """Writes one dataset to a folder that gets its final name at the end.

    Args:
        folder: existing folder
        fps: frames per second
        task: text of the only task
        pointed: names of the sensors with a feature of points
    """

    def __init__(self, folder: Path, fps: int, task: str, pointed: list[str]) -> None:
        self.folder, self._fps, self._task, self._pointed = folder, fps, task, pointed
        self._features: list[dict[str, Any]] = []
        self._names: list[str] = []
        self._episodes: list[dict[str, Any]] = []
        self._stats: list[list[Stats]] = []
        self._parts: list[str | None] = []
        self._frames = self._file = 0
        self._data: pq.ParquetWriter | None = None
        self._data_file: BinaryIO | None = None
        self.bytes = 0

    def _create(self, name: str) -> BinaryIO:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return create_locked(path)

    def _write(self, name: str, text: str) -> None:
        with self._create(name) as file:
            file.write(text.encode())

    def append_trial(
        self,
        number: int,
        trial: StoredTrial,
        part: str | None,
        t: NDArray[np.float64],
        series: list[Series],
    ) -> int:
        """Writes a trial as episodes, as few as possible; returns their number.

        Args:
            number: number of the trial
            trial: the trial
            part: its part of the split; trials come grouped by part
            t: instants of the frames [s]
            series: values of the trial
        """
        pieces = _pieces(len(t), self._fps)
        for piece in pieces:
            at = [one.at(t[piece]) for one in series]
            points = [_points(trial, sensor, at) for sensor in self._pointed]
            self._parts.append(part)
            self._append(number, t[piece], [*_features(trial, at), *points])
        return len(pieces)

    def _append(self, number: int, t: NDArray[np.float64], features: list[Feature]) -> None:
        """Writes an episode, frames of trial `number`."""
        frames, episode = np.arange(len(t), dtype=np.int64), len(self._episodes)
        counts: dict[str, NDArray[Any]] = {
            "timestamp": (frames / self._fps).astype(np.float32),
            "frame_index": frames,
            "episode_index": np.full_like(frames, episode),
            "index": frames + self._frames,
            "task_index": np.zeros_like(frames),
        }
        features = [
            *features,
            Feature("time", ["s"], t.reshape(-1, 1)),
            *(Feature(name, None, values.reshape(-1, 1)) for name, values in counts.items()),
        ]
        described = [one.described for one in features]
        names = [one.name for one in features]
        schema = pa.schema([one.field for one in features])
        if self._names and (names, described) != (self._names, self._features):
            raise InputError(
                f"trial {number}: has other features than the previous trials; choose common sensors with --sensors, or one trial with --trial"
            )
        self._names, self._features = names, described
        self._data_of(schema).write_table(
            pa.Table.from_arrays([one.array for one in features], schema=schema)
        )
        self._stats.append([Stats.measured(one.values) for one in features])
        self._episodes.append(self._episode(number, len(t)))
        self._frames += len(t)

    def _data_of(self, schema: pa.Schema) -> pq.ParquetWriter:
        """The data file for the next episode: the open one, or another if that is large."""
        if self._data is not None and self.bytes_of_file() >= FILE_BYTES:
            self.close()
            self._file += 1
        if self._data is None:
            # A file object: pyarrow takes some names, such as a:b, for addresses.
            self._data_file = self._create(self._data_name())
            self._data = pq.ParquetWriter(
                self._data_file, schema, write_statistics=False, **encodings(schema)
            )
        return self._data

    def _episode(self, number: int, frames: int) -> dict[str, Any]:
        """The row of the table of episodes for the last statistics."""
        return {
            "episode_index": len(self._episodes),
            "trial": number,
            "tasks": [self._task],
            "length": frames,
            "data/chunk_index": self._file // FILES_A_CHUNK,
            "data/file_index": self._file % FILES_A_CHUNK,
            "dataset_from_index": self._frames,
            "dataset_to_index": self._frames + frames,
            **{
                f"stats/{name}/{key}": values
                for name, one, feature in zip(
                    self._names, self._stats[-1], self._features, strict=True
                )
                for key, values in one.lists(feature["shape"]).items()
            },
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
        }

    def _data_name(self) -> str:
        return DATA.format(
            chunk_index=self._file // FILES_A_CHUNK, file_index=self._file % FILES_A_CHUNK
        )

    def bytes_of_file(self) -> int:
        return os.path.getsize(self.folder / self._data_name())

    def close(self) -> None:
        """Closes the data file."""
        if self._data is not None and self._data_file is not None:
            self._data.close()
            self._data_file.close()
            self._data = None
            self.bytes += self.bytes_of_file()

    def abandon(self) -> None:
        """Closes the unfinished data file, which will be removed."""
        if self._data is not None and self._data_file is not None:
            abandon(self._data, self._data_file)

    def _splits(self) -> dict[str, str]:
        """The episodes of each part, as FIRST:END."""
        counts = {part: self._parts.count(part) for part in ("train", "valid", "test")}
        ends = np.cumsum([0, *counts.values()]).tolist()
        return {
            part: f"{ends[i]}:{ends[i + 1]}"
            for i, (part, count) in enumerate(counts.items())
            if count
        } or {"train": f"0:{len(self._parts)}"}

    def finish(self, data: Dataset, request: Request) -> None:
        """Writes the metadata. `request`: with the sensors of this dataset only."""
        self.close()
        with self._create(EPISODES) as file:
            pq.write_table(pa.Table.from_pylist(self._episodes), file, compression="zstd")
        with self._create("meta/tasks.parquet") as file:
            pq.write_table(_table_of_task(self._task), file)
        stats = {
            name: Stats.together([episode[i] for episode in self._stats]).lists(
                self._features[i]["shape"]
            )
            for i, name in enumerate(self._names)
        }
        for name, content in (("stats", stats), ("info", self._info())):
            self._write(f"meta/{name}.json", json.dumps(content, indent=1, allow_nan=False) + "\n")
        self._write(CARDS[0], card_text(data, request))
        files = [
            (path.relative_to(self.folder).as_posix(), str(path))
            for path in self.folder.rglob("*")
            if path.is_file()
        ]
        self._write(CARDS[1], croissant_text(data, request, files))

    def _info(self) -> dict[str, Any]:
        """The content of meta/info.json."""
        return {
            "codebase_version": VERSION,
            "robot_type": ROBOT,
            "total_episodes": len(self._episodes),
            "total_frames": self._frames,
            "total_tasks": 1,
            "chunks_size": FILES_A_CHUNK,
            "data_files_size_in_mb": FILE_BYTES // 1_000_000,
            "video_files_size_in_mb": 200,
            "fps": self._fps,
            "splits": self._splits(),
            "data_path": DATA,
            "video_path": None,
            "features": dict(zip(self._names, self._features, strict=True)),
        }


def _table_of_task(task: str) -> pa.Table:
    """The table of the only task, with the metadata that pandas writes."""
    columns = [
        {
            "name": name,
            "field_name": name,
            "pandas_type": kind,
            "numpy_type": numpy,
            "metadata": None,
        }
        for name, kind, numpy in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    ]
    about = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": columns,
        "pandas_version": "2.0.0",
    }
    return pa.table(
        {"task_index": pa.array([0], pa.int64()), "task": [task]}
    ).replace_schema_metadata({"pandas": json.dumps(about)})


def _is_own(folder: Path) -> bool:
    try:
        about = json.loads((folder / "meta/info.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return not any(folder.iterdir())
    return (
        isinstance(about, dict)
        and about.get("robot_type") == ROBOT
        and about.get("codebase_version") == VERSION
    )


def _temporary_folders(folder: Path) -> tuple[Path, Path]:
    """Folders for the unfinished dataset and for the replaced one."""
    return folder.with_name(folder.name + ".partial"), folder.with_name(folder.name + ".old")


def _check_target(folder: Path) -> None:
    if folder.is_symlink() or (folder.exists() and not (folder.is_dir() and _is_own(folder))):
        raise InputError(
            f"{folder}: would be replaced, but is not a LeRobot dataset of slipbench; choose another --output"
        )
    for other in _temporary_folders(folder):
        if other.is_symlink() or (
            other.exists()
            and not (
                other.is_dir() and {one.name for one in other.iterdir()} <= {"data", "meta", *CARDS}
            )
        ):
            raise InputError(
                f"{other}: would be removed, but is not left by a killed export; choose another --output"
            )


def _publish(partial: Path, folder: Path) -> None:
    """Renames a complete dataset to its final name, and removes the replaced one."""
    for path in partial.rglob("*"):
        if path.is_file():
            with path.open("rb") as file:
                os.fsync(file.fileno())
    old = _temporary_folders(folder)[1]
    if folder.exists():
        shutil.rmtree(old, ignore_errors=True)
        folder.rename(old)
    partial.rename(folder)
    sync_folder(folder.parent)
    shutil.rmtree(old, ignore_errors=True)


def _recorded(sensor: Arrays) -> bool:
    """True if the times are from a recorder, whose clock is inexact."""
    return "mean_rate_hz" in sensor.attrs


def _fits(sensor: Arrays, rate: float) -> bool:
    """True if the samples of a sensor fit a dataset at `rate` [Hz]."""
    own = float(sensor.attrs["rate_hz"])
    return abs(own - rate) <= (RATE_TOLERANCE if _recorded(sensor) else TIME_ROUNDING) * rate


def _rates(trial: StoredTrial, request: Request) -> dict[float, list[str]]:
    """The sensors of each dataset by its rate.

    A whole number, for a recorded sensor the nearest to its rate.
    """
    rates: dict[float, list[str]] = {}
    for name in request.sensors:
        rate = (
            request.rate
            if request.rate is not None
            else float(trial.sensors[name].attrs["rate_hz"])
        )
        whole = float(max(1, round(rate)))
        if request.rate is None and _fits(trial.sensors[name], whole):
            rate = whole
        rates.setdefault(rate, []).append(name)
    for rate, sensors in rates.items():
        if abs(rate - round(rate)) > TIME_ROUNDING * rate:
            raise InputError(
                f"lerobot: {', '.join(sensors)} at {rate:g} Hz; choose a whole number with --rate"
            )
    return rates


def _check_rates(
    number: int, trial: StoredTrial, rates: dict[float, list[str]], request: Request
) -> None:
    """Raises InputError if a sensor of this trial has another rate than in the first trial."""
    for rate, sensors in rates.items():
        for name in sensors:
            if request.rate is None and not _fits(trial.sensors[name], rate):
                raise InputError(
                    f"trial {number}: {name} at {float(trial.sensors[name].attrs['rate_hz']):g} Hz, but in the previous trials at "
                    f"{rate:g} Hz; choose one rate with --rate, or one trial with --trial"
                )


def _instants(
    number: int,
    trial: StoredTrial,
    sensors: list[str],
    series: list[Series],
    rate: float,
    request: Request,
) -> NDArray[np.float64]:
    """Instants from the first at which every series has a value.

    The sensors' own, or at the requested rate if it differs.
    """
    recorded = [trial.sensors[name] for name in sensors if _recorded(trial.sensors[name])]
    same = len(recorded) == len(sensors) and all(_fits(one, rate) for one in recorded)
    if request.rate is not None and not same:
        return grid(number, trial, sensors, series, request.rate)
    for name in sensors:
        check_evenly_spaced(
            f"trial {number}: {name}",
            trial.sensors[name],
            "one rate throughout, as `slipbench import --rate RATE` makes it",
        )
    own: NDArray[np.float64] = trial.sensors[sensors[0]]["t"][:]
    return own[own >= max(float(one.t[0]) for one in series) - TIME_ROUNDING]


def _other_rate(trial: StoredTrial, sensors: list[str], rate: float) -> list[str]:
    """Notes about recorded sensors whose clock is inexact."""
    own = {
        name: float(trial.sensors[name].attrs["rate_hz"])
        for name in sensors
        if _fits(trial.sensors[name], rate)
    }
    return [
        f"{name} was recorded at {one:.6g} Hz and is written as {rate:g} fps: timestamp counts frames, time is the recorded time"
        for name, one in own.items()
        if one != rate
    ]


def _longest_episode(frames: int, fps: int) -> int:
    """Maximum number of frames of an episode.

    `timestamp` is float32, whose spacing grows with time until a step violates STEP_TOLERANCE.
    """
    steps = np.diff((np.arange(frames) / fps).astype(np.float32))
    off = np.maximum(
        np.abs(steps - np.float32(1 / fps)).astype(np.float64),
        np.abs(steps.astype(np.float64) - 1 / fps),
    )
    missed = np.flatnonzero(off >= STEP_TOLERANCE)
    return int(missed[0]) + 1 if len(missed) else frames


def _pieces(frames: int, fps: int) -> list[slice]:
    """Divides a trial into episodes, as few as possible and nearly equal in length."""
    count = -(-frames // _longest_episode(frames, fps))
    ends = [round(k * frames / count) for k in range(count + 1)]
    return [slice(first, last) for first, last in pairwise(ends)]


def write(data: Dataset, request: Request, progress: Progress) -> list[str]:
    """Writes a dataset for each rate, OUT/<rate>hz; returns the names of its files."""
    out = Path(request.out)
    made = make_folder(out)
    try:
        with locked_folder(out):
            return _write_locked(out, data, request, progress)
    finally:
        if made and not any(out.iterdir()):
            out.rmdir()


def _write_locked(out: Path, data: Dataset, request: Request, progress: Progress) -> list[str]:
    """As write(), in the folder `out`, which no other export writes into."""
    parts = split_of(data)
    order = _ordered(request.trials, parts)
    rates = _rates(data[order[0]], request)
    targets = {rate: out / f"{round(rate)}hz" for rate in rates}
    partials = {rate: _temporary_folders(target)[0] for rate, target in targets.items()}
    for target in targets.values():
        _check_target(target)
    pointed = _check_points(data[order[0]], request, progress) if request.points else []
    writers: dict[float, _Writer] = {}
    try:
        for rate, partial in partials.items():
            shutil.rmtree(partial, ignore_errors=True)  # left by a killed run
            partial.mkdir()  # not through a link that has appeared since the check
            own = [sensor for sensor in rates[rate] if sensor in pointed]
            writers[rate] = _Writer(partial, round(rate), _task(data.scene), own)
        for done, number in enumerate(order, 1):
            _check_rates(number, data[number], rates, request)
            _append(number, data[number], parts.get(number), writers, rates, request, progress)
            progress.update(
                done, sum(writer.bytes + writer.bytes_of_file() for writer in writers.values())
            )
        for rate, writer in writers.items():
            writer.finish(data, replace(request, sensors=rates[rate]))
        progress.check()
        for rate, partial in partials.items():
            _publish(partial, targets[rate])
    finally:
        for writer in writers.values():
            writer.abandon()
        for partial in partials.values():
            shutil.rmtree(partial, ignore_errors=True)
    return [str(path) for target in targets.values() for path in _files_below(target)]


def _ordered(trials: list[int], parts: dict[int, str]) -> list[int]:
    """The trials grouped by their part of the split."""
    return [
        number
        for part in ("train", "valid", "test", None)
        for number in trials
        if parts.get(number) == part
    ]


def _files_below(folder: Path) -> list[Path]:
    return [path for path in sorted(folder.rglob("*")) if path.is_file()]


def _append(
    number: int,
    trial: StoredTrial,
    part: str | None,
    writers: dict[float, _Writer],
    rates: dict[float, list[str]],
    request: Request,
    progress: Progress,
) -> None:
    """Writes a trial, which is in `part` of the split, to the dataset of each rate."""
    shared = [*body_series(trial), *control_series(trial)]
    for rate, sensors in rates.items():
        own = [
            one
            for sensor in sensors
            for one in (
                *sensor_series(trial, sensor),
                *label_series(trial, sensor, request.labels),
            )
        ]
        t = _instants(number, trial, sensors, own + shared, rate, request)
        episodes = writers[rate].append_trial(number, trial, part, t, own + shared)
        for note in _other_rate(trial, sensors, rate):
            progress.note(f"trial {number}: {note}")
        if episodes > 1:
            progress.note(
                f"trial {number}: its {counted(len(t), 'frame')} at {rate:g} fps become {episodes} episodes, since float32 timestamps of one "
                f"would miss LeRobot's tolerance of {STEP_TOLERANCE:g} s"
            )
