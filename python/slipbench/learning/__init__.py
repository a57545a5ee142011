"""Training of slip detection networks in PyTorch.

`train()` trains a detector on a dataset and writes one ONNX file, which a scene can name.

A recipe (`RECIPES`) defines a network's input, training data and training. `networks` has the
published networks; a custom module replaces them by `train(..., network=...)`. `Frames` converts a
sensor's samples to frames by the loop's code, `Engine` runs a written file as the loop does.

It needs PyTorch 1.13 or later, which is not a requirement of the package.
"""

from slipbench.learning import _torch as _torch  # first: reports a missing PyTorch
from slipbench.learning._export import check_engine, write_detector
from slipbench.learning._fit import (
    MASKED,
    Checkpoint,
    Clips,
    Fitted,
    Report,
    Training,
    answers,
    balanced_accuracy,
    fit,
)
from slipbench.learning._input import (
    Engine,
    Example,
    Examples,
    Frames,
    Input,
    describe_file,
    read_examples,
)
from slipbench.learning._training import Trained, scale_of, train
from slipbench.learning.recipes import RECIPES, Recipe, find_recipe

__all__ = [
    "Checkpoint",
    "Clips",
    "Engine",
    "Example",
    "Examples",
    "Fitted",
    "Frames",
    "Input",
    "MASKED",
    "RECIPES",
    "Recipe",
    "Report",
    "Trained",
    "Training",
    "answers",
    "balanced_accuracy",
    "check_engine",
    "describe_file",
    "find_recipe",
    "fit",
    "read_examples",
    "scale_of",
    "train",
    "write_detector",
]
