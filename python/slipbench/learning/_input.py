"""Conversion of a sensor's samples to the frames of a network, by the loop's code."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from slipbench.bin import _core

Floats = NDArray[np.float32]

HOLD_OR_SLIP = (("hold", "non_slip"), ("slip", "incipient"))


@dataclass(frozen=True)
class Input:
    """Input of a network.

    Converts a sensor's samples to frames, in the order channels, median, window, centre, transform,
    pixels.

    Each transform has its own parameters, which raise an error with another transform.
    detectors/network has the formulas.

    Attributes:
        sensor: type of the sensor, such as "papillarray"
        rate: Hz, of the samples
        channels: names, or by name the values to read, by index in C order; empty: all
        median: number of latest samples whose median replaces each value
        window: samples per frame
        stride: samples between the starts of successive frames
        centre: True: subtract each value's mean over the window
        transform: "samples", "log_psd", "amplitude", "spreads", "levels" or "units"
        low: Hz, first bin of log_psd and amplitude
        high: Hz, last bin of log_psd and amplitude
        hann: True: apply a Hann window to spectra
        floor: lower limit, > 0; of log_psd in unit^2/Hz, of spreads, levels and units in the
            sensor's unit
        spans: samples, of spreads, levels and units
        pixels: for each pixel of an image, the values to average; empty: the values themselves
        rates: Hz, lowest and highest rate of the sensors for which the network is trained; the rate of
            each trial is drawn between them, and up to `rate`; None: `rate` alone
        units: physical unit of channels by name, such as {"signal": "counts"}; default: N for force
            and m for displacement; other channels: that of the first sensor that is read
    """

    sensor: str
    rate: float
    channels: Sequence[str] | Mapping[str, Sequence[int]]
    median: int = 1
    window: int = 1
    stride: int = 1
    centre: bool = False
    transform: str = "samples"
    low: float = 0.0
    high: float = 0.0
    hann: bool = False
    floor: float = 0.0
    spans: Sequence[int] = ()
    pixels: Sequence[Sequence[int]] = ()
    rates: tuple[float, float] | None = None
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def period(self) -> float:
        """Time between frames, s."""
        return self.stride / self.rate

    def as_dict(self) -> dict[str, Any]:
        """The object `input` of a description."""
        picks = (
            self.channels
            if isinstance(self.channels, Mapping)
            else {name: () for name in self.channels}
        )
        channels = [
            {"name": name}
            | ({"values": list(values)} if len(values) else {})
            | ({"unit": self.units[name]} if self.units.get(name) else {})
            for name, values in picks.items()
        ]
        all_keys: dict[str, Any] = {
            "sensor": self.sensor,
            "rate": self.rate,
            "channels": channels,
            "median": self.median,
            "window": self.window,
            "stride": self.stride,
            "centre": self.centre,
            "transform": self.transform,
        }
        if self.transform in ("log_psd", "amplitude"):
            all_keys |= {"low": self.low, "high": self.high, "hann": self.hann}
        if self.floor:
            all_keys["floor"] = self.floor
        if len(self.spans):
            all_keys["spans"] = list(self.spans)
        if len(self.pixels):
            all_keys["pixels"] = [list(pixel) for pixel in self.pixels]
        if self.rates is not None:
            all_keys["rates"] = [float(rate) for rate in self.rates]
        return all_keys

    def text(self) -> str:
        """A description with this input and two classes, in JSON, for the extension."""
        return json.dumps(describe_file(self, HOLD_OR_SLIP))


def describe_file(frames: Input, classes: Sequence[tuple[str, str]], **more: Any) -> dict[str, Any]:
    """Description for the file of a detector.

    Args:
        frames: input of the network
        classes: name of each class and the pad's state that it means: "no_contact", "non_slip",
            "incipient" or "gross"
        more: further keys: "states", "output", "threshold", "alarm", "trained"

    Returns:
        The unchecked object.
    """
    return {
        "format": 1,
        "input": frames.as_dict(),
        "classes": [{"name": name, "state": state} for name, state in classes],
        **more,
    }


class Frames:
    """Converts a sensor's samples to frames by the loop's code.

    So training and detection have the same input.

    Args:
        frames: definition of the frames, or the description of a detector as a dict, whose offset
            and scale are applied too
        type: type of the sensor
        rate: Hz, of its samples, within 1 % of the required rate
        channels: shape of a sample of each channel by name, in the sensor's order: {"force": (9,
            3)}

    Raises:
        InputError: the sensor is of another type, or a channel, value, pixel or bin is missing
    """

    def __init__(
        self,
        frames: Input | Mapping[str, Any],
        type: str,
        rate: float,
        channels: Mapping[str, Sequence[int]],
    ) -> None:
        text = frames.text() if isinstance(frames, Input) else json.dumps(dict(frames))
        self._names = list(channels)
        self._frames = _core.Frames(
            text,
            type,
            float(rate),
            [(name, [int(size) for size in shape]) for name, shape in channels.items()],
        )

    @property
    def size(self) -> int:
        """Values per frame."""
        return self._frames.size

    def all(self, samples: Mapping[str, Any]) -> tuple[Floats, NDArray[np.intp]]:
        """The frames of a recording, from its first sample.

        Args:
            samples: array [T, ...] of each channel by name

        Returns:
            Frames [F, size], and the last sample [F] of each.
        """
        rows = [np.asarray(samples[name], np.float32) for name in self._names]
        flat = np.ascontiguousarray(
            np.concatenate([one.reshape(len(one), -1) for one in rows], axis=1)
        )
        frames, ends = self._frames.all(flat)
        return frames, ends.astype(np.intp)

    def push(self, sample: Mapping[str, Any]) -> Floats | None:
        """Adds the next sample.

        Args:
            sample: array of each channel by name

        Returns:
            The frame [size] completed by it, else None.
        """
        flat = np.concatenate(
            [np.asarray(sample[name], np.float32).reshape(-1) for name in self._names]
        )
        return np.asarray(self._frames.latest()) if self._frames.push(flat) else None

    def reset(self) -> None:
        """Removes all samples."""
        self._frames.reset()


class Engine:
    """Runs the network in the ONNX file of a detector like a loop does.

    It keeps its state from step to step.

    Args:
        path: path of the file

    Raises:
        InputError: not a detector that a loop accepts; the message states the remedy
    """

    def __init__(self, path: str) -> None:
        self._engine = _core.Engine(str(path))

    @property
    def description(self) -> dict[str, Any]:
        """The file's description of its input, classes and training."""
        described: dict[str, Any] = json.loads(self._engine.description)
        return described

    @property
    def inputs(self) -> int:
        """Values per step: history x frame."""
        return int(self._engine.inputs)

    def run(self, inputs: Floats) -> Floats:
        """Runs step by step.

        Args:
            inputs: [T, history x frame], scaled frames

        Returns:
            [T, classes], logits or probabilities, according to the description.
        """
        return self._engine.run(np.ascontiguousarray(inputs, np.float32))

    def reset(self) -> None:
        """Sets the state to zero, as at the beginning of a recording."""
        self._engine.reset()


