"""Table 2 of the Myrmex paper.

Nets 1 to 3 by its split, by trial and by object, compared with the information in the static image
or a clock.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import Any

import numpy as np
from slipbench.learning import answers
from slipbench_studies.grid import check_only, chosen
from slipbench_studies.myrmex_tactile_cnn.bench import SOURCE
from slipbench_studies.myrmex_tactile_cnn.networks import (
    BINS_OF,
    TAXELS,
    TRIAL_FOLDS,
    Judged,
    Row,
    Validations,
    accuracy,
    network_row,
    percent,
    run_trials,
    setup_of,
    size_of,
)
from slipbench_studies.result import Options, RealFigure, Result, Table
from slipbench_studies.statistics import mean_sd

NAME = "myrmex-tactile-cnn/table2"
WINDOW_SPLITS = 5  # 20 % of the windows are for the test; the first of five folds
PUBLISHED_FORWARD = {1: 0.29, 2: 0.44, 3: 0.43}  # ms
FORWARD_PASSES = 201


def all_rows() -> dict[str, Row]:
    """The rows of the table by name."""
    net_3 = replace(network_row(3), published=math.nan)
    rows = [
        *(network_row(net, what) for what in ("spectra", "high_pass") for net in (1, 2, 3)),
        *(network_row(net, word="bench") for net in (1, 2, 3)),
        network_row(3, word="motion"),
        replace(net_3, name="net_3_longer", text="net 3, four times the steps", longer=4),
        replace(
            net_3,
            name="net_3_late",
            text="net 3, stable windows only from the last half second",
            late=True,
        ),
        replace(net_3, name="static", text="the static image alone, net 3", inputs="static_image"),
        Row("load", "the mean count alone", inputs="load"),
        Row("clock", "a clock", inputs="clock"),
        Row("placement", "object and placement", inputs="placement"),
        Row("clock_placement", "a clock, object and placement", inputs="clock_placement"),
    ]
    return {row.name: row for row in rows}


def forward_ms(row: Row) -> float:
    """Time of one window through a network that the paper times.

    Args:
        row: row of the table

    Returns:
        ms, median on one core; NaN for a row that the paper does not time
    """
    if (
        row.net == 0
        or row.inputs == "static_image"
        or row.longer > 1
        or row.late
        or row.word != "true"
    ):
        return math.nan
    first, end = BINS_OF[row.inputs]
    inputs = TAXELS * (end - first)
    network, window = row.network(inputs), np.full((1, inputs), 0.5, dtype=np.float32)
    times = []
    for _ in range(FORWARD_PASSES):
        begun = time.perf_counter()
        answers(network, window)
        times.append(1e3 * (time.perf_counter() - begun))
    return float(np.median(times))


def figures_of(judged: Judged) -> dict[str, Any]:
    """Accuracy of all folds together and of each fold, and windows [true, called]."""
    return {
        "accuracy": accuracy(judged.all),
        "folds": [accuracy(fold) for fold in judged.folds],
        "windows": judged.all,
    }


def study(options: Options) -> Result:
    """myrmex-tactile-cnn/table2.

    Args:
        options: trials, only, full, seed, jobs, output, resume

    Returns:
        accuracy of each row by window, by trial and by object

    Raises:
        InputError: for an unknown name of --only, too few trials, or saved networks of another run
    """
    size = size_of(options)
    rows = all_rows()
    check_only(options.only, list(rows))
    rows = {name: rows[name] for name in chosen(list(rows), options.only)}
    trials = run_trials(options, size)
    validations = Validations(options, size, trials)
    asked = {
        name: (
            validations.queue(row, "window", WINDOW_SPLITS, 1),
            validations.queue(row, "trial", TRIAL_FOLDS, TRIAL_FOLDS),
            validations.queue(row, "object", 0, 0 if row.longer > 1 else len(trials)),
        )
        for name, row in rows.items()
    }
    validations.run(NAME)

    scores = Table(
        "Accuracy in %",
        [
            "network or input",
            "label",
            "paper, by window",
            "by window",
            "by trial",
            "SD of folds",
            "object left out",
            "object, least fold",
            "forward, ms: paper",
            "ours",
        ],
        note="By window: the test set is a fifth of the windows of each class in turn, as in the paper, and its neighbours are in the training "
        "set. By trial: five folds. Object left out: cylinder, remote, glass.",
    )
    mistakes = Table(
        "Stable windows called slip, in %, by trial",
        [
            "network or input",
            "label",
            "last half second before the true onset",
            "earlier",
            "of trials that hold",
        ],
        note="All windows of the last half second, and the drawn ones of the others.",
    )
    figures, real = {}, []
    for name, row in rows.items():
        by_window, by_trial, by_object = (validations.figures(number) for number in asked[name])
        accuracies = {
            "by_window": figures_of(by_window),
            "by_trial": figures_of(by_trial),
            "object_left_out": figures_of(by_object),
        }
        forward = forward_ms(row)
        timed = not math.isnan(forward)
        scores.rows.append(
            [
                row.text,
                row.word,
                percent(row.published / 100.0),
                *(percent(accuracies[by]["accuracy"]) for by in ("by_window", "by_trial")),
                percent(mean_sd(accuracies["by_trial"]["folds"])[1]),
                percent(accuracies["object_left_out"]["accuracy"]),
                percent(min(accuracies["object_left_out"]["folds"], default=math.nan)),
                f"{PUBLISHED_FORWARD[row.net]:.2f}" if timed else "-",
                f"{forward:.2f}" if timed else "-",
            ]
        )
        stable = {
            "last_half_second": by_trial.called_slip("late"),
            "earlier": by_trial.called_slip("earlier"),
            "trials_that_hold": by_trial.called_slip("holds"),
        }
        mistakes.rows.append([row.text, row.word, *map(percent, stable.values())])
        figures[name] = {**accuracies, "stable_called_slip": stable, "forward_ms": forward}
        if not math.isnan(row.published):
            real.append(
                RealFigure(
                    f"{row.text}, windows that are right, %",
                    row.published,
                    100.0 * accuracies["by_window"]["accuracy"],
                    "ours has learnt from simulation",
                )
            )
    return Result(
        title="Networks of the Myrmex array: stable, translation or rotation",
        source=f"Table 2 of {SOURCE}",
        figures=figures,
        tables=[scores, mistakes],
        setup=setup_of(options, size, trials),
        remarks=[
            "The grip opens until the object slips, so a low static image indicates slip. The shortcuts show how much of a score this explains.",
            "Random windows are rarely from just before the onset, where stable and slip differ least; the second table has these.",
            "Forward: one window through PyTorch on one core, without its spectra; the paper used a GPU.",
        ],
        real=real,
    )
