"""Common parts of the studies of grasp stability.

Networks, sets of grasps, and a table that compares networks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import torch
from slipbench.learning.biotac import ELECTRODES, IMAGES
from slipbench.learning.networks import BiotacCnn, BiotacGcn
from slipbench_studies.biotac_stability_slip.grasps import (
    FINGERS,
    SCENE,
    Grasps,
    as_graph,
    as_image,
    as_list,
    graph_of,
    levelled,
    read_grasps,
    run_grasps,
)
from slipbench_studies.biotac_stability_slip.validation import (
    LONGER,
    Examples,
    Network,
    RowsNetwork,
    Validations,
    cell,
    check_data,
    figures_object,
    folds_by_object,
    scores_of,
    without_real,
)
from slipbench_studies.network_training import Floats, folds
from slipbench_studies.result import Options, Result, Table

FOLDS = 5
INPUTS = len(FINGERS) * ELECTRODES
PLAIN_STEPS, NETWORK_STEPS = 1000, 500
PUBLISHED_DRAWS = 620  # of each of nine cells: 5,580 grasps of the 5,581
CLASSES = 2  # held, lost


@dataclass(frozen=True)
class StabilityNetwork:
    """A network with its representation of a grasp.

    Attributes:
        network: the network
        shown: function from counts [N, fingers, electrodes] to frames [N, 1, inputs]
        by_palm: True: standardise the grasps by levelled() first
    """

    network: Network
    shown: Callable[[Floats], Floats]
    by_palm: bool = False


def logistic_regression(by_palm: bool = False) -> StabilityNetwork:
    """Logistic regression on the 72 counts; `by_palm`: on counts standardised by levelled()."""
    make = partial(RowsNetwork, INPUTS, CLASSES)
    if by_palm:
        return StabilityNetwork(
            Network(
                "lr_by_palm",
                "the same, standardised for each palm",
                make,
                PLAIN_STEPS,
                CLASSES,
                "standard",
            ),
            as_list,
            True,
        )
    return StabilityNetwork(
        Network("lr", "logistic regression", make, PLAIN_STEPS, CLASSES), as_list
    )


def plain_network(longer: int = 1) -> StabilityNetwork:
    """A hidden layer of 128 on the 72 counts; `longer`: multiple of the usual steps."""
    name, text = (
        ("mlp", "MLP 128") if longer == 1 else ("mlp_longer", f"MLP 128, {longer} times the steps")
    )
    return StabilityNetwork(
        Network(
            name,
            text,
            partial(RowsNetwork, INPUTS, CLASSES, hidden=128),
            longer * PLAIN_STEPS,
            CLASSES,
        ),
        as_list,
    )


def cnn(image: str, units: int, name: str = "cnn") -> StabilityNetwork:
    """The paper's network for an image.

    Args:
        image: a name of IMAGES
        units: number of units in the hidden layer
        name: name of the network

    Returns:
        the network
    """
    layout = IMAGES[image]
    rows, columns = layout[0]
    make = partial(BiotacCnn, len(FINGERS) * rows * columns, CLASSES, rows, columns, units)
    return StabilityNetwork(
        Network(name, f"CNN {units}, {image} ({rows} x {columns})", make, NETWORK_STEPS, CLASSES),
        partial(as_image, layout=layout),
    )


def gcn(neighbours: int, name: str, text: str) -> StabilityNetwork:
    """The paper's network for a graph; `neighbours`: as for graph_of()."""
    adjacency = torch.tensor(graph_of(neighbours).tolist(), dtype=torch.float32)
    return StabilityNetwork(
        Network(name, text, partial(BiotacGcn, INPUTS, CLASSES, adjacency), NETWORK_STEPS, CLASSES),
        as_graph,
    )


def examples_of(grasps: Grasps, network: StabilityNetwork, by_object: bool, seed: int) -> Examples:
    """Represents grasps for a network.

    Args:
        grasps: for training and test
        network: the network
        by_object: True: all grasps of an object are in one fold; False: grasps are distributed
            individually
        seed: as for folds()

    Returns:
        in FOLDS folds

    Raises:
        InputError: for too few objects
    """
    counts = (levelled(grasps) if network.by_palm else grasps).counts
    if by_object:
        fold = folds_by_object(grasps.objects.tolist(), FOLDS, seed)
    else:
        fold = folds(np.zeros(len(grasps)), FOLDS, seed)
    return Examples(network.shown(counts), grasps.slipped.astype(np.uint8), fold)


