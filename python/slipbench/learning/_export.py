"""The file of a detector: the ONNX graph of one step, with a description in its metadata."""

# PyTorch's layers and operators are typed only in part, depending on the release.
# mypy: disable-error-code="no-untyped-call,no-any-return,attr-defined,unused-ignore"

from __future__ import annotations

import json
import os
import tempfile
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from slipbench._output import NewFiles, partial_path
from slipbench.bin import _core
from slipbench.learning._fit import Floats, answers, array_of, history_of, reproducible, tensor_of
from slipbench.learning._input import Engine

METADATA_KEY = b"slipbench"
TOLERANCE = 1e-5  # between the engine and PyTorch, relative to the larger of 1 and the value


class _Step(nn.Module):
    """One step of networks with averaged probabilities, with flat inputs, as a loop calls it."""

    def __init__(self, members: Sequence[nn.Module], inputs: int) -> None:
        super().__init__()
        self.members = nn.ModuleList(members)
        self.history, self.inputs = history_of(members[0]), inputs
        self.zeros: list[tuple[Tensor, ...]] = []  # state of each member before the first step
        for member in members:
            answer = member(torch.zeros(1, self.history, inputs))
            state = answer[1] if isinstance(answer, tuple) else ()
            self.zeros.append(
                tuple(
                    torch.zeros_like(one)
                    for one in ((state,) if isinstance(state, Tensor) else state)
                )
            )
        self.single = [
            isinstance(member(torch.zeros(1, self.history, inputs))[1], Tensor)
            if self.zeros[i]
            else False
            for i, member in enumerate(members)
        ]

    def forward(self, frames: Tensor, *state: Tensor) -> tuple[Tensor, ...]:
        """[1, history x inputs] and all states to [1, classes] and all next states."""
        clip = frames.reshape(1, self.history, self.inputs)
        outputs, after, place = [], [], 0
        for member, zeros, single in zip(self.members, self.zeros, self.single, strict=True):
            if not zeros:
                logits = member(clip)
            else:
                own = state[place : place + len(zeros)]
                place += len(zeros)
                logits, following = member(clip, own[0] if single else own)
                after += [following] if single else list(following)
            outputs.append(logits[:, -1])
        if len(outputs) == 1:
            return (outputs[0], *after)
        return (torch.stack([torch.softmax(one, 1) for one in outputs]).mean(0), *after)


def _varint(value: int) -> bytes:
    data = b""
    while value > 127:
        data, value = data + bytes([value & 127 | 128]), value >> 7
    return data + bytes([value])


def _entry(key: int, value: bytes) -> bytes:
    """A length-delimited field of a protobuf message."""
    return _varint(key << 3 | 2) + _varint(len(value)) + value


def with_metadata(model: bytes, text: str) -> bytes:
    """Adds a description to an ONNX file.

    Fields may be appended to a protobuf message; 14 is ModelProto.metadata_props, with key 1 and
    value 2.
    """
    return model + _entry(14, _entry(1, METADATA_KEY) + _entry(2, text.encode()))


def is_detector(data: bytes) -> bool:
    """True if the bytes of a file are an ONNX model with a description."""
    return data[:1] == b"\x08" and _entry(1, METADATA_KEY) in data


