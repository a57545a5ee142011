"""Gradient descent on the cross entropy of clips drawn from labelled sequences of frames."""

# PyTorch's layers and operators are typed only in part, depending on the release.
# mypy: disable-error-code="no-untyped-call,no-any-return,attr-defined,unused-ignore"

from __future__ import annotations

import copy
import hashlib
import io
import math
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from slipbench._output import write_whole
from slipbench._program import counted
from slipbench.bin import _core
from slipbench.learning._names import named

MASKED = 255  # label of a frame that is neither trained on nor judged
_IGNORED = -100  # the same for PyTorch's loss
_ANSWERS_AT_ONCE = (
    256  # of a network without state: convolving many windows at once takes much memory
)
_FRAMES_AT_ONCE = 4096
_DIVERGED = "the training diverged: use a lower learning rate (`Training.learning_rate`)"

Floats = NDArray[np.float32]
Labels = NDArray[np.uint8]
Sequences = Sequence[tuple[Floats, Labels]]
Augment = Callable[[Tensor, torch.Generator], Tensor]


@dataclass(frozen=True)
class Training:
    """Parameters of the training of a network.

    Attributes:
        steps: number of steps of gradient descent
        batch: clips per step
        clip: answers per clip, which has history - 1 frames more; a shorter sequence is a single
            clip
        learning_rate: at the first step
        final_rate: share of the learning rate at the last step; the rate decreases linearly
        optimiser: "adam" or "rmsprop" (decay 0.99)
        balance: "weights" (clips are drawn uniformly, and the loss of a class is weighted by the
            inverse of its share) or "drawing" (draws a class, then one of its frames, then the
            clip's position around it)
        label_smoothing: share of the target distributed equally over all classes
        validate_every: steps between validations; the last state is validated too
        patience: number of validations without improvement after which training ends; 0: never
        onset_frames: for a run of frames of a class other than 0, such as a slip: number of first
            frames that train, then each tenth; 0: all train
        augment: changes the scaled clips [B, T, inputs] of each step; it draws random numbers from
            the generator, so that a training can be repeated
    """

    steps: int = 1000
    batch: int = 32
    clip: int = 128
    learning_rate: float = 1e-3
    final_rate: float = 0.1
    optimiser: Literal["adam", "rmsprop"] = "adam"
    balance: Literal["weights", "drawing"] = "weights"
    label_smoothing: float = 0.0
    validate_every: int = 50
    patience: int = 0
    onset_frames: int = 0
    augment: Augment | None = None


@dataclass(frozen=True)
class Report:
    """State of a running training, after a validation.

    Attributes:
        step: steps done
        steps: maximum number of steps
        loss: mean since the last report
        validation: balanced accuracy; NaN: no validation data
        best: True if it is the best so far
        seconds: mean time per step since the last report
    """

    step: int
    steps: int
    loss: float
    validation: float
    best: bool
    seconds: float


@dataclass
class Fitted:
    """Result of fit().

    Attributes:
        losses: loss of every step
        best_step: step of the kept state
        validation: its balanced accuracy; NaN: no validation data
    """

    losses: list[float] = field(default_factory=list)
    best_step: int = 0
    validation: float = math.nan


@dataclass(frozen=True)
class Checkpoint:
    """File in which a training saves its state at each validation, for a continuation after a kill.

    Attributes:
        path: path of the file
        identity: identity of the data and of everything else that the weights depend on
        resume: True: continue from the file, if it exists; False: the file must not exist
    """

    path: str
    identity: str
    resume: bool = False


def tensor_of(array: NDArray[Any]) -> Tensor:
    """A numpy array as a tensor, without a copy if it is writable.

    Unlike torch.from_numpy it supports any pair of versions.
    """
    if not array.flags.writeable or not array.flags.c_contiguous:
        array = np.array(array)
    tensor: Tensor = torch.from_dlpack(array)
    return tensor


def array_of(tensor: Tensor) -> NDArray[Any]:
    """A tensor as a numpy array. Unlike Tensor.numpy() it supports any pair of versions."""
    return np.from_dlpack(tensor.detach().contiguous())  # type: ignore[arg-type]


