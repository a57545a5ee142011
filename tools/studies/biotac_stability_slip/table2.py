"""Table 2 of the paper: grasps held or lost, from a snapshot before the lift, on unseen objects.

Networks are trained on real grasps, on synthetic ones and on both.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from slipbench_studies.biotac_stability_slip.grasps import PALMS, Grasps
from slipbench_studies.biotac_stability_slip.stability import (
    StabilityNetwork,
    cnn,
    examples_of,
    gcn,
    grasps_for,
    logistic_regression,
    plain_network,
    setup_of,
    stability_without_real,
)
from slipbench_studies.biotac_stability_slip.validation import (
    JUDGED_HERE,
    PAPER,
    Answers,
    Examples,
    Validations,
    cell,
    figures_object,
    scores_of,
)
from slipbench_studies.result import Options, RealFigure, Result, Table

NAME = "biotac-stability-slip/table2"
DRAWS = (
    306  # twice the scene's: 1,100 training grasps are too few for the paper's networks (README.md)
)
PUBLISHED = [
    ["paper, GCN", "75.5", "74.1", "75.1", "77.4", "76.6", "74.7", "75.6", "-"],
    ["paper, CNN", "76.5", "82.9", "70.8", "76.3", "88.4", "61.8", "72.6", "-"],
]
PUBLISHED_ACCURACY = {"gcn": 75.5, "cnn": 76.5}  # %
TRAINED_ON = ("real", "synthetic_to_real", "both")


@dataclass
class Row:
    """A network of the table.

    Attributes:
        network: the network
        synthetic: grasps in its representation
        real: likewise; None without --real
        numbers: numbers of its validations: "synthetic", and those in TRAINED_ON
    """

    network: StabilityNetwork
    synthetic: Examples
    real: Examples | None = None
    numbers: dict[str, int] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name in the figures."""
        return self.network.network.name

    @property
    def text(self) -> str:
        """Name in the tables."""
        return self.network.network.text


def palm_cells(
    answers: Answers, examples: Examples, grasps: Grasps
) -> tuple[list[str], dict[str, Any]]:
    """The cells of a row: accuracy on all palms and on each, then the other figures on all palms.

    Args:
        answers: answers for the grasps
        examples: the grasps in the network's representation
        grasps: the grasps

    Returns:
        the cells, and the figures of "all", "palm_0", "palm_90" and "palm_45"
    """
    every = scores_of(answers, examples.fold)
    by_palm = {
        f"palm_{palm.text}": scores_of(answers, examples.fold, grasps.palm == number)
        for number, palm in enumerate(PALMS)
    }
    cells = [cell(one["accuracy"]) for one in (every, *by_palm.values())]
    cells += [cell(every[name]) for name in ("precision", "recall", "f1", "auc")]
    return cells, {name: figures_object(one) for name, one in {"all": every, **by_palm}.items()}


def palm_table(
    title: str, rows: list[Row], which: str, grasps: Grasps, validations: Validations
) -> tuple[Table, dict[str, Any]]:
    """Table of one set of grasps.

    Args:
        title: title of the table
        rows: all networks
        which: "real" or "synthetic"
        grasps: the set
        validations: after run()

    Returns:
        the table and its figures
    """
    table = Table(
        title,
        ["network", "accuracy", "palm 0", "palm 90", "palm 45", "precision", "recall", "F1", "AUC"],
        list(PUBLISHED),
    )
    figures = {}
    for row in rows:
        cells, figures[row.name] = palm_cells(
            validations.answers(row.numbers[which]), getattr(row, which), grasps
        )
        table.rows.append([row.text, *cells])
    return table, figures


def three_ways(rows: list[Row], validations: Validations) -> tuple[Table, dict[str, Any]]:
    """Compares training on real, synthetic and both kinds of grasps, tested on unseen real objects.

    Args:
        rows: with real grasps
        validations: after run()

    Returns:
        the table and its figures
    """
    table = Table(
        "Test on real objects outside the training, by training set",
        [
            "accuracy",
            "real alone",
            "synthetic alone",
            "both",
            "AUC: real alone",
            "synthetic alone",
            "both",
        ],
        note="The network trained only on synthetic grasps is tested on all real grasps.",
    )
    figures = {}
    for row in rows:
        assert row.real is not None
        scores = {
            source: scores_of(validations.answers(row.numbers[source]), row.real.fold)
            for source in TRAINED_ON
        }
        table.rows.append(
            [
                row.text,
                *(cell(one[name]) for name in ("accuracy", "auc") for one in scores.values()),
            ]
        )
        figures[row.name] = {source: figures_object(one) for source, one in scores.items()}
    return table, figures


def real_figures(three_way: dict[str, Any]) -> list[RealFigure]:
    """Figures for `realism`.

    Args:
        three_way: figures of three_ways()

    Returns:
        figures of real devices with ours
    """
    return [
        *(
            RealFigure(
                f"grasps held or lost, {name}, real to real, %",
                published,
                100.0 * three_way[name]["real"]["accuracy"],
                "other objects than the paper's judge",
            )
            for name, published in PUBLISHED_ACCURACY.items()
        ),
        *(
            RealFigure(
                f"the same, AUC, {name}: trained here on real, on synthetic grasps",
                three_way[name]["real"]["auc"],
                three_way[name]["synthetic_to_real"]["auc"],
                JUDGED_HERE,
            )
            for name in ("gcn", "cnn", "lr_by_palm")
        ),
    ]


def study(options: Options) -> Result:
    """biotac-stability-slip/table2.

    Args:
        options: real, data, trials, full, seed, jobs, output, resume

    Returns:
        figures of each network by palm, trained on real, synthetic and both kinds of grasps

    Raises:
        InputError: as grasps_for() and Validations.run()
    """
    networks = [
        logistic_regression(),
        logistic_regression(True),
        plain_network(),
        plain_network(4),
        gcn(0, "gcn", "GCN, graph drawn by hand"),
        cnn("D1", 1024),
    ]
    grasps, validations, rows = grasps_for(options, DRAWS), Validations(options), []
    for network in networks:
        row = Row(network, examples_of(grasps.synthetic, network, True, options.draws_seed))
        rows.append(row)
        row.numbers["synthetic"] = validations.queue(network.network, row.synthetic)
        if grasps.real is not None:
            row.real = examples_of(grasps.real, network, True, options.draws_seed)
            row.numbers["real"] = validations.queue(network.network, row.real)
            row.numbers["synthetic_to_real"] = validations.queue(
                network.network, row.real, own=False, other=row.synthetic
            )
            row.numbers["both"] = validations.queue(network.network, row.real, other=row.synthetic)
    validations.run(NAME)

    result = Result(
        title="Grasps with three BioTac SP: held or lost, from a snapshot before the lift",
        source=f"Table 2 of {PAPER}. Shares in %; precision, recall and F1 are of lost grasps.",
        figures={},
        setup=setup_of(options, grasps),
        remarks=[
            "The test set of the paper is 10 of 51 objects, which are not published separately. Here each object is tested with a network that was not "
            "trained on it.",
            "The paper does not state for which class it gives precision and recall.",
            *stability_without_real(options),
        ],
    )
    if grasps.real is not None:
        table, result.figures["real"] = palm_table(
            "Real grasps, by object", rows, "real", grasps.real, validations
        )
        three, result.figures["three_way"] = three_ways(rows, validations)
        result.tables += [table, three]
        result.real = real_figures(result.figures["three_way"])
    table, result.figures["synthetic"] = palm_table(
        "Synthetic grasps, by object", rows, "synthetic", grasps.synthetic, validations
    )
    result.tables.append(table)
    return result
