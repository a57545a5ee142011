"""Fig. 12 of the paper: a grasp held or lost, by the graph of the GCN."""

from __future__ import annotations

from dataclasses import replace

from slipbench.learning.biotac import ELECTRODES
from slipbench_studies.biotac_stability_slip.stability import compare, gcn, grasps_for
from slipbench_studies.biotac_stability_slip.validation import PAPER
from slipbench_studies.result import Options, Result

NAME = "biotac-stability-slip/fig12"
NEIGHBOURS = (0, 2, 8, 23)


def study(options: Options) -> Result:
    """biotac-stability-slip/fig12.

    Args:
        options: real, data, trials, full, seed, jobs, output, resume

    Returns:
        accuracy of the GCN by its graph, by sample and by object

    Raises:
        InputError: as grasps_for() and compare()
    """
    grasps = grasps_for(options)
    networks = []
    for k in range(ELECTRODES) if options.full else NEIGHBOURS:
        text = f"{k} nearest" if k else "drawn by hand"
        networks.append((gcn(k, f"k{k}", f"GCN, {text}"), [str(k), text]))
    result = compare(NAME, options, grasps, ["k", "graph"], networks)
    result.tables[0].title = "Fig. 12: the GCN by its graph"
    return replace(
        result,
        title="Tactile graphs of a BioTac SP: held or lost",
        source=f"Fig. 12 of {PAPER}. Accuracy in %.",
        remarks=[
            "The paper shows a curve without numbers: the hand-drawn graph is best, and accuracy falls with k. It does not state whether its folds are by "
            "sample or by object.",
            *result.remarks,
        ],
    )