def history_of(network: nn.Module) -> int:
    """Number of frames that an answer of a network depends on: its attribute `history`, else 1."""
    return int(getattr(network, "history", 1))


@contextmanager
def reproducible(seed: int) -> Iterator[None]:
    """Sets one thread and PyTorch's generator to `seed`, and restores both afterwards.

    The order of sums, and so the weights, are then the same everywhere.
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        with torch.random.fork_rng(devices=[]):
            torch.default_generator.manual_seed(seed)
            yield
    finally:
        torch.set_num_threads(threads)


def answers(network: nn.Module, features: Floats) -> Floats:
    """Logits of a sequence.

    Args:
        network: left in evaluation mode
        features: [T, inputs], scaled

    Returns:
        [T - history + 1, classes]
    """
    network.eval()
    with torch.no_grad():
        logits: Floats = array_of(_answers(network, tensor_of(features)[None])[0])
    return logits


def _answers(network: nn.Module, frames: Tensor) -> Tensor:
    """[N, T, inputs] to [N, T - history + 1, classes].

    A network without state processes windows in parts.
    """
    before = history_of(network) - 1
    if before == 0:
        return logits_of(network(frames))
    count = frames.shape[1] - before
    parts = [
        logits_of(network(frames[:, first : min(first + _ANSWERS_AT_ONCE, count) + before]))
        for first in range(0, count, _ANSWERS_AT_ONCE)
    ]
    return torch.cat(parts, 1)


def logits_of(answer: Any) -> Tensor:
    """The logits of a network's output, without its state."""
    logits: Tensor = answer[0] if isinstance(answer, tuple) else answer
    return logits


def balanced_accuracy(called: Sequence[Labels], labels: Sequence[Labels]) -> float:
    """Mean of the recalls of the classes that occur.

    Args:
        called: assigned class of each frame, one array per sequence
        labels: true class of each frame, or MASKED

    Returns:
        0 to 1; NaN without frames.
    """
    truth = np.concatenate(list(labels)) if len(labels) else np.zeros(0, np.uint8)
    classified = np.concatenate(list(called)) if len(called) else truth
    recalls = [
        float(np.mean(classified[truth == one] == one)) for one in np.unique(truth[truth != MASKED])
    ]
    return float(np.mean(recalls)) if recalls else math.nan


def answers_to_all(network: nn.Module, sequences: Sequence[Floats]) -> list[Floats]:
    """Logits of sequences. Consecutive sequences of equal length are evaluated together.

    Args:
        network: left in evaluation mode
        sequences: [T, inputs] each, scaled

    Returns:
        [T - history + 1, classes] of each
    """
    network.eval()
    before = history_of(network) - 1
    at_once = _FRAMES_AT_ONCE if before == 0 else _ANSWERS_AT_ONCE
    logits: list[Floats] = []
    first = 0
    while first < len(sequences):
        length = len(sequences[first])
        last = first + 1
        while (
            last < len(sequences)
            and len(sequences[last]) == length
            and (last - first + 1) * (length - before) <= at_once
        ):
            last += 1
        with torch.no_grad():
            logits += list(array_of(_answers(network, tensor_of(np.stack(sequences[first:last])))))
        first = last
    return logits


def _validate(network: nn.Module, sequences: Sequences) -> float:
    """Balanced accuracy of the network."""
    called = [
        logits.argmax(1).astype(np.uint8)
        for logits in answers_to_all(network, [features for features, _ in sequences])
    ]
    before = history_of(network) - 1
    return balanced_accuracy(called, [labels[before:] for _, labels in sequences])


