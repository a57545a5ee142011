"""Slip of an object between two Myrmex arrays: when it begins by the truth, and when by the rule of the paper (section 2.2)."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from slipbench import Trial

SCENE = "scenes/myrmex/dataset.yaml"
SOURCE = '"Tactile Convolutional Networks for Online Slip and Rotation Detection"'
SETTLED, APART = 2.0, 2.5  # s, in SCENE: the third sensor rests on the object, the arms begin to move
FULL_SCALE = 4095.0  # counts of a taxel that nothing touches
TAXEL_NOISE_SD = 9.0 / 1024.0 * 4095.0  # counts, of a resting taxel (sensors/myrmex: 9 of 1,024)
NO_CONTACT = 0  # code of a pad's state
SLIP = 2  # code of a unit's state
ROTATIONAL_FROM = 5e-3  # m, of the centre of mass to the side of the grip

Floats = NDArray[np.float64]


class Pad(NamedTuple):
    """One array's recording of T samples and N taxels.

    Attributes:
        time: [T] s
        counts: [T, N] counts
        force: [T, N] N, along the normal, without noise
        unit_state: [T, N] code of each taxel
        state: [T] code of the array, rule strict
    """

    time: Floats
    counts: NDArray[np.float32]
    force: NDArray[np.float32]
    unit_state: NDArray[np.uint8]
    state: NDArray[np.uint8]


def pad_of(trial: Trial, name: str) -> Pad:
    """The recording of an array of SCENE.

    Args:
        trial: a full record of the scene
        name: "left", "right" or "top"

    Returns:
        the recording
    """
    sensor = trial.sensors[name]
    labels = trial.labels[name]
    return Pad(sensor.t, sensor.channels["taxels"].reshape(len(sensor.t), -1), labels.force[:, :, 2], labels.unit_state, labels.state)


class Placed(NamedTuple):
    """What a trial's object is: "cylinder", "remote" or "glass"; its mass [kg]; how far its centre of mass lies to the side of the grip [m]."""

    name: str
    mass: float
    side: float

    @property
    def rotational(self) -> bool:
        """Whether it turns when it slips."""
        return abs(self.side) > ROTATIONAL_FROM


def placed_of(params: dict[str, Any]) -> Placed:
    """The object of a trial.

    Args:
        params: what was swept, by dotted path, SI: `bodies.object.` shape, mass, position, rotation, bore, centre_of_mass; None: a shape has none

    Returns:
        name, mass and where it is held
    """
    shape, mass, position, rotation, bore, centre = (params[f"bodies.object.{name}"]
                                                     for name in ("shape", "mass", "position", "rotation", "bore", "centre_of_mass"))
    # Turned about the fixed axes X, Y, Z one after the other, as a scene says.
    turned = Rotation.from_euler("xyz", rotation).apply([0.0, 0.0, 0.0] if centre is None else centre)
    return Placed("glass" if bore else "remote" if shape == "box" else shape, mass, float(position[1] + turned[1]))


def _sums(values: NDArray[Any]) -> Floats:
    """The sum of each row, added from left to right."""
    return np.asarray(np.ascontiguousarray(values.T, dtype=float).sum(axis=0))


def sum_of_contacts(counts: NDArray[Any]) -> Floats:
    """The sum of 4095 - counts over all taxels.

    Args:
        counts: [T, N]

    Returns:
        [T] counts
    """
    return _sums(FULL_SCALE - counts.astype(float))


def most_missing(counts: NDArray[Any]) -> Floats:
    """The counts that are missing of the taxel that misses most.

    Args:
        counts: [T, N]

    Returns:
        [T] counts
    """
    return np.asarray(FULL_SCALE - counts.min(axis=1).astype(float))


def backward_mean(time: ArrayLike, values: ArrayLike, window: float) -> Floats:
    """The mean of the values over the samples of the last `window` up to each.

    Args:
        time: [T] s, ascending
        values: [T]
        window: s; 0: the values themselves

    Returns:
        [T]
    """
    t, v = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if not window > 0.0:
        return v.copy()
    here = np.arange(len(t))
    first = np.minimum(np.searchsorted(t, t - window, "right"), here)
    # What t - window was rounded to may leave a sample in that is exactly a window old, or out one that is not.
    first -= (first > 0) & (t - t[np.maximum(first - 1, 0)] < window)
    first += (first < here) & (t - t[first] >= window)
    total = np.concatenate([[0.0], np.cumsum(v)])
    return np.asarray((total[here + 1] - total[first]) / (here + 1 - first))


class OnsetRule(NamedTuple):
    """What the paper's rule leaves open: "the onset of slippage is the time when the sum of contacts on the third sensor started to decrease".

    Attributes:
        window: s, over whose samples up to each the sum is averaged; 0: not at all
        threshold: below its mean while nothing moves, in standard deviations of the averaged sum then
    """

    window: float
    threshold: float


