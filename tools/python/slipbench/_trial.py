"""A simulated trial as numpy arrays."""

from __future__ import annotations

import json
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
    """The truth about one pad: T samples of N units. Codes are `State` and, of units, 0 detached, 1 stick, 2 slip, 3 partial."""

    unit_state: Bytes  #: [T, N]
    slip_velocity: Floats  #: [T, N, 2] m/s
    slip_distance: Floats  #: [T, N] m
    margin: Floats  #: [T, N] 1 - f_t/(mu_s f_n), NaN while detached
    force: Floats  #: [T, N, 3] N
    state: Bytes  #: [T] a unit slips when all of it slips
    state_micro: Bytes  #: [T] as soon as a part of it does
    state_paper: Bytes  #: [T] the rule of the sensor's paper
    stuck_fraction: Floats  #: [T] NaN while nothing touches
    slip_direction: Floats  #: [T] rad, NaN while nothing slips
    slip_centre: Floats  #: [T, 2] m, NaN while the slip has no rotation
    slip_angle: Floats  #: [T] rad, accumulated
    event_time: Doubles  #: [E] s
    event_unit: NDArray[np.uint32]  #: [E]
    event_kind: Bytes  #: [E] 0 touch, 1 slip, 2 stick, 3 detach, 4 micro, 5 part_sticks
    unit_positions: Doubles  #: [N, 2] m
    unit_heights: Doubles  #: [N] m
    k_normal: Doubles  #: [N] N/m
    k_tangential: Doubles  #: [N] N/m
    mu_static: Doubles  #: [N]
    mu_kinetic: Doubles  #: [N]
    onset_time: Doubles  #: [N] s, first slip of all of a unit; NaN: never
    micro_onset_time: Doubles  #: [N] s, first slip of a part of it; NaN: never


@dataclass(frozen=True)
class Sensor:
    """What one sensor emitted: T samples."""

    name: str  #: in the scene
    type: str  #: "papillarray"
    rate: float  #: Hz
    frame: str  #: what the axes are
    follows: str  #: the sensor whose pad it reads; empty: it has its own
    time: Doubles  #: [T] s
    channels: dict[str, Floats]  #: [T, ...] by name
    units: dict[str, str]  #: of each channel
    channel_time: dict[str, Doubles]  #: [T] s, of channels with a time of their own
    labels: Labels


@dataclass(frozen=True)
class Control:
    """What the loop saw and did, at T samples of the sensor that it reads. In an open recording the last four are empty."""

    detector: str  #: empty: none
    controller: str  #: empty: none
    sensor: str
    rate: float  #: Hz
    time: Doubles  #: [T] s
    detector_class: Bytes  #: [T] State
    command: Bytes  #: [T, 3] registers: position, speed, force
    measured_position: Bytes  #: [T] counts
    grip_force: Floats  #: [T] N, true
    arm: Floats  #: [T, 2] m/s, sideways and up


class Trial:
    """One simulated trial. Its arrays are read-only views of the simulation's own record, without a copy."""

    def __init__(self, record: _core.Record) -> None:
        self._record = record
        self.trial: int = record.trial  #: number in the sweep
        self.seed: int = record.seed  #: of the dataset
        self.params: dict[str, Any] = json.loads(record.params_json)  #: what was swept, SI
        self.outcome: dict[str, Any] = json.loads(record.outcome_json)  #: how it ended; the keys of a dataset's attribute `outcome`
        self.sensors: dict[str, Sensor] = {
            name: Sensor(**{**told, "labels": Labels(**told["labels"])}) for name, told in record.sensors(record).items()
        }
        #: by name: {"time" [T] s, "pose" [T, 7] m and quaternion w x y z, "velocity" [T, 6] m/s and rad/s}
        self.bodies: dict[str, dict[str, NDArray[Any]]] = record.bodies(record)
        control = record.control(record)
        self.control: Control | None = None if control is None else Control(**control)  #: None: no detector, no controller

    @property
    def sha256(self) -> str:
        """The digest of all that the trial holds: equal to the attribute `sha256` of the same trial in a dataset."""
        return self._record.sha256()

    def __repr__(self) -> str:
        return f"<slipbench.Trial {self.trial} of seed {self.seed}: {', '.join(self.sensors) or 'outcome alone'}>"
