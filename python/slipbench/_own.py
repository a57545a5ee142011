"""Sensors, detectors and controllers as Python classes.

A class has one method that receives each frame and returns its result. Each trial has its own
instance. Only sensors see the true contact.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipbench.bin import _core


class State(IntEnum):
    """State of a whole pad, with the codes of a dataset.

    Attributes:
        NO_CONTACT: 0
        NON_SLIP: 1
        INCIPIENT: 2, some touching units slip
        GROSS: 3, all of them slip
    """

    NO_CONTACT = _core.pad_states()["no_contact"]
    NON_SLIP = _core.pad_states()["non_slip"]
    INCIPIENT = _core.pad_states()["incipient"]
    GROSS = _core.pad_states()["gross"]


@dataclass(frozen=True)
class Source:
    """Source of frames, passed to a class when a trial begins.

    Attributes:
        sensor: its name in the scene
        type: such as "papillarray"
        rate: Hz, of the frames
        shapes: shape of each channel's array in a frame: {"force": (9, 3)}
        preset: N, the grip force with which the box is gripped; NaN for a detector
    """

    sensor: str
    type: str
    rate: float
    shapes: dict[str, tuple[int, ...]]
    preset: float = math.nan


@dataclass(frozen=True)
class Frame:
    """One sample of a sensor. The next frame overwrites the arrays: copy what you keep.

    Attributes:
        time: s
        channels: arrays by name, with the shapes of `Source.shapes` and the units of
            `Sensor.units`; `frame["force"]` is one of them
    """

    time: float
    channels: dict[str, NDArray[Any]]

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.channels[name]


@dataclass(frozen=True)
class Estimate:
    """Result of a detector.

    Attributes:
        state: state of the whole pad
        latency: s, from the frame until the loop sees the result
        stuck_fraction: stuck fraction of the touching units, 0 to 1; NaN: not estimated
    """

    state: State
    latency: float = 0.0
    stuck_fraction: float = math.nan


@dataclass(frozen=True)
class Slip:
    """Input of a controller besides the frame: the detector's estimate, and the gripper's status.

    Attributes:
        state: a `State`; NO_CONTACT without a detector
        stuck_fraction: stuck fraction of the touching units, 0 to 1; NaN: not estimated
        position: counts, 0 open to 255
        moving: True if the fingers are moving
        stopped: True if they stopped at the force limit
    """

    state: int
    stuck_fraction: float
    position: int
    moving: bool
    stopped: bool

    @property
    def slips(self) -> bool:
        """True if the detector reports incipient or gross slip."""
        return self.state >= State.INCIPIENT


@dataclass(frozen=True)
class Command:
    """The gripper's registers, 0 to 255.

    Attributes:
        position: counts, 0 open to 255 closed
        speed: counts, 0 slowest to 255
        force: counts, 0 weakest to 255
    """

    position: int
    speed: int = 0
    force: int = 0


class Detector(Protocol):
    """Interface of classes for `detector()`."""

    def update(self, frame: Frame) -> Estimate | State | int:
        """Called with each sample of the sensor.

        Args:
            frame: the sample

        Returns:
            The state of the pad; an int is the code of a `State`.
        """


class Controller(Protocol):
    """Interface of classes for `controller()`."""

    def act(self, frame: Frame, slip: Slip) -> Command | int:
        """Called at each read of the gripper.

        Args:
            frame: the latest sample of the sensor
            slip: state of the slip

        Returns:
            The command; an int is a position.
        """


@dataclass(frozen=True)
class SensorSource:
    """Identifies a sensor of a trial; passed to a sensor's class when it is created.

    Attributes:
        sensor: its name in the scene
        seed: seed of the dataset
        trial: the trial's number
    """

    sensor: str
    seed: int
    trial: int

    @property
    def random(self) -> np.random.Generator:
        """Random generator of this sensor and trial, independent of threads."""
        return np.random.default_rng([self.seed, self.trial, *self.sensor.encode()])


@dataclass(frozen=True)
class Layout:
    """Constant properties of a sensor.

    Vectors are in the pad's frame, whose +Z points from the object into the pad.

    Attributes:
        tips: [E, 3] m, undeformed contact points
        k_normal: N/m, for all points or [E]
        k_tangential: N/m, likewise
        channels: content of a sample, shape and unit by name: {"force": ((16, 3), "N")}
        rate: Hz, of the samples
        directions: [E, 3] unit vectors out of the pad, or one for all points
        units: [E] index of each point's unit (taxel), 0, 0, 1, 1, ...; None: each point is a unit
    """

    tips: ArrayLike
    k_normal: ArrayLike
    k_tangential: ArrayLike
    channels: dict[str, tuple[tuple[int, ...], str]]
    rate: float = 100.0
    directions: ArrayLike = (0.0, 0.0, -1.0)
    units: ArrayLike | None = None


class OwnSensor(Protocol):
    """Interface of classes for `sensor()`."""

    def layout(self) -> Layout:
        """Called once; returns the sensor's points and the content of a sample."""

    def measure(self, frame: Frame) -> dict[str, ArrayLike] | ArrayLike:
        """Called at each sample.

        Args:
            frame: the contact of U units and E points: "force" [U, 3] N, "displacement" [U, 3] m,
                "depth" [E] m of the undeformed point in the surface, and "shear" [3, E] m along the
                surface

        Returns:
            The reading of each channel, or an array if there is only one channel.
        """


