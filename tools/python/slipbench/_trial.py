"""A simulated trial as numpy arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from slipbench.bin import _core

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Bytes = NDArray[np.uint8]


@dataclass(frozen=True)
class Labels:
    """The truth about one pad: T samples of N units, E events. It lies in the contact plane.

    Codes of a pad are those of `State`; of a unit 0 detached, 1 stick, 2 slip (all of it), 3 partial (a part of it slips).

    Attributes:
        unit_state: [T, N] code of each unit
        slip_velocity: [T, N, 2] m/s of the slipping tip; 0 while it sticks
        slip_distance: [T, N] m, path slipped since the trial's start
        margin: [T, N] 1 - f_t/(mu_s f_n): 0 at the limit; NaN while detached
        force: [T, N, 3] N on the unit, without noise: x and y tangential, z normal
        state: [T] code of the pad, rule strict: a unit slips when all of it slips
        state_micro: [T] the same, rule micro: a unit slips as soon as a part of it does
        state_paper: [T] the same, rule of the sensor's paper
        stuck_fraction: [T] share of the touching elements that stick, 0 to 1; NaN while nothing touches
        slip_direction: [T] rad, of the slip's translation; NaN while nothing slips or the slip has none
        slip_centre: [T, 2] m, centre of the slip's rotation; NaN while it does not turn
        slip_angle: [T] rad, rotation of the slip, accumulated
        event_time: [E] s, when a unit changed its state, resolved inside the step
        event_unit: [E] which unit, 0 to N - 1
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


@dataclass(frozen=True)
class Sensor:
    """What one sensor emitted: T samples.

    Attributes:
        name: the scene's name for it
        type: what it is: "papillarray"
        rate: Hz, of the samples
        frame: what the axes are, as a sentence
        follows: the sensor whose pad it reads; empty: it has its own
        time: [T] s, when each sample was taken
        channels: [T, ...] by name, in the unit that `units` says: "force" [T, 9, 3] N
        units: SI unit of each channel
        channel_time: [T] s, of channels that are read at another time or rate
        labels: the truth about its pad
    """

    name: str
    type: str
    rate: float
    frame: str
    follows: str
    time: Doubles
    channels: dict[str, Floats]
    units: dict[str, str]
    channel_time: dict[str, Doubles]
    labels: Labels


@dataclass(frozen=True)
class Contact:
    """What the units of one pad feel, in the pad frame P, at T samples of its sensor: N units. Recorded with `record="contact"` alone.

    P has x and y in the plane of the pad and +z into the sensor, so that compression is positive. A sensor reads these two; `Labels.force` is the same
    force in the contact plane.

    Attributes:
        time: [T] s, of the samples
        force: [T, N, 3] N, what the object does to the unit, with what shakes the bench
        displacement: [T, N, 3] m, deformed tip minus undeformed tip, mean of the unit's elements
    """

    time: Doubles
    force: Floats
    displacement: Floats


@dataclass(frozen=True)
class Control:
    """What the loop saw and did, at T samples of the sensor that it reads. In an open recording the last four are empty.

    Attributes:
        detector: its type; empty: none
        controller: its type; empty: none
        sensor: the one that the loop reads
        rate: Hz, of the samples
        time: [T] s
        detector_class: [T] code of `State` that the loop sees; 0 is also "nothing seen yet"
        command: [T, 3] counts, registers written last: position, speed, force
        measured_position: [T] counts, 0 open to 255, register read last
        grip_force: [T] N, true normal force, mean of both pads
        arm: [T, 2] m/s, speed written last: sideways, up
    """

    detector: str
    controller: str
    sensor: str
    rate: float
    time: Doubles
    detector_class: Bytes
    command: Bytes
    measured_position: Bytes
    grip_force: Floats
    arm: Floats


class Trial:
    """One simulated trial. Its arrays are read-only views of the simulation's own record, without a copy.

    Attributes:
        trial: number in the sweep
        seed: of the dataset
        params: what was swept, by dotted path, SI
        outcome: how it ended; the keys of a dataset's attribute `outcome`
        sensors: what each sensor emitted, by name; empty where outcomes alone were recorded
        bodies: by name {"time": [T] s, "pose": [T, 7] m and quaternion w x y z, "velocity": [T, 6] m/s and rad/s}, in the world
        control: what the loop saw and did; None: the scene has neither detector nor controller
        contacts: what the units of each sensor's pad feel, by the sensor's name; empty but for `record="contact"`
    """

    def __init__(self, record: _core.Record, contacts: Mapping[str, tuple[Floats, Floats]] | None = None) -> None:
        self._record = record
        self.trial: int = record.trial
        self.seed: int = record.seed
        self.params: dict[str, Any] = json.loads(record.params_json)
        self.outcome: dict[str, Any] = json.loads(record.outcome_json)
        self.sensors: dict[str, Sensor] = {
            name: Sensor(**{**told, "labels": Labels(**told["labels"])}) for name, told in record.sensors(record).items()
        }
        self.bodies: dict[str, dict[str, NDArray[Any]]] = record.bodies(record)
        control = record.control(record)
        self.control: Control | None = None if control is None else Control(**control)
        self.contacts: dict[str, Contact] = {name: Contact(self.sensors[name].time, *felt) for name, felt in (contacts or {}).items()}

    @property
    def sha256(self) -> str:
        """The digest of all that the trial holds: equal to the attribute `sha256` of the same trial in a dataset."""
        return self._record.sha256()

    def __repr__(self) -> str:
        return f"<slipbench.Trial {self.trial} of seed {self.seed}: {', '.join(self.sensors) or 'outcome alone'}>"