class Clips:
    """Draws clips from sequences.

    Raises:
        InputError: a sequence is shorter than an answer's history, or a class has no frame for
            training
    """

    def __init__(
        self, sequences: Sequences, training: Training, history: int, classes: int
    ) -> None:
        self._training, self._before = training, history - 1
        lengths = np.array([len(labels) for _, labels in sequences])
        if len(lengths) == 0 or lengths.min() <= self._before:
            raise _core.InputError(
                f"a sequence has {counted(int(lengths.min()) if len(lengths) else 0, 'frame')}; an answer needs {history} or more"
            )
        self._features = np.concatenate([features for features, _ in sequences])
        trained = [_thinned(labels, training.onset_frames) for _, labels in sequences]
        self._labels = np.concatenate(trained).astype(np.int64)
        self._labels[self._labels == MASKED] = _IGNORED
        self._start = np.concatenate(([0], np.cumsum(lengths)))
        self._answers = min(training.clip, int(lengths.max()) - self._before)
        # The frames with an answer, by class.
        place = np.concatenate([np.arange(length) for length in lengths])
        of_class = [
            np.flatnonzero((self._labels == one) & (place >= self._before))
            for one in range(classes)
        ]
        self._count = np.array([len(frames) for frames in of_class])
        if 0 in self._count:
            raise _core.InputError(
                f"a class has no frame to train on: {self._count.tolist()}; training needs frames of every class"
            )
        self._by_class, self._first_of_class = (
            np.concatenate(of_class),
            np.cumsum(self._count) - self._count,
        )

    def weights(self) -> Tensor:
        """Inverse share of each class; all 1 if classes are drawn."""
        if self._training.balance == "drawing":
            return torch.ones(len(self._count))
        return tensor_of((self._count.sum() / (len(self._count) * self._count)).astype(np.float32))

    def draw(self, seed: int, step: int) -> tuple[Tensor, Tensor]:
        """The clips of a step, independent of earlier draws.

        Features [B, T, inputs] and classes [B, T - history + 1].

        A sequence shorter than a clip is padded with its last frame, masked. The same `seed` and
        `step` give the same clips.
        """
        random = np.random.default_rng((seed, step))
        if self._training.balance == "drawing":
            which = random.integers(len(self._count), size=self._training.batch)
            wanted = self._by_class[
                self._first_of_class[which] + random.integers(self._count[which])
            ]
            sequence = np.searchsorted(self._start, wanted, side="right") - 1
            answer, latest = wanted - self._start[sequence] - self._before, self._latest(sequence)
            end = np.minimum(answer, latest)
            first = random.integers(
                np.minimum(np.maximum(answer + 1 - self._answers, 0), end), end, endpoint=True
            )
        else:
            sequence = random.integers(len(self._start) - 1, size=self._training.batch)
            first = random.integers(self._latest(sequence), endpoint=True)
        frames = (
            self._start[sequence][:, None]
            + first[:, None]
            + np.arange(self._answers + self._before)
        )
        last = self._start[sequence + 1][:, None] - 1
        classes = np.where(frames <= last, self._labels[np.minimum(frames, last)], _IGNORED)[
            :, self._before :
        ]
        return tensor_of(self._features[np.minimum(frames, last)]), tensor_of(classes)

    def _latest(self, sequence: NDArray[np.intp]) -> NDArray[np.intp]:
        """The last possible first frame of a clip in each sequence."""
        latest: NDArray[np.intp] = np.maximum(
            self._start[sequence + 1] - self._start[sequence] - self._before - self._answers, 0
        )
        return latest


def _thinned(labels: Labels, onset_frames: int) -> Labels:
    """Labels in which long runs of a class other than 0 are thinned.

    They keep their first frames and then each tenth.
    """
    if onset_frames == 0:
        return labels
    begins = np.flatnonzero(np.concatenate(([True], labels[1:] != labels[:-1])))
    run = (
        np.arange(len(labels))
        - np.repeat(begins, np.diff(np.concatenate((begins, [len(labels)]))))
        + 1
    )
    return np.where((labels > 0) & (run > onset_frames) & (run % 10 != 0), MASKED, labels).astype(
        np.uint8
    )


