"""Dataset files: trials, masks, lazily read arrays, training windows."""

from __future__ import annotations

import json
import os
import warnings
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from slipbench._program import counted
from slipbench._trial import (
    Body,
    Contact,
    Control,
    Labels,
    Row,
    Sensor,
    shape_text,
    table,
    trial_table,
    trial_text,
)
from slipbench._values import index as whole_number
from slipbench.bin import _core

if TYPE_CHECKING:
    import h5py
    import pandas

_MOST_BYTES = 8e9  # of Windows.arrays()
# What h5py and json raise on damaged data.
_OF_DAMAGED_DATA = (OSError, RuntimeError, LookupError, TypeError, ValueError, MemoryError)
# Array of the states by each rule that a dataset contains, and that of an imported recording.
RULES = {rule.name: rule.array for rule in _core.label_rules() if rule.array}
RECORDED = {"recorded": RULES.pop("recorded")}


@contextmanager
def reading(
    what: h5py.Group | h5py.Dataset, errors: tuple[type[Exception], ...] = _OF_DAMAGED_DATA
) -> Iterator[None]:
    """Converts exceptions on damaged data to an InputError that names file and object.

    Args:
        what: the object that is read
        errors: the exceptions to convert
    """
    try:
        yield
    except _core.InputError:
        raise
    except errors as error:
        raise _core.InputError(f"{what.file.filename}: {what.name}: is damaged: {error}") from error


def _member(group: h5py.Group, name: str) -> Any:
    """The object `name` of a group.

    Raises InputError for links and external storage, which may point to any file.
    """
    import h5py  # slow to load

    from slipbench._array import Array

    with reading(group):
        link = group.get(name, getlink=True)
    if link is None:
        raise KeyError(name)
    if not isinstance(link, h5py.HardLink):
        raise _core.InputError(
            f"{group.file.filename}: {group.name}/{name} is a link to another file, but a dataset must contain all of its data"
        )
    with reading(group):
        found = group[name]
        if isinstance(found, h5py.Dataset) and (found.external or found.is_virtual):
            raise _core.InputError(
                f"{group.file.filename}: {found.name} is stored in another file, but a dataset must contain all of its data"
            )
    return Array(found.id, readonly=True) if isinstance(found, h5py.Dataset) else found


def _kept(array: NDArray[Any]) -> NDArray[Any]:
    """Marks an array that an object caches as read-only, as those of a simulated trial."""
    array.setflags(write=False)
    return array


class Arrays(Mapping[str, "h5py.Dataset"]):
    """The arrays of a group by name, read when indexed: `labels["state"][:]`.

    Each has its unit in `array.attrs["unit"]`.

    Attributes:
        attrs: the group's own attributes
    """

    def __init__(self, group: h5py.Group) -> None:
        self._group = group
        with reading(group):
            self.attrs: dict[str, Any] = dict(group.attrs)
            self._names = list(group)

    def __getitem__(self, name: str) -> h5py.Dataset:
        import h5py

        member = self._group
        for part in name.split("/"):
            member = _member(member, part)
        return Arrays(member) if isinstance(member, h5py.Group) else member

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __reduce__(self) -> Any:
        return _reopened, (type(self), self._group.file.filename, self._group.name)

    def _array(self, name: str) -> Any:
        """The whole array `name`, read now. Raises AttributeError if there is none."""
        if name.split("/")[0] not in self:
            raise AttributeError(
                f"{self._group.file.filename}: {self._group.name} has no {name!r}; it has {', '.join([*self, *self.attrs])}"
            )
        return _kept(self[name][:])

    def _arrays(self, names: Sequence[str]) -> Iterator[Row]:
        for name in names:
            yield name, self[name].shape, str(self[name].attrs["unit"])


Opened = TypeVar("Opened")


def _reopened(kind: Callable[..., Opened], file: str, name: str, *arguments: Any) -> Opened:
    """Restores a pickled object from its location in the file."""
    import h5py

    try:
        return kind(h5py.File(file, "r")[name], *arguments)
    except OSError as error:
        raise _core.InputError(f"{file}: cannot be read: {error}") from error


