"""Table I of the piezo paper.

Architectures, compared with shortcuts that need no signal of slip.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from slipbench.learning import networks
from slipbench_studies.grid import check_only
from slipbench_studies.piezo_fft_gru.bench import (
    BENCH_LEVEL,
    PUBLISHED_SPECTRA,
    RULES,
    SIGNAL_AT_100_HZ,
    Recording,
)
from slipbench_studies.piezo_fft_gru.networks import (
    GRU_32,
    MLP_32,
    SOURCE,
    USUAL_RECORDINGS,
    Row,
    Validations,
    cell,
    figures_of,
    motors_right,
    on_all,
    on_slip,
    recipe_row,
    recordings_for,
    setup_of,
    size_of,
)
from slipbench_studies.result import Options, RealFigure, Result, Table

NAME = "piezo-fft-gru/table1"
SIGNAL = 1  # index into Recording.inputs
# Twice as many as in the other tables: 160 training recordings are too few for the convolutions
# (README.md).
RECORDINGS = 2 * USUAL_RECORDINGS
SHORTCUT_STEPS = 300
NOTE_ON_SHORTCUTS = (
    "The network receives only this input, not the signal. Speed of the motors: the sum over all running motors, including those that do not move "
    "the tip. If a motor moves a touching tip, the bench slips except for the shear before it: so contact and motors together are a definition "
    "rather than a shortcut."
)
HALF = 62  # of the 4 x 31 frames before the last


def network_rows(full: bool) -> dict[str, Row]:
    """The architectures by name.

    Args:
        full: True: all of the paper; False: those whose recipes take minutes, and MLP 32 with
            longer training

    Returns:
        the rows
    """
    rows = [
        replace(
            recipe_row("raw_gru_32", "signal at 100 Hz, GRU 32", "piezo_raw_gru", 0.9157, 94.71),
            input=SIGNAL,
        ),
        GRU_32,
        MLP_32,
        recipe_row("mlp_128", "FFT, MLP 128", "piezo_mlp_128", 0.7941, 89.39),
        recipe_row("tcn_128_8", "FFT, TCN 128, kernel 8", "piezo_tcn", 0.9579, 97.64),
    ]
    if full:
        wide = partial(networks.PiezoTcn, kernel=32)
        rows += [
            Row(
                "gru_128",
                "FFT, GRU 128",
                partial(networks.PiezoGru, units=128),
                f1=0.9787,
                accuracy=98.73,
            ),
            Row(
                "tcn_128_1",
                "FFT, TCN 128, kernel 1",
                partial(networks.PiezoTcn, kernel=1),
                f1=0.8051,
                accuracy=88.97,
            ),
            Row("tcn_128_32", "FFT, TCN 128, kernel 32", wide, f1=0.9694, accuracy=98.26),
            Row(
                "tcn_128_32_later",
                "the same, not causal",
                wide,
                later=HALF,
                f1=0.9836,
                accuracy=99.21,
            ),
        ]
    else:
        training = replace(MLP_32.training, steps=2 * MLP_32.training.steps)
        rows.append(
            replace(
                MLP_32, name="mlp_32_longer", text="FFT, MLP 32, twice the steps", training=training
            )
        )
    return {row.name: row for row in rows}


def shortcut_rows() -> dict[str, Row]:
    """The results that a network can reach without the signal, by name."""
    shortcuts = {
        "clock": ("time", ("time",)),
        "contact": ("contact", ("contact",)),
        "contact_clock": ("contact and time", ("time", "contact")),
        "motors": ("speed of the motors", ("motors",)),
        "contact_motors": ("contact and speed of the motors", ("contact", "motors")),
        "kind": ("slip recording or motors alone", ("kind",)),
    }
    training = replace(MLP_32.training, steps=SHORTCUT_STEPS)
    return {
        name: replace(
            MLP_32,
            name=name,
            text=f"{text}, MLP 32",
            training=training,
            shortcuts=names,
            f1=math.nan,
            accuracy=math.nan,
        )
        for name, (text, names) in shortcuts.items()
    }


def table_of(
    title: str,
    rows: Mapping[str, Row],
    inputs: Mapping[str, int],
    asked: Mapping[str, Mapping[str, int]],
    validations: Validations,
) -> tuple[Table, dict[str, dict[str, Any]]]:
    """A table of rows, and its figures.

    Args:
        title: title of the table
        rows: by name
        inputs: values per frame of each row
        asked: number of the validation by label and row; a missing row was not trained with this
            label
        validations: after run()

    Returns:
        both
    """
    table = Table(
        title,
        [
            "input, network",
            "parameters",
            "paper",
            "position label: all",
            "with contact",
            "motors alone, % right",
            "true label: all",
            "with contact",
            "motors alone, % right",
        ],
    )
    figures: dict[str, dict[str, Any]] = {}
    for name, row in rows.items():
        cells = []
        for rule in RULES:
            if name not in asked[rule]:
                cells += ["-"] * 3
                continue
            counts = validations.counts(asked[rule][name])
            cells += [on_all(counts).cell(), on_slip(counts).cell(), cell(motors_right(counts))]
            figures.setdefault(RULES[rule], {})[name] = figures_of(counts)
        table.rows.append([row.text, str(row.parameters(inputs[name])), row.published(), *cells])
    return table, figures


def queued(
    validations: Validations,
    recordings: list[Recording],
    architectures: dict[str, Row],
    shortcuts: dict[str, Row],
    by_truth: set[str],
) -> dict[str, dict[str, int]]:
    """Queues the validations of all rows; returns their numbers by rule and name of the row.

    Args:
        validations: receives them
        recordings: training and test data
        architectures: rows that are trained by the paper's label
        shortcuts: rows that are trained by every label
        by_truth: names of those of `architectures` that are trained by every label
    """
    asked: dict[str, dict[str, int]] = {rule: {} for rule in RULES}
    for rule in RULES:
        for name, row in architectures.items():
            if rule == "paper" or name in by_truth:
                asked[rule][name] = validations.queue_folds(recordings, row, rule)
    for rule in RULES:
        for name, row in shortcuts.items():
            asked[rule][name] = validations.queue_folds(recordings, row, rule)
    return asked


def study(options: Options) -> Result:
    """piezo-fft-gru/table1.

    Args:
        options: data, trials, only, full, seed, jobs, output, resume

    Returns:
        accuracy and F1 of architectures, and of shortcuts

    Raises:
        InputError: for an unknown name of --only, as size_of() and recordings_for(), or for saved
            networks of another run
    """
    size = size_of(options, RECORDINGS)
    architectures, shortcuts = network_rows(options.full), shortcut_rows()
    check_only(options.only, [*architectures, *shortcuts])
    architectures, shortcuts = (
        {name: row for name, row in rows.items() if not options.only or name in options.only}
        for rows in (architectures, shortcuts)
    )
    recordings = recordings_for(options, size, [BENCH_LEVEL], [PUBLISHED_SPECTRA, SIGNAL_AT_100_HZ])
    validations = Validations(options, size)
    by_truth = set(architectures) if options.full else {GRU_32.name, MLP_32.name}
    asked = queued(validations, recordings, architectures, shortcuts, by_truth)
    validations.run(NAME)

    tables, figures = [], {}
    inputs = {
        name: row.features(recordings[0]).shape[1]
        for name, row in {**architectures, **shortcuts}.items()
    }
    for part, title, rows in (
        ("networks", "Table I: architectures", architectures),
        ("shortcuts", "What needs no slip signal", shortcuts),
    ):
        if rows:
            table, figures[part] = table_of(title, rows, inputs, asked, validations)
            tables.append(table)
    if shortcuts:
        tables[-1].note = NOTE_ON_SHORTCUTS
    setup = [
        *setup_of(options, size, len(recordings)),
        "Before the beginning of a recording, a convolution gets copies of its first frame, so that all frames are evaluated. The paper pads, too.",
    ]
    if not options.full:
        setup.append(
            "With the true label GRU 32, MLP 32 and the shortcuts are trained; with `--full` all networks."
        )
    return Result(
        title="Networks that distinguish slip and hold on the piezoelectric skin",
        source=f"Table I of {SOURCE}",
        figures=figures,
        tables=tables,
        setup=setup,
        remarks=[
            "The paper keeps the state with the best validation result, where the validation set is the test set; here test recordings select nothing.",
            "The paper states neither the vibration of its motors nor the size of its signal: level 2 is assumed. table4 has the others.",
        ],
        real=[
            RealFigure(
                f"{row.text}, balanced accuracy of frames, %",
                row.accuracy,
                on_all(validations.counts(asked["paper"][name])).accuracy[0],
                "ours has learnt from simulation",
            )
            for name, row in architectures.items()
            if not math.isnan(row.accuracy)
        ],
    )