@dataclass(frozen=True)
class Example:
    """One sensor in one trial: T frames of N values.

    Attributes:
        features: [T, N], unscaled
        labels: [T] class of each frame, or 255: neither trained on nor judged
        time: [T] s, of each frame's last sample
        part: "learns", "validates", "judges" or "left_out"
        own_part: part in the dataset's own split: "train", "valid", "test" or "none"; empty: no
            split
        trial: number; the numbers of a second dataset follow those of the first
        dataset: index of the file
        sensor: name in the scene
        sha256: digest of the trial
        twin: digest of its truth: trials with equal values are one experiment
        material: swept material and friction; empty: not swept
        object: swept shape and surface; empty: not swept
        speed: m/s, swept speed; NaN: not swept
        mass: kg, swept mass; NaN: not swept
        touches: True if there is contact at some time
        holds: True if no part of a unit slips; False without truth
        onset: s, true first slip; NaN: none
        turn: rotation of its images in multiples of 30 degrees
        truth: [T] code of the pad's state; empty: unknown
        scored: [T] 1: slip, 0: none, 255: neither, as the benchmark counts slip; empty: unknown
        path: [T] m, path that the object has slipped since the start; empty: unknown
    """

    features: Floats = field(repr=False)
    labels: NDArray[np.uint8] = field(repr=False)
    time: NDArray[np.float64] = field(repr=False)
    part: str
    own_part: str
    trial: int
    dataset: int
    sensor: str
    sha256: str = field(repr=False)
    twin: str = field(repr=False)
    material: str
    object: str
    speed: float
    mass: float
    touches: bool
    holds: bool
    onset: float
    turn: int
    truth: NDArray[np.uint8] = field(repr=False)
    scored: NDArray[np.uint8] = field(repr=False)
    path: NDArray[np.float64] = field(repr=False)


