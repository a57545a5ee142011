"""Table 3 of the paper: direction of slip under one finger, on unseen objects.

Each network is trained with and without the position of the contact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
from slipbench.learning.biotac import IMAGES
from slipbench.learning.networks import BiotacConvLstm, BiotacLstm
from slipbench_studies.biotac_stability_slip.touches import (
    CLASSES,
    DEVICES,
    RANDOM_SITE_SCENE,
    SCENE,
    Touch,
    Window,
    read_touches,
    run_touches,
    windows_of,
)
from slipbench_studies.biotac_stability_slip.validation import (
    JUDGED_HERE,
    LONGER,
    PAPER,
    Examples,
    Folds,
    Network,
    RowsNetwork,
    Validations,
    cell,
    check_data,
    figures_object,
    folds_by_object,
    object_count,
    scores_of,
    without_real,
)
from slipbench_studies.grid import check_only, chosen
from slipbench_studies.result import Options, RealFigure, Result, Table
from torch import nn

NAME = "biotac-stability-slip/table3"
DRAWS, PUBLISHED_DRAWS = 4, 8  # of each of 28 cells and each device
STEPS = 1200
BRIEF, WHOLE = Window(5, 5), Window(50, 25)
IMAGE = "D1"

# Training and test sets.
REAL_COLUMNS = {
    "real": "real alone",
    "synthetic_to_real": "synthetic alone",
    "both": "both",
    "random_to_real": "random site alone",
}
# These need no recordings.
SYNTHETIC_COLUMNS = {
    "synthetic": "synthetic, on synthetic",
    "random_site": "random site, on random site",
}
COLUMNS = REAL_COLUMNS | SYNTHETIC_COLUMNS


@dataclass(frozen=True)
class DirectionNetwork:
    """A row of the tables.

    Attributes:
        network: the network
        window: part of a recording that it sees
        columns: number of its leading COLUMNS; without real recordings it has all of
            SYNTHETIC_COLUMNS
    """

    network: Network
    window: Window
    columns: int


def all_networks(full: bool) -> dict[str, DirectionNetwork]:
    """The rows of the tables by name.

    Args:
        full: True: the ConvLSTM has the paper's size

    Returns:
        rows with the site, then without
    """
    rows: dict[str, DirectionNetwork] = {}

    def add(
        site: bool,
        name: str,
        text: str,
        make: Callable[..., nn.Module],
        steps: int,
        window: Window,
        columns: int,
    ) -> None:
        window = Window(window.rows, window.stride, site, window.image, window.figures)
        length, values = window.shape
        suffix, off = ("", "") if site else ("_no_site", ", mean taken off")
        network = Network(
            f"{name}{suffix}",
            f"{text}, {10 * window.rows} ms{off}",
            partial(make, values, len(CLASSES), length),
            steps,
            len(CLASSES),
            "range" if site else "standard",
        )
        rows[network.name] = DirectionNetwork(network, window, columns)

    for site in (True, False):
        every, three = len(COLUMNS), 3  # the latter for rows that take long
        add(site, "lr", "logistic regression", _regression, STEPS, BRIEF, every)
        add(site, "mlp", "MLP 128", _mlp, STEPS, BRIEF, every)
        add(
            site,
            "lstm",
            "LSTM, 5 layers of 32",
            partial(_lstm, layers=5),
            STEPS // 2,
            BRIEF,
            every if site else three,
        )
        if site:
            add(
                site,
                "lstm_longer",
                "the same, four times the steps",
                partial(_lstm, layers=5),
                2 * STEPS,
                BRIEF,
                1,
            )
            add(
                site,
                "lstm_2",
                "LSTM, 2 layers of 32",
                partial(_lstm, layers=2),
                STEPS,
                BRIEF,
                three,
            )
        layers, filters = (5, 32) if full else (2, 8)
        add(
            site,
            "convlstm",
            f"ConvLSTM, {layers} layers of {filters}",
            partial(_conv_lstm, layers=layers, filters=filters),
            STEPS,
            Window(BRIEF.rows, BRIEF.stride, image=IMAGE),
            every if full else three if site else 2,
        )
        add(
            site,
            "lstm_500",
            "LSTM, 2 layers of 32",
            partial(_lstm, layers=2),
            STEPS // 4,
            WHOLE,
            2 if site else three,
        )
    add(
        False,
        "sd_trend",
        "MLP 128 of SDs and trends",
        _mlp,
        STEPS // 2,
        Window(WHOLE.rows, WHOLE.stride, figures="by_electrode"),
        every,
    )
    add(
        False,
        "sorted_sd",
        "MLP 128 of the SDs in order",
        _mlp,
        STEPS // 2,
        Window(WHOLE.rows, WHOLE.stride, figures="sorted"),
        every,
    )
    return rows


def _regression(values: int, classes: int, rows: int) -> nn.Module:
    return RowsNetwork(values, classes, rows)


def _mlp(values: int, classes: int, rows: int) -> nn.Module:
    return RowsNetwork(values, classes, rows, 128)


def _lstm(values: int, classes: int, rows: int, layers: int) -> nn.Module:
    return BiotacLstm(values, classes, layers, rows)


def _conv_lstm(values: int, classes: int, rows: int, layers: int, filters: int) -> nn.Module:
    height, width = IMAGES[IMAGE][0]
    return BiotacConvLstm(values, classes, height, width, layers, filters, rows)


def examples_of(touches: Sequence[Touch], window: Window, seed: int) -> Examples:
    """The windows of recordings, with one fold per object.

    Args:
        touches: recordings
        window: definition of the windows
        seed: as for folds()

    Returns:
        the windows

    Raises:
        InputError: for windows of one object
    """
    cut = [windows_of(touch, window) for touch in touches]
    objects = [touch.object for touch, (_, label) in zip(touches, cut, strict=True) for _ in label]
    features, labels = (np.concatenate(column) for column in zip(*cut, strict=True))
    return Examples(features, labels, folds_by_object(objects, _objects(touches), seed))


def _objects(touches: Sequence[Touch]) -> int:
    return object_count(touch.object for touch in touches)


@dataclass(frozen=True)
class Touches:
    """Recordings for training and evaluation.

    Attributes:
        real: empty without --real
        synthetic: of SCENE
        random_site: of RANDOM_SITE_SCENE
    """

    real: list[Touch]
    synthetic: list[Touch]
    random_site: list[Touch]


def touches_for(options: Options) -> Touches:
    """Reads the requested recordings, or simulates them.

    Args:
        options: real, data, trials, full, seed, jobs, progress output

    Returns:
        all recordings

    Raises:
        InputError: for --trials together with --data, for imported recordings as --data, and as
            read_touches() and run_touches()
    """
    check_data(options, "recordings")
    draws = options.trials or (PUBLISHED_DRAWS if options.full else DRAWS)
    real = read_touches(options.real, options) if options.real else []
    synthetic = (
        read_touches(options.data, options) if options.data else run_touches(SCENE, draws, options)
    )
    return Touches(real, synthetic, run_touches(RANDOM_SITE_SCENE, draws, options))


Numbers = dict[
    str, tuple[int, Folds]
]  # by column: number of the validation, and folds of the report


def queue(
    network: DirectionNetwork, sets: Mapping[str, Examples], validations: Validations
) -> Numbers:
    """Adds the validations of a row.

    Args:
        network: network of the row
        sets: "synthetic", "random_site" and, if available, "real"
        validations: target

    Returns:
        numbers by column
    """
    one, numbers = network.network, {}
    others = {
        "real": None,
        "synthetic_to_real": "synthetic",
        "both": "synthetic",
        "random_to_real": "random_site",
    }
    for column in list(COLUMNS)[: network.columns] if "real" in sets else SYNTHETIC_COLUMNS:
        judged, other = (sets["real"], others[column]) if column in others else (sets[column], None)
        own = not column.endswith("_to_real")
        numbers[column] = (
            validations.queue(one, judged, own=own, other=None if other is None else sets[other]),
            judged.fold,
        )
    return numbers


def published() -> Table:
    """The paper's own table."""
    return Table(
        "The paper: accuracy by kind of object, five repetitions",
        ["network, 50 ms", "rigid and smooth", "rough", "little contact", "mean"],
        [
            ["LSTM", "82.5 +- 2.0", "73.8 +- 2.0", "72.4 +- 3.6", "76.1 +- 2.4"],
            ["ConvLSTM", "82.6 +- 1.2", "73.5 +- .7", "70.9 +- 1.9", "75.5 +- 1.2"],
        ],
    )