def onnx_bytes(members: Sequence[nn.Module], inputs: int, description: dict[str, Any]) -> bytes:
    """The file of a detector.

    Args:
        members: trained networks; the probabilities of several are averaged
        inputs: values per frame
        description: from describe_file(); states, output and history are filled in

    Returns:
        Its bytes: input "frames" [1, history x inputs], output "output" [1, classes], states
        "state_k" and "state_k_next".

    Raises:
        InputError: the description does not fit
    """
    for member in members:
        member.eval()
    with reproducible(1), torch.no_grad(), warnings.catch_warnings():
        warnings.simplefilter(
            "ignore"
        )  # the exporter warns of a fixed batch size, which a step needs
        step = _Step(members, inputs).eval()
        zeros = [one for of_member in step.zeros for one in of_member]
        names = [f"state_{i}" for i in range(len(zeros))]
        newest: dict[str, Any] = (
            {"dynamo": False} if int(torch.__version__.split(".")[0]) >= 2 else {}
        )
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "network.onnx"
            torch.onnx.export(
                step,
                (torch.zeros(1, step.history * inputs), *zeros),
                str(file),
                opset_version=13,
                input_names=["frames", *names],
                output_names=["output", *(f"{name}_next" for name in names)],
                **newest,
            )
            exported = file.read_bytes()
    whole = dict(description)
    whole["input"] = dict(whole["input"], history=step.history)
    whole["states"] = [{"input": name, "output": f"{name}_next"} for name in names]
    whole["output"] = "logits" if len(members) == 1 else "probabilities"
    return with_metadata(
        exported, _core.normalised_description(json.dumps(whole), "the description")
    )


def mean_answers(members: Sequence[nn.Module], features: Floats) -> Floats:
    """Output of the file for a sequence: logits of one network, mean probabilities of several.

    [T - history + 1, classes]
    """
    logits = [answers(member, features) for member in members]
    if len(logits) == 1:
        return logits[0]
    mean: Floats = np.mean([array_of(torch.softmax(tensor_of(one), 1)) for one in logits], axis=0)
    return mean


def check_engine(path: str, members: Sequence[nn.Module], features: Floats) -> float:
    """Runs a file as a loop does, and compares it with PyTorch.

    Args:
        path: path of the file
        members: the networks in the file
        features: [T, inputs], scaled

    Returns:
        The greatest difference, relative to the larger of 1 and the value.

    Raises:
        RuntimeError: a difference of more than 1e-5
        InputError: the engine does not accept the file
    """
    history = history_of(members[0])
    steps = np.lib.stride_tricks.sliding_window_view(
        features, history, axis=0
    )  # [T', inputs, history]
    computed = Engine(path).run(
        np.ascontiguousarray(steps.transpose(0, 2, 1)).reshape(len(steps), -1)
    )
    expected = mean_answers(members, features)
    difference = float(np.max(np.abs(computed - expected) / np.maximum(1.0, np.abs(expected))))
    if not difference <= TOLERANCE:
        raise RuntimeError(
            f"{path}: differs from PyTorch by {difference:.2g}; allowed: {TOLERANCE}"
        )
    return difference


def write_detector(
    path: str | os.PathLike[str],
    members: Sequence[nn.Module],
    inputs: int,
    description: dict[str, Any],
    features: Floats | None = None,
) -> None:
    """Writes the file of a detector, which gets its name once the engine has accepted it.

    Args:
        path: path of the file, which ends in .onnx
        members: trained networks; the probabilities of several are averaged
        inputs: values per frame
        description: from describe_file(), with "offset" and "scale" in its input
        features: [T, inputs], scaled: a recording for comparing the engine with PyTorch; None: the
            engine only loads the file

    Raises:
        InputError: the file exists and is not a detector, or the engine does not accept it
    """
    check_output(path)
    target = Path(path)
    with NewFiles() as files:
        file = files.create(target)
        file.write(onnx_bytes(members, inputs, description))
        file.flush()
        if _core.engine_available():
            unchecked = str(partial_path(target))
            Engine(unchecked) if features is None else check_engine(unchecked, members, features)
        files.publish()


def check_output(path: str | os.PathLike[str]) -> None:
    """Raises InputError for a file that exists and is not a detector, and for a missing folder."""
    file = Path(path)
    if not file.parent.is_dir():
        raise _core.InputError(f"cannot write {file}: the folder {file.parent} does not exist")
    if (file.exists() or file.is_symlink()) and not (
        file.is_file() and not file.is_symlink() and is_detector(file.read_bytes())
    ):
        raise _core.InputError(
            f"cannot write {file}: {file} exists and is not a detector of slipbench; choose a new name, or a detector of "
            f"slipbench to replace"
        )
