"""Grasps with three BioTac SP, real and synthetic, and their representation for networks."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, NoReturn

import numpy as np
import slipbench
from numpy.typing import NDArray
from slipbench import InputError, Trial
from slipbench.bin import _core
from slipbench.learning._fit import array_of
from slipbench.learning.biotac import ELECTRODES, Layout, drawn_graph, pixels_of
from slipbench_studies.biotac_stability_slip.validation import object_count
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.network_training import Floats
from slipbench_studies.result import Options

SCENE = "scenes/biotac_sp/grasp.yaml"
FINGERS = ("ff", "mf", "th")
TIME_ROUNDING = 1e-9  # s, tolerance for a sample's time


class Palm(NamedTuple):
    """A pose of the hand.

    Attributes:
        text: degrees, as in the paper
        imported: name in the real sets
        model: name in the scene
    """

    text: str
    imported: str
    model: str


PALMS = (
    Palm("0", "down", "hand_down.xml"),
    Palm("90", "side", "hand_side.xml"),
    Palm("45", "45", "hand_45.xml"),
)


class Grasp(NamedTuple):
    """A grasp at the time of the paper's snapshot, before the lift, and its outcome.

    Attributes:
        counts: [fingers, electrodes] counts
        object: the grasped object
        palm: index into PALMS
        slipped: True if the object is lost
    """

    counts: Floats
    object: str
    palm: int
    slipped: bool


@dataclass(frozen=True)
class Grasps:
    """N grasps.

    Attributes:
        counts: [N, fingers, electrodes] counts
        objects: [N] the grasped objects
        palm: [N] index into PALMS
        slipped: [N] True if the object is lost
    """

    counts: Floats
    objects: NDArray[np.str_]
    palm: NDArray[np.int64]
    slipped: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.palm)

    def chosen(self, which: NDArray[np.bool_]) -> Grasps:
        """The grasps selected by a mask [N]."""
        return Grasps(
            self.counts[which], self.objects[which], self.palm[which], self.slipped[which]
        )

    def text(self) -> str:
        """The numbers of the set: "2754 grasps of 51 objects, 48 % lost"."""
        return f"{len(self)} grasps of {object_count(self.objects)} objects, {100.0 * self.slipped.mean():.0f} % lost"


def gathered(grasps: Iterable[Grasp]) -> Grasps:
    """Stacks one or more grasps."""
    counts, objects, palm, slipped = zip(*grasps, strict=True)
    return Grasps(np.stack(counts), np.array(objects), np.array(palm), np.array(slipped))


def _refuse(trial: Any, what: str) -> NoReturn:
    raise InputError(
        f"trial {trial.trial}: {what}; allowed: grasps of {SCENE}, or files bts3v2_palm_down.csv, _side and _45 that "
        "`slipbench import --format bts3v2` has read"
    )


def grasp_of(trial: Any) -> Grasp:
    """The grasp of a trial with sensors ff, mf and th.

    Args:
        trial: a `Trial` or `StoredTrial`: imported from bts3v2, or simulated from SCENE, whose
            snapshot is the last row before the lift

    Returns:
        counts and outcome

    Raises:
        InputError: for another trial
    """
    real = "slipped" in trial.params
    word = trial.params.get("palm" if real else "model", "")
    palms = [palm.imported if real else palm.model for palm in PALMS]
    if word not in palms:
        _refuse(trial, f"its palm is '{word}'")
    name = _core.swept_object(json.dumps(trial.params))
    if not name:
        _refuse(trial, "it names no object")
    if not real and "held" not in trial.outcome:
        _refuse(trial, "its outcome does not state whether the object was held")
    counts = []
    for finger in FINGERS:
        sensor = trial.sensors.get(finger)
        if sensor is None or sensor.type != "biotac_sp" or not len(sensor.t):
            _refuse(trial, f"no reading of a biotac_sp '{finger}'")
        row = len(sensor.t) - 1
        if "held" in trial.outcome:
            row = max(
                int(
                    np.searchsorted(sensor.t, trial.outcome["hold_from_s"] + TIME_ROUNDING, "right")
                )
                - 1,
                0,
            )
        counts.append(np.array(sensor.channels["electrodes"][row]))
    return Grasp(
        np.stack(counts),
        name,
        palms.index(word),
        bool(trial.params["slipped"] if real else not trial.outcome["held"]),
    )


def read_grasps(path: str, options: Options) -> Grasps:
    """The grasps of a dataset.

    Args:
        path: path of the dataset
        options: progress output

    Returns:
        all of its grasps

    Raises:
        InputError: an incomplete dataset, or as grasp_of()
    """
    options.say(f"reading {path}")
    with slipbench.open(path) as dataset:
        try:
            return gathered(grasp_of(trial) for trial in dataset.values())
        except InputError as error:
            raise InputError(f"{path}: {error}") from error


def run_grasps(draws: int, options: Options) -> Grasps:
    """Simulates grasps of SCENE.

    Args:
        draws: draws in each of its nine cells; 0: as in the scene
        options: seed, jobs, progress output

    Returns:
        all grasps

    Raises:
        InputError: as run_grid()
    """

    def reduced(_: Cell, trial: Trial) -> Grasp:
        return grasp_of(trial)

    return gathered(run_grid([Cell("grasps", SCENE, draws=draws)], options, reduced)[0])


def levelled(grasps: Grasps) -> Grasps:
    """Standardises each count.

    Subtracts the mean over the grasps with that palm, and divides by their standard deviation.

    The result does not depend on the individual fingers of a set.

    Args:
        grasps: with any palms

    Returns:
        the grasps with standardised counts; the divisor is max(1 count, standard deviation)
    """
    counts = grasps.counts.astype(float)
    for palm in np.unique(grasps.palm):
        of_palm = counts[grasps.palm == palm]
        sd = of_palm.std(axis=0, ddof=1) if len(of_palm) > 1 else np.ones(of_palm.shape[1:])
        counts[grasps.palm == palm] = (of_palm - of_palm.mean(axis=0)) / np.maximum(1.0, sd)
    return replace(grasps, counts=counts.astype(np.float32))


def as_list(counts: Floats) -> Floats:
    """Counts [N, fingers, electrodes] as frames [N, 1, fingers x electrodes]."""
    return counts.reshape(len(counts), 1, -1)


def as_image(counts: Floats, layout: Layout) -> Floats:
    """Counts [N, fingers, electrodes] as images: frames [N, 1, fingers x rows x columns]."""
    return as_list(image_of(counts, layout))


def image_of(counts: Floats, layout: Layout) -> Floats:
    """Counts [..., electrodes] as the pixels [..., rows x columns] of an image."""
    return np.stack(
        [counts[..., pixel].mean(axis=-1, dtype=np.float32) for pixel in pixels_of(layout)], axis=-1
    )


def as_graph(counts: Floats) -> Floats:
    """Counts [N, fingers, electrodes] as nodes: frames [N, 1, electrodes x fingers]."""
    return as_list(counts.swapaxes(1, 2))


def graph_of(k: int) -> NDArray[np.float64]:
    """The adjacency of a graph of the electrodes.

    Args:
        k: number of neighbours, 1 to 23: a node is the mean of itself and its k nearest by the
            electrodes' positions on the core, directed as in the paper; 0: the hand-drawn graph

    Returns:
        [electrodes, electrodes]
    """
    if k == 0:
        return array_of(drawn_graph()).astype(float)
    places = _core.biotac_electrode_places()
    distance = ((places[:, None] - places[None]) ** 2).sum(axis=2)
    nearest = np.argsort(distance, axis=1, kind="stable")[:, : k + 1]
    adjacency = np.zeros((ELECTRODES, ELECTRODES))
    np.put_along_axis(adjacency, nearest, 1.0 / (k + 1), axis=1)
    return adjacency
