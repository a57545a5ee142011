"""Content of a trial as numpy arrays, the same for simulated and stored trials.

Also the simulated trial itself.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipbench._program import counted
from slipbench.bin import _core

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Bytes = NDArray[np.uint8]

Row = tuple[str, tuple[int, ...], str]  # row of a representation: name, shape and unit of an array


def shape_text(shape: tuple[int, ...], unit: str) -> str:
    """Shape and unit as "[4000, 9, 3] N"; a pure number has no unit."""
    return f"[{', '.join(map(str, shape))}]" + (f" {unit}" if unit not in ("", "1") else "")


def table(title: str, rows: Iterable[Row]) -> str:
    """An HTML table of arrays, for notebooks."""
    lines = "".join(
        f"<tr><td><code>{escape(name)}</code></td><td>[{', '.join(map(str, shape))}]</td><td>{escape(unit)}</td></tr>"
        for name, shape, unit in rows
    )
    return f"<p>{escape(title)}</p><table><thead><tr><th>array</th><th>shape</th><th>unit</th></tr></thead><tbody>{lines}</tbody></table>"


class Described:
    """Base of classes with arrays: short representations with shapes and units."""

    def _title(self) -> str:
        return type(self).__name__.removeprefix("Stored")

    def _rows(self) -> Iterator[Row]:
        """Name, shape and unit of each array."""
        for name, unit in UNITS[self._title().split()[0]].items():
            if hasattr(self, name):
                yield name, getattr(self, name).shape, unit

    def __getitem__(self, name: str) -> Any:
        try:
            return getattr(self, name)
        except AttributeError:
            raise KeyError(name) from None

    def _arrays_text(self) -> str:
        return ", ".join(f"{name} {shape_text(shape, unit)}" for name, shape, unit in self._rows())

    def __repr__(self) -> str:
        return f"<slipbench.{self._title()}: {self._arrays_text()}>"

    def _repr_html_(self) -> str:
        return table(self._title(), self._rows())


UNITS = _core.array_units()  # by class


@dataclass(frozen=True, repr=False, eq=False)
class Labels(Described):
    """The truth about one pad, in the contact plane: T samples of N units, E events.

    Codes of a pad are those of `State`; codes of a unit: 0 detached, 1 stick, 2 slip (the whole
    unit), 3 partial (a part of it slips).

    docs/concepts/labels.md compares the three states. Labels of an imported recording have at most
    `t` and `state_paper`; other attributes raise AttributeError.

    Attributes:
        t: [T] s, of the samples
        unit_state: [T, N] code of each unit
        slip_velocity: [T, N, 2] m/s of the slipping tip; 0 in stick
        slip_distance: [T, N] m, path slipped since the trial's start
        margin: [T, N] 1 - f_t/(mu_s f_n): 0 at the limit; NaN while detached
        force: [T, N, 3] N on the unit, without noise: x and y tangential, z normal
        state: [T] code of the pad, rule strict: a unit slips when all of it slips
        state_micro: [T] the same, rule micro: a unit slips as soon as a part of it does
        state_paper: [T] the same, rule of the sensor's paper
        stuck_fraction: [T] share of the touching elements in stick, 0 to 1; NaN without contact
        slip_direction: [T] rad, of the slip's translation; NaN without slip or translation
        slip_centre: [T, 2] m, centre of the slip's rotation; NaN without rotation
        slip_angle: [T] rad, rotation of the slip, accumulated
        event_time: [E] s, time of a unit's change of state, resolved within the step
        event_unit: [E] index of the unit, 0 to N - 1
        event_kind: [E] 0 touch, 1 slip, 2 stick, 3 detach, 4 micro, 5 part_sticks
        unit_positions: [N, 2] m, in the pad plane
        unit_heights: [N] m, along the pad's normal
        k_normal: [N] N/m, stiffness along the normal
        k_tangential: [N] N/m, stiffness in the plane
        mu_static: [N] coefficient of static friction, the scene's
        mu_kinetic: [N] coefficient of kinetic friction, the scene's
        onset_time: [N] s, first slip of all of a unit; NaN: never
        micro_onset_time: [N] s, first slip of a part of it; NaN: never
    """

    t: Doubles
    unit_state: Bytes
    slip_velocity: Floats
    slip_distance: Floats
    margin: Floats
    force: Floats
    state: Bytes
    state_micro: Bytes
    state_paper: Bytes
    stuck_fraction: Floats
    slip_direction: Floats
    slip_centre: Floats
    slip_angle: Floats
    event_time: Doubles
    event_unit: NDArray[np.uint32]
    event_kind: Bytes
    unit_positions: Doubles
    unit_heights: Doubles
    k_normal: Doubles
    k_tangential: Doubles
    mu_static: Doubles
    mu_kinetic: Doubles
    onset_time: Doubles
    micro_onset_time: Doubles


@dataclass(frozen=True, repr=False, eq=False)
class Sensor(Described):
    """Output of one sensor: T samples.

    Each channel is also an attribute: `sensor.force` is `sensor.channels["force"]`, [T, 9, 3] N of
    a papillarray.

    Attributes:
        name: its name in the scene
        type: such as "papillarray"
        rate: Hz, of the samples
        frame: definition of the axes, as a sentence
        follows: the sensor whose pad it reads; empty: its own pad
        t: [T] s, time of each sample
        channels: [T, ...] by name, in the units of `units`: "force" [T, 9, 3] N
        units: SI unit of each channel
        channel_time: [T] s, of channels with a different time or rate
    """

    name: str
    type: str
    rate: float
    frame: str
    follows: str
    t: Doubles
    channels: Mapping[str, Floats]
    units: Mapping[str, str]
    channel_time: Mapping[str, Doubles]

    def __getattr__(self, name: str) -> Floats:
        channels = self.__dict__.get("channels", {})
        if name not in channels:
            raise AttributeError(
                f"sensor {self.__dict__.get('name')!r} has no channel or attribute {name!r}; channels: {', '.join(channels)}"
            )
        found: Floats = channels[name]
        return found

    def __getitem__(self, name: str) -> Any:
        return self.channels[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.channels]

    def _title(self) -> str:
        return f"Sensor {self.name!r} {self.type}, {counted(len(self.t), 'sample')} at {self.rate:g} Hz"

    def _rows(self) -> Iterator[Row]:
        for name, values in self.channels.items():
            yield name, values.shape, self.units[name]


@dataclass(frozen=True, repr=False, eq=False)
class Contact(Described):
    """Force and displacement of one pad's N units at T samples of its sensor.

    They are in the pad frame P. Recorded only with `record="contact"`.

    P has x and y in the plane of the pad and +z into the sensor, so that compression is positive. A
    sensor reads these two arrays; `Labels.force` is the same force in the contact plane.

    Attributes:
        t: [T] s, of the samples
        force: [T, N, 3] N, force of the object on the unit, including disturbances of the bench
        displacement: [T, N, 3] m, deformed tip minus undeformed tip, mean of the unit's elements
    """

    t: Doubles
    force: Floats
    displacement: Floats


@dataclass(frozen=True, repr=False, eq=False)
class Body(Described):
    """Motion of a body in the world, at T samples.

    Attributes:
        t: [T] s, of the samples
        pose: [T, 7] position of the body's origin [m], then its quaternion w x y z
        velocity: [T, 6] velocity of the origin [m/s], then angular velocity [rad/s]
    """

    t: Doubles
    pose: Floats
    velocity: Floats


@dataclass(frozen=True, repr=False, eq=False)
class Control(Described):
    """The control loop at T samples of the sensor that it reads.

    In an open recording the last four arrays are empty.

    Attributes:
        detector: its type; empty: none
        controller: its type; empty: none
        sensor: the sensor that the loop reads
        rate: Hz, of the samples
        t: [T] s, of the samples
        detector_class: [T] code of `State` seen by the loop; 0 also means "nothing seen yet"
        command: [T, 3] counts, registers written last: position, speed, force
        measured_position: [T] counts, 0 open to 255, of the latest read
        grip_force: [T] N, true normal force, mean of both pads
        arm: [T, 2] m/s, speed written last: sideways, up
    """

    detector: str
    controller: str
    sensor: str
    rate: float
    t: Doubles
    detector_class: Bytes
    command: Bytes
    measured_position: Bytes
    grip_force: Floats
    arm: Floats


class Trial:
    """One simulated trial.

    Its arrays are read-only views of the simulation's record, without a copy. A `StoredTrial` has
    the same attributes.

    Trials can be pickled and deep-copied; a copy has its own arrays.

    Attributes:
        trial: number in the sweep
        seed: seed of the dataset
        params: swept values by dotted path, SI
        outcome: the trial's outcome, with the keys of a dataset's attribute `outcome`
        sensors: output of each sensor, by name; empty if only outcomes were recorded
        labels: the truth about each sensor's pad, by the sensor's name
        bodies: motion of each body in the world, by name
        control: the control loop; None: the scene has neither detector nor controller
        contacts: force and displacement of the units of each sensor's pad, by the sensor's name;
            empty unless `record="contact"`
    """

    def __init__(
        self, record: _core.Record, contacts: Mapping[str, tuple[Floats, Floats]] | None = None
    ) -> None:
        self._record: _core.Record | None = record
        self.trial: int = record.trial
        self.seed: int = record.seed
        self.params: dict[str, Any] = json.loads(record.params_json)
        self.outcome: dict[str, Any] = json.loads(record.outcome_json)
        sensors = record.sensors(record)
        self.labels: dict[str, Labels] = {
            name: Labels(t=one["t"], **one.pop("labels")) for name, one in sensors.items()
        }
        self.sensors: dict[str, Sensor] = {name: Sensor(**one) for name, one in sensors.items()}
        self.bodies: dict[str, Body] = {
            name: Body(**one) for name, one in record.bodies(record).items()
        }
        control = record.control(record)
        self.control: Control | None = None if control is None else Control(**control)
        self.contacts: dict[str, Contact] = {
            name: Contact(self.sensors[name].t, *felt) for name, felt in (contacts or {}).items()
        }

    @property
    def _simulated(self) -> _core.Record:
        """The simulation's record, for detectors and training.

        Returns:
            the record, whose memory the arrays share

        Raises:
            InputError: the trial is a copy by pickle or deepcopy, which has arrays only
        """
        if self._record is None:
            raise _core.InputError(
                f"trial {self.trial}: expected a trial of this process, found a copy by pickle or deepcopy, which has no record"
            )
        return self._record

    @property
    def sha256(self) -> str:
        """Digest of the whole trial.

        It equals the attribute `sha256` of the same trial in a dataset.
        """
        return self._record.sha256() if self._record else str(self.__dict__["_sha256"])

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_record": None, "_sha256": self.sha256}

    def __repr__(self) -> str:
        return trial_text(self.trial, self.seed, self.sensors)

    def _repr_html_(self) -> str:
        return trial_table(repr(self), self.sensors)


def trial_text(number: int, seed: int, sensors: Mapping[str, Sensor]) -> str:
    """Short representation of a trial."""
    arrays = "; ".join(
        f"{name} {one._arrays_text()} at {one.rate:g} Hz" for name, one in sensors.items()
    )
    return f"<slipbench.Trial {number} of seed {seed}: {arrays or 'only the outcome'}>"


def trial_table(title: str, sensors: Mapping[str, Sensor]) -> str:
    """Table of the arrays of a trial's sensors, for notebooks."""
    return table(
        title.strip("<>"),
        [
            (f"{name}.{channel}", shape, unit)
            for name, one in sensors.items()
            for channel, shape, unit in one._rows()
        ],
    )