def real_figures(figures: Mapping[str, Any]) -> list[RealFigure]:
    """Figures for `realism`.

    Args:
        figures: by row and column

    Returns:
        figures of real devices with ours
    """
    return [
        RealFigure(
            f"slip against touch, AUC, {name}: trained here on real, on synthetic recordings",
            one["real"]["auc"],
            one["synthetic_to_real"]["auc"],
            JUDGED_HERE,
        )
        for name, one in figures.items()
        if "real" in one and "synthetic_to_real" in one
    ]


def setup_of(options: Options, touches: Touches) -> list[str]:
    """Setup of the measurement.

    Args:
        options: real, data, full
        touches: all recordings

    Returns:
        one sentence per line
    """

    def recordings(some: Sequence[Touch]) -> str:
        return f"{len(some)} recordings of {_objects(some)} objects"

    fingers = f"{len(DEVICES)} fingers"
    return [
        *([f"Real: {options.real}, {recordings(touches.real)}."] if touches.real else []),
        f"Synthetic: {options.data or f'{SCENE}, {fingers}'}, {recordings(touches.synthetic)}.",
        f"Random site: {RANDOM_SITE_SCENE}, {fingers}, {recordings(touches.random_site)}.",
        "Windows of five rows at 100 Hz, one after the other; of 0.5 s, half overlapping. Mean and standard deviation over the objects. Each electrode is "
        f"scaled to 0..1, or to mean 0 and deviation 1 if the mean of the window is subtracted. Adam at 1e-3, {(LONGER if options.full else 1) * STEPS} steps of 64 at 50 ms, half of them for the"
        " LSTM of five layers; the last state is evaluated.",
    ]


