"""Imports PyTorch, or reports how to install it."""

import contextlib
import importlib.util
import io
import sys
import warnings

try:
    # Debian 12's PyTorch does not support numpy 2 and prints a long warning once. It is irrelevant
    # here: arrays are converted by DLPack.
    with warnings.catch_warnings(), contextlib.redirect_stderr(io.StringIO()):
        warnings.filterwarnings("ignore", message="Failed to initialize NumPy")
        import torch as torch

        torch.tensor([0.0])  # initialises numpy support
except ModuleNotFoundError as error:
    if error.name != "torch":
        raise
    raise ModuleNotFoundError(
        f"training of networks needs PyTorch, which {sys.executable} does not have; install it: pip install torch onnx, or on Debian: apt install python3-torch "
        "python3-onnx libopenblas0-serial, for a Python that sees /usr/lib/python3/dist-packages, such as build/venv of ./slipbench test",
        name="torch",
    ) from None

# Its exporter needs onnx from version 2.
if int(torch.__version__.split(".")[0]) >= 2 and importlib.util.find_spec("onnx") is None:
    raise ModuleNotFoundError(
        f"training of networks with PyTorch {torch.__version__} needs the package onnx, which {sys.executable} does not have; "
        "install it: pip install onnx, or on Debian: apt install python3-onnx",
        name="onnx",
    )
