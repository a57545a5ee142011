"""Answers of detectors in recordings, and their figures."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from slipbench.bin import _core

Doubles = NDArray[np.float64]
Codes = NDArray[np.uint8]

UNKNOWN = _core.unknown_state
STATES: dict[str | None, int] = dict(_core.pad_states().items())
STATES[None] = UNKNOWN  # nobody knows
NO_CONTACT, NON_SLIP, _, GROSS = _core.pad_states().values()
FEWEST = 10  # groups of a bootstrap interval (tools/eval)
STEADY = 0.5  # s


@dataclass(frozen=True)
class Answer:
    """Answer of a detector in one recording of one sensor.

    Attributes:
        trial: number of the trial in the dataset
        time: [T] s
        labels: [T] STATES; empty: no labels
        seen: [T] STATES, by the detector
        since: [T] s, time at which that estimate was available
        probability: [T] NaN without a new estimate
    """

    trial: int
    time: Doubles
    labels: Codes
    seen: Codes
    since: Doubles
    probability: Doubles

    @property
    def slips(self) -> NDArray[np.bool_]:
        """[T] True for labelled slip."""
        return np.asarray((self.labels >= 2) & (self.labels <= GROSS))

    @property
    def known(self) -> NDArray[np.bool_]:
        """[T] True where the label is known."""
        return np.asarray(self.labels != UNKNOWN)


def answers_of(detected: Mapping[str, Any]) -> list[Answer]:
    """The answers of the object that `slipbench detect --json` prints."""
    answers = []
    for trial in detected["trials"]:
        samples = trial["samples"]
        time = np.array(samples["time_s"], dtype=float)
        since = time.copy()
        for alarm in trial["alarms"]:
            row = int(np.searchsorted(time, alarm["begin_s"]))
            if row < len(time):
                since[row] = alarm["begin_s"]
        answers.append(
            Answer(
                int(trial["trial"]),
                time,
                np.array([STATES[word] for word in samples["label"] or ()], dtype=np.uint8),
                np.array([STATES[word] for word in samples["state"]], dtype=np.uint8),
                since,
                np.array(
                    [math.nan if value is None else value for value in samples["probability"]],
                    dtype=float,
                ),
            )
        )
    return answers


def steady(answer: Answer) -> Answer:
    """The answer with labels only where the label has been the same for STEADY.

    A detector that reads a window of this length then has read a single state.
    """
    first = np.append(True, np.diff(answer.labels) != 0)
    since = answer.time[np.maximum.accumulate(np.where(first, np.arange(len(first)), 0))]
    return replace(
        answer,
        labels=np.where(answer.time - since >= STEADY - 1e-9, answer.labels, UNKNOWN).astype(
            np.uint8
        ),
    )


def best_threshold(answers: Sequence[Answer]) -> float:
    """The probability from which slip is reported with the greatest balanced accuracy.

    The accuracy is that of slip and no slip on these answers; the probability is the middle between
    the two values next to it. NaN if a class is missing.
    """
    values = np.concatenate([one.probability[one.known] for one in answers] or [np.empty(0)])
    slips = np.concatenate([one.slips[one.known] for one in answers] or [np.empty(0, bool)])
    slips, values = slips[~np.isnan(values)], values[~np.isnan(values)]
    if not slips.any() or slips.all():
        return math.nan
    order = np.argsort(-values, kind="stable")
    values, slips = values[order], slips[order]
    gain = np.cumsum(
        slips / slips.sum() - ~slips / (~slips).sum()
    )  # recall of slip less share of false reports
    ends = np.append(np.flatnonzero(np.diff(values)), len(values) - 1)  # of equal values
    best = int(ends[np.argmax(gain[ends])])
    return float(
        values[best] if best + 1 == len(values) else 0.5 * (values[best] + values[best + 1])
    )


def at_threshold(answer: Answer, threshold: float) -> Answer:
    """The answer of a detector that reports gross slip from this probability on."""
    held = ~np.isnan(answer.probability)
    seen = np.where(
        held, np.where(answer.probability >= threshold, GROSS, NON_SLIP), NO_CONTACT
    ).astype(np.uint8)
    return replace(answer, seen=seen, since=answer.time)


def left_out(answers: Sequence[Answer], groups: Sequence[str]) -> tuple[list[Answer], list[float]]:
    """Answers at thresholds that were chosen on the other groups.

    Args:
        answers: of all recordings
        groups: group of each answer

    Returns:
        answers at the thresholds; the threshold of each group, NaN where the other groups lack a
        class, whose answers are left out
    """
    chosen, thresholds = [], []
    for name in dict.fromkeys(groups):
        threshold = best_threshold(
            [one for one, group in zip(answers, groups, strict=True) if group != name]
        )
        thresholds.append(threshold)
        if not math.isnan(threshold):
            chosen += [
                at_threshold(one, threshold)
                for one, group in zip(answers, groups, strict=True)
                if group == name
            ]
    return chosen, thresholds


def summary(answers: Sequence[Answer], groups: Sequence[str]) -> dict[str, Any]:
    """The figures of `slipbench eval` (summary_json) of these answers.

    Args:
        answers: of recordings with labels
        groups: group of each answer; intervals treat the recordings of one as one experiment

    Returns:
        trials, figures with value, low and high, and so on
    """
    judgements = _core.Judgements()
    for one in answers:
        rate = (len(one.time) - 1) / (one.time[-1] - one.time[0]) if len(one.time) > 1 else 1.0
        judgements.add(one.time, one.labels, rate, one.seen, one.since, one.probability)
    found: dict[str, Any] = json.loads(judgements.summary(list(groups)))
    return found
