"""slipbench: a physics testbench for tactile slip detection.

A scene is a YAML file. `Scene.load()` reads a scene, `Scene.run()` simulates one of its trials and
returns numpy arrays, `open()` reads a dataset file. Sensors, detectors and controllers may be
Python classes (`sensor()`, `detector()`, `controller()`); a grasp is a Gymnasium environment
(`slipbench.gym`).

Units are SI throughout. Bad input raises `InputError` with the program's message: file:line, what
was found, what is allowed.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from slipbench._commands import PathLike, export, import_recordings, merge, report, verify
from slipbench._data import (
    Arrays,
    Dataset,
    StoredBody,
    StoredControl,
    StoredLabels,
    StoredSensor,
    StoredTrial,
    Windows,
    open,
)
from slipbench._detect import detect
from slipbench._own import (
    Command,
    Controller,
    Detector,
    Estimate,
    Frame,
    Layout,
    OwnSensor,
    SensorSource,
    Slip,
    Source,
    State,
    controller,
    detector,
    sensor,
)
from slipbench._scene import Check, Scene, Sweep, describe, evaluate, list_names, scenes
from slipbench._trial import Body, Contact, Control, Labels, Sensor, Trial
from slipbench._values import RandomStream, parse_quantity
from slipbench.bin._core import InputError
from slipbench.bin._core import version as __version__

if TYPE_CHECKING:
    from slipbench.learning import Recipe, Trained

__all__ = [
    "Arrays",
    "Body",
    "Check",
    "Command",
    "Contact",
    "Control",
    "Controller",
    "Dataset",
    "Detector",
    "Estimate",
    "Frame",
    "InputError",
    "Labels",
    "Layout",
    "OwnSensor",
    "RandomStream",
    "Scene",
    "Sensor",
    "SensorSource",
    "Slip",
    "Source",
    "State",
    "StoredBody",
    "StoredControl",
    "StoredLabels",
    "StoredSensor",
    "StoredTrial",
    "Sweep",
    "Trial",
    "Windows",
    "__version__",
    "controller",
    "describe",
    "detect",
    "detector",
    "evaluate",
    "export",
    "import_recordings",
    "list_names",
    "merge",
    "open",
    "parse_quantity",
    "report",
    "scenes",
    "sensor",
    "train",
    "verify",
]


def train(
    dataset: PathLike | Sequence[PathLike],
    *,
    output: PathLike,
    recipe: str | Recipe = "slip_gru",
    **options: Any,
) -> Trained:
    """Trains a slip detector on datasets and writes its ONNX file.

    `slipbench.learning.train()`, which needs PyTorch.

    Args:
        dataset: path of a dataset, or several
        output: path of the file, which ends with .onnx
        recipe: name of a recipe (`slipbench.learning.RECIPES`), or a custom recipe
        options: further arguments of `slipbench.learning.train()`: network, sensor, labels, split,
            held_out, every_trial, seed, steps, turned, alarms, by_score, specificity, resume,
            log, progress, reading, before_step

    Returns:
        The trained detector: path, networks, description and figures.

    Raises:
        InputError: as `slipbench.learning.train()`
        ModuleNotFoundError: PyTorch is not installed; the message says how to install it
    """
    from slipbench import learning  # loads PyTorch, which the rest of the package does not need

    return learning.train(dataset, output=output, recipe=recipe, **options)
