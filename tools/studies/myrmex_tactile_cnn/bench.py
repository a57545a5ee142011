"""Slip of an object between two Myrmex arrays.

Its onset by the truth, and by the paper's rule (section 2.2).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation
from slipbench import Trial

SCENE = "scenes/myrmex/dataset.yaml"
SOURCE = '"Tactile Convolutional Networks for Online Slip and Rotation Detection"'
SETTLED, APART = (
    2.0,
    2.5,
)  # s, in SCENE: the third sensor rests on the object; the arms begin to move
FULL_SCALE = 4095.0  # counts of a taxel without contact
TAXEL_NOISE_SD = 9.0 / 1024.0 * 4095.0  # counts, of a resting taxel (sensors/myrmex: 9 of 1,024)
NO_CONTACT = 0  # code of a pad's state
SLIP = 2  # code of a unit's state
ROTATIONAL_FROM = 5e-3  # m, distance of the centre of mass from the grip, sideways

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
    return Pad(
        sensor.t,
        sensor.channels["taxels"].reshape(len(sensor.t), -1),
        labels.force[:, :, 2],
        labels.unit_state,
        labels.state,
    )


class Placed(NamedTuple):
    """The object of a trial.

    Name "cylinder", "remote" or "glass"; mass [kg]; lateral distance of its centre of mass from the
    grip [m].
    """

    name: str
    mass: float
    side: float

    @property
    def rotational(self) -> bool:
        """True if it turns when it slips."""
        return abs(self.side) > ROTATIONAL_FROM


def placed_of(params: dict[str, Any]) -> Placed:
    """The object of a trial.

    Args:
        params: swept values by dotted path, SI: `bodies.object.` shape, mass, position, rotation,
            bore, centre_of_mass; None: not applicable to the shape

    Returns:
        name, mass and position in the grip
    """
    shape, mass, position, rotation, bore, centre = (
        params[f"bodies.object.{name}"]
        for name in ("shape", "mass", "position", "rotation", "bore", "centre_of_mass")
    )
    # Rotated about the fixed axes X, Y, Z in turn, as in a scene.
    turned = Rotation.from_euler("xyz", rotation).apply(
        [0.0, 0.0, 0.0] if centre is None else centre
    )
    return Placed(
        "glass" if bore else "remote" if shape == "box" else shape,
        mass,
        float(position[1] + turned[1]),
    )


def _sums(values: NDArray[Any]) -> Floats:
    """The sum of each row, added from left to right (for reproducible rounding)."""
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
    """Largest decrease of a taxel from full scale.

    Args:
        counts: [T, N]

    Returns:
        [T] counts
    """
    return np.asarray(FULL_SCALE - counts.min(axis=1).astype(float))


def backward_mean(time: ArrayLike, values: ArrayLike, window: float) -> Floats:
    """Backward moving average: mean over the samples of the last `window` up to each sample.

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
    # Rounding of t - window may include a sample that is exactly one window old, or exclude a newer
    # one.
    first -= (first > 0) & (t - t[np.maximum(first - 1, 0)] < window)
    first += (first < here) & (t - t[first] >= window)
    total = np.concatenate([[0.0], np.cumsum(v)])
    return np.asarray((total[here + 1] - total[first]) / (here + 1 - first))


class OnsetRule(NamedTuple):
    """Free parameters of the paper's rule.

    "The onset of slippage is the time when the sum of contacts on the third sensor started to
    decrease".

    Attributes:
        window: s, of the moving average of the sum; 0: none
        threshold: below the mean at rest, in standard deviations of the averaged sum at rest
    """

    window: float
    threshold: float


# Parameters with which every slipping trial has an onset.
SINKS = OnsetRule(0.1, 3.0)


