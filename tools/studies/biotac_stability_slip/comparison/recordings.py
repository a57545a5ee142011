"""Recordings of a BioTac SP as CSV files, and figures that apply to any recording.

The layout is that of github.com/yayaneath/BioTacSP-DoS: folders n e s w cw aw t (slip north, east,
south, west, clockwise, anti-clockwise, touch) with files OBJECTNUMBER.csv, whose columns ff_e1 to
ff_e24 hold counts, 100 rows per second, without a time.
"""

import re
from pathlib import Path

import numpy as np
from scipy import ndimage, signal

RATE = 100.0  # Hz
CLASSES = ("n", "e", "s", "w", "cw", "aw", "t")
GROUPS = {
    "cw,aw": ("cw", "aw"),
    "e,w": ("e", "w"),
    "n,s": ("n", "s"),
    "t": ("t",),
}  # as in BIOTAC.md of the specification
COLUMNS = [f"ff_e{k}" for k in range(1, 25)]

# Positions of the electrodes [mm]: x along the finger towards its tip, y into the finger, z
# sideways (SynTouch, in the repository above). E11 to E20 mirror E1 to E10 in z.
_SIDE = [
    (9.8154, -2.7677, 3.9845),
    (8.1012, -5.2081, 3.0659),
    (2.2193, -3.2655, 7.1623),
    (2.1309, -5.9925, 5.1198),
    (-0.4731, -7.6230, 2.4109),
    (-2.3339, -3.0591, 7.2379),
    (-3.4712, -6.0338, 4.7529),
    (-5.6757, -6.8751, 1.8170),
    (-8.1471, -5.0673, 3.2454),
    (-10.0821, -2.5411, 3.8498),
]
_MIDDLE = [
    (6.5723, -6.4094, 0.0),
    (4.3219, -6.9705, 1.8519),
    (4.3219, -6.9705, -1.8519),
    (1.9133, -7.5710, 0.0),
]
ELECTRODES = np.array(_SIDE + [(x, y, -z) for x, y, z in _SIDE] + _MIDDLE)

DISTANCE_BINS = [(0, 3), (3, 4.5), (4.5, 6), (6, 9), (9, 13), (13, 20), (20, 30)]  # mm
BANDS = [(0.5, 2), (2, 5), (5, 10), (10, 20), (20, 35), (35, 50)]  # Hz
SEGMENT = 256  # rows per spectrum
SMOOTHING = 5  # rows, standard deviation


class BadInput(Exception):
    """An invalid file: what is wrong, and what is allowed."""


class Recording:
    def __init__(self, kind, path, counts):
        self.kind = kind  # one of CLASSES
        self.object = re.sub(r"\d*$", "", Path(path).stem)
        self.path = str(path)
        self.counts = counts  # [T, 24]


def read_recording(kind, path):
    with open(path, encoding="ascii", errors="replace") as file:
        header = file.readline().strip().split(",")
        if header != COLUMNS:
            raise BadInput(
                f"{path}:1: columns {','.join(header)[:60]}...; allowed: ff_e1 to ff_e24"
            )
        try:
            counts = np.loadtxt(file, delimiter=",", ndmin=2)
        except ValueError as error:
            raise BadInput(f"{path}: {error}; expected 24 numbers per row") from error
    if counts.shape[0] < SEGMENT or counts.shape[1] != 24:
        raise BadInput(
            f"{path}: {counts.shape[0]} rows of {counts.shape[1]}; allowed: at least {SEGMENT} rows of 24"
        )
    return Recording(kind, path, counts)


def read_folder(folder):
    """All recordings below a folder, by class and then by name."""
    recordings = []
    for kind in CLASSES:
        files = sorted((Path(folder) / kind).glob("*.csv"))
        if not files:
            raise BadInput(
                f"{folder}/{kind}: contains no CSV file; expected folders {' '.join(CLASSES)} with CSV files"
            )
        recordings += [read_recording(kind, path) for path in files]
    return recordings


def detrended(x):
    """Columns without their mean and linear trend."""
    return signal.detrend(x, axis=0)


def smoothed(x, sd=SMOOTHING):
    """Columns filtered by a Gaussian of `sd` rows, truncated at 4 sd and mirrored at the ends."""
    return ndimage.gaussian_filter1d(x, sd, axis=0)


def most_active(counts):
    """The electrode with the largest detrended standard deviation."""
    return int(detrended(counts).std(0).argmax())


def active_spectrum(recording):
    """Welch's one-sided density [counts^2/Hz] of the most active electrode.

    Hann windows of 256 rows with half overlap. Returns frequencies [Hz] and density.
    """
    return signal.welch(
        detrended(recording.counts)[:, most_active(recording.counts)],
        RATE,
        nperseg=SEGMENT,
        detrend=False,
    )


def band_rms(recording):
    """RMS of the most active electrode in each band [counts]."""
    f, density = active_spectrum(recording)
    return [
        np.sqrt(density[(f >= low) & ((f < high) | (high == f[-1]))].sum() * f[1])
        for low, high in BANDS
    ]


_PAIRS = np.triu_indices(24, 1)
_PAIR_DISTANCE = np.linalg.norm(ELECTRODES[_PAIRS[0]] - ELECTRODES[_PAIRS[1]], axis=1)


def distance_correlation(recording):
    """Mean correlation of the smoothed signals of two electrodes, by their distance."""
    found, distance = np.corrcoef(smoothed(recording.counts).T)[_PAIRS], _PAIR_DISTANCE
    return [found[(distance >= low) & (distance < high)].mean() for low, high in DISTANCE_BINS]


def components(recording):
    """Shares of the first three principal components in the variance of the smoothed signals."""
    values = np.linalg.eigvalsh(np.cov(smoothed(recording.counts).T))[::-1]
    return list(values[:3] / values.sum())


def net_change(recording, least=20.0):
    """Numbers of electrodes whose last 0.2 s are higher, and lower, than their first.

    They differ by more than `least` counts.
    """
    change = recording.counts[-20:].mean(0) - recording.counts[:20].mean(0)
    return [int((change > least).sum()), int((change < -least).sum())]


def step_figures(recording):
    """Noise of the steps between rows [counts], and the share of repeated rows.

    The noise is the median over electrodes of the standard deviation; a repeated row is equal to
    the previous one.
    """
    steps = np.diff(recording.counts, axis=0)
    return [np.median(steps.std(0)), (steps == 0).mean()]


def spreads(recording):
    """Detrended standard deviation [counts].

    Median over electrodes, and that of the most active one.
    """
    sd = detrended(recording.counts).std(0)
    return [np.median(sd), sd.max()]


def levels(recording):
    """Mean count of all electrodes, and of the one with the lowest mean."""
    mean = recording.counts.mean(0)
    return [mean.mean(), mean.min()]


def extremes(recording):
    """Largest peak-to-peak value of an electrode [counts], and largest slope [counts/s].

    The slope is that of a smoothed electrode.
    """
    slope = np.abs(np.gradient(smoothed(recording.counts), axis=0)).max() * RATE
    return [np.ptp(recording.counts, axis=0).max(), slope]


def windows(counts, rows=50, step=25):
    """Segments of 0.5 s with half overlap."""
    return [counts[a : a + rows] for a in range(0, len(counts) - rows + 1, step)]