def study(options: Options) -> Result:
    """biotac-stability-slip/table3.

    Args:
        options: real, data, trials, only, full, seed, jobs, output, resume

    Returns:
        balanced accuracy of seven classes, and area under the curve of slip against touch, of each
        network

    Raises:
        InputError: for an unknown name of --only, and as touches_for() and Validations.run()
    """
    networks = all_networks(options.full)
    check_only(options.only, list(networks))
    touches, validations, seed = touches_for(options), Validations(options), options.draws_seed

    @cache
    def sets_of(window: Window) -> dict[str, Examples]:
        made = {"synthetic": touches.synthetic, "random_site": touches.random_site}
        made |= {"real": touches.real} if touches.real else {}
        return {name: examples_of(some, window, seed) for name, some in made.items()}

    rows = {
        name: queue(networks[name], sets_of(networks[name].window), validations)
        for name in chosen(list(networks), options.only)
    }
    validations.run(NAME)

    columns = COLUMNS if touches.real else SYNTHETIC_COLUMNS
    head = ["network", *columns.values()]
    classes = Table(
        "Seven classes, balanced accuracy on objects outside the training (chance: 14.3)", head
    )
    areas = Table(
        "Slip against touch, area under the curve on objects outside the training",
        head,
        note='The probability of slip is the sum over all classes except t. The first columns are tested on real objects outside the training; "synthetic" '
        'and "random site" are one network each.',
    )
    figures: dict[str, Any] = {}
    for name, numbers in rows.items():
        scores = {
            column: scores_of(validations.answers(number), fold)
            for column, (number, fold) in numbers.items()
        }
        figures[name] = {column: figures_object(one) for column, one in scores.items()}
        for table, figure in ((classes, "balanced_accuracy"), (areas, "auc")):
            cells = [
                cell(scores[column][figure]) if column in scores else "-" for column in columns
            ]
            table.rows.append([networks[name].network.text, *cells])
    return Result(
        title="Direction of slip under a BioTac SP: t, n, e, s, w, cw, aw",
        source=f"Table 3 of {PAPER}. Figures in %.",
        figures=figures,
        setup=setup_of(options, touches),
        tables=[published(), classes, areas],
        remarks=[
            "The paper tests on seven other objects, which are not in the local copy of its recordings. Here each of the four objects is left out in turn.",
            "In these recordings the contact site reveals the direction. Without the mean of the window only changes within the window remain.",
            *(
                []
                if options.full
                else ["The paper's ConvLSTM has five layers of 32 filters (--full), here two of 8."]
            ),
            *([] if options.real else [without_real("biotacsp-dos", "yayaneath/BioTacSP-DoS")]),
        ],
        real=real_figures(figures),
    )
