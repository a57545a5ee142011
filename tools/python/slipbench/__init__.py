"""slipbench: a physics testbench for tactile slip detection.

A scene is a YAML file. `Scene.load()` reads one, `Scene.run()` simulates a trial of it and gives numpy arrays, `open()` reads a dataset file.
Detectors and controllers may be classes of one's own (`detector()`, `controller()`); a grasp is a Gymnasium environment (`slipbench.gym`).

Units are SI throughout. Bad input raises `InputError` with the program's own message: file:line, what was found, what is allowed.
"""

from slipbench.bin._core import InputError, __version__
from slipbench._data import Dataset, Windows, open
from slipbench._own import Command, Estimate, Frame, Slip, Source, State, command_of, controller, detector, estimate_of
from slipbench._scene import Check, Scene, Sweep, describe, evaluate, list_names, scenes
from slipbench._trial import Control, Labels, Sensor, Trial

__all__ = [
    "Check", "Command", "Control", "Dataset", "Estimate", "Frame", "InputError", "Labels", "Scene", "Sensor", "Slip", "Source", "State", "Sweep",
    "Trial", "Windows", "__version__", "command_of", "controller", "describe", "detector", "estimate_of", "evaluate", "list_names", "open",
    "scenes",
]
