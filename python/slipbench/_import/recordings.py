"""Reads recordings from sources by a map."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from slipbench import InputError
from slipbench._import.arrays import read_npy, read_npz, read_parquet
from slipbench._import.block import Block
from slipbench._import.keys import STATES, TIME_UNITS
from slipbench._import.labels import File, Lookup, States, object_of
from slipbench._import.source import MISSING, Source, stamps_of
from slipbench._import.times import (
    AmbiguousStepError,
    duration_text,
    format_error,
    is_moment,
    jump_text,
    stamp_text,
    unwrapped,
)
from slipbench._program import counted
from slipbench.bin import _core

# Files that are read in a folder: those of the first of these kinds in it.
KINDS = (
    (".mcap",),  # bags first: there may be tables of labels next to them
    (".bag",),
    (".csv",),
    (".tsv", ".tab"),
    (".txt", ".dat"),
    (".lvm",),
    (".parquet", ".pq"),
    (".npz",),
    (".npy",),
)
BAGS = (".mcap", ".bag")
MOST_RUNS = 5  # runs of missing samples listed in a warning
FRAME = "as the recordings have it"
LARGEST = 1_000_000_000  # bytes of a recording
CONTACT_NAMES = {
    number: name.replace("_", "-") for name, number in STATES.items() if number > 0
}  # labels of samples with contact
CONTACT = list(CONTACT_NAMES)
SHORTEST = 1e-10  # s between two samples


def list_files(sources: list[str], pattern: str = "") -> list[File]:
    """The recordings among files and folders, sorted by name.

    Args:
        sources: files and folders
        pattern: pattern of the names of files and bags in folders, such as "*_bio.csv"; empty: all

    Returns:
        The files, with their names in the dataset.

    Raises:
        InputError: a source does not exist, or a folder has no recording.
    """
    endings: set[str] = set()
    folders = [source for source in sources if _is_folder(source)]
    for source in folders:
        paths = [
            path
            for path in Path(source).rglob("*")
            if _matches(path, pattern) or _matches(path.parent, pattern)
        ]
        # The database of a ROS 2 bag is found by the bag's folder.
        found = {".mcap" if path.suffix == ".db3" else path.suffix for path in paths}
        endings |= set(next((kind for kind in KINDS if found & set(kind)), ()))
    every = [ending for kind in KINDS for ending in kind]
    files = [File(*one) for one in _core.list_sources(sources, sorted(endings) or every)]
    named = {source for source in sources if source not in folders}
    chosen = [file for file in files if file.path in named or _matches(Path(file.path), pattern)]
    if not chosen:
        names = ", ".join(Path(file.path).name for file in files[:5])
        raise InputError(
            f"{', '.join(folders)}: no file matches files: {pattern!r} of the map; found: {names}"
            + (f" and {len(files) - 5} more" if len(files) > 5 else "")
        )
    return chosen


def _is_folder(source: str) -> bool:
    """True for a folder of recordings; the folder of a bag is not one."""
    return Path(source).is_dir() and not (Path(source) / "metadata.yaml").is_file()


def _matches(path: Path, pattern: str) -> bool:
    return not pattern or fnmatchcase(path.name, pattern)


class Sensor:
    """A sensor of the map, or the map itself if it has only one sensor."""

    def __init__(self, name: str, block: Block, root: Block) -> None:
        self.name, self.block = name, block
        self.type = block.need("type")
        self.channels: dict[str, Block] = block.need("channels")
        for key, channel in self.channels.items():
            if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", key) or key == "t":
                channel.fail(
                    f"channels: expected a name of letters, digits and '_', no digit first, not t, found {key!r}"
                )
        self.time: Block | None = block.get("time", root.get("time"))
        if self.time is not None:
            self.time.only_one(("column", "rate"))
            given = [key for key in ("unit", "scale", "format", "nanoseconds") if key in self.time]
            if "wrap" in self.time and "rate" in self.time:
                self.time.fail("time: wrap is for a column of times, not for a rate", "wrap")
            if len(given) > 1 or (given and "rate" in self.time):
                self.time.fail(
                    f"time: expected one of unit, scale, format and nanoseconds, found {' and '.join(given)}"
                    f"{' next to rate' if 'rate' in self.time else ''}"
                )
            if reason := format_error(self.time.get("format", "")):
                self.time.fail(
                    f"time.format: expected a format of strptime, found {self.time.get('format')[:80]!r}: {reason}",
                    "format",
                )
            if self.time.get("scale", 1.0) < 0:
                self.time.fail(
                    f"time.scale: expected a positive number, found {self.time.get('scale')}",
                    "scale",
                )
        labels = block.get("state", root.get("state"))
        self.states = None if labels is None else States(labels)

    @property
    def scale(self) -> float | None:
        """Unit of the times in seconds; None: not stated in the map."""
        if self.time is None or not ("unit" in self.time or "scale" in self.time):
            return None
        return float(self.time.get("scale") or TIME_UNITS[self.time.need("unit")])


class Map:
    """A checked map, which reads files."""

    def __init__(self, block: Block) -> None:
        self.block = block
        block.only_one(("sensor", "sensors"))
        if "sensors" in block:
            for key in ("type", "channels", "topic", "message", "each", "frame"):
                if key in block:
                    block.fail(f"{key} is next to 'sensors'; move it into a sensor", key)
            self.sensors = [Sensor(name, one, block) for name, one in block.need("sensors").items()]
            for sensor in self.sensors:
                if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", sensor.name):
                    sensor.block.fail(
                        f"sensors: expected a name of letters, digits and '_', no digit first, found {sensor.name!r}"
                    )
        else:
            self.sensors = [Sensor(block.need("sensor"), block, block)]
        self.object = Lookup(block.need("object")) if "object" in block else None
        self._definitions: dict[str, Any] | None = None  # of messages; read with the first bag
        self._named: set[str] = set()  # sources that are not folders
        self._folders: list[Path] = []  # of the sources
        if (comment := block.get("comment")) is not None and comment != comment.strip():
            block.fail(
                f"comment: expected a text without spaces around it, found {comment!r}", "comment"
            )

    def files(self, sources: list[str]) -> list[File]:
        """The recordings, without tables of labels and objects."""
        self._named = {source for source in sources if not _is_folder(source)}
        self._folders = [
            Path(source) if Path(source).is_dir() else Path(source).absolute().parent
            for source in sources
        ]
        lookups = [sensor.states for sensor in self.sensors] + [self.object]
        for lookup in filter(None, lookups):
            lookup.folders = self._folders
        tables = {lookup.table for lookup in lookups if lookup is not None and lookup.table}
        ends = [
            tuple(part for part in Path(table).parts if part not in (".", "..")) for table in tables
        ]
        return [
            file
            for file in list_files(sources, self.block.get("files", ""))
            if not any(Path(file.path).absolute().parts[-len(end) :] == end for end in ends)
        ]

    def read(self, file: File) -> Iterator[tuple[str, Sensor, Source]]:
        """The sensors of a file: name, block of the map, columns."""
        path = Path(file.path)
        if path.is_dir() or path.suffix in BAGS:
            yield from self._read_bag(file)
            return
        if not path.is_file():
            raise InputError(f"{file.path}: is not a plain file")
        source = self._open(file.path)
        source.in_folder = file.path not in self._named
        titles: list[str] = []
        texts: list[str] = []
        for sensor in self.sensors:
            numbers, words = _titles_of(sensor, source)
            titles += numbers
            texts += words
        if self.object is not None and self.object.column is not None:
            texts.append(source.find(self.object.column))
        source.load(titles + texts, texts)
        for sensor in self.sensors:
            yield sensor.name, sensor, source

    def _open(self, path: str) -> Source:
        suffix = Path(path).suffix
        if suffix in (".parquet", ".pq"):
            return read_parquet(path)
        if suffix == ".npz":
            return read_npz(path)
        if suffix == ".npy":
            return read_npy(path)
        from slipbench._import.text import TextTable

        get = self.block.get
        return TextTable(
            path,
            get("separator", ""),
            get("decimal", ""),
            get("thousands", ""),
            get("header", True),
            get("skip", 0),
            get("comment", "#"),
        )

    def _read_bag(self, file: File) -> Iterator[tuple[str, Sensor, Source]]:
        from slipbench._import.bags import Bag, read_definitions

        if self._definitions is None:
            self._definitions = read_definitions(self.block, self._folders)
        bag = Bag(file.path, self._definitions)
        try:
            for sensor in self.sensors:
                names = bag.find(sensor.block.get("topic", ""), sensor.block.get("message", ""))
                topics = [bag.read(name) for name in names]
                each = sensor.block.get("each")
                found = [
                    item for topic in topics for item in (topic.items(each) if each else [topic])
                ]
                for topic in found:
                    label = re.sub(r"[^A-Za-z0-9_]+", "_", topic.name).strip("_")
                    yield (
                        sensor.name if len(found) == 1 else f"{sensor.name}_{label}",
                        sensor,
                        topic,
                    )
        finally:
            bag.close()


def _titles_of(sensor: Sensor, source: Source) -> tuple[list[str], list[str]]:
    """The columns of a sensor in a table: those of numbers, and those of texts."""
    titles: list[str] = []
    texts: list[str] = []
    for key, channel in sensor.channels.items():
        titles += source.find_all(channel.need("columns"), f"channels.{key}.columns")[0]
    if sensor.time is None:
        sensor.block.fail(
            "the map has no key 'time'; expected time: {column: TITLE}, or time: {rate: 100 Hz} for a table without times"
        )
    if "nanoseconds" in sensor.time:
        titles += [source.find(sensor.time.need(key)) for key in ("column", "nanoseconds")]
    elif "column" in sensor.time:
        texts.append(source.find(sensor.time.need("column")))
    if sensor.states is not None and sensor.states.column is not None:
        texts.append(source.find(sensor.states.column))
    return titles, texts


def _channel_values(
    source: Source, key: str, channel: Block
) -> tuple[list[int], list[str], np.ndarray]:
    """Shape of a row, names of its values, and values [T, N] in the SI unit of the channel's unit."""
    titles, starred = source.find_all(channel.need("columns"), f"channels.{key}.columns")
    parts = [source.values(title) for title in titles]
    names = [
        name
        for title, part in zip(titles, parts, strict=True)
        for name in ([title] if part.ndim == 1 else [f"{title}[{k}]" for k in range(part[0].size)])
    ]
    if len(names) * len(source) * 4 > LARGEST:
        raise InputError(
            f"{source.path}: channel {key} takes more than {LARGEST // 1_000_000} MB; split the file"
        )
    components = channel.get("components", starred)
    has_table = (
        len(parts) == 1 and parts[0].ndim > 2 and "components" not in channel
    )  # whose last axis has the components
    factors = _factors(key, channel, parts[0].shape[-1] if has_table else components, len(names))
    joined = np.concatenate([part.reshape(len(part), -1) for part in parts], axis=1) * factors
    large = np.argwhere(np.abs(joined) > np.finfo(np.float32).max)
    if large.size:
        raise InputError(
            f"{source.place(int(large[0][0]))}: column {names[large[0][1]]}: expected a number in the range of float32,  "
            f"found {joined[tuple(large[0])]:g}"
        )
    if len(names) % components:
        raise InputError(
            f"{source.title_place()}: has {counted(len(names), 'column')} for channel {key}; expected a multiple of its {components} components"
        )
    if has_table:
        return list(parts[0].shape[1:]), names, joined
    return [len(names) // components, components] if components > 1 else [len(names)], names, joined


def _unit_of(key: str, channel: Block) -> tuple[str, list[float]]:
    """The SI unit of a channel's values, and the factors from its cells.

    One, or one for each component. A scale without a unit converts to `unit`. With a unit it states
    what one `unit` of a cell is, such as 0.01 N for a count.
    """
    unit, factor = _core.si_unit_of(channel.need("unit"))
    scales: list[tuple[float, str]] = channel.get("scale", [(1.0, "")])
    if not any(written for _, written in scales):
        return unit, [scale * factor for scale, _ in scales]
    converted = [(*_core.si_unit_of(written), scale, written) for scale, written in scales]
    first, where = converted[0], f"{channel.where}.scale"
    for symbol, _, scale, written in converted:
        if symbol != first[0]:
            found = [
                f"'{one:g}{other and ' '}{other}'" for one, other in (scales[0], (scale, written))
            ]
            channel.fail(
                f"{where}: expected the same unit for each component, found {' and '.join(found)}",
                "scale",
            )
    if first[0] == unit:
        channel.fail(
            f"{where}: expected a number, because unit is {channel.need('unit')!r}, found '{first[2]:g} {first[3]}'; "
            "if the cells are counts, write unit: counts",
            "scale",
        )
    return first[0], [factor * scale for _, factor, scale, _ in converted]


def _factors(key: str, channel: Block, components: int, width: int) -> np.ndarray:
    """The factors from the cells of a row to values in the channel's SI unit."""
    scale = _unit_of(key, channel)[1]
    if len(scale) not in (1, components):
        fits = "components" not in channel and width % len(scale) == 0
        remedy = (
            f"; for values of {len(scale)} components each, set components: {len(scale)}"
            if fits
            else ""
        )
        channel.fail(
            f"channels.{key}.scale: expected one factor, or one for each of the {counted(components, 'component')}, found {len(scale)}{remedy}",
            "scale",
        )
    return np.resize(np.array(scale), width)


def _without_baseline(
    source: Source,
    sensor: Sensor,
    key: str,
    values: np.ndarray,
    times: np.ndarray,
    kept: np.ndarray,
    states: np.ndarray | None,
) -> np.ndarray:
    """Subtracts the level at rest, if the channel has the key `baseline`.

    The mean of each value over the first seconds of the recording.

    Args:
        source: the table
        sensor: the sensor of the map
        key: name of the channel
        values: [T, N], in the unit of the channel; NaN if missing
        times: [T] s
        kept: [T] rows of the samples in the table
        states: [T] labels; None: no labels

    Returns:
        The values without their level at rest.

    Raises:
        InputError: the recording is not longer than the baseline, is labelled as contact in it, or
            lacks a value throughout it.
    """
    channel = sensor.channels[key]
    if "baseline" not in channel:
        return values
    length, where = (
        channel.need("baseline"),
        f"{channel.path('baseline')}: the baseline is {duration_text(channel.need('baseline'))}",
    )
    rounding = 2.0 * float(np.spacing(np.abs(times).max()))  # of the difference of two stamps
    if times[-1] - times[0] <= length + rounding:
        channel.fail(
            f"{where}, but {source.path} lasts only {duration_text(float(times[-1] - times[0]))}; shorten it",
            "baseline",
        )
    count = int(np.count_nonzero(times - times[0] < length - rounding))
    labels = np.zeros(count, np.uint8) if states is None else states[:count]
    contact = np.flatnonzero(np.isin(labels, CONTACT))
    if contact.size:
        row = int(contact[0])
        channel.fail(
            f"{where}, but {source.place(int(kept[row]))} is labelled as {CONTACT_NAMES[int(labels[row])]} {duration_text(float(times[row] - times[0]))} after "
            "the beginning; expected no contact in that time: shorten or remove it",
            "baseline",
        )
    known = ~np.isnan(values)
    unknown = np.flatnonzero(known.any(axis=0) & ~known[:count].any(axis=0))
    if unknown.size:
        channel.fail(
            f"{where}, but value {int(unknown[0]) + 1} of {source.path} is missing throughout it",
            "baseline",
        )
    sums = np.where(known[:count], values[:count], 0.0).sum(axis=0)
    moved: np.ndarray = values - sums / np.maximum(known[:count].sum(axis=0), 1)
    return moved


def _times(source: Source, sensor: Sensor) -> tuple[np.ndarray, float, float | None]:
    """Times of all rows [s], their resolution [s] and their rate [Hz].

    Missing times are NaN; the rate is given if the map states it.
    """
    if sensor.time is None:
        clock = source.clock()
        if clock is None:
            raise InputError(f"{source.path}: contains no times; the map needs the key 'time'")
        return clock * 1e-9, 1e-9, None
    if "rate" in sensor.time:
        rate = float(sensor.time.need("rate"))
        return np.arange(len(source)) / rate, 0.0, rate
    title = source.find(sensor.time.need("column"))
    if "nanoseconds" in sensor.time:
        times = source.values(title) + 1e-9 * source.values(
            source.find(sensor.time.need("nanoseconds"))
        )
        resolution = 1e-9
    else:
        times, resolution = stamps_of(source, title, sensor.scale, sensor.time.get("format", ""))
    if "wrap" in sensor.time:
        period = sensor.time.need("wrap")
        try:
            times = unwrapped(times, period)
        except AmbiguousStepError as step:
            title = sensor.time.need("column")
            raise InputError(
                f"{source.place(step.row)}: column {source.titles.index(title) + 1}, time: {stamp_text(times[step.row])} is "
                f"{duration_text(float(times[step.row] - times[step.before]))} after the time of {source.row_text(step.before)}; expected at most half of "
                f"time.wrap, {duration_text(period / 2)}: sort samples that are in another order, and split the file at a long pause"
            ) from None
        except ValueError as error:
            sensor.time.fail(
                f"time.wrap: {source.title_place()}: {error}; expected times within {duration_text(period)}",
                "wrap",
            )
    return times, resolution, None


def _time_unit(source: Source, sensor: Sensor) -> float:
    """Unit of a numeric time column [s].

    0 for dates, clocks of bags and rates, whose unit is known.
    """
    if (
        sensor.time is None
        or "column" not in sensor.time
        or "nanoseconds" in sensor.time
        or "format" in sensor.time
    ):
        return 0.0
    texts = (
        text for text in source.texts(sensor.time.need("column")) if text.lower() not in MISSING
    )
    return 0.0 if is_moment(next(texts, "")) else sensor.scale or 1.0


def _order_error(
    source: Source, sensor: Sensor, times: np.ndarray, kept: np.ndarray, row: int
) -> str:
    """Describes the first time that does not come after the one above it.

    Args:
        source: the table
        sensor: the sensor of the map
        times: [T] s
        kept: [T] rows of the times in the table
        row: index of that time
    """
    title = "" if sensor.time is None else sensor.time.need("column")
    column = f"column {source.titles.index(title) + 1}, " if title else ""
    if title and not np.any(times != times[0]):
        remedy = (
            "leave out 'time' in the map, to use the times of receipt"
            if source.clock() is not None
            else "use time: {rate: 100 Hz}, with your rate"
        )
        return f"{source.title_place()}: {column}time: {title} is {stamp_text(times[0])} in all {counted(len(times), 'sample')}; {remedy}"
    where = f"{source.place(int(kept[row]))}: {column}time: {stamp_text(times[row])}"
    before = source.row_text(int(kept[row - 1]))
    if times[row] == times[row - 1]:
        return f"{where} is the time of {before}, too; expected ascending times"
    drop = duration_text(float(times[row - 1] - times[row]))
    return f"{where} comes after {stamp_text(times[row - 1])} in {before}, {drop} earlier; expected ascending times{jump_text(times, row)}"


def _runs(rows: np.ndarray) -> list[tuple[int, int]]:
    """First and last of each run of consecutive numbers."""
    cuts = np.flatnonzero(np.diff(rows) > 1) + 1
    return [(int(run[0]), int(run[-1])) for run in np.split(rows, cuts) if run.size]


def _missing_text(source: Source, times: np.ndarray, rows: np.ndarray, done: str) -> str:
    """The text of a warning about samples that were left out or are NaN.

    "3 of 100 samples have missing values and are left out: 3 from FILE:12 on, 0.04 s from 1.2 s to
    1.24 s".
    """
    runs = _runs(rows)
    texts = []
    for first, last in runs[:MOST_RUNS]:
        before, after = max(first - 1, 0), min(last + 1, len(times) - 1)
        texts.append(
            f"{last - first + 1} at {source.place(first)}, {times[after] - times[before]:.4g} s from {times[before]:.6g} s on"
        )
    more = f" and {counted(len(runs) - MOST_RUNS, 'more gap')}" if len(runs) > MOST_RUNS else ""
    have, are = ("have", "are") if len(rows) > 1 else ("has", "is")
    return f"{len(rows)} of {counted(len(times), 'sample')} {have} missing values and {are} {done}: {'; '.join(texts)}{more}"


def _check_times(source: Source, sensor: Sensor, times: np.ndarray, kept: np.ndarray) -> None:
    """Raises InputError for times that do not ascend, or that seem to have another unit.

    Args:
        source: columns of the file
        sensor: block of the map
        times: times of the samples [s]
        kept: their rows in the file
    """
    steps = np.diff(times)
    late = np.flatnonzero(~(steps > 0))
    if late.size:
        raise InputError(_order_error(source, sensor, times, kept, int(late[0]) + 1))
    if steps.size and steps.min() < SHORTEST:
        raise InputError(
            f"{source.place(int(kept[int(steps.argmin()) + 1]))}: time: {steps.min():g} s after the sample before; "
            f"expected at least {SHORTEST:g} s; set time.unit"
        )
    if np.abs(times).max() > 1e10:
        raise InputError(
            f"{source.place(0)}: time: {np.abs(times).max():g} s; expected at most 1e10 s; set time.unit"
        )


class Importer:
    """Reads files by a map and passes their recordings to the writer."""

    def __init__(self, map: Map, writer: _core.MappedImport) -> None:
        self._map, self._writer = map, writer
        self._policy = map.block.get("missing", "refuse")

    def add(self, file: File) -> None:
        """Adds the recording of a file. Raises InputError with file and line."""
        named = ""
        names: list[str] = []
        for name, sensor, source in self._map.read(file):
            if name in names:
                raise InputError(
                    f"{file.path}: gives two sensors called {name!r}; name them in the map"
                )
            names.append(name)
            if not named and self._map.object is not None:
                named = object_of(self._map.object, file, source)
            self._add_sensor(file, name, sensor, source)
        self._writer.add(
            file.path, json.dumps({"file": file.name} | ({"object": named} if named else {})), named
        )

    def _add_sensor(self, file: File, name: str, sensor: Sensor, source: Source) -> None:
        times, resolution, rate = _times(source, sensor)
        channels = {
            key: _channel_values(source, key, channel) for key, channel in sensor.channels.items()
        }
        empty = np.isnan(times)
        for _, _, values in channels.values():
            empty |= np.isnan(values).any(axis=1)
        kept = self._kept(name, source, sensor, channels, times, np.flatnonzero(empty))
        if len(kept) < len(times):
            rate = None  # the remaining rows have gaps
        times = times[kept]
        if len(times) < (1 if rate else 2):
            raise InputError(
                f"{file.path}: has {counted(len(times), 'sample')}; at least two are needed to determine the rate"
            )
        _check_times(source, sensor, times, kept)
        states = sensor.states.of_rows(file, source, kept) if sensor.states else None
        self._writer.add_sensor(
            name,
            sensor.type,
            sensor.block.get("frame", FRAME),
            np.ascontiguousarray(times),
            resolution,
            _time_unit(source, sensor),
            rate,
            sensor.states.block.need("rule") if sensor.states else "",
            states,
            [
                (
                    key,
                    _unit_of(key, sensor.channels[key])[0],
                    shape,
                    titles,
                    np.ascontiguousarray(
                        _without_baseline(source, sensor, key, values[kept], times, kept, states),
                        np.float32,
                    ).ravel(),
                )
                for key, (shape, titles, values) in channels.items()
            ],
        )

    def _kept(
        self,
        name: str,
        source: Source,
        sensor: Sensor,
        channels: dict[str, tuple[list[int], list[str], np.ndarray]],
        times: np.ndarray,
        empty: np.ndarray,
    ) -> np.ndarray:
        """The rows that become samples, according to the key `missing`."""
        every = np.arange(len(times))
        if not empty.size:
            return every
        if self._policy == "refuse" or (self._policy == "nan" and np.isnan(times).any()):
            row = (
                int(np.flatnonzero(np.isnan(times))[0]) if self._policy == "nan" else int(empty[0])
            )
            titles = [
                title
                for _, names, values in channels.values()
                for title, value in zip(names, values[row], strict=True)
                if np.isnan(value)
            ]
            if np.isnan(times[row]) and sensor.time is not None:
                titles = [sensor.time.need("column")]
            raise InputError(
                f"{source.place(row)}: column {titles[0]} has no value; expected a number in each row, or missing: gap in the "
                "map, which skips such rows, or missing: nan, which keeps the other values"
            )
        known = (
            np.interp(every, np.flatnonzero(~np.isnan(times)), times[~np.isnan(times)])
            if not np.isnan(times).all()
            else times
        )
        done = "left out" if self._policy == "gap" else "NaN in the dataset"
        subject = f"sensor {name}: " if len(self._map.sensors) > 1 else ""
        self._writer.warn(source.path, subject + _missing_text(source, known, empty, done))
        return np.setdiff1d(every, empty) if self._policy == "gap" else every
