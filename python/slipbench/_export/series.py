"""A trial as series: data of one sensor, body, label or loop, with one row per instant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from slipbench import Arrays, InputError, StoredTrial
from slipbench._data import RULES, is_recording
from slipbench._program import counted

TIME_ROUNDING = 1e-9  # s: closer times are equal, since k/rate and the like are rounded
AXES = {
    "pose": ("x", "y", "z", "qw", "qx", "qy", "qz"),
    "velocity": ("vx", "vy", "vz", "wx", "wy", "wz"),
    "command": ("position", "speed", "force"),
    "arm_speed": ("sideways", "up"),
}
LAST_AXES = {
    "force": "xyz",
    "slip_velocity": "xy",
    "slip_centre": "xy",
}  # of labels: names along the last axis


@dataclass(frozen=True)
class Series:
    """An array of the dataset with one row per instant.

    Attributes:
        kind: "sensors", "labels", "truth" or "control", as its group
        owner: name of the sensor or body; empty: the loop
        name: name of the array
        unit: unit in the dataset
        codes: JSON object from word to number for an array of codes; else empty
        columns: a name for each value of a row
        shape: shape of a row
        t: [T] s
        values: [T, values of a row], of the dataset's type
    """

    kind: str
    owner: str
    name: str
    unit: str
    codes: str
    columns: tuple[str, ...]
    shape: tuple[int, ...]
    t: NDArray[np.float64]
    values: NDArray[np.float32] | NDArray[np.uint8]

    def at(self, instants: NDArray[np.float64]) -> Series:
        """The latest row at or before each of the `instants` [s], without a filter.

        Each must have one.
        """
        rows = np.searchsorted(self.t, instants + TIME_ROUNDING, side="right") - 1
        return replace(self, t=instants, values=self.values[rows])

    def is_sampled_at(self, instants: NDArray[np.float64]) -> bool:
        """True if these are its own instants."""
        return len(self.t) == len(instants) and bool(np.array_equal(self.t, instants))


def _label_columns(name: str, shape: tuple[int, ...]) -> tuple[str, ...]:
    """Names such as "unit_state_0", "force_8_z" and "state"."""
    if not shape:
        return (name,)
    last = LAST_AXES.get(name, "")
    return tuple(
        "_".join(
            [
                name,
                *(
                    last[i] if last and axis == len(shape) - 1 else str(i)
                    for axis, i in enumerate(index)
                ),
            ]
        )
        for index in np.ndindex(*shape)
    )


def _series(
    kind: str,
    owner: str,
    group: Arrays,
    name: str,
    t: NDArray[np.float64],
    columns: tuple[str, ...] = (),
) -> Series:
    array = group[name]
    about = array.attrs  # read from the file on each access
    shape = tuple(int(extent) for extent in array.shape[1:])
    if not columns:
        columns = (
            tuple(f"{name}_{axis}" for axis in AXES[name])
            if name in AXES
            else _label_columns(name, shape)
        )
    values = array[:].reshape(len(array), -1)
    if len(t) != len(values) or len(columns) != values.shape[1]:
        raise InputError(
            f"{kind}/{owner or 'loop'}/{name}: {counted(values.shape[0], 'row')} of {values.shape[1]} values; expected {len(t)} of {len(columns)}"
        )
    return Series(
        kind,
        owner,
        name,
        str(about["unit"]),
        str(about.get("codes", "")),
        columns,
        shape,
        t,
        values,
    )


def sensor_series(trial: StoredTrial, sensor: str) -> Iterator[Series]:
    """The channels of a sensor, in the sensor's order."""
    group = trial.sensors[sensor]
    names = [str(name) for name in group.attrs["channel_names"]]
    t = group["t"][:]
    for channel in map(str, group.attrs["channels"]):
        count = int(np.prod(group[channel].shape[1:], dtype=int))
        own = f"{channel}_t"
        yield _series(
            "sensors",
            sensor,
            group,
            channel,
            group[own][:] if own in group else t,
            tuple(names[:count]),
        )
        names = names[count:]


def label_series(trial: StoredTrial, sensor: str, rule: str | None) -> Iterator[Series]:
    """The truth about a sensor's pad; with a `rule`, the pad's state by this rule only.

    An imported recording may have none.
    """
    group = trial.labels.get(sensor)
    if group is None:
        return
    t = group["t"][:]
    left_out = {array for name, array in RULES.items() if rule not in (None, name)}
    for name in group:
        if name not in ("t", "events") and name not in left_out:
            one = _series("labels", sensor, group, name, t)
            yield (
                replace(one, name="state_recorded", columns=("state_recorded",))
                if is_recording(group)
                else one
            )


def body_series(trial: StoredTrial) -> Iterator[Series]:
    """Pose and velocity of every body."""
    for body, group in trial.bodies.items():
        t = group["t"][:]
        for name in ("pose", "velocity"):
            yield _series("truth", body, group, name, t)


def control_series(trial: StoredTrial) -> Iterator[Series]:
    """The series of the control loop."""
    group = trial.control
    if group is not None:
        t = group["t"][:]
        for name in group:
            if name != "t":
                yield _series("control", "", group, name, t)


def grid(
    number: int, trial: StoredTrial, sensors: list[str], series: list[Series], rate: float
) -> NDArray[np.float64]:
    """Instants 1/`rate` apart [s].

    They begin when all `series` have a value, and end with the first of the sensors, bodies or
    loop.
    """
    fastest = max(sensors, key=lambda sensor: float(trial.sensors[sensor].attrs["rate_hz"]))
    most = float(trial.sensors[fastest].attrs["rate_hz"])
    if rate > most * (1 + TIME_ROUNDING):
        raise InputError(
            f"trial {number}: a rate of {rate:g} Hz would repeat samples of '{fastest}'; allowed: up to {most:g} Hz, the rate of the sensor"
        )
    ends = [float(one.t[-1]) for one in series if one.kind in ("truth", "control")] + [
        float(trial.sensors[sensor]["t"][-1]) for sensor in sensors
    ]
    start = max(float(one.t[0]) for one in series)
    count = int(np.floor((min(ends) - start + TIME_ROUNDING) * rate)) + 1
    if count < 2:
        raise InputError(
            f"trial {number}: has fewer than two rows at {rate:g} Hz; use a higher --rate"
        )
    return start + np.arange(count) / rate


def sensor_at(
    number: int, trial: StoredTrial, sensor: str, rule: str | None, rate: float | None
) -> tuple[list[Series], list[Series]]:
    """A sensor's channels and labels.

    At its own times, or with a `rate` the latest values at the instants of its grid().
    """
    channels, labels = list(sensor_series(trial, sensor)), list(label_series(trial, sensor, rule))
    if rate is None:
        return channels, labels
    t = grid(number, trial, [sensor], [*channels, *labels], rate)
    return [one.at(t) for one in channels], [one.at(t) for one in labels]
