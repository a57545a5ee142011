"""Recordings of the piezoelectric skin's bench as training frames."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import slipbench
from numpy.typing import NDArray
from slipbench import InputError, StoredTrial, Trial
from slipbench.learning import Frames, Input, find_recipe
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.network_training import Floats, Labels
from slipbench_studies.piezo_fft_gru import SCENE
from slipbench_studies.result import Options

BENCH_LEVEL = 2.0  # level of the motors' vibration in SCENE
NON_SLIP = 1  # code of a pad's state; greater codes are slip
RULES = {
    "paper": "position",
    "micro": "true",
}  # labels by their name in `slipbench train --labels`: name in the tables

PUBLISHED_SPECTRA = find_recipe("piezo_fft_gru").input
SIGNAL_AT_100_HZ = find_recipe("piezo_raw_gru").input


def spectra_of(low: float, high: float) -> Input:
    """The published spectra, limited to the band from `low` to `high` [Hz]."""
    return replace(PUBLISHED_SPECTRA, low=low, high=high)


@dataclass(frozen=True)
class LabelledFrames:
    """The frames of a recording for one input.

    Attributes:
        features: [T, F]
        labels: [T] by each rule of RULES, 1: slip
    """

    features: Floats
    labels: dict[str, Labels]


@dataclass(frozen=True)
class Recording:
    """A recording of the bench.

    Attributes:
        level: level of the motors' vibration; NaN: not swept
        tip: swept values except the motion; equal texts mean equal tips
        motors_only: True if there is never contact
        slip_time: s, first slip of a part of the contact; NaN: none
        label_time: s, first sample with slip by the 100 Hz position; NaN: none
        inputs: the frames for each requested input
        time: [T] s, last sample of each frame of the first input
        contact: [T] 1: contact at this sample
        motors: [T] m/s, sum of the speeds of all axes whose motors run at this sample
    """

    level: float
    tip: str
    motors_only: bool
    slip_time: float
    label_time: float
    inputs: list[LabelledFrames]
    time: NDArray[np.float64]
    contact: Labels
    motors: Floats


def tip_of(params: Mapping[str, Any]) -> str:
    """Describes the swept values except the motion, as "friction.static=0.6 ...".

    `params`: of a trial.
    """
    return " ".join(
        f"{path}={json.dumps(value, separators=(',', ':'), ensure_ascii=False)}"
        for path, value in params.items()
        if not path.startswith("motion.")
    )


def recording_of(trial: Trial | StoredTrial, inputs: Sequence[Input]) -> Recording:
    """Converts a trial to training frames.

    Args:
        trial: a full record with a piezo_skin
        inputs: input definitions

    Returns:
        the recording

    Raises:
        InputError: there is no piezo_skin, or it lacks labels of one of the rules
    """
    pads = [name for name, sensor in trial.sensors.items() if sensor.type == "piezo_skin"]
    if not pads:
        raise InputError(
            f"trial {trial.trial}: expected a sensor of type piezo_skin, found "
            f"{[one.type for one in trial.sensors.values()]}"
        )
    sensor, labels = trial.sensors[pads[0]], trial.labels[pads[0]]
    states = {rule: getattr(labels, f"state_{rule}", None) for rule in RULES}
    missing = [rule for rule, codes in states.items() if codes is None]
    if missing:
        raise InputError(
            f"trial {trial.trial}: sensor {pads[0]} has no labels {missing[0]}; use simulated recordings, which have "
            "both micro and paper"
        )
    slips = {rule: np.asarray(codes) > NON_SLIP for rule, codes in states.items()}
    time = np.asarray(sensor.t)
    frames, ends = [], []
    for one in inputs:
        shapes = {name: values.shape[1:] for name, values in sensor.channels.items()}
        features, last = Frames(one, sensor.type, sensor.rate, shapes).all(sensor.channels)
        frames.append(
            LabelledFrames(
                features, {rule: states[last].astype(np.uint8) for rule, states in slips.items()}
            )
        )
        ends.append(last)
    at = time[ends[0]]
    idle_speed, idle_start = (
        _number(trial.params.get(f"motion.idle_{what}")) for what in ("speed", "start")
    )
    motors = speed_of_bodies(trial, at) + np.where(
        at >= idle_start, idle_speed, 0.0
    )  # never if it is NaN
    onsets = np.asarray(labels.micro_onset_time)
    return Recording(
        level=_number(trial.params.get("motion.vibration")),
        tip=tip_of(trial.params),
        motors_only=not np.asarray(labels.state).any(),
        slip_time=math.nan if np.isnan(onsets).all() else float(np.nanmin(onsets)),
        label_time=float(time[slips["paper"].argmax()]) if slips["paper"].any() else math.nan,
        inputs=frames,
        time=at,
        contact=(np.asarray(states["micro"])[ends[0]] > 0).astype(np.uint8),
        motors=motors.astype(np.float32),
    )


def _number(value: Any) -> float:
    """A swept value; NaN if it is missing or not a number."""
    return float(value) if isinstance(value, int | float) else math.nan


def speed_of_bodies(trial: Trial | StoredTrial, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of the speeds along all axes of all bodies.

    Args:
        trial: a full record
        time: [T] s

    Returns:
        [T] m/s, 0 before the first sample
    """
    speed = np.zeros(len(time))
    for body in trial.bodies.values():
        row = np.searchsorted(np.asarray(body.t), time, "right") - 1
        speed += np.where(
            row < 0, 0.0, np.abs(np.asarray(body.velocity)[row, :3].astype(float)).sum(axis=1)
        )
    return speed


def run_recordings(
    levels: Iterable[float],
    count: int,
    inputs: Sequence[Input],
    options: Options,
    others_too: bool = True,
) -> list[Recording]:
    """Simulates the published bench.

    Args:
        levels: levels of the motors' vibration
        count: recordings at each level, half with a slip and half of motors only
        inputs: input definitions
        options: seed, jobs
        others_too: True: in half of the recordings a motor runs that does not move the tip; False:
            in none

    Returns:
        the recordings

    Raises:
        InputError: a trial fails
    """
    overrides = {"sweep.motion.vibration": f"[{', '.join(f'{level:g}' for level in levels)}]"}
    if not others_too:
        overrides["sweep.motion.idle_speed"] = "[0 mm/s]"
    name = "recordings" if others_too else "recordings, no motor but the tip's"
    return run_grid(
        [Cell(name, SCENE, overrides, count // 2)],
        options,
        lambda _, trial: recording_of(trial, inputs),
    )[0]


def read_recordings(path: str, inputs: Sequence[Input]) -> list[Recording]:
    """The recordings of a dataset.

    Args:
        path: path of its first file
        inputs: input definitions

    Returns:
        one recording per trial

    Raises:
        InputError: the file is not a dataset of piezo skins, with its name
    """
    with slipbench.open(path) as dataset:
        try:
            return [recording_of(dataset[trial], inputs) for trial in dataset.trials]
        except InputError as error:
            raise InputError(f"{path}: {error}") from error
