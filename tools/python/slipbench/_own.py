"""Detectors and controllers as Python classes.

A class says in one method what it makes of each frame. It is made anew for each trial and never sees the truth.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Protocol, TypeVar

from numpy.typing import NDArray

from slipbench.bin import _core


class State(IntEnum):
    """What can be said of a whole pad; the codes of a dataset."""

    NO_CONTACT = 0
    NON_SLIP = 1
    INCIPIENT = 2
    GROSS = 3


@dataclass(frozen=True)
class Source:
    """Whose frames come: handed to a class when a trial begins."""

    sensor: str  #: the scene's name for it
    type: str  #: "papillarray"
    rate: float  #: Hz
    shapes: dict[str, tuple[int, ...]]  #: of each channel
    preset: float = math.nan  #: N, the force with which the box is taken; of controllers alone


@dataclass(frozen=True)
class Frame:
    """One sample of a sensor. The arrays are filled anew for the next frame: copy what is to be kept."""

    time: float  #: s
    channels: dict[str, NDArray[Any]]  #: by name, in the shape that Source says

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.channels[name]


@dataclass(frozen=True)
class Estimate:
    """What a detector says."""

    state: State
    latency: float = 0.0  #: s, from the frame until the loop can see it
    stuck_fraction: float = math.nan  #: of the touching units, 0 to 1; NaN: not told


@dataclass(frozen=True)
class Slip:
    """What a controller is told beside the frame: the detector's estimate, and the gripper's status."""

    state: int  #: State; NO_CONTACT without a detector
    stuck_fraction: float  #: NaN: not told
    position: int  #: counts, 0 open to 255
    moving: bool
    stopped: bool  #: at the force limit

    @property
    def slips(self) -> bool:
        """Whether the detector says incipient or gross slip."""
        return self.state >= State.INCIPIENT


@dataclass(frozen=True)
class Command:
    """The gripper's registers, 0 to 255."""

    position: int  #: counts, 0 open
    speed: int = 0  #: 0 slowest
    force: int = 0  #: 0 weakest


class Detector(Protocol):
    """What `detector()` takes: `update` is called with each frame of the sensor."""

    def update(self, frame: Frame) -> Estimate | State | int: ...


class Controller(Protocol):
    """What `controller()` takes: `act` is called at each read of the gripper."""

    def act(self, frame: Frame, slip: Slip) -> Command | int: ...


def estimate_of(said: Any) -> Estimate:
    """What a detector returned, checked."""
    estimate = said if isinstance(said, Estimate) else Estimate(said)
    if not isinstance(estimate.state, numbers.Integral) or not 0 <= int(estimate.state) <= 3:
        raise TypeError(f"update() returned {said!r}; allowed: a State, 0 to 3, or an Estimate")
    if not 0.0 <= estimate.latency < math.inf:
        raise ValueError(f"a latency of {estimate.latency} s; allowed: 0 s or more")
    if estimate.stuck_fraction < 0.0 or estimate.stuck_fraction > 1.0:
        raise ValueError(f"a stuck fraction of {estimate.stuck_fraction}; allowed: 0 to 1, or NaN")
    return estimate


def command_of(said: Any) -> Command:
    """What a controller returned, checked."""
    command = said if isinstance(said, Command) else Command(said)
    for name in ("position", "speed", "force"):
        value = getattr(command, name)
        if not isinstance(value, numbers.Integral) or not 0 <= int(value) <= 255:
            raise TypeError(f"act() returned {said!r}; allowed: a position of 0 to 255, or a Command of such numbers")
    return command


DetectorClass = TypeVar("DetectorClass", bound=Callable[..., Detector])
ControllerClass = TypeVar("ControllerClass", bound=Callable[..., Controller])


def _declared(made: Any) -> list[tuple[str, float]]:
    return [(name, float(value)) for name, value in getattr(made, "parameters", {}).items()]


def _summary(made: Any) -> str:
    return (made.__doc__ or "A Python class.").strip().splitlines()[0]


def detector(name: str) -> Callable[[DetectorClass], DetectorClass]:
    """Registers a class as `detector: {type: NAME}` for the scenes of this process.

    It is made as `cls(source, **parameters)`, where its attribute `parameters`, a dict of numbers, gives names and defaults of what a scene may
    say beside the type. Raises InputError for a name that is slipbench's own; one of one's own is replaced.
    """

    def register(made: DetectorClass) -> DetectorClass:
        _core.register_detector(name, made, _summary(made), _declared(made))
        return made

    return register


def controller(name: str) -> Callable[[ControllerClass], ControllerClass]:
    """Registers a class as `controller: {type: NAME}`, as `detector()` does."""

    def register(made: ControllerClass) -> ControllerClass:
        _core.register_controller(name, made, _summary(made), _declared(made))
        return made

    return register