def fit(
    network: nn.Module,
    train: Sequences,
    validate: Sequences,
    training: Training,
    *,
    classes: int,
    seed: int = 1,
    checkpoint: Checkpoint | None = None,
    before_step: Callable[[], None] | None = None,
    report: Callable[[Report], None] | None = None,
) -> Fitted:
    """Trains a network in place.

    Keeps the validated state with the greatest balanced accuracy, the earliest of equals; the last
    state if `validate` is empty. The same seed, data and machine give the same weights, also across
    a checkpoint.

    Args:
        network: maps clips [N, T, inputs] to logits [N, T - history + 1, classes], or returns
            (logits, state)
        train: features [T, inputs], scaled, and labels [T] of each sequence
        validate: likewise, for validation
        training: parameters of the training
        classes: number of classes
        seed: seed of the draws of clips; the caller initialises the weights
        checkpoint: None: nothing is saved
        before_step: may raise, which ends the training with the state saved at the last validation
        report: called after every validation

    Raises:
        InputError: sequences that do not fit, a loss or weight that is not finite, a checkpoint
            that is damaged or belongs to another training, or a checkpoint that exists although
            `resume` is False
    """
    with reproducible(seed):
        clips = Clips(train, training, history_of(network), classes)
        work = _Work(network, clips, validate, training, seed, checkpoint)
        _run(work, before_step, report)
        return work.finish()


class _Work:
    """A training in progress.

    Attributes:
        done: losses and best step so far
        worse: validations since the best one
    """

    def __init__(
        self,
        network: nn.Module,
        clips: Clips,
        validate: Sequences,
        training: Training,
        seed: int,
        checkpoint: Checkpoint | None,
    ) -> None:
        self.done, self.worse = Fitted(), 0
        self._network, self._clips, self._validate = network, clips, validate
        self._training, self._seed, self._checkpoint = training, seed, checkpoint
        self._loss_of = nn.CrossEntropyLoss(
            weight=clips.weights(), ignore_index=_IGNORED, label_smoothing=training.label_smoothing
        )
        self._optimiser = (
            torch.optim.Adam if training.optimiser == "adam" else torch.optim.RMSprop
        )(network.parameters(), lr=training.learning_rate)
        self._best = copy.deepcopy(network.state_dict())
        if checkpoint is not None and os.path.exists(checkpoint.path):
            self._best, self.worse = _load(checkpoint, network, self._optimiser, self.done)

    @property
    def step(self) -> int:
        """Number of steps so far."""
        return len(self.done.losses)

    @property
    def out_of_patience(self) -> bool:
        """True after `patience` validations without an improvement."""
        return 0 < self._training.patience <= self.worse

    @property
    def ended(self) -> bool:
        """True if no step follows."""
        return self.step >= self._training.steps or self.out_of_patience

    @property
    def last_step(self) -> int:
        """Number of steps after which the training ends, as far as it is known."""
        return self.step if self.out_of_patience else self._training.steps

    @property
    def due(self) -> bool:
        """True if a validation follows the last step."""
        every = max(self._training.validate_every, 1)
        return self.step % every == 0 or self.step == self._training.steps

    def take_step(self) -> None:
        """Draws clips and changes the weights. Raises InputError for a loss that is not finite."""
        training, step = self._training, self.step
        for group in self._optimiser.param_groups:
            group["lr"] = training.learning_rate * (
                1 - (1 - training.final_rate) * step / training.steps
            )
        features, labels = self._clips.draw(self._seed, step)
        # For layers such as dropout, so that a resumed training repeats them. torch.manual_seed()
        # would also queue a call with a stack trace for CUDA.
        torch.default_generator.manual_seed(_step_seed(self._seed, step))
        if training.augment is not None:
            features = training.augment(
                features, torch.Generator().manual_seed(_step_seed(self._seed, step))
            )
        self._network.train()
        loss = self._loss_of(logits_of(self._network(features)).flatten(0, 1), labels.flatten())
        self.done.losses.append(loss.item())
        if not math.isfinite(self.done.losses[-1]):
            raise _core.InputError(f"step {self.step}: the loss is not finite; {_DIVERGED}")
        self._optimiser.zero_grad(set_to_none=True)
        loss.backward()
        self._optimiser.step()

    def validate(self) -> float:
        """Validates the network, keeps it if it is the best one, and saves the checkpoint.

        Returns:
            Its balanced accuracy; NaN without data for validation.

        Raises:
            InputError: a weight is not finite
        """
        # The last update may overflow although the loss before was finite.
        if not all(bool(torch.isfinite(one).all()) for one in self._network.parameters()):
            raise _core.InputError(f"step {self.step}: a weight is not finite; {_DIVERGED}")
        done, judged = self.done, len(self._validate) > 0
        validation = _validate(self._network, self._validate) if judged else math.nan
        if not judged or math.isnan(done.validation) or validation > done.validation:
            self._best, self.worse = copy.deepcopy(self._network.state_dict()), 0
            done.best_step, done.validation = self.step, validation
        else:
            self.worse += 1
        if self._checkpoint is not None:
            _save(self._checkpoint, self._network, self._optimiser, done, self._best, self.worse)
        return validation

    def finish(self) -> Fitted:
        """Gives the network its best weights."""
        self._network.load_state_dict(self._best)
        self._network.eval()
        return self.done


