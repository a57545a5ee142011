"""Dataset files: trials, masks, lazy arrays, windows for a trainer."""

from __future__ import annotations

import json
import os
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from slipbench.bin import _core

if TYPE_CHECKING:
    import h5py
    import pandas

# How a dataset's labels say of a sample whether the pad slips: by all of a unit, a part of it, the sensor's paper.
RULES = {"strict": "state", "micro": "state_micro", "paper": "state_paper"}


@contextmanager
def reading(what: h5py.Group | h5py.Dataset, *errors: type[Exception]) -> Iterator[None]:
    """Turns what h5py and json raise on damaged data into an InputError that names the file and the object. `errors`: which; default: all of them."""
    try:
        yield
    except _core.InputError:
        raise
    except errors or (OSError, RuntimeError, LookupError, TypeError, ValueError, MemoryError) as error:
        raise _core.InputError(f"{what.file.filename}: {what.name}: is damaged: {error}") from error


def _member(group: h5py.Group, name: str) -> Any:
    """The object `name` of a group. Links and storage elsewhere, which could be anybody's file, are refused."""
    import h5py  # takes as long to load as all else here

    from slipbench._array import Array

    with reading(group):
        link = group.get(name, getlink=True)
    if link is None:
        raise KeyError(name)
    if not isinstance(link, h5py.HardLink):
        raise _core.InputError(f"{group.file.filename}: {group.name}/{name} is a link to another place; allowed: what the file itself holds")
    with reading(group):
        found = group[name]
        if isinstance(found, h5py.Dataset) and (found.external or found.is_virtual):
            raise _core.InputError(f"{group.file.filename}: {found.name} is stored in another file; allowed: what the file itself holds")
    return Array(found.id, readonly=True) if isinstance(found, h5py.Dataset) else found


class Arrays(Mapping[str, "h5py.Dataset"]):
    """The arrays of a group by name, read when they are indexed: `labels["state"][:]`. Each has its unit as `array.attrs["unit"]`.

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


def check_evenly_spaced(place: str, sensor: Arrays, allowed: str) -> None:
    """Raises InputError, which begins with `place`, where the samples of a recorded `sensor` cannot be counted in place of time."""
    times, resolution = sensor["t"][:], float(sensor.attrs.get("time_resolution_s", 0.0))
    if not _core.evenly_spaced(times, resolution):
        raise _core.InputError(f"{place}: its samples are not evenly spaced ({_core.timing_text(times, resolution)}); allowed: {allowed}")


class StoredTrial:
    """One trial of a dataset. Arrays stay in the file until they are indexed.

    Attributes:
        trial: number in the sweep
        seed: of the dataset
        params: what was swept, by dotted path, SI
        outcome: how it ended
        sha256: digest of all that the trial holds; empty in a file of schema 1
    """

    def __init__(self, group: h5py.Group, trial: int) -> None:
        self._group = group
        self.trial = trial
        with reading(group):
            self.seed = int(group.attrs["seed"])
            self.params: dict[str, Any] = json.loads(group.attrs["params"])
            self.outcome: dict[str, Any] = json.loads(group.attrs["outcome"])
            self.sha256 = str(group.attrs.get("sha256", ""))

    def _groups(self, of: str) -> dict[str, Arrays]:
        with reading(self._group):
            if of not in self._group:
                return {}
            parent = _member(self._group, of)
            return {name: Arrays(_member(parent, name)) for name in parent}

    @property
    def sensors(self) -> dict[str, Arrays]:
        """The channels of each sensor by name, [T, ...], and "t" [T] s; attributes type, rate_hz, frame. Empty where outcomes alone were recorded.

        An imported recording has mean_rate_hz, median_rate_hz, largest_gap_s, largest_gap_at_s and time_resolution_s, too.
        """
        return self._groups("sensors")

    @property
    def labels(self) -> dict[str, Arrays]:
        """The truth about each sensor's pad: the arrays of `Labels`, with the same shapes and units; events are "events/t", "events/unit", "events/kind"."""
        return self._groups("labels")

    @property
    def bodies(self) -> dict[str, Arrays]:
        """Motion of each body in the world: "t" [T] s, "pose" [T, 7] m and quaternion w x y z, "velocity" [T, 6] m/s and rad/s."""
        return self._groups("truth")

    @property
    def control(self) -> Arrays | None:
        """What the loop saw and did: "t" [T] s, "detector_class" [T]; in a grasp "command" [T, 3] and "measured_position" [T] counts, "grip_force" [T] N.

        None: the scene has neither detector nor controller.
        """
        with reading(self._group):
            return Arrays(_member(self._group, "control")) if "control" in self._group else None


