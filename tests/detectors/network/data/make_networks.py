"""Writes mlp13.onnx, gru21.onnx, unit13.onnx and unit13_biotac.onnx next to this file.

The networks are made as by a user, with the `onnx` package of PyPI. Their weights are weight(i) in
order, which networks.h repeats.
"""

import json
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

HERE = Path(__file__).parent


def weights(name, shape, first):
    count = int(np.prod(shape))
    values = [((7 * i) % 11 - 5) / 8 for i in range(first, first + count)]
    return numpy_helper.from_array(np.array(values, dtype=np.float32).reshape(shape), name)


def real(name, shape):
    return helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)


def write(name, graph, opset, ir_version, about):
    model = helper.make_model(
        graph, opset_imports=[helper.make_opsetid("", opset)], ir_version=ir_version
    )
    entry = model.metadata_props.add()
    entry.key, entry.value = "slipbench", json.dumps(about)
    onnx.checker.check_model(model, full_check=True)
    onnx.save(model, HERE / name)


classes = [{"name": "hold", "state": "non_slip"}, {"name": "slip", "state": "gross"}]
force = {
    "sensor": "papillarray",
    "rate": 1000,
    "channels": [{"name": "force", "values": [0, 1, 2]}],
}

# Two frames of three values -> 4, ReLU -> 2 logits.
write(
    "mlp13.onnx",
    helper.make_graph(
        [
            helper.make_node("Flatten", ["frames"], ["flat"]),
            helper.make_node("Gemm", ["flat", "W1", "B1"], ["hidden"], transB=1),
            helper.make_node("Relu", ["hidden"], ["relu"]),
            helper.make_node("Gemm", ["relu", "W2", "B2"], ["logits"], transB=1),
        ],
        "mlp",
        [real("frames", ["N", 2, 3])],
        [real("logits", ["N", 2])],
        [
            weights("W1", [4, 6], 0),
            weights("B1", [4], 24),
            weights("W2", [2, 4], 28),
            weights("B2", [2], 36),
        ],
    ),
    13,
    7,
    {
        "format": 1,
        "input": force | {"stride": 5, "history": 2, "offset": [0.5], "scale": [2.0]},
        "classes": classes,
    },
)

# A frame of three values -> GRU of 2 as PyTorch has it (linear_before_reset), its state carried ->
# 2 probabilities.
write(
    "gru21.onnx",
    helper.make_graph(
        [
            helper.make_node("Unsqueeze", ["frame", "zero"], ["sequence"]),
            helper.make_node(
                "GRU",
                ["sequence", "W", "R", "B", "", "h"],
                ["", "h_next"],
                hidden_size=2,
                linear_before_reset=1,
            ),
            helper.make_node("Squeeze", ["h_next", "zero"], ["hidden"]),
            helper.make_node("Gemm", ["hidden", "W2", "B2"], ["logits"], transB=1),
            helper.make_node("Softmax", ["logits"], ["probabilities"], axis=-1),
        ],
        "gru",
        [real("frame", ["N", 3]), real("h", [1, "N", 2])],
        [real("probabilities", ["N", 2]), real("h_next", [1, "N", 2])],
        [
            weights("W", [1, 6, 3], 0),
            weights("R", [1, 6, 2], 18),
            weights("B", [1, 12], 30),
            weights("W2", [2, 2], 42),
            weights("B2", [2], 46),
            numpy_helper.from_array(np.array([0], dtype=np.int64), "zero"),
        ],
    ),
    21,
    10,
    {
        "format": 1,
        "input": force,
        "states": [{"input": "h", "output": "h_next"}],
        "output": "probabilities",
        "classes": classes,
        "threshold": 0.6,
    },
)


def write_unit(name, about):
    """A frame x -> x/|x|, which is no number where x is zero -> 2 logits."""
    values = len(about["channels"][0]["values"])
    write(
        name,
        helper.make_graph(
            [
                helper.make_node("Flatten", ["frame"], ["flat"]),
                helper.make_node("ReduceL2", ["flat"], ["length"], axes=[1], keepdims=1),
                helper.make_node("Div", ["flat", "length"], ["direction"]),
                helper.make_node("Gemm", ["direction", "W", "B"], ["logits"], transB=1),
            ],
            "unit",
            [real("frame", ["N", values])],
            [real("logits", ["N", 2])],
            [weights("W", [2, values], 0), weights("B", [2], 2 * values)],
        ),
        13,
        7,
        {"format": 1, "input": about, "classes": classes},
    )


write_unit("unit13.onnx", force)
electrodes = {"name": "electrodes", "values": list(range(24))}
write_unit("unit13_biotac.onnx", {"sensor": "biotac_sp", "rate": 100, "channels": [electrodes]})