def layout_of(
    returned: Any,
) -> tuple[float, list[list[float]], list[int], list[tuple[str, str, list[int]]]]:
    """Checks the result of a sensor's layout() and converts it for the program."""
    if not isinstance(returned, Layout):
        raise TypeError(f"layout() returned {returned!r}; expected a Layout")
    tips = np.asarray(returned.tips, float)
    if tips.ndim != 2 or tips.shape[1] != 3:
        raise ValueError(f"tips of shape {tips.shape}; expected (points, 3)")
    each = [
        np.broadcast_to(np.asarray(value, float), shape)
        for value, shape in (
            (returned.directions, tips.shape),
            (returned.k_normal, len(tips)),
            (returned.k_tangential, len(tips)),
        )
    ]
    units = (
        range(len(tips))
        if returned.units is None
        else np.broadcast_to(np.asarray(returned.units, int), len(tips))
    )
    return (
        float(returned.rate),
        np.column_stack([tips, *each]).tolist(),
        [int(unit) for unit in units],
        [
            (name, unit, [int(extent) for extent in shape])
            for name, (shape, unit) in returned.channels.items()
        ],
    )


def readings_of(returned: Any, shapes: dict[str, tuple[int, ...]]) -> list[NDArray[np.float32]]:
    """Checks the result of a sensor's measure(), and returns it in the order of the channels."""
    channels = returned if isinstance(returned, dict) else {name: returned for name in shapes}
    if channels.keys() != shapes.keys():
        raise KeyError(
            f"measure() returned {', '.join(map(str, channels))}; allowed: {', '.join(shapes)}"
        )
    arrays = [np.ascontiguousarray(channels[name], np.float32) for name in shapes]
    for (name, shape), array in zip(shapes.items(), arrays, strict=True):
        if array.shape != shape:
            raise ValueError(f"measure() returned {name} of shape {array.shape}; allowed: {shape}")
    return arrays


def estimate_of(returned: Any) -> Estimate:
    """Checks the result of a detector."""
    estimate = returned if isinstance(returned, Estimate) else Estimate(returned)
    if (
        isinstance(estimate.state, bool)
        or not isinstance(estimate.state, numbers.Integral)
        or not 0 <= int(estimate.state) <= 3
    ):
        raise TypeError(f"update() returned {returned!r}; expected a State, 0 to 3, or an Estimate")
    if not 0.0 <= estimate.latency < math.inf:
        raise ValueError(f"a latency of {estimate.latency} s; allowed: 0 s or more")
    if estimate.stuck_fraction < 0.0 or estimate.stuck_fraction > 1.0:
        raise ValueError(f"a stuck fraction of {estimate.stuck_fraction}; allowed: 0 to 1, or NaN")
    return estimate


def command_of(returned: Any) -> Command:
    """Checks the result of a controller."""
    command = returned if isinstance(returned, Command) else Command(returned)
    for name in ("position", "speed", "force"):
        value = getattr(command, name)
        if (
            isinstance(value, bool)
            or not isinstance(value, numbers.Integral)
            or not 0 <= int(value) <= 255
        ):
            raise TypeError(
                f"act() returned {returned!r}; expected a position of 0 to 255, or a Command with such numbers"
            )
    return command


SensorClass = TypeVar("SensorClass", bound=Callable[..., OwnSensor])
DetectorClass = TypeVar("DetectorClass", bound=Callable[..., Detector])
ControllerClass = TypeVar("ControllerClass", bound=Callable[..., Controller])


def _registering(register: Callable[..., None], name: str) -> Callable[[Any], Any]:
    """Decorator that passes a class to `register` with its summary and its parameters."""

    def decorate(made: Any) -> Any:
        summary = ((made.__doc__ or "").strip() or "A Python class.").splitlines()[0]
        declared = getattr(made, "parameters", {}).items()
        register(
            name,
            made,
            summary,
            [
                (key, value if isinstance(value, str) else repr(float(value)))
                for key, value in declared
            ],
        )
        return made

    return decorate


def sensor(name: str) -> Callable[[SensorClass], SensorClass]:
    """Registers a class as a sensor for the scenes of this process, like `detector()`.

    The class has the methods of `OwnSensor`. It is created as `cls(source, **parameters)` with a
    `SensorSource`, once for each trial and when the program examines the scene.

    Args:
        name: the NAME in a scene's `type: NAME`

    Returns:
        The decorator.
    """
    return _registering(_core.register_sensor, name)


def detector(name: str) -> Callable[[DetectorClass], DetectorClass]:
    """Registers a class as a detector for the scenes of this process.

    The class has the method of `Detector`. It is created for each trial as `cls(source,
    **parameters)`. Its attribute `parameters`, a dict, declares names and defaults of the
    parameters in a scene: numbers, or texts with a unit such as "5 mm", which the class receives in
    SI. A registered custom name is replaced.

    Args:
        name: the NAME in a scene's `detector: {type: NAME}`: `@slipbench.detector("mine")`

    Returns:
        The decorator.

    Raises:
        InputError: a name of slipbench
    """
    return _registering(_core.register_detector, name)


def controller(name: str) -> Callable[[ControllerClass], ControllerClass]:
    """Registers a class as a controller for the scenes of this process, like `detector()`.

    The class has the method of `Controller`.

    Args:
        name: the NAME in a scene's `controller: {type: NAME}`

    Returns:
        The decorator.
    """
    return _registering(_core.register_controller, name)