def decrease_onset(
    time: ArrayLike,
    values: ArrayLike,
    rule: OnsetRule,
    rest: float,
    moves: float,
    end: float,
    least: float = 0.0,
) -> float:
    """Time from which the averaged sum stays below its threshold until the end.

    That of the first sample.

    Args:
        time: [T] s
        values: [T] the sum
        rule: average and threshold
        rest: s, start of the interval for the mean; it ends at `moves`
        moves: s, earliest possible onset
        end: s
        least: minimum fall of the sum, in its unit

    Returns:
        s; NaN: the sum is not below the threshold at the end, or there is no interval of rest
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
    """Start of the last interval in which the condition holds.

    Args:
        time: [T] s
        holds: [T]

    Returns:
        s; NaN: the condition does not hold at the last sample, or there are no samples
    """
    if not len(holds) or not holds[-1]:
        return math.nan
    breaks = np.flatnonzero(~holds)
    return float(time[breaks[-1] + 1 if len(breaks) else 0])


def slipping_share(force: NDArray[Any], unit_state: NDArray[np.uint8]) -> Floats:
    """Share of a pad's normal force on slipping taxels.

    Args:
        force: [T, N] N
        unit_state: [T, N] codes

    Returns:
        [T] 0 to 1; 0 without contact
    """
    whole, slipping = _sums(force), _sums(np.where(unit_state == SLIP, force, 0.0))
    return np.divide(slipping, whole, out=np.zeros(len(whole)), where=whole > 0.0)


class SlipSpan(NamedTuple):
    """Fall of an object out of the grip: start, NaN if it is held, and end of contact [s]."""

    onset: float
    end: float


def true_slip(left: Pad, right: Pad, begin: float = APART) -> SlipSpan:
    """Onset of the object's slip.

    From then on, while both pads are in contact, slipping taxels carry at least half of the normal
    force on both.

    At the friction limit this holds for translation and for rotation, whose centre sticks.

    Args:
        left: one array
        right: the other array, with the same times
        begin: s, start of the search

    Returns:
        the onset, and the last sample with contact of both pads; 0 s if there is none
    """
    touching = (left.state != NO_CONTACT) & (right.state != NO_CONTACT)
    apart = np.flatnonzero((left.time >= begin) & ~touching)
    rows = slice(
        int(np.searchsorted(left.time, begin)), int(apart[0]) if len(apart) else len(left.time)
    )
    time = left.time[rows]
    shares = [slipping_share(pad.force[rows], pad.unit_state[rows]) for pad in (left, right)]
    return SlipSpan(
        last_run(time, np.minimum(*shares) >= 0.5), float(time[-1]) if len(time) else 0.0
    )


class ContactGate(NamedTuple):
    """Definition of contact, which the paper leaves open.

    The paper: "no more contacts were detected on the sensors holding the object".

    Attributes:
        of_sum: True: uses an array's sum of contacts; False: its taxel with the largest decrease
        window: s, of the moving average; 0: none
        counts: threshold of the decrease; more is contact
    """

    of_sum: bool
    window: float
    counts: float


def sum_end() -> ContactGate:
    """Contact by an array's sum, averaged over 20 ms.

    The threshold is 5 sd above its value for noise alone, since a trial has some thousand
    independent means.
    """
    # A normal variable clipped above its mean has a mean deficit of sd/sqrt(2 pi), and the standard
    # deviation sqrt(1/2 - 1/(2 pi)) sd.
    cut_mean = 1.0 / math.sqrt(2.0 * math.pi)
    cut_sd = math.sqrt(0.5 - cut_mean**2)
    taxels, images = 256.0, 20.0  # of an array; of its sum's mean of 20 ms at 1 kHz
    return ContactGate(
        True, 0.02, taxels * TAXEL_NOISE_SD * (cut_mean + 5.0 * cut_sd / math.sqrt(taxels * images))
    )


def contact_end(left: Pad, right: Pad, gate: ContactGate) -> float:
    """End of a trial by the paper's rule.

    Args:
        left: one array
        right: the other
        gate: definition of contact

    Returns:
        s, the last sample at which either array has contact; 0 if there is none
    """
    ends = [0.0]
    for pad in (left, right):
        missing = backward_mean(
            pad.time,
            sum_of_contacts(pad.counts) if gate.of_sum else most_missing(pad.counts),
            gate.window,
        )
        ends += pad.time[missing > gate.counts][-1:].tolist()
    return max(ends)
