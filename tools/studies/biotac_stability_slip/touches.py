"""Recordings of one BioTac SP in contact, real and synthetic: touch, sliding or turning.

Windows of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from slipbench import InputError, Trial
from slipbench.bin import _core
from slipbench.learning import MASKED, find_recipe
from slipbench.learning.biotac import ELECTRODES, IMAGES
from slipbench_studies.biotac_stability_slip.grasps import image_of
from slipbench_studies.biotac_stability_slip.validation import RECIPE, truth_of
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.network_training import Floats, Labels
from slipbench_studies.result import Options

SCENE = "scenes/biotac_sp/slip.yaml"
RANDOM_SITE_SCENE = "scenes/biotac_sp/slip_random_site.yaml"
DEVICES = (1, 2, 3)  # fingers of a synthetic set
CLASSES = ("t", "n", "e", "s", "w", "cw", "aw")


class Touch(NamedTuple):
    """A recording.

    Attributes:
        counts: [T, electrodes] counts, at 100 Hz
        label: [T] index into CLASSES; MASKED without contact
        object: the touched object
    """

    counts: Floats
    label: Labels
    object: str


def _touch_of(example: dict[str, Any]) -> Touch:
    return Touch(example["features"], example["labels"], example["object"])


def read_touches(path: str, options: Options) -> list[Touch]:
    """Reads the recordings of a dataset.

    It was imported from BioTacSP-DoS, or simulated from one of the scenes.

    Args:
        path: path of the dataset
        options: progress output

    Returns:
        one element per recording

    Raises:
        InputError: an invalid dataset
    """
    options.say(f"reading {path}")
    labels = "recorded" if truth_of(path) else "micro"
    text = find_recipe(RECIPE).input.text()
    examples = _core.read_examples(
        [path], text, labels, "direction", "", 0, 0, 1, "", 0.0, False, None
    )["examples"]
    for example in examples:
        if not example["object"]:
            raise InputError(
                f"{path}: trial {example['trial']} names no object; allowed: recordings of {SCENE}, or of "
                "BioTacSP-DoS as `slipbench import --format biotacsp-dos` has read them"
            )
    return [_touch_of(example) for example in examples]


def run_touches(scene: str, draws: int, options: Options) -> list[Touch]:
    """Simulates recordings of a scene.

    Args:
        scene: SCENE or RANDOM_SITE_SCENE
        draws: draws in each of its cells with each of DEVICES
        options: seed, jobs, progress output

    Returns:
        one element per recording

    Raises:
        InputError: as run_grid()
    """
    text = find_recipe(RECIPE).input.text()

    def reduced(_: Cell, trial: Trial) -> Touch:
        return _touch_of(
            _core.example_of(
                trial._simulated, next(iter(trial.sensors)), text, "micro", "direction", 0
            )
        )

    name = "recordings" if scene == SCENE else "recordings, random site"
    return run_grid(
        [Cell(name, scene, {"sweep.sensors.pad.device_number": str(list(DEVICES))}, draws)],
        options,
        reduced,
    )[0]


@dataclass(frozen=True)
class Window:
    """A window of a recording.

    Attributes:
        rows: rows per window
        stride: rows between the starts of successive windows
        site: True: the level of each electrode is kept, which shows the contact's position; False:
            its mean over the window is subtracted
        image: name of the image of IMAGES that represents a row; empty: the electrodes
        figures: one row of figures instead of the rows: "by_electrode" (24 standard deviations,
            counts, and 24 slopes of the linear fit through the rows, counts per row), "sorted" (the
            standard deviations, ascending) or empty
    """

    rows: int = 5
    stride: int = 5
    site: bool = True
    image: str = ""
    figures: str = ""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows of an example, and values of a row."""
        if self.figures:
            return 1, ELECTRODES * (2 if self.figures == "by_electrode" else 1)
        (rows, columns), _ = IMAGES[self.image] if self.image else ((1, ELECTRODES), ())
        return self.rows, rows * columns


def windows_of(touch: Touch, window: Window) -> tuple[Floats, Labels]:
    """The windows of a recording with contact throughout.

    Args:
        touch: the recording
        window: definition of the windows

    Returns:
        features [W, *window.shape], and the class of each window's last row [W]
    """
    if len(touch.label) < window.rows:
        return np.zeros((0, *window.shape), np.float32), np.zeros(0, np.uint8)
    labels = sliding_window_view(touch.label, window.rows)[:: window.stride]
    touches = (labels != MASKED).all(axis=1)
    counts = sliding_window_view(touch.counts, window.rows, axis=0)[:: window.stride][
        touches
    ].swapaxes(1, 2)
    if not window.site:
        counts = (counts - counts.mean(axis=1, keepdims=True, dtype=float)).astype(np.float32)
    if window.figures:
        counts = _figures(counts, window.figures)
    elif window.image:
        counts = image_of(counts, IMAGES[window.image])
    return np.ascontiguousarray(counts), labels[touches, -1]


def _figures(counts: NDArray[Any], figures: str) -> Floats:
    """[W, rows, electrodes] to [W, 1, values]."""
    rows = counts.shape[1]
    time = np.arange(rows) - 0.5 * (rows - 1)
    off = counts - counts.mean(axis=1, keepdims=True, dtype=float)
    deviations = counts.std(axis=1, ddof=1, dtype=float)
    if figures == "sorted":
        return np.sort(deviations.astype(np.float32), axis=1)[:, None]
    slopes = np.einsum("wte,t->we", off, time) / (time**2).sum()
    return np.concatenate([deviations, slopes], axis=1).astype(np.float32)[:, None]
