"""Table III of the piezo paper: tips that are not in the training set."""

from __future__ import annotations

from typing import Any

from slipbench import InputError
from slipbench_studies.piezo_fft_gru import SCENE
from slipbench_studies.piezo_fft_gru.bench import BENCH_LEVEL, PUBLISHED_SPECTRA, RULES
from slipbench_studies.piezo_fft_gru.networks import (
    GRU_32,
    MLP_32,
    SOURCE,
    USUAL_RECORDINGS,
    Validations,
    figures_of,
    on_all,
    recordings_for,
    setup_of,
    size_of,
)
from slipbench_studies.result import Options, Result, Table

NAME = "piezo-fft-gru/table3"
PUBLISHED = [
    "98.6, 0.976",
    "96.5, 0.950",
    "95.3, 0.937",
    "94.4, 0.934",
]  # all tips in training, and without each of three tips


def study(options: Options) -> Result:
    """piezo-fft-gru/table3.

    Args:
        options: data, trials, full, seed, jobs, output, resume

    Returns:
        accuracy and F1 on each tip, by networks trained without it

    Raises:
        InputError: if all recordings are of one tip, as size_of() and recordings_for(), or for
            saved networks of another run
    """
    size = size_of(options, USUAL_RECORDINGS)
    recordings = recordings_for(options, size, [BENCH_LEVEL], [PUBLISHED_SPECTRA])
    tips = sorted({one.tip for one in recordings})
    if len(tips) < 2:
        raise InputError(
            f"{options.data or SCENE}: all recordings are of one tip; allowed: two or more, as one is left out"
        )
    tip_of = [tips.index(one.tip) for one in recordings]
    validations = Validations(options, size)
    asked = []
    for row in (GRU_32, MLP_32):
        for rule in RULES:
            every = validations.queue_folds(recordings, row, rule)
            asked.append((row, rule, every, validations.queue(recordings, tip_of, row, rule)))
    validations.run(NAME)

    table = Table(
        "Table III: all recordings of the tip, with contact and motors alone",
        [
            "network",
            "label",
            "none left out",
            *(f"tip {number + 1}" for number in range(len(tips))),
        ],
        note="Tips are numbered in the order of their swept values; the paper does not describe its tips, so the numbers do not correspond.",
    )
    published = ["paper, GRU 32", "position", *PUBLISHED, *["-"] * len(tips)]
    table.rows.append(published[: len(table.head)])
    figures: dict[str, dict[str, Any]] = {name: {} for name in RULES.values()}
    for row, rule, every, left_out in asked:
        counts, of_tips = validations.counts(every), validations.counts(left_out)
        folds = [of_tips[tip : tip + 1] for tip in range(len(tips))]
        table.rows.append(
            [row.text, RULES[rule], on_all(counts).cell(), *(on_all(fold).cell() for fold in folds)]
        )
        figures[RULES[rule]][row.name] = {
            "none": figures_of(counts),
            "tips": [figures_of(fold) for fold in folds],
        }
    return Result(
        title="A tip outside the training",
        source=f"Table III of {SOURCE}",
        figures=figures,
        tables=[table],
        setup=[
            *setup_of(options, size, len(recordings)),
            *(
                f"Tip {number + 1}: {tip_of.count(number)} recordings, {tip}"
                for number, tip in enumerate(tips)
            ),
        ],
        remarks=[
            "The tips of the scene differ in friction, stiffness, roundness, resonance and roughness; they share the sensor and its motors."
        ],
    )