class Dataset(Mapping[int, StoredTrial]):
    """The trials of a dataset file, or of several that are one dataset, by number. `open()` makes one.

    Attributes:
        version: of the program that wrote it
        scene: the scene file, word for word
        seed: of the dataset
        command: that writes it again
        complete: whether all of the sweep is in it
        failed: trials that failed, each a dict of trial, message, command
        trials: numbers of its trials
    """

    def __init__(self, path: str | os.PathLike[str], check: bool = True) -> None:
        import h5py

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
                self._where |= {int(name.removeprefix("demo_")): file for name in _member(file, "data")}
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
        """Numbers of the trials of `part`: "train", "valid" or "test". Empty where the run was killed."""
        if part not in ("train", "valid", "test"):
            raise _core.InputError(f"part {part!r}; allowed: 'train', 'valid', 'test'")
        trials: list[int] = []
        for file in self._files:
            with reading(file):
                if "mask" in file:
                    trials += [int(name.removeprefix("demo_")) for name in _member(_member(file, "mask"), part).asstr()[:]]
        return sorted(trials)

    def to_pandas(self) -> pandas.DataFrame:
        """A row a trial: what was swept, then how it ended, by their own names; index `trial`. Needs pandas."""
        import pandas

        rows = [{**self[trial].params, **self[trial].outcome} for trial in self.trials]
        return pandas.DataFrame(rows, index=pandas.Index(self.trials, name="trial"))

    def windows(self, *, length: int, stride: int = 1, sensor: str = "", channels: Sequence[str] = (), labels: str = "micro",
                part: str = "") -> Windows:
        """Windows of a sensor's samples with a label each, for a trainer.

        `length` and `stride` count samples. `sensor`: which; empty: the only one. `channels`: their columns side by side; empty: all. `labels`: when a
        sample is slip, "strict" (all of a unit slips), "micro" (a part of it does) or "paper" (the rule of the sensor's paper). Labels are taken sample by
        sample: the channels must be sampled at the labels' rate. `part`: of the masks; empty: every trial. A recording whose samples are not evenly
        spaced is refused, since a window counts samples.
        """
        return Windows(self, length, stride, sensor, channels, labels, self.mask(part) if part else self.trials)

    def close(self) -> None:
        """Closes the files."""
        for file in self._files:
            file.close()

    def __enter__(self) -> Dataset:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Windows(Sequence[tuple[NDArray[np.float32], int]]):
    """What `torch.utils.data.DataLoader` takes as a map-style dataset: windows [length, values] float32 and their labels, 0 hold, 1 slip.

    A window's label is that of its last sample. Samples in which nothing touches are hold. No trial's window reaches into another's. A trial is
    read once and kept: a sensor's chosen channels of all trials must fit into memory.
    """

    def __init__(self, dataset: Dataset, length: int, stride: int, sensor: str, channels: Sequence[str], labels: str, trials: Sequence[int]) -> None:
        if length < 1 or stride < 1:
            raise _core.InputError(f"length {length}, stride {stride}; allowed: 1 or more")
        if labels not in RULES:
            raise _core.InputError(f"labels {labels!r}; allowed: {', '.join(map(repr, RULES))}")
        self._dataset, self._length, self._stride, self._rule = dataset, length, stride, RULES[labels]
        self._sensor, self._channels = sensor, list(channels)
        self._trials = list(trials)
        self._kept: dict[int, tuple[NDArray[np.float32], NDArray[np.uint8]]] = {}
        self._ends = np.cumsum([0] + [self._count(trial) for trial in self._trials]).tolist()

    def _name(self, trial: StoredTrial) -> str:
        names = list(trial.sensors)
        if self._sensor in names:
            return self._sensor
        if self._sensor or len(names) != 1:
            raise _core.InputError(f"trial {trial.trial}: sensor {self._sensor!r}; allowed: {', '.join(map(repr, names)) or 'nothing, outcomes alone'}")
        return names[0]

    def _count(self, number: int) -> int:
        trial = self._dataset[number]
        samples = len(trial.labels[self._name(trial)][self._rule])
        return max(0, (samples - self._length) // self._stride + 1)

    def _read(self, number: int) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
        if number not in self._kept:
            trial = self._dataset[number]
            name = self._name(trial)
            sensor = trial.sensors[name]
            check_evenly_spaced(f"trial {number}: sensor {name!r}", sensor, "one rate throughout, as `slipbench import --rate RATE` makes it")
            channels = self._channels or [str(one) for one in sensor.attrs["channels"]]
            samples = len(trial.labels[name][self._rule])
            for channel in channels:
                if channel not in sensor or len(sensor[channel]) != samples:
                    at_rate = [one for one in sensor.attrs["channels"] if len(sensor[str(one)]) == samples]
                    raise _core.InputError(f"trial {number}: channel {channel!r} {'is not there' if channel not in sensor else 'has another rate than the labels'}; "
                                           f"allowed: channels={[str(one) for one in at_rate]}")
            values = np.concatenate([np.asarray(sensor[channel][:], np.float32).reshape(samples, -1) for channel in channels], axis=1)
            slips = (np.asarray(trial.labels[name][self._rule][:]) >= 2).astype(np.uint8)
            self._kept[number] = values, slips
        return self._kept[number]

    def __len__(self) -> int:
        return int(self._ends[-1])

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(index)
        index %= len(self)
        place = bisect_right(self._ends, index) - 1
        values, slips = self._read(self._trials[place])
        first = (index - self._ends[place]) * self._stride
        return values[first : first + self._length], int(slips[first + self._length - 1])


def open(path: str | os.PathLike[str], *, check: bool = True) -> Dataset:
    """Opens a dataset that `slipbench run`, `sweep`, `import` or `Scene.write()` has written, by the `path` of its first file.

    Raises `InputError`, as the command line does, if a file is damaged, missing or of another dataset. `check`: compare all that the files hold with their
    digests first, which reads them once; False: open at once, for data that have been checked before.
    """
    return Dataset(path, check)
