"""A network of one's own.

Trained on simulated grasps, written as a detector, and run in a grasp's loop.
"""

import argparse

import numpy as np
import slipbench
import torch
from slipbench import learning
from torch import nn


class Memory(nn.Module):
    """Two dense layers and an LSTM.

    Frames [N, T, inputs] to logits [N, T, classes], with the loop's state.
    """

    def __init__(self, inputs, classes):
        super().__init__()
        self.first = nn.Sequential(nn.Linear(inputs, 32), nn.ReLU())
        self.memory = nn.LSTM(32, 32, batch_first=True)
        self.last = nn.Linear(32, classes)

    def forward(self, frames, state=None):
        hidden, state = self.memory(self.first(frames), state)
        return self.last(hidden), state


options = argparse.ArgumentParser(description=__doc__)
options.add_argument(
    "--quick", action="store_true", help="few grasps and steps, to show how it is done"
)
quick = options.parse_args().quick

# Grasps for training, with the scene's split.
grasps = slipbench.Scene.load("grasp/learn.yaml").write("grasps.h5", draws=5 if quick else 40)[
    "files"
][0]

# The recipe defines input and training; the network is custom.
trained = learning.train(
    grasps,
    recipe="grasp_gru",
    network=Memory,
    steps=30 if quick else 600,
    alarms="20/min",
    output="memory.onnx",
    progress=lambda member, report: print(
        report.step, round(report.loss, 3), round(report.validation, 3)
    ),
)
print(trained.judged)

# The same file in the loop of a grasp.
lift = slipbench.Scene.load("grasp/lift.yaml").set(
    {
        "detector": {"type": "network", "model": "memory.onnx"},
        "friction.static": 0.2,
        "friction.kinetic": 0.19,
    }
)
trial = lift.run()
print(trial.outcome["detection"])

# The detector's input in that loop: its frames, scaled by the loop's code; and the network's output
# for each.
pad = trial.sensors["pad"]
channels = {name: array.shape[1:] for name, array in pad.channels.items()}
engine = learning.Engine("memory.onnx")
frames = learning.Frames(engine.description, pad.type, pad.rate, channels)
seen, samples = frames.all(pad.channels)
logits = engine.run(seen)
print(
    f"{len(samples)} frames of {frames.size} values, {logits.argmax(axis=1).mean():.0%} of them slip"
)

# Sample-by-sample evaluation gives the same.
frames.reset()
engine.reset()
first = next(
    frame
    for row in range(len(pad.channels["force"]))
    if (frame := frames.push({name: array[row] for name, array in pad.channels.items()}))
    is not None
)
assert engine.inputs == frames.size  # the network reads one frame per step
assert np.array_equal(first, seen[0]) and np.array_equal(engine.run(first[None]), logits[:1])
assert np.allclose(learning.answers(trained.networks[0], seen), logits, atol=1e-5)

# The parts of train(), for a custom training with, for example, a dropout of channels.
examples = learning.read_examples(
    [grasps], learning.find_recipe("grasp_gru").input, progress=lambda done, trials: None
)
offset, scale = learning.scale_of([one.features for one in examples.part("learns")], "standard")
data = {
    part: [((one.features - offset) * scale, one.labels) for one in examples.part(part)]
    for part in ("learns", "validates")
}


def drop_channels(clips, random):
    """Sets a tenth of the channels of each clip to zero."""
    return clips * (torch.rand(clips.shape[0], 1, clips.shape[2], generator=random) > 0.1)


network = Memory(examples.inputs, len(examples.classes))
training = learning.Training(
    steps=20, batch=16, clip=100, learning_rate=3e-3, validate_every=10, augment=drop_channels
)
print(
    learning.fit(network, data["learns"], data["validates"], training, classes=2, seed=1).validation
)
