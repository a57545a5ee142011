"""The nib pad's lever bench (scenes/nib_pad).

Traces of a recorded trial, and the origin of signals below 8 Hz.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from slipbench import InputError, State, Trial
from slipbench.bin import _core

Doubles = NDArray[np.float64]

WINDOW, HOP = 150, 30  # samples at 300 Hz: 0.5 s and 0.1 s, as in the paper
SLOW = 8.0  # Hz, the paper's effective response
SLIP_BEGINS, SLIP_ENDS = 0.3e-3, 10e-3  # m, of the lever


class Trace:
    """A trial of the bench.

    Attributes:
        time: [T] s
        normal: [T] N, true, sum over all nibs
        lever: [T] m, position of the lever along the pull
        linear: [T] counts, difference of the two electrodes of the fast linear mode
        rate: Hz
    """

    def __init__(self, trial: Trial) -> None:
        """Raises InputError for a trial without the lever or with several sensors."""
        if len(trial.sensors) != 1 or "lever" not in trial.bodies:
            raise InputError(
                f"trial {trial.trial}: expected one sensor and the body 'lever', found {', '.join([*trial.sensors, *trial.bodies])}"
            )
        self._trial = trial
        [(self._name, sensor)] = trial.sensors.items()
        self.time: Doubles = np.asarray(sensor.t)
        self.rate = sensor.rate
        self.normal: Doubles = trial.labels[self._name].force[:, :, 2].sum(axis=1, dtype=float)
        self.lever: Doubles = trial.bodies["lever"].pose[:, 1].astype(float)
        self.linear: Doubles = (
            sensor.channels["fl"][:, 0].astype(float) - sensor.channels["fl"][:, 1]
        )

    def at(self, time: float) -> int:
        """Index of the first sample at or after `time` [s].

        The number of samples if there is none.
        """
        return int(np.searchsorted(self.time, time))

    def moved(self, begun: int, way: float) -> int | None:
        """First sample from `begun` at which the lever has moved by `way` [m] since.

        None if it never has.
        """
        if begun >= len(self.lever):
            return None
        there = np.flatnonzero(self.lever[begun:] - self.lever[begun] >= way)
        return begun + int(there[0]) if there.size else None

    def estimates(
        self, detector: str, parameters: dict[str, str]
    ) -> tuple[NDArray[np.uint8], dict[str, Doubles]]:
        """Runs a detector on the recorded samples.

        Args:
            detector: type of the detector
            parameters: by name, as in a scene

        Returns:
            [T] code of State, and [T] of each feature, by name

        Raises:
            InputError: for an unknown parameter
        """
        states, values, names = _core.estimates(
            self._trial._simulated, self._name, detector, list(parameters.items())
        )
        return states, dict(zip(names, values.T, strict=True))

    def detection(self, detector: str, parameters: dict[str, str]) -> int | None:
        """First sample in which a detector reports gross slip; None if there is none.

        Arguments and errors as for estimates().
        """
        found = np.flatnonzero(self.estimates(detector, parameters)[0] == State.GROSS)
        return int(found[0]) if found.size else None


def spectra(signal: ArrayLike, window: int = WINDOW, hop: int = HOP) -> Doubles:
    """Magnitude spectra of a signal's windows.

    As in the nib pad's slip detection (detectors/nib/features.h).

    Each window minus its least-squares line, times the Hamming window of that period, without
    normalisation.

    Args:
        signal: [T] samples
        window: samples per window
        hop: samples between the starts of successive windows

    Returns:
        [windows, window/2 + 1] in the signal's unit
    """
    values = np.asarray(signal, dtype=float)
    if len(values) < window:
        return np.empty((0, window // 2 + 1))
    parts = np.lib.stride_tricks.sliding_window_view(values, window)[::hop]
    n = np.arange(window)
    about = n - n.mean()
    mean = parts.mean(axis=1, keepdims=True)
    slope = ((parts - mean) @ about / (about @ about))[:, None]
    hamming = 0.54 - 0.46 * np.cos(2.0 * np.pi * n / window)
    return np.abs(np.fft.rfft(hamming * (parts - mean - slope * about)))


@dataclass(frozen=True)
class Signature:
    """Energy of the difference of FL in the windows within one slip.

    Attributes:
        wavy: True if the plate has waves
        share: share of the energy above 0 Hz that is below 8 Hz
        time: s, duration of the slip
        below: counts rms below 8 Hz
        above: counts rms above 8 Hz
    """

    wavy: bool
    share: float
    time: float
    below: float
    above: float


def signature_of(trace: Trace, start: float, wavy: bool) -> Signature | None:
    """Energy from a motion of the lever of 0.3 mm to 10 mm.

    The motion counts from the time at which the detector began to count.

    White noise of variance v has v sum w^2 in every bin, sum w^2 = (0.54^2 + 0.46^2/2) N; there are
    N/2 bins.

    Args:
        trace: trace of the trial
        start: s, start of the detector's counting
        wavy: True if the plate has waves

    Returns:
        None if the slip is shorter than a window, or the pad does not slip
    """
    begun = trace.at(start)
    first = trace.moved(begun, SLIP_BEGINS)
    if first is None:
        return None
    ended = trace.moved(begun, SLIP_ENDS)
    last = len(trace.time) if ended is None else ended
    if last - first < WINDOW:
        return None
    energy = spectra(trace.linear[first:last])[:, 1:] ** 2
    slow = np.arange(1, energy.shape[1] + 1) * trace.rate / WINDOW <= SLOW
    below, above = float(energy[:, slow].sum()), float(energy[:, ~slow].sum())
    scale = 2.0 / (0.3974 * WINDOW**2 * len(energy))
    return Signature(
        wavy,
        below / (below + above),
        (last - first) / trace.rate,
        float(np.sqrt(scale * below)),
        float(np.sqrt(scale * above)),
    )


def has_waves(params: dict[str, Any]) -> bool:
    """True if the plate of a trial with these swept parameters has waves: the effect `texture`."""
    return any("texture" in effect for effect in params["effects"])


PATCHES, RATE = r"\{patchy_friction: \{[^}]*\}\},?\s*", r",?\s*\{viscous_friction: \{[^}]*\}\}"


def _patches(sd: str) -> Callable[[str], str]:
    return lambda text: re.sub(r"(patchy_friction: \{sd: )[\d.]+", rf"\g<1>{sd}", text)


def _no_patches(text: str) -> str:
    return re.sub(PATCHES, "", text)


def _no_rate(text: str) -> str:
    return re.sub(RATE, "", text)


def _kinetic(text: str) -> str:
    """Coulomb's law, mu_k 0.9 mu_s."""
    return re.sub(
        r"static: ([\d.]+), kinetic: [\d.]+",
        lambda found: f"static: {found[1]}, kinetic: {0.9 * float(found[1])!r}",
        text,
    )


@dataclass(frozen=True)
class Law:
    """A change of the scene's friction only.

    Attributes:
        text: text in the tables
        change: function that changes the scene's text; None: no change
    """

    text: str
    change: Callable[[str], str] | None


LAWS = {  # by the names of the figures; the scene's own law first
    "scene": Law("as in the scene: rate law, patches 0.3", None),
    "patches_0.2": Law("patches 0.2", _patches("0.2")),
    "patches_0.1": Law("patches 0.1", _patches("0.1")),
    "no_patches": Law("no patches", _no_patches),
    "no_rate": Law("no rate law", _no_rate),
    "coulomb": Law(
        "Coulomb, mu_k 0.9 mu_s, no patches", lambda text: _kinetic(_no_rate(_no_patches(text)))
    ),
    "coulomb_patches": Law(
        "Coulomb, mu_k 0.9 mu_s, patches 0.3", lambda text: _kinetic(_no_rate(text))
    ),
}
