"""Training of networks that detect slip, in PyTorch: `train()` makes a detector of a dataset, in one ONNX file that a scene can name.

A recipe (`RECIPES`) says what a network reads, what it is trained on and how. `networks` has the published networks; a module of your own takes their
place by `train(..., network=...)`. `Frames` makes frames of a sensor's samples by the code of the loop, `Engine` runs a written file as the loop does.

It needs PyTorch 1.13 or later, which is not among the package's requirements.
"""

from slipbench.learning import _torch as _torch  # first: it reports a missing PyTorch

from slipbench.learning._export import check_engine, write_detector
from slipbench.learning._fit import MASKED, Checkpoint, Clips, Fitted, Report, Training, answers, balanced_accuracy, fit
from slipbench.learning._input import Engine, Example, Examples, Frames, Input, describe_file, read_examples
from slipbench.learning._train import Trained, scale_of, train
from slipbench.learning.recipes import RECIPES, Recipe, find_recipe

__all__ = [
    "Checkpoint", "Clips", "Engine", "Example", "Examples", "Fitted", "Frames", "Input", "MASKED", "RECIPES", "Recipe", "Report", "Trained", "Training",
    "answers", "balanced_accuracy", "check_engine", "describe_file", "find_recipe", "fit", "read_examples", "scale_of", "train", "write_detector",
]