@dataclass(frozen=True)
class Examples:
    """Result of read_examples().

    Attributes:
        all: examples by trial, then by sensor
        classes: name of each class and the pad's state that it means
        inputs: values per frame
        command: command that wrote the datasets
        sha256: digest of each dataset
        units: physical unit of each channel of the input
    """

    all: list[Example]
    classes: list[tuple[str, str]]
    inputs: int
    command: str
    sha256: list[str]
    units: dict[str, str]

    def part(self, name: str) -> list[Example]:
        """Examples of the part `name`: "learns", "validates" or "judges"."""
        return [example for example in self.all if example.part == name]


def read_examples(
    datasets: Sequence[str],
    frames: Input,
    *,
    labels: str = "micro",
    classes: str = "slip",
    sensor: str = "",
    turned: int = 0,
    at_most: int = 0,
    seed: int = 1,
    split: str = "trial",
    held_out: float = 0.2,
    divide_anew: bool = False,
    progress: Callable[[int, int], object] | None = None,
) -> Examples:
    """Reads every trial of datasets as frames with labels, and divides the trials.

    A frame's label is that of its last sample. A dataset's own split defines training, validation
    and test, unless `divide_anew`. Without an own split, groups by the property `split` are
    shuffled, `held_out` of them are for the test and a fifth of the others for validation.

    Args:
        datasets: paths of the first files
        frames: input definition
        labels: a rule for training (docs/concepts/labels.md); for recordings "recorded"
        classes: "slip" (hold, slip), "kind" (stable, translation, rotation) or "direction" (t, n,
            e, s, w, cw, aw)
        sensor: name in the scene; empty: every sensor that fits
        turned: number of copies of each example of an image sensor with turned images, for training only
        at_most: maximum number of drawn frames per class and example; 0: all
        seed: seed of the draws
        split: "trial", "material", "object" or "speed": property whose values are never in both
            training and test
        held_out: share of the groups for the test, 0 to 0.5
        divide_anew: True: ignore a dataset's own split
        progress: called with the numbers of trials read and of all

    Raises:
        InputError: an incomplete dataset, no sensor that fits, missing labels, too few groups
    """
    read = _core.read_examples(
        [str(path) for path in datasets],
        frames.text(),
        labels,
        classes,
        sensor,
        turned,
        at_most,
        seed,
        split,
        held_out,
        divide_anew,
        progress,
    )
    return Examples(
        [Example(**one) for one in read["examples"]],
        read["classes"],
        read["inputs"],
        read["command"],
        read["sha256"],
        read["units"],
    )


def fit_units(frames: Input, dataset: str, sensor: str) -> Input:
    """An input of the transform `units` for the sensor of a dataset.

    Its type, rate and first channel of three axes.

    Windows and spans in samples are scaled by the ratio of the rates, to a window of at least 2 and
    spans of at least 2, 3, 4, ... If the channel differs from that of `frames`, the floor is a
    thousandth of the channel's greatest value in the first trial.

    Args:
        frames: input of a recipe
        dataset: path of the dataset
        sensor: name in the scene; empty: the first with the channel of `frames` at 200 Hz or more,
            else the first with any channel of three axes

    Returns:
        The input, or `frames` if no sensor has three axes.

    Raises:
        InputError: an incomplete dataset, or a channel that is 0 throughout the first trial
    """
    text, units = _core.units_input(str(dataset), sensor, frames.text())
    if units == 0:
        return frames
    found = json.loads(text)["input"]
    [channel] = found["channels"]
    return replace(
        frames,
        sensor=found["sensor"],
        rate=found["rate"],
        channels=[channel["name"]],
        units={channel["name"]: channel["unit"]} if "unit" in channel else {},
        window=found["window"],
        stride=found["stride"],
        spans=tuple(found["spans"]),
        floor=found["floor"],
    )
