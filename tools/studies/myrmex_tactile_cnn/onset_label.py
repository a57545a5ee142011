"""Section 2.2 of the Myrmex paper.

The onset of slip by a third sensor on the object, compared with the true onset.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from slipbench import Trial
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.myrmex_tactile_cnn.bench import (
    APART,
    FULL_SCALE,
    SCENE,
    SETTLED,
    SOURCE,
    TAXEL_NOISE_SD,
    ContactGate,
    OnsetRule,
    SlipSpan,
    contact_end,
    decrease_onset,
    pad_of,
    placed_of,
    sum_end,
    sum_of_contacts,
    true_slip,
)
from slipbench_studies.result import Options, Result, Table
from slipbench_studies.statistics import median, quantile

USUAL_TRIALS = 8  # of each of the scene's eight cells
FORCE_FALL = 0.05  # for the rule by the true force
STILL = APART - SETTLED


class Rule(NamedTuple):
    """Parameters for the paper's rule: its text; average and threshold.

    True to use the counts, False to use the true noise-free force.
    """

    text: str
    rule: OnsetRule
    noisy: bool = True


RULES = {
    "w20_2": Rule("counts, mean of 20 ms, 2 sd", OnsetRule(0.02, 2.0)),
    "w20_3": Rule("counts, mean of 20 ms, 3 sd", OnsetRule(0.02, 3.0)),
    "w20_5": Rule("counts, mean of 20 ms, 5 sd", OnsetRule(0.02, 5.0)),
    "w100_3": Rule("counts, mean of 100 ms, 3 sd", OnsetRule(0.1, 3.0)),
    "w100_5": Rule("counts, mean of 100 ms, 5 sd", OnsetRule(0.1, 5.0)),
    "force": Rule("true force, 5 % below", OnsetRule(0.0, 0.0), noisy=False),
}

# Criteria for the end of a trial: text and gate; None: the truth. A single taxel: by the public
# tools (llach/myrmex_tools: 5 % of full scale), and by 3 sd of its noise.
ENDS: dict[str, tuple[str, ContactGate | None]] = {
    "public": ("a taxel, 205 counts", ContactGate(False, 0.0, 0.05 * FULL_SCALE)),
    "taxel_3": (
        f"a taxel, 3 sd of noise, {3.0 * TAXEL_NOISE_SD:.0f} counts",
        ContactGate(False, 0.0, 3.0 * TAXEL_NOISE_SD),
    ),
    "sum_5": (
        f"an array's sum, mean of 20 ms, 5 sd above its rest, {sum_end().counts:.0f} counts",
        sum_end(),
    ),
    "truth": ("the truth", None),
}


class OnsetTrial(NamedTuple):
    """Data that the study keeps of a trial.

    Attributes:
        object: name and mass
        rotational: True if it turns when it slips
        truth: true slip
        end: s, by the names of ENDS
        labelled: s, onset by the names of ENDS and of RULES; NaN: none
    """

    object: str
    rotational: bool
    truth: SlipSpan
    end: dict[str, float]
    labelled: dict[str, dict[str, float]]

    @property
    def slips(self) -> bool:
        """True if it truly slips."""
        return not math.isnan(self.truth.onset)


def onset_trial(trial: Trial) -> OnsetTrial:
    """The ends and onsets of a trial.

    Args:
        trial: a full record of SCENE

    Returns:
        data for the tables
    """
    left, right, top = (pad_of(trial, name) for name in ("left", "right", "top"))
    placed = placed_of(trial.params)
    truth = true_slip(left, right)
    counts, force = sum_of_contacts(top.counts), top.force.astype(float).sum(axis=1)
    least = FORCE_FALL * float(force[np.searchsorted(top.time, APART)])
    end = {
        name: truth.end if gate is None else contact_end(left, right, gate)
        for name, (_, gate) in ENDS.items()
    }
    labelled = {
        name: {
            rule: decrease_onset(
                top.time,
                counts if one.noisy else force,
                one.rule,
                SETTLED,
                APART,
                at,
                0.0 if one.noisy else least,
            )
            for rule, one in RULES.items()
        }
        for name, at in end.items()
    }
    return OnsetTrial(
        f"{placed.name}, {1e3 * placed.mass:.0f} g", placed.rotational, truth, end, labelled
    )


class Bias(NamedTuple):
    """Labelled minus true onset of some trials [ms], and number of trials without label."""

    all: list[float]
    missed: int

    def text(self) -> str:
        """Median, quartiles and worst; "-" without trials."""
        if not self.all:
            return "-"
        missed = f", {self.missed} missed" if self.missed else ""
        return (
            f"{median(self.all):+.0f} ({quantile(self.all, 0.25):+.0f} to {quantile(self.all, 0.75):+.0f}; "
            f"{max(self.all, key=abs):+.0f}){missed}"
        )

    def figures(self) -> dict[str, Any]:
        """n, missed, bias_ms and, with a label, median_ms."""
        return {
            "n": len(self.all),
            "missed": self.missed,
            "bias_ms": self.all,
            **({"median_ms": median(self.all)} if self.all else {}),
        }


def bias_of(trials: Iterable[OnsetTrial], end: str, rule: str) -> Bias:
    """Biases of one rule.

    Args:
        trials: trials that truly slip
        end: a name of ENDS
        rule: a name of RULES

    Returns:
        labelled minus true onset
    """
    biases = [1e3 * (trial.labelled[end][rule] - trial.truth.onset) for trial in trials]
    return Bias(
        [one for one in biases if not math.isnan(one)], sum(math.isnan(one) for one in biases)
    )


def kept_table(slipping: Sequence[OnsetTrial]) -> tuple[Table, list[dict[str, Any]]]:
    """Each end, and the number of trials with an onset before it.

    Args:
        slipping: trials that truly slip

    Returns:
        the table and its figures, one row per end; empty without trials
    """
    table = Table(
        "Trials with an onset before their end",
        [
            "end: no more contact by",
            "less true end, ms: median (quartiles)",
            "true onset",
            *(rule.text for rule in RULES.values()),
        ],
    )
    figures = []
    for end, (text, _) in ENDS.items() if slipping else ():
        late = [1e3 * (trial.end[end] - trial.truth.end) for trial in slipping]
        slips = sum(trial.end[end] > trial.truth.onset for trial in slipping)
        kept = {
            rule: sum(not math.isnan(trial.labelled[end][rule]) for trial in slipping)
            for rule in RULES
        }
        table.rows.append(
            [
                text,
                f"{median(late):+.0f} ({quantile(late, 0.25):+.0f} to {quantile(late, 0.75):+.0f})",
                f"{slips} of {len(late)}",
                *map(str, kept.values()),
            ]
        )
        figures.append({"end": end, "less_true_end_ms": late, "true_onset": slips, **kept})
    return table, figures


def bias_table(
    slipping: Sequence[OnsetTrial], objects: Sequence[str], end: str
) -> tuple[Table, list[dict[str, Any]]]:
    """Biases of each kind and object.

    Args:
        slipping: trials that truly slip
        objects: names, in the order of the rows
        end: a name of ENDS

    Returns:
        the table and its figures, one row per kind and object that occurs
    """
    table = Table(
        f"Labelled less true onset, ms: median (quartiles; worst). End by {ENDS[end][0]}",
        ["kind", "object", "trials", *(rule.text for rule in RULES.values())],
        note="A positive bias means a late label. Missed: the sum is not below the threshold at the end.",
    )
    figures = []

    def add(kind: str, name: str, fits: Callable[[OnsetTrial], bool]) -> None:
        some = [trial for trial in slipping if fits(trial)]
        if some:
            found = {rule: bias_of(some, end, rule) for rule in RULES}
            table.rows.append(
                [kind, name, str(len(some)), *(bias.text() for bias in found.values())]
            )
            figures.append(
                {
                    "end": end,
                    "kind": kind,
                    "object": name,
                    **{rule: bias.figures() for rule, bias in found.items()},
                }
            )

    for kind, rotational in (("translation", False), ("rotation", True)):
        for name in objects:
            add(
                kind,
                name,
                lambda trial, rotational=rotational, name=name: (  # type: ignore[misc]
                    trial.rotational == rotational and trial.object == name
                ),
            )
        add(kind, "all", lambda trial, rotational=rotational: trial.rotational == rotational)  # type: ignore[misc]
    add("both", "all", lambda _: True)
    return table, figures


def study(options: Options) -> Result:
    """myrmex-tactile-cnn/onset_label.

    Args:
        options: trials, seed, jobs

    Returns:
        the labelled onset with the true one

    Raises:
        InputError: for a trial that cannot run
    """
    trials = run_grid(
        [Cell("dataset.yaml", SCENE, draws=options.trials or USUAL_TRIALS)],
        options,
        lambda _, trial: onset_trial(trial),
    )[0]
    slipping = [trial for trial in trials if trial.slips]
    objects = list(dict.fromkeys(trial.object for trial in trials))
    table, kept = kept_table(slipping)
    by_end = [bias_table(slipping, objects, end) for end in ENDS]
    lengths = [1e3 * (trial.truth.end - trial.truth.onset) for trial in slipping]
    means, long_means = STILL / 0.02, STILL / 0.1
    result = Result(
        title="Onset of slip by a third sensor on the object",
        source=f"Section 2.2 of {SOURCE}",
        figures={
            "ends": kept,
            "bias": [row for _, rows in by_end for row in rows],
            "slip_ms": lengths,
        }
        if slipping
        else None,
        tables=[table, *(one for one, _ in by_end)],
        setup=[
            f"{SCENE}, seed {options.draws_seed}: {len(trials)} trials, electronics typical; {len(trials) - len(slipping)} of them held to the end.",
            "True onset: from this time on slipping taxels carry at least half of the normal force on both pads. True end: one pad loses contact.",
            "Rule: the sum of 4095 - counts over the taxels of the third sensor (500 Hz), averaged backwards, lies below its mean from 2.0 to 2.5 s, when "
            "nothing moves, by some standard deviations (sd) of that interval, and stays there to the end. End: the two holding arrays have no contact any "
            "more. The paper does not state the average, the threshold and what a contact is. True force: the force on the sensor, without its noise and "
            "memory.",
            f"sd is that of the averaged sum over the 500 ms: {means:.0f} independent means of 20 ms, {long_means:.0f} of 100 ms, so that it is itself "
            f"known to {100.0 / math.sqrt(2.0 * (means - 1.0)):.0f} % and {100.0 / math.sqrt(2.0 * (long_means - 1.0)):.0f} % (1/sqrt(2 (n - 1))).",
        ],
    )
    if lengths:
        result.setup.append(
            f"From the true onset to the true end {median(lengths):.0f} ms in the median."
        )
    return result