@dataclass(frozen=True)
class GraspSets:
    """Networks and data of a study of stability.

    Attributes:
        real: None without --real
        synthetic: simulated ones
    """

    real: Grasps | None
    synthetic: Grasps


def grasps_for(options: Options, usual: int = 0) -> GraspSets:
    """Reads the requested grasps, or simulates them.

    Args:
        options: real, data, trials, full, seed, jobs, progress output
        usual: draws of each of the scene's nine cells; 0: as in the scene

    Returns:
        the sets

    Raises:
        InputError: for --trials together with --data, for imported recordings as --data, and as
            read_grasps() and run_grasps()
    """
    check_data(options, "grasps")
    real = read_grasps(options.real, options) if options.real else None
    draws = options.trials or (PUBLISHED_DRAWS if options.full else usual)
    return GraspSets(
        real, read_grasps(options.data, options) if options.data else run_grasps(draws, options)
    )


def setup_of(options: Options, grasps: GraspSets) -> list[str]:
    """Setup of the measurement, common to all tables.

    Args:
        options: real, data, full
        grasps: all sets

    Returns:
        one sentence per line
    """
    longer = LONGER if options.full else 1
    lines = (
        [f"Real: {grasps.real.text()} of {options.real} (paper: 5,581 of 51)."]
        if grasps.real is not None
        else []
    )
    return [
        *lines,
        f"Synthetic: {grasps.synthetic.text()} of {options.data or f'{SCENE}, three sets of fingers'}.",
        f"{FOLDS} folds; mean and standard deviation of the folds. One network is trained on all palms.",
        f"Each electrode is scaled to 0..1 on the training set. Adam at 1e-3, {longer * NETWORK_STEPS} steps of 64 for CNN and GCN, {longer * PLAIN_STEPS} for the others; classes are drawn equally"
        " often; the last state is evaluated.",
    ]


def stability_without_real(options: Options) -> list[str]:
    """The remark for runs without --real."""
    return (
        []
        if options.real
        else [without_real("bts3v2", "3dperceptionlab/biotacsp-stability-set-v2")]
    )


def compare(
    name: str,
    options: Options,
    grasps: GraspSets,
    head: Sequence[str],
    networks: Sequence[tuple[StabilityNetwork, list[str]]],
) -> Result:
    """Compares networks on all sets, with FOLDS folds by sample and by object.

    Args:
        name: PAPER/TABLE
        options: options of the command line
        grasps: sets for training and test
        head: heads of the leading cells of each row
        networks: each with these cells

    Returns:
        table, figures, setup and the remark about --real

    Raises:
        InputError: as Validations.run()
    """
    validations = Validations(options)
    sources = {} if grasps.real is None else {"real": grasps.real}
    sources["synthetic"] = grasps.synthetic
    rows = []
    for network, _ in networks:
        row = []
        for source, some in sources.items():
            for by in ("by_sample", "by_object"):
                judged = examples_of(some, network, by == "by_object", options.draws_seed)
                row.append((source, by, judged.fold, validations.queue(network.network, judged)))
        rows.append(row)
    validations.run(name)
    table = Table(
        "", [*head, *(f"{source}: {by}" for source in sources for by in ("by sample", "by object"))]
    )
    figures: dict[str, dict[str, dict[str, dict[str, float]]]] = {}
    for (network, cells), row in zip(networks, rows, strict=True):
        scores = [
            (source, by, scores_of(validations.answers(number), fold))
            for source, by, fold, number in row
        ]
        table.rows.append([*cells, *(cell(one["accuracy"]) for _, _, one in scores)])
        for source, by, one in scores:
            figures.setdefault(source, {}).setdefault(by, {})[network.network.name] = (
                figures_object(one)
            )
    return Result(
        "",
        "",
        figures,
        setup=setup_of(options, grasps),
        tables=[table],
        remarks=stability_without_real(options),
    )
