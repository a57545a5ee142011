"""From a sensor's samples to the frames of a network, by the code that a loop runs."""

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
    """What a network reads: samples of a sensor become frames. In this order: channels, median, window, centre, transform, pixels.

    A transform has keys of its own, which are refused with the others. The formulas stand in detectors/network.

    Attributes:
        sensor: its type, such as "papillarray"
        rate: Hz, of its samples
        channels: names, or by name which of its values are read, by their place in C order; empty: all
        median: samples; each value becomes the median of so many of its latest samples
        window: samples a frame
        stride: samples from one frame to the next
        centre: whether each value is taken less its mean over the window
        transform: "samples", "log_psd", "amplitude", "spreads", "levels" or "units"
        low: Hz, first bin of log_psd and amplitude
        high: Hz, last bin of log_psd and amplitude
        hann: whether spectra have Hann's taper
        floor: of log_psd unit^2/Hz, of spreads, levels and units the sensor's unit; more than 0
        spans: samples, of spreads, levels and units
        pixels: of each pixel of an image the values whose mean it is; empty: the values as they are
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

    @property
    def period(self) -> float:
        """Time from one frame to the next, s."""
        return self.stride / self.rate

    def as_dict(self) -> dict[str, Any]:
        """The object `input` of a description."""
        picks = self.channels if isinstance(self.channels, Mapping) else {name: () for name in self.channels}
        channels = [{"name": name, "values": list(values)} if len(values) else {"name": name} for name, values in picks.items()]
        all_keys: dict[str, Any] = {"sensor": self.sensor, "rate": self.rate, "channels": channels, "median": self.median, "window": self.window,
                                    "stride": self.stride, "centre": self.centre, "transform": self.transform}
        if self.transform in ("log_psd", "amplitude"):
            all_keys |= {"low": self.low, "high": self.high, "hann": self.hann}
        if self.floor:
            all_keys["floor"] = self.floor
        if len(self.spans):
            all_keys["spans"] = list(self.spans)
        if len(self.pixels):
            all_keys["pixels"] = [list(pixel) for pixel in self.pixels]
        return all_keys

    def text(self) -> str:
        """A description with this input and two classes, in JSON, as the extension takes it."""
        return json.dumps(describe_file(self, HOLD_OR_SLIP))


def describe_file(frames: Input, classes: Sequence[tuple[str, str]], **more: Any) -> dict[str, Any]:
    """The description that stands in the file of a detector.

    Args:
        frames: what the network reads
        classes: name of each class and the pad's state that it means: "no_contact", "non_slip", "incipient" or "gross"
        more: further keys: "states", "output", "threshold", "alarm", "trained"

    Returns:
        The object, not checked.
    """
    return {"format": 1, "input": frames.as_dict(), "classes": [{"name": name, "state": state} for name, state in classes], **more}


class Frames:
    """A sensor's samples as frames, by the code that a loop runs: what is trained on is what the detector sees.

    Args:
        frames: what to make of the samples, or the description of a detector as a dict, whose offset and scale are applied, too
        type: type of the sensor
        rate: Hz, of its samples, within 1 % of the one that is read
        channels: shape of a sample of each channel by name, in the sensor's order: {"force": (9, 3)}

    Raises:
        InputError: the sensor is another one, or a channel, value, pixel or bin is not there
    """

    def __init__(self, frames: Input | Mapping[str, Any], type: str, rate: float, channels: Mapping[str, Sequence[int]]) -> None:
        text = frames.text() if isinstance(frames, Input) else json.dumps(dict(frames))
        self._names = list(channels)
        self._frames = _core.Frames(text, type, float(rate), [(name, [int(size) for size in shape]) for name, shape in channels.items()])

    @property
    def size(self) -> int:
        """Values a frame."""
        return self._frames.size

    def all(self, samples: Mapping[str, Any]) -> tuple[Floats, NDArray[np.intp]]:
        """The frames of a recording, from its first sample on.

        Args:
            samples: array [T, ...] of each channel by name

        Returns:
            Frames [F, size], and the sample [F] with which each is complete.
        """
        rows = [np.asarray(samples[name], np.float32) for name in self._names]
        flat = np.ascontiguousarray(np.concatenate([one.reshape(len(one), -1) for one in rows], axis=1))
        frames, ends = self._frames.all(flat)
        return frames, ends.astype(np.intp)

    def push(self, sample: Mapping[str, Any]) -> Floats | None:
        """Takes the next sample.

        Args:
            sample: array of each channel by name

        Returns:
            The frame [size] that is complete with it, else None.
        """
        flat = np.concatenate([np.asarray(sample[name], np.float32).reshape(-1) for name in self._names])
        return np.asarray(self._frames.latest()) if self._frames.push(flat) else None

    def reset(self) -> None:
        """Forgets all samples."""
        self._frames.reset()


class Engine:
    """The network in the ONNX file of a detector, as a loop runs it. It carries its state from step to step.

    Args:
        path: of the file

    Raises:
        InputError: not a detector that a loop accepts, with what to change
    """

    def __init__(self, path: str) -> None:
        self._engine = _core.Engine(str(path))

    @property
    def description(self) -> dict[str, Any]:
        """What the file says of its input, classes and training."""
        described: dict[str, Any] = json.loads(self._engine.description)
        return described

    @property
    def inputs(self) -> int:
        """Values a step: history x frame."""
        return int(self._engine.inputs)

    def run(self, inputs: Floats) -> Floats:
        """Runs step by step.

        Args:
            inputs: [T, history x frame], scaled frames

        Returns:
            [T, classes], logits or probabilities, as the description says.
        """
        return self._engine.run(np.ascontiguousarray(inputs, np.float32))

    def reset(self) -> None:
        """Sets the state to zero, as at the beginning of a recording."""
        self._engine.reset()


@dataclass(frozen=True)
class Example:
    """One sensor in one trial: T frames of N values.

    Attributes:
        features: [T, N], not scaled
        labels: [T] class of each frame, or 255: neither trains nor judges
        time: [T] s, of each frame's last sample
        part: "learns", "validates", "judges" or "left_out"
        own_part: of the dataset's own split: "train", "valid", "test" or "none"; empty: it has none
        trial: number; those of a second dataset follow on the first's
        dataset: number of the file
        sensor: the scene's name
        sha256: digest of the trial
        twin: digest of its truth: trials in which it is equal are one experiment
        material: what was swept of material and friction; empty: nothing
        object: what was swept of shape and surface; empty: nothing
        speed: m/s, as it was swept; NaN: it was not
        mass: kg, as it was swept; NaN: it was not
        touches: whether there is contact at some time
        onset: s, true first slip; NaN: there is none
        turn: its images are turned by so many times 30 degrees
        truth: [T] code of the pad's state; empty: not known
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
    onset: float
    turn: int
    truth: NDArray[np.uint8] = field(repr=False)


