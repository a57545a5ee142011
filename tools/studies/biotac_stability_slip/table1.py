"""Table 1 of the paper: a grasp held or lost, by the layout of the tactile image."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from slipbench.learning.biotac import IMAGES
from slipbench_studies.biotac_stability_slip.grasps import PALMS, Grasps
from slipbench_studies.biotac_stability_slip.stability import (
    GraspSets,
    cnn,
    compare,
    grasps_for,
    plain_network,
)
from slipbench_studies.biotac_stability_slip.validation import PAPER
from slipbench_studies.result import Options, Result

NAME = "biotac-stability-slip/table1"
PUBLISHED = {"D1": "90.9 +- 1.5", "D2": "89.6 +- 1.7", "D3": "89.7 +- 1.3"}


def judged(grasps: Grasps) -> Grasps:
    """The grasps with palms 0 and 90."""
    return grasps.chosen(np.array([PALMS[palm].text != "45" for palm in grasps.palm]))


def study(options: Options) -> Result:
    """biotac-stability-slip/table1.

    Args:
        options: real, data, trials, full, seed, jobs, output, resume

    Returns:
        accuracy of each image, by sample and by object

    Raises:
        InputError: as grasps_for() and compare()
    """
    grasps = grasps_for(options)
    grasps = GraspSets(
        None if grasps.real is None else judged(grasps.real), judged(grasps.synthetic)
    )
    networks = []
    for image, published in PUBLISHED.items():
        rows, columns = IMAGES[image][0]
        networks.append((cnn(image, 128, image), [f"{image} ({rows} x {columns})", published]))
    networks.append((plain_network(), ["no image: MLP 128", "-"]))
    result = compare(NAME, options, grasps, ["image", "paper, by sample"], networks)
    result.tables[0].title = "Table 1: 32 filters, 128 units"
    return replace(
        result,
        title="Layouts of the tactile image of a BioTac SP: held or lost",
        source=f"Table 1 of {PAPER}. Accuracy in %.",
        remarks=[
            "Only palms 0 and 90, as in the paper, whose 2,549 grasps are those of the public set. The paper distributes them by sample, so the training "
            "set contains the objects of the test set.",
            *result.remarks,
        ],
    )