class _Read:
    """Base of stored objects.

    Reads an attribute of the matching in-memory class from the file on first access, and caches it.
    """

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or "_group" not in self.__dict__:
            raise AttributeError(name)
        self.__dict__[name] = value = self._read(name)
        return value

    def _read(self, name: str) -> Any:
        raise NotImplementedError

    def _has(self, name: str) -> bool:
        """True if the file has the attribute, without reading it."""
        return True

    def __dir__(self) -> list[str]:
        # For completion: attributes that were not read yet are not in __dict__.
        return [
            *super().__dir__(),
            *(one.name for one in fields(type(self)) if self._has(one.name)),  # type: ignore[arg-type]
        ]


class _Channels(Mapping[str, Any]):
    """Arrays of a sensor, read when indexed, by the sensor's channel names."""

    def __init__(self, sensor: Arrays, names: Mapping[str, str]) -> None:
        self._sensor, self._names = sensor, names

    def __getitem__(self, name: str) -> Any:
        return self._sensor._array(self._names[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


class StoredSensor(_Read, Arrays, Sensor):
    """A sensor of a stored trial, with the attributes of `Sensor`.

    Each attribute is read from the file on first access and cached.

    Indexing returns the array in the file, which allows partial reads: `sensor["force"][:100]`;
    `attrs` holds the file's attributes. For an imported recording these include mean_rate_hz,
    median_rate_hz, largest_gap_s, largest_gap_at_s and time_resolution_s.
    """

    def _read(self, name: str) -> Any:
        channels = [str(channel) for channel in self.attrs["channels"]]
        match name:
            case "name":
                return self._group.name.rsplit("/", 1)[-1]
            case "rate":
                return float(self.attrs["rate_hz"])
            case "type" | "frame" | "follows":
                return str(self.attrs.get(name, ""))
            case "channels":
                return _Channels(self, {channel: channel for channel in channels})
            case "channel_time":
                return _Channels(
                    self,
                    {channel: f"{channel}_t" for channel in channels if f"{channel}_t" in self},
                )
            case "units":
                return {channel: str(self[channel].attrs["unit"]) for channel in channels}
        if name != "t" and name not in channels:
            raise AttributeError(
                f"sensor {self.name!r} has no channel or attribute {name!r}; channels: {', '.join(channels)}"
            )
        return self._array(name)

    def _title(self) -> str:
        return f"Sensor {self.name!r} {self.type}, {counted(len(self['t']), 'sample')} at {self.rate:g} Hz"

    def _rows(self) -> Iterator[Row]:
        return self._arrays([str(channel) for channel in self.attrs["channels"]])


class StoredLabels(_Read, Arrays, Labels):
    """The truth about a pad of a stored trial, with the attributes of `Labels`.

    Each is read from the file on first access.

    Indexing returns the array in the file: `labels["state"][:100]`; events are "events/t",
    "events/unit" and "events/kind".
    """

    def _read(self, name: str) -> Any:
        if name.startswith("event_"):
            return self._array(
                "events/" + {"event_time": "t"}.get(name, name.removeprefix("event_"))
            )
        for key in (name, f"{name}_s"):
            if key in self.attrs and name not in ("frame", "rule"):
                return _kept(np.array(self.attrs[key]))
        return self._array(name)

    def _has(self, name: str) -> bool:
        return (
            "events" in self._names
            if name.startswith("event_")
            else name in self._names or name in self.attrs or f"{name}_s" in self.attrs
        )


class StoredBody(_Read, Arrays, Body):
    """Motion of a body in a stored trial, with the attributes of `Body`.

    Each is read from the file on first access.
    """

    def _read(self, name: str) -> Any:
        return self._array(name)


class StoredControl(_Read, Arrays, Control):
    """The control loop of a stored trial, with the attributes of `Control`.

    Each is read from the file on first access.
    """

    def _read(self, name: str) -> Any:
        if name == "rate":
            return float(self.attrs["rate_hz"])
        if name in ("detector", "controller", "sensor"):
            return str(self.attrs.get(name, ""))
        if (
            name in ("command", "measured_position", "grip_force", "arm")
            and self._place(name) not in self
        ):
            kind = np.float32 if name in ("grip_force", "arm") else np.uint8
            return _kept(
                np.empty({"command": (0, 3), "arm": (0, 2)}.get(name, (0,)), kind)
            )  # as for a simulated open recording
        return self._array(self._place(name))

    @staticmethod
    def _place(name: str) -> str:
        return "arm_speed" if name == "arm" else name


def is_recording(labels: Arrays) -> bool:
    """True if the labels are those of an imported recording."""
    return "rule" in labels.attrs


def rules_of(labels: Arrays) -> dict[str, str]:
    """The rules of the labels, each with its array."""
    return {
        rule: array
        for rule, array in (RECORDED if is_recording(labels) else RULES).items()
        if array in labels
    }


def check_evenly_spaced(place: str, sensor: Arrays, allowed: str) -> None:
    """Raises InputError if the samples of a recorded `sensor` are not evenly spaced.

    Their indices then cannot replace time. The message begins with `place`.
    """
    times, resolution = sensor["t"][:], float(sensor.attrs.get("time_resolution_s", 0.0))
    if not _core.evenly_spaced(times, resolution):
        raise _core.InputError(
            f"{place}: its samples are not evenly spaced ({_core.timing_text(times, resolution)}); allowed: {allowed}"
        )


def check_units(place: str, found: Mapping[str, str], needed: Mapping[str, str]) -> None:
    """Raises InputError if a channel has another physical unit than the one in which it is read.

    The message begins with `place`.

    Args:
        place: beginning of the message
        found: units of channels by name
        needed: units in which some of them are read
    """
    for name, unit in needed.items():
        if name in found and found[name] != unit:
            raise _core.InputError(
                f"{place}: channel {name} is in {found[name]!r}, but it is read in {unit}{_core.other_unit_remedy(found[name], unit)}"
            )


class StoredTrial:
    """One trial of a dataset, with the attributes of a simulated `Trial`.

    Arrays stay in the file until they are accessed.

    Pickling and deep-copying are supported: the copy opens the file again.

    Attributes:
        trial: number in the sweep
        seed: seed of the dataset
        params: swept values by dotted path, SI
        outcome: the trial's outcome
        sha256: digest of the whole trial; empty in a file of schema 1
    """

    def __init__(self, group: h5py.Group, trial: int) -> None:
        self._group = group
        self.trial = trial
        with reading(group):
            self.seed = int(group.attrs["seed"])
            self.params: dict[str, Any] = json.loads(group.attrs["params"])
            self.outcome: dict[str, Any] = json.loads(group.attrs["outcome"])
            self.sha256 = str(group.attrs.get("sha256", ""))

        self._made: dict[str, Any] = {}  # each array is read only once

    def _groups(self, of: str, kind: Callable[[h5py.Group], Opened]) -> dict[str, Opened]:
        if of not in self._made:
            with reading(self._group):
                parent = _member(self._group, of) if of in self._group else {}
                self._made[of] = {name: kind(_member(parent, name)) for name in parent}
        made: dict[str, Opened] = self._made[of]
        return made

    @property
    def sensors(self) -> dict[str, StoredSensor]:
        """Output of each sensor, by name. Empty if only outcomes were recorded."""
        return self._groups("sensors", StoredSensor)

    @property
    def labels(self) -> dict[str, StoredLabels]:
        """The truth about each sensor's pad, by the sensor's name."""
        return self._groups("labels", StoredLabels)

    @property
    def bodies(self) -> dict[str, StoredBody]:
        """Motion of each body in the world, by name."""
        return self._groups("truth", StoredBody)

    @property
    def control(self) -> StoredControl | None:
        """The control loop. None: the scene has neither detector nor controller."""
        if "control" not in self._made:
            with reading(self._group):
                self._made["control"] = (
                    StoredControl(_member(self._group, "control"))
                    if "control" in self._group
                    else None
                )
        found: StoredControl | None = self._made["control"]
        return found

    @property
    def contacts(self) -> dict[str, Contact]:
        """Empty: datasets do not contain the contact of units (`Trial.contacts`)."""
        return {}

    def __reduce__(self) -> Any:
        return _reopened, (StoredTrial, self._group.file.filename, self._group.name, self.trial)

    def __repr__(self) -> str:
        return trial_text(self.trial, self.seed, self.sensors)

    def _repr_html_(self) -> str:
        return trial_table(repr(self), self.sensors)


class Dataset(Mapping[int, StoredTrial]):
    """The trials of a dataset, in one or more files, by number. Created by `open()`.

    Attributes:
        version: version of the program that wrote it
        scene: text of the scene file
        seed: seed of the dataset
        command: command that writes the dataset again
        complete: True if it contains the whole sweep
        failed: trials that failed, each a dict of trial, message, command
        trials: numbers of its trials
    """

    def __init__(self, path: str | os.PathLike[str], check: bool = True) -> None:
        import h5py

        self._path = os.fspath(path)
        self._files: list[h5py.File] = []
        for name in _core.dataset_files(os.fspath(path), check):
            try:
                self._files.append(h5py.File(name, "r"))
            except OSError as error:
                raise _core.InputError(f"{name}: cannot be read: {error}") from error
        first = self._files[0]
        with reading(first):
            self.version = str(first.attrs["version"])
            self.scene = str(first.attrs["scene"])
            self.seed = int(first.attrs["seed"])
            self.command = str(first.attrs["command"])
        self.complete = True
        self.failed: list[dict[str, Any]] = []
        self._where: dict[int, h5py.File] = {}
        for file in self._files:
            with reading(file):
                self.complete = self.complete and int(file.attrs.get("complete", 0)) == 1
                self.failed += json.loads(file.attrs.get("failed", "[]"))
                self._where |= {
                    int(name.removeprefix("demo_")): file for name in _member(file, "data")
                }
        self.trials = sorted(self._where)

    def __getitem__(self, trial: int) -> StoredTrial:
        file = self._where[trial]
        with reading(file):
            return StoredTrial(_member(_member(file, "data"), f"demo_{trial}"), trial)

    def __iter__(self) -> Iterator[int]:
        return iter(self.trials)

    def __len__(self) -> int:
        return len(self.trials)

    def mask(self, part: str) -> list[int]:
        """Numbers of the trials of a part of the split.

        Args:
            part: "train", "valid" or "test"

        Returns:
            The numbers; empty if the run was killed.

        Raises:
            InputError: another part
        """
        if part not in ("train", "valid", "test"):
            raise _core.InputError(f"part {part!r}; allowed: 'train', 'valid', 'test'")
        trials: list[int] = []
        for file in self._files:
            with reading(file):
                if "mask" in file:
                    trials += [
                        int(name.removeprefix("demo_"))
                        for name in _member(_member(file, "mask"), part).asstr()[:]
                    ]
        return sorted(trials)

    def to_pandas(self) -> pandas.DataFrame:
        """Table with one row per trial.

        Columns are the swept values, then the outcome, by their names; the index is `trial`. Needs
        pandas.
        """
        import pandas

        rows = [{**self[trial].params, **self[trial].outcome} for trial in self.trials]
        return pandas.DataFrame(rows, index=pandas.Index(self.trials, name="trial"))

    def windows(
        self,
        *,
        length: int,
        stride: int = 1,
        sensor: str = "",
        channels: Sequence[str] = (),
        labels: str = "strict",
        part: str = "",
        trials: Sequence[int] | None = None,
    ) -> Windows:
        """Creates windows of a sensor's samples with one label each, for training.

        Warns of trials that are shorter than a window.

        Args:
            length: samples per window
            stride: samples between the starts of successive windows
            sensor: name; empty: the only sensor
            channels: channels to concatenate; empty: all. They must have the labels' rate
            labels: rule by which a sample slips: "strict", a whole unit slips, the default of
                `evaluate()`; "micro", a part of a unit slips; "paper", the rule of the sensor's
                paper; "recorded", the labels of an imported recording, which has no others.
                docs/concepts/labels.md compares them
            part: "train", "valid" or "test" of the masks; empty: every trial
            trials: numbers of the trials to use; None: all of the part

        Returns:
            The windows.

        Raises:
            InputError: an argument is invalid, no trial is chosen, for example because the mask of
            `part` is empty, a trial lacks such labels or channels, every trial is shorter than a
            window, the label of every window is unknown, trials differ in the sensor's rate by
            more than 1 % or in the unit or shape of a channel, or a recording's samples are not evenly spaced, which
            windows require.
        """
        return Windows(
            self,
            whole_number(length, "length"),
            whole_number(stride, "stride"),
            sensor,
            channels,
            labels,
            part,
            trials,
        )

    def close(self) -> None:
        """Closes the files."""
        for file in self._files:
            file.close()

    def __reduce__(self) -> Any:
        return Dataset, (self._path, False)

    def __repr__(self) -> str:
        if not self._files[0]:
            return f"<slipbench.Dataset {self._path}: closed>"
        first = self[self.trials[0]].sensors if self.trials else {}
        sensors = "; ".join(
            f"{name} {one._arrays_text()} at {one.rate:g} Hz" for name, one in first.items()
        )
        return f"<slipbench.Dataset {self._path}: {counted(len(self), 'trial')}; {sensors or 'only outcomes'}>"

    def _repr_html_(self) -> str:
        return trial_table(
            repr(self), self[self.trials[0]].sensors if self._files[0] and self.trials else {}
        )

    def __enter__(self) -> Dataset:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Windows(Sequence[tuple[NDArray[np.float32], int]]):
    """Map-style dataset for `torch.utils.data.DataLoader`.

    It has windows [length, values] float32 and their labels, 0 hold, 1 slip.

    A window's label is that of its last sample. Samples without contact are hold. Windows of a
    recording whose last sample has an unknown label are left out. No window spans two trials. A
    trial is read once and cached: the chosen channels of all trials must fit into memory. Windows can be pickled: the copy opens the dataset again, by its path.
    """

    def __init__(
        self,
        dataset: Dataset,
        length: int,
        stride: int,
        sensor: str,
        channels: Sequence[str],
        labels: str,
        part: str,
        trials: Sequence[int] | None,
    ) -> None:
        if length < 1 or stride < 1:
            raise _core.InputError(f"length {length}, stride {stride}; allowed: 1 or more")
        if labels not in (known := RULES | RECORDED):
            raise _core.InputError(f"labels {labels!r}; allowed: {', '.join(map(repr, known))}")
        self._dataset, self._length, self._stride, self._rule = dataset, length, stride, labels
        self._sensor, self._channels = (
            sensor,
            [channels] if isinstance(channels, str) else list(channels),
        )
        self._arguments = (dataset, length, stride, sensor, self._channels, labels, part, trials)
        self._trials = self._chosen_trials(part, trials)
        self._kept: dict[
            int, tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.float64]]
        ] = {}
        samples = [self._samples(trial) for trial in self._trials]
        self._check_alike()
        self._starts = [
            self._known_starts(trial, count)
            for trial, count in zip(self._trials, samples, strict=True)
        ]
        self._ends = np.cumsum([0] + [len(starts) for starts in self._starts]).tolist()
        self._check_lengths(samples)

    def _chosen_trials(self, part: str, trials: Sequence[int] | None) -> list[int]:
        """The trials of a part, or those of it that are in `trials`, ascending."""
        chosen = self._dataset.mask(part) if part else list(self._dataset.trials)
        if trials is not None:
            if unknown := sorted(set(trials) - set(chosen)):
                raise _core.InputError(
                    f"trials: {', '.join(map(str, unknown))}; allowed: the numbers of the {part or 'dataset'}'s trials"
                )
            chosen = sorted(set(trials))
        if not chosen:
            raise _core.InputError(self._empty_text(part, trials))
        return chosen

    def _check_lengths(self, samples: list[int]) -> None:
        """Warns of trials without a window; raises InputError if there is none at all.

        `samples`: number of samples of each trial.
        """
        length = self._length
        short = [
            trial for trial, count in zip(self._trials, samples, strict=True) if count < length
        ]
        if len(short) == len(samples):
            longest = int(np.argmax(samples))
            raise _core.InputError(
                f"length {length}: the longest trial, {self._trials[longest]}, has {counted(samples[longest], 'sample')}; allowed: 1 to {samples[longest]}"
            )
        if not self._ends[-1]:
            raise _core.InputError(
                f"labels {self._rule!r}: the label of each window of {counted(len(samples), 'trial')} is unknown; "
                "use recordings in which hold or slip is known"
            )
        if short:
            warnings.warn(
                f"{len(short)} of {counted(len(samples), 'trial')} {'has' if len(short) == 1 else 'have'} fewer than {length} samples and no window: "
                f"{', '.join(map(str, short[:10]))}{' ...' if len(short) > 10 else ''}",
                stacklevel=4,
            )

    def _empty_text(self, part: str, trials: Sequence[int] | None) -> str:
        """The error of windows without any trial.

        What was chosen, and how many trials each mask has.
        """
        dataset = self._dataset
        masks = ", ".join(
            f"{name!r} {len(dataset.mask(name))}" for name in ("train", "valid", "test")
        )
        if trials is not None and len(trials) == 0:
            return f"trials: found an empty list; expected numbers of trials, or None for all of them; trials in the masks: {masks}"
        return f"{f'part {part!r}' if part else 'the dataset'} has no trials; trials in the masks: {masks}, of {len(dataset)} in the dataset"

    def _name(self, trial: StoredTrial) -> str:
        names = list(trial.sensors)
        if self._sensor in names:
            return self._sensor
        if self._sensor or len(names) != 1:
            raise _core.InputError(
                f"trial {trial.trial}: sensor {self._sensor!r}; allowed: "
                f"{', '.join(map(repr, names)) or 'nothing, only outcomes were recorded'}"
            )
        return names[0]

    def _states(self, trial: StoredTrial, name: str) -> h5py.Dataset:
        """The states of a sensor's pad by the rule of the windows.

        Raises InputError if the trial has none by this rule.
        """
        labels = trial.labels.get(name)
        rules = rules_of(labels) if labels is not None else {}
        if labels is None or self._rule not in rules:
            found = ", ".join(map(repr, rules)) or "no labels"
            which = "recording" if labels is None or is_recording(labels) else "simulated trial"
            raise _core.InputError(
                f"trial {trial.trial}: labels {self._rule!r}: the {which} has {found}; "
                + (
                    f"pass {' or '.join(f'labels={rule!r}' for rule in rules)}"
                    if rules
                    else "use a recording with labels"
                )
            )
        return labels[rules[self._rule]]

    def _known_starts(self, number: int, samples: int) -> range | NDArray[np.int64]:
        """First samples of the windows of a trial whose label is known."""
        starts = range(0, samples - self._length + 1, self._stride)
        if self._rule not in RECORDED or not starts:
            return starts
        trial = self._dataset[number]
        ends = np.asarray(self._states(trial, self._name(trial))[:])[
            self._length - 1 :: self._stride
        ]
        known = ends != _core.unknown_state
        return starts if known.all() else np.asarray(starts, np.int64)[known]

    def _samples(self, number: int) -> int:
        trial = self._dataset[number]
        return len(self._states(trial, self._name(trial)))

    def _chosen_channels(self, sensor: StoredSensor) -> list[str]:
        return self._channels or [str(one) for one in sensor.attrs["channels"]]

    def _check_alike(self) -> None:
        """Raises InputError if a trial lacks a channel, or differs from the first one.

        They differ if a sample has another meaning.
        """
        first = self._trials[0]
        first_rate, first_values = self._rate(first), self._values(first)
        for number in self._trials:
            name, rate, values = (
                self._name(self._dataset[number]),
                self._rate(number),
                self._values(number),
            )
            if abs(rate - first_rate) > 0.01 * first_rate:
                same = [one for one in self._trials if abs(self._rate(one) - rate) <= 0.01 * rate]
                raise _core.InputError(
                    f"trial {number}: sensor {name!r} has {rate:g} Hz, but {first_rate:g} Hz in trial {first}, so that windows of {self._length} samples "
                    f"differ in time; choose trials of one rate, such as trials={same[:10]}{' ...' if len(same) > 10 else ''}"
                )
            if values != first_values:
                texts = [
                    ", ".join(
                        f"{channel} {shape_text(shape, unit)}" for channel, shape, unit in one
                    )
                    for one in (values, first_values)
                ]
                raise _core.InputError(
                    f"trial {number}: sensor {name!r} has {texts[0]} per sample, but {texts[1]} in trial {first}; choose alike trials by trials=[...]"
                )

    def _sensor_of(self, number: int) -> StoredSensor:
        trial = self._dataset[number]
        return trial.sensors[self._name(trial)]

    def _rate(self, number: int) -> float:
        """Rate of a trial's sensor [Hz]."""
        return float(self._sensor_of(number).attrs["rate_hz"])

    def _values(self, number: int) -> list[tuple[str, tuple[int, ...], str]]:
        """Name, shape of a sample and unit of each channel of a trial.

        Raises InputError for a channel that the trial lacks, or that has another rate than the
        labels.
        """
        sensor, samples = self._sensor_of(number), self._samples(number)
        channels = self._chosen_channels(sensor)
        for channel in channels:
            if channel not in sensor or len(sensor[channel]) != samples:
                at_rate = [
                    str(one) for one in sensor.attrs["channels"] if len(sensor[str(one)]) == samples
                ]
                raise _core.InputError(
                    f"trial {number}: channel {channel!r} {'is not there' if channel not in sensor else 'has another rate than the labels'}; "
                    f"allowed: channels={at_rate}"
                )
        return [
            (channel, sensor[channel].shape[1:], str(sensor[channel].attrs["unit"]))
            for channel in channels
        ]

    def __reduce__(self) -> Any:
        return Windows, self._arguments

    def __repr__(self) -> str:
        return f"<slipbench.Windows {len(self)} of {counted(self._length, 'sample')} every {self._stride}, {counted(len(self._trials), 'trial')}, labels {self._rule}>"

    def _repr_html_(self) -> str:
        values = (
            (len(self), *self[0][0].shape)
            if len(self) and self._dataset._files[0]
            else (len(self), self._length)
        )
        return table(
            repr(self).strip("<>"),
            [("values", values, ""), ("labels", (len(self),), "0 hold, 1 slip")],
        )

    def _read(
        self, number: int
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.float64]]:
        if number not in self._kept:
            trial = self._dataset[number]
            name = self._name(trial)
            sensor = trial.sensors[name]
            check_evenly_spaced(
                f"trial {number}: sensor {name!r}",
                sensor,
                "one rate throughout, as `slipbench import --rate RATE` makes it",
            )
            states = self._states(trial, name)
            samples = len(states)
            values = np.concatenate(
                [
                    np.asarray(sensor[channel][:], np.float32).reshape(samples, -1)
                    for channel in self._chosen_channels(sensor)
                ],
                axis=1,
            )
            codes = np.asarray(states[:])
            slips = ((codes >= 2) & (codes != _core.unknown_state)).astype(np.uint8)
            self._kept[number] = values, slips, np.asarray(sensor["t"][:], np.float64)
        return self._kept[number]

    def __len__(self) -> int:
        return int(self._ends[-1])

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        values, slips, _, first = self._found(index)
        return values[first : first + self._length], int(slips[first + self._length - 1])

    def _found(
        self, index: int
    ) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.float64], int]:
        """Values, labels and times of the trial of window `index`, and its first sample.

        The sample is that of the window.
        """
        place = self._place(index)
        return *self._read(self._trials[place]), int(
            self._starts[place][index % len(self) - self._ends[place]]
        )

    def _place(self, index: int) -> int:
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        return bisect_right(self._ends, index % len(self)) - 1

    def trial(self, index: int) -> int:
        """The number of the trial of window `index`."""
        return self._trials[self._place(index)]

    def time(self, index: int) -> float:
        """Time of the last sample of window `index`, which has the window's label [s]."""
        _, _, times, first = self._found(index)
        return float(times[first + self._length - 1])

    def arrays(self) -> tuple[NDArray[np.float32], NDArray[np.uint8], NDArray[np.int64]]:
        """Copies all windows to arrays, for scikit-learn and PyTorch.

        `X, y, groups = data.windows(length=40, part="train").arrays()`.

        Returns:
            The windows [N, length, values], their labels [N], 0 hold, 1 slip, and their trials [N],
            for `GroupKFold`.

        Raises:
            InputError: the windows take more than 8 GB; use a greater stride, a shorter length or
            fewer channels.
        """
        counts = np.diff(self._ends)
        columns = self._read(self.trial(0))[0].shape[1] if len(self) else 0
        size = 4 * len(self) * self._length * columns
        if size > _MOST_BYTES:
            raise _core.InputError(
                f"{counted(len(self), 'window')} of {counted(self._length, 'sample')} of {counted(columns, 'value')} need {size / 1e9:.3g} GB; allowed: "
                f"{_MOST_BYTES / 1e9:g} GB; use a greater stride, a shorter length or fewer channels"
            )
        X, y = (
            np.empty((len(self), self._length, columns), np.float32),
            np.empty(len(self), np.uint8),
        )
        at = 0
        for trial, starts, count in zip(self._trials, self._starts, counts, strict=True):
            if not count:
                continue
            values, slips, _ = self._read(trial)
            chosen = slice(0, starts.stop, starts.step) if isinstance(starts, range) else starts
            X[at : at + count] = np.lib.stride_tricks.sliding_window_view(
                values, self._length, axis=0
            )[chosen].swapaxes(1, 2)
            y[at : at + count] = slips[self._length - 1 :][chosen]
            at += count
        return X, y, np.repeat(np.asarray(self._trials, np.int64), counts)


def open(path: str | os.PathLike[str], *, check: bool = True) -> Dataset:
    """Opens a dataset.

    Args:
        path: path of the first file, written by `slipbench run`, `sweep`, `import` or
            `Scene.write()`
        check: first compares the whole content of the files with their digests, which reads them
            once; False: opens at once, for data checked before

    Returns:
        The dataset.

    Raises:
        InputError: as the command line, if a file is damaged, missing or of another dataset
    """
    return Dataset(path, check)
