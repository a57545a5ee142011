"""Public recordings of a uSkin on a gripper, compared with scenes/magnetic_skin/creep.yaml.

Source: github.com/yinzhaodong/tactile_prediction, a Xela uSkin of 4 x 4 x 3 at some 38 Hz, 11 recordings of boxes that are held, moved or lost. They are
running means of 6 samples and begin at 0. The constants are results of the functions in this file; the program does not contain the recordings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from slipbench import InputError, Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.result import Options, RealFigure

Doubles = NDArray[np.float64]

TAXELS, AXES = 16, 3
SMOOTHED = 6  # samples of the running mean in the recordings
BEFORE_THE_END = (1.5, 0.5)  # s, before the end of the hold, which the release follows
GROSS = 3  # label of a pad that slips as a whole
SCENE = "scenes/magnetic_skin/creep.yaml"
SCENE_SEED = 3  # of creep.yaml; determines the device
REST = {
    "sensors": "{skin: {type: magnetic_skin, rate: 40 Hz, noise: 2.2, noise_ratio: 2.2}}",
    "motion": "{kind: stage, gap: 100 mm, speed: 0, start: 30 s}",
    "duration": "20 s",
}  # the pad would touch after 25 s

RATIO, SHARE, LEVEL, PEAK = 6.9, 0.88, 0.10, 1.15
NOISE = (0.9, 0.9, 2.0)  # counts; of each axis
SETUP = (
    "Real: a Xela uSkin of 4 x 4 x 3 on a gripper at 38 Hz, 11 recordings of boxes, running means of 6 samples. "
    f"Ours: {SCENE}, 24 lifts at 38 Hz, and scenes/magnetic_skin/uskin.yaml at rest for 20 s at 40 Hz, smoothed alike. "
    "Fitted: noise, places of the magnets, drift of the grip. Assumed: a coefficient of friction of 0.2, from which k_t/k_n = 2.3 follows, and boxes, magnets "
    "and thickness."
)
SPREAD = {"ratio": "6.2 to 8.6", "level": "0.04 to 0.35", "peak": "1.03 to 2.3"}


@dataclass(frozen=True)
class Recording:
    """Counts of a uSkin while it holds a box.

    Attributes:
        time: [T] s
        counts: [T, 16, 3] less those without load
        slips: whether the box slips at the end
    """

    time: Doubles
    counts: Doubles
    slips: bool


def smoothed(values: Doubles, samples: int = SMOOTHED) -> Doubles:
    """Running means.

    Args:
        values: [T, ...]
        samples: of a mean

    Returns:
        [T - samples + 1, ...]
    """
    return np.asarray(
        np.lib.stride_tricks.sliding_window_view(values, samples, axis=0).mean(axis=-1)
    )


def held(recording: Recording) -> NDArray[np.bool_]:
    """[T] True if the sum of z is above half of its level: the median of the values above 30 % of the greatest."""
    total = recording.counts[:, :, 2].sum(axis=1)
    return np.asarray(total > 0.5 * np.median(total[total > 0.3 * total.max()]))


def last_second(recording: Recording) -> NDArray[np.bool_]:
    """[T] True in the second that ends half a second before the end of the hold."""
    holds = held(recording)
    left = recording.time[holds][-1] - recording.time
    return np.asarray(holds & (left <= BEFORE_THE_END[0]) & (left >= BEFORE_THE_END[1]))


def normal_over_shear(recording: Recording) -> float:
    """The sum of z over the length of the sum of (x, y), over all taxels, in the last second."""
    sums = recording.counts[last_second(recording)].sum(axis=1)
    return float(sums[:, 2].mean() / np.hypot(sums[:, 0], sums[:, 1]).mean())


def common_share(recordings: Sequence[Recording]) -> float:
    """Share of the strongest common pattern in the power of all shear channels while held: the square of the first singular value."""
    shear = np.concatenate(
        [one.counts[held(one)][:, :, :2].reshape(-1, 2 * TAXELS) for one in recordings]
    )
    powers = np.linalg.svd(shear, compute_uv=False) ** 2
    return float(powers[0] / powers.sum())


def level_sd(recording: Recording) -> float:
    """The standard deviation of the sum of z over its mean, while held."""
    total = recording.counts[held(recording)][:, :, 2].sum(axis=1)
    return float(total.std() / total.mean())


def peak_over_level(recording: Recording) -> float:
    """The greatest sum of z over its median while held."""
    total = recording.counts[:, :, 2].sum(axis=1)
    return float(total.max() / np.median(total[held(recording)]))


def noise_of(counts: Doubles) -> Doubles:
    """[3] counts: median over taxels of the standard deviation about a straight line. `counts`: [T, 16, 3] without load."""
    flat = counts.reshape(len(counts), -1)
    basis = np.stack([np.ones(len(flat)), np.arange(len(flat))], axis=1)
    residual = flat - basis @ np.linalg.lstsq(basis, flat, rcond=None)[0]
    return np.asarray(np.median(residual.std(axis=0).reshape(-1, AXES), axis=0))


def counts_of(trial: Trial) -> Doubles:
    """[T, 16, 3] counts of the one magnetic skin of a trial.

    Raises:
        InputError: where the trial has no counts of 16 x 3
    """
    [skin] = trial.sensors.values()
    counts = skin.channels.get("counts")
    if counts is None or counts.shape[1:] != (TAXELS, AXES):
        raise InputError(
            "reproduce: realism: the scene has no magnetic skin with counts of 4 x 4 x 3"
        )
    return counts.astype(float)


def recording_of(trial: Trial) -> Recording | None:
    """A trial of creep.yaml processed like the recordings: smoothed, minus the counts before contact; None if the box was not lifted."""
    if not trial.outcome["lifted"]:
        return None
    counts, [skin], [labels] = counts_of(trial), trial.sensors.values(), trial.labels.values()
    touch = max(int(np.argmax(labels.state > 0)), 1)
    recording = Recording(
        np.asarray(skin.t, float)[SMOOTHED - 1 :],
        smoothed(counts - counts[:touch].mean(axis=0)),
        False,
    )
    slipping = labels.state[SMOOTHED - 1 :][last_second(recording)] == GROSS
    return Recording(recording.time, recording.counts, bool(slipping.mean() > 0.5))


def figures(options: Options) -> list[RealFigure]:
    """Figures of the recordings, compared with those of creep.yaml.

    Args:
        options: seed (default: creep.yaml's own), jobs

    Returns:
        the figures

    Raises:
        InputError: a trial fails
    """
    options = replace(options, seed=SCENE_SEED if options.seed is None else options.seed)
    [trials] = run_grid([Cell("creep.yaml", SCENE)], options, lambda _, trial: recording_of(trial))
    recordings = [one for one in trials if one is not None]
    [[rest]] = run_grid(
        [Cell("at rest", "scenes/magnetic_skin/uskin.yaml", REST)],
        options,
        lambda _, trial: noise_of(smoothed(counts_of(trial))),
    )
    slipping = [normal_over_shear(one) for one in recordings if one.slips]
    fitted = "fitted with this in view: "
    return [
        RealFigure(
            "sum of z over sum of shear while it slips, median",
            RATIO,
            float(np.median(slipping)) if slipping else float("nan"),
            f"{fitted}k_t/k_n; real {SPREAD['ratio']}, four recordings",
        ),
        RealFigure(
            "share of shear's power in the pattern common to all recordings",
            SHARE,
            common_share(recordings),
            f"{fitted}place of the magnets",
        ),
        RealFigure(
            "sd of the sum of z over its level, held, median",
            LEVEL,
            float(np.median([level_sd(one) for one in recordings])),
            f"{fitted}drift of the grip; real {SPREAD['level']}",
        ),
        RealFigure(
            "greatest sum of z over its level, median",
            PEAK,
            float(np.median([peak_over_level(one) for one in recordings])),
            f"real {SPREAD['peak']}: some grippers overshoot as they close, ours does not",
        ),
        *(
            RealFigure(
                f"noise at rest along {axis}, smoothed, counts",
                real,
                float(ours),
                "measured; set as measured",
            )
            for axis, real, ours in zip("xyz", NOISE, rest, strict=True)
        ),
    ]