@dataclass(frozen=True)
class Examples:
    """What read_examples() has read.

    Attributes:
        all: by trial, then by sensor
        classes: name of each class and the pad's state that it means
        inputs: values a frame
        command: that made the datasets
        sha256: digest of each dataset
    """

    all: list[Example]
    classes: list[tuple[str, str]]
    inputs: int
    command: str
    sha256: list[str]

    def part(self, name: str) -> list[Example]:
        """Those whose part is `name`: "learns", "validates" or "judges"."""
        return [example for example in self.all if example.part == name]


def read_examples(datasets: Sequence[str], frames: Input, *, labels: str = "micro", classes: str = "slip", sensor: str = "", turned: int = 0,
                  at_most: int = 0, seed: int = 1, split: str = "trial", held_out: float = 0.2, divide_anew: bool = False,
                  progress: Callable[[int, int], object] | None = None) -> Examples:
    """Reads every trial of datasets as frames with labels, and divides the trials.

    A frame's label is that of its last sample. A dataset's own split says which trials train, validate and judge, unless `divide_anew`. Where
    there is no own split, groups that differ in the fact `split` are shuffled, `held_out` of them judge and a fifth of the others validates.

    Args:
        datasets: paths of the first files
        frames: what to read
        labels: "micro", "strict", "paper", "latched", "masked" or "tightened"; of recordings "recorded"
        classes: "slip" (hold, slip), "kind" (stable, translation, rotation) or "direction" (t, n, e, s, w, cw, aw)
        sensor: the scene's name; empty: every one that fits
        turned: copies of each example of a myrmex whose images are turned; they only train
        at_most: frames of a class in an example, drawn; 0: all
        seed: of what is drawn
        split: "trial", "material", "object" or "speed": what is never on two sides
        held_out: share of the groups that judge, 0 to 0.5
        divide_anew: whether to ignore a dataset's own split
        progress: called with the numbers of trials read and of all

    Raises:
        InputError: no whole dataset, no sensor that fits, labels that are not there, too few groups
    """
    read = _core.read_examples([str(path) for path in datasets], frames.text(), labels, classes, sensor, turned, at_most, seed, split, held_out,
                               divide_anew, progress)
    return Examples([Example(**one) for one in read["examples"]], read["classes"], read["inputs"], read["command"], read["sha256"])


def fit_units(frames: Input, dataset: str, sensor: str) -> Input:
    """An input of the transform `units` for the sensor that a dataset has: its type, rate and first channel of three axes.

    Samples of windows and spans are in the ratio of the rates, a window of 2 and spans of 2, 3, 4, ... at least. Where the channel is not the one of
    `frames`, the floor is a thousandth of the channel's greatest value in the first trial.

    Args:
        frames: what a recipe reads
        dataset: path of the dataset
        sensor: the scene's name; empty: the first with the channel of `frames` at 200 Hz or more, else the first with any of three axes

    Returns:
        The input, or `frames` where no sensor has three axes.

    Raises:
        InputError: no whole dataset, or a channel that is 0 throughout the first trial
    """
    text, units = _core.units_input(str(dataset), sensor, frames.text())
    if units == 0:
        return frames
    found = json.loads(text)["input"]
    [channel] = found["channels"]
    return replace(frames, sensor=found["sensor"], rate=found["rate"], channels=[channel["name"]], window=found["window"], stride=found["stride"],
                   spans=tuple(found["spans"]), floor=found["floor"])