# The reading that has an onset in every trial that slips.
SINKS = OnsetRule(0.1, 3.0)


def decrease_onset(time: ArrayLike, values: ArrayLike, rule: OnsetRule, rest: float, moves: float, end: float, least: float = 0.0) -> float:
    """The first sample's time from which on the averaged sum stays below its threshold up to the end.

    Args:
        time: [T] s
        values: [T] the sum
        rule: average and threshold
        rest: s, from here to `moves` the sum's mean is taken
        moves: s, no onset is before
        end: s
        least: by how much the sum must fall at least, in its unit

    Returns:
        s; NaN: the sum does not stand below at the end, or nothing rests
    """
    t = np.asarray(time, dtype=float)
    averaged = backward_mean(t, values, rule.window)
    still = averaged[(t >= rest) & (t < moves)]
    if len(still) < 2:
        return math.nan
    level = still.mean() - max(least, rule.threshold * float(still.std(ddof=1)))
    asked = (t >= moves) & (t <= end)
    return last_run(t[asked], averaged[asked] < level)


def last_run(time: Floats, holds: NDArray[np.bool_]) -> float:
    """Where what holds at the last sample began to.

    Args:
        time: [T] s
        holds: [T]

    Returns:
        s; NaN: it does not hold at the last sample, or there is none
    """
    if not len(holds) or not holds[-1]:
        return math.nan
    breaks = np.flatnonzero(~holds)
    return float(time[breaks[-1] + 1 if len(breaks) else 0])


def slipping_share(force: NDArray[Any], unit_state: NDArray[np.uint8]) -> Floats:
    """The share of a pad's normal force that slipping taxels carry.

    Args:
        force: [T, N] N
        unit_state: [T, N] codes

    Returns:
        [T] 0 to 1; 0 where nothing touches
    """
    whole, slipping = _sums(force), _sums(np.where(unit_state == SLIP, force, 0.0))
    return np.divide(slipping, whole, out=np.zeros(len(whole)), where=whole > 0.0)


class SlipSpan(NamedTuple):
    """How an object falls out of the grip: when it begins to, NaN where it holds, and the end of contact [s]."""

    onset: float
    end: float


def true_slip(left: Pad, right: Pad, begin: float = APART) -> SlipSpan:
    """When the object begins to slip: from then on, as long as both pads touch, slipping taxels carry at least half of the normal force on both.

    At the limit of friction that is so of a translation and of a turn, whose centre sticks.

    Args:
        left: one array
        right: the other, with the same times
        begin: s, where to begin to look

    Returns:
        the onset, and the last sample at which both pads touch; 0 s of none
    """
    touching = (left.state != NO_CONTACT) & (right.state != NO_CONTACT)
    apart = np.flatnonzero((left.time >= begin) & ~touching)
    rows = slice(int(np.searchsorted(left.time, begin)), int(apart[0]) if len(apart) else len(left.time))
    time = left.time[rows]
    shares = [slipping_share(pad.force[rows], pad.unit_state[rows]) for pad in (left, right)]
    return SlipSpan(last_run(time, np.minimum(*shares) >= 0.5), float(time[-1]) if len(time) else 0.0)


class ContactGate(NamedTuple):
    """What a contact is, which the paper leaves open in "no more contacts were detected on the sensors holding the object".

    Attributes:
        of_sum: of an array its sum of contacts; else its taxel that misses most counts
        window: s, over whose samples up to each that is averaged; 0: not at all
        counts: that must be missing; more is a contact
    """

    of_sum: bool
    window: float
    counts: float


def sum_end() -> ContactGate:
    """An array's sum, mean of 20 ms, 5 sd above what its noise alone makes it, since a trial has some thousand independent means."""
    # Cut off above rest, a normal variable misses sd/sqrt(2 pi) in the mean, and has the standard deviation sqrt(1/2 - 1/(2 pi)) sd.
    cut_mean = 1.0 / math.sqrt(2.0 * math.pi)
    cut_sd = math.sqrt(0.5 - cut_mean**2)
    taxels, images = 256.0, 20.0  # of an array; of its sum's mean of 20 ms at 1 kHz
    return ContactGate(True, 0.02, taxels * TAXEL_NOISE_SD * (cut_mean + 5.0 * cut_sd / math.sqrt(taxels * images)))


def contact_end(left: Pad, right: Pad, gate: ContactGate) -> float:
    """The end of a trial by the paper's rule.

    Args:
        left: one array
        right: the other
        gate: what a contact is

    Returns:
        s, the last sample at which either array has a contact; 0: there is none
    """
    ends = [0.0]
    for pad in (left, right):
        missing = backward_mean(pad.time, sum_of_contacts(pad.counts) if gate.of_sum else most_missing(pad.counts), gate.window)
        ends += pad.time[missing > gate.counts][-1:].tolist()
    return max(ends)