def _run(
    work: _Work,
    before_step: Callable[[], None] | None,
    report: Callable[[Report], None] | None,
) -> None:
    """Trains until the end. Arguments as for fit()."""
    reported, since = work.step, time.monotonic()
    while not work.ended:
        if before_step is not None:
            before_step()
        work.take_step()
        if not work.due:
            continue
        validation = work.validate()
        if report is not None:
            now = time.monotonic()
            report(
                Report(
                    work.step,
                    work.last_step,
                    float(np.mean(work.done.losses[reported:])),
                    validation,
                    work.worse == 0,
                    (now - since) / (work.step - reported),
                )
            )
            reported, since = work.step, now


def _step_seed(seed: int, step: int) -> int:
    return int(np.random.SeedSequence((seed, step, 1)).generate_state(1)[0])


def _save(
    checkpoint: Checkpoint,
    network: nn.Module,
    optimiser: torch.optim.Optimizer,
    done: Fitted,
    best: dict[str, Any],
    worse: int,
) -> None:
    """Saves the state.

    The file begins with the SHA-256 of its content: PyTorch does not detect changed bits.
    """
    whole = io.BytesIO()
    # PyTorch 1.13 cannot read plain floats without running code of the file: numbers are tensors,
    # and the optimiser's settings are set again at each step.
    figures = torch.tensor([*done.losses, done.validation], dtype=torch.float64)
    torch.save(
        {
            "identity": checkpoint.identity,
            "network": network.state_dict(),
            "best": best,
            "optimiser": optimiser.state_dict()["state"],
            "figures": figures,
            "best_step": done.best_step,
            "worse": worse,
        },
        whole,
    )
    write_whole(Path(checkpoint.path), hashlib.sha256(whole.getvalue()).digest() + whole.getvalue())


def _load(
    checkpoint: Checkpoint, network: nn.Module, optimiser: torch.optim.Optimizer, done: Fitted
) -> tuple[dict[str, Any], int]:
    path = checkpoint.path
    if not checkpoint.resume:
        raise _core.InputError(
            f"{path}: is the checkpoint of a training that did not finish; continue it with {named('resume', True)}, or delete the file"
        )
    data = Path(path).read_bytes()
    if hashlib.sha256(data[32:]).digest() != data[:32]:
        raise _core.InputError(
            f"{path}: is damaged, or is not a checkpoint of a training; delete the file, and train without {named('resume', True)}"
        )
    left = torch.load(io.BytesIO(data[32:]), weights_only=True)
    if left["identity"] != checkpoint.identity:
        raise _core.InputError(
            f"{path}: is of another training (data, recipe or options); repeat the arguments of that training, or delete the file and train "
            f"without {named('resume', True)}"
        )
    network.load_state_dict(left["network"])
    optimiser.load_state_dict(
        {"state": left["optimiser"], "param_groups": optimiser.state_dict()["param_groups"]}
    )
    *done.losses, done.validation = left["figures"].tolist()
    done.best_step = left["best_step"]
    return left["best"], left["worse"]
