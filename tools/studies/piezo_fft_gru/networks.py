"""Networks that are trained on recordings of the piezoelectric skin's bench, and how well they judge others."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipbench import InputError, RandomStream
from slipbench.learning import MASKED, Input, Training, find_recipe
from slipbench.learning._fit import history_of
from slipbench_studies.network_training import Floats, Labels, folds, train_and_answer, train_all
from slipbench_studies.piezo_fft_gru import SCENE
from slipbench_studies.piezo_fft_gru.bench import RULES, Recording, read_recordings, run_recordings
from slipbench_studies.result import Options
from slipbench_studies.statistics import mean_sd
from torch import nn

SOURCE = ('"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor". '
          "Cells are balanced accuracy in % and F1 of slip.")
PUBLISHED_RECORDINGS, USUAL_RECORDINGS = 3200, 200
FOLDS = 5
CLASSES = 2  # hold, slip
WITH_SLIP, MOTORS_ALONE = 0, 1  # groups of recordings
EPOCHS = 200  # published
SHOWN, KEPT = 0.8, 0.8  # shares: recordings that are trained on, and those of them that do not validate
# Its steps depend on the number of recordings.
PUBLISHED_TRAINING = Training(batch=32, clip=128, learning_rate=8e-4, optimiser="rmsprop")
SHORTCUTS = ("time", "contact", "motors", "kind")  # kind: whether the recording is of motors alone


@dataclass(frozen=True)
class Row:
    """A row of a table: a network, what it reads and what the paper prints of it.

    Attributes:
        name: in --only and in the figures
        text: in the tables
        network: makes the module from the number of values a frame and of classes
        training: of the usual size
        input: number in Recording.inputs
        told: those of SHORTCUTS that it reads in place of an input
        later: frames after the one that it judges, which it has seen
        f1: the paper's, 0 to 1; NaN: not published
        accuracy: the paper's, %; NaN: not published
    """

    name: str
    text: str
    network: Callable[[int, int], nn.Module]
    training: Training = Training()
    input: int = 0
    told: tuple[str, ...] = ()
    later: int = 0
    f1: float = math.nan
    accuracy: float = math.nan

    def features(self, recording: Recording) -> Floats:
        """[T, values] what the network reads of a recording, before frames are repeated at its ends."""
        if not self.told:
            return recording.inputs[self.input].features
        kind = np.full(len(recording.time), recording.motors_only)
        columns: dict[str, NDArray[Any]] = {
            "time": recording.time, "contact": recording.contact, "motors": recording.motors, "kind": kind
        }
        return np.stack([columns[one] for one in self.told], axis=1).astype(np.float32)

    def parameters(self, inputs: int) -> int:
        """The number of the network's weights, for so many values a frame."""
        return sum(one.numel() for one in self.network(inputs, CLASSES).parameters())

    def published(self) -> str:
        """The paper's figures as "98.7, 0.978"; "-" where it prints none."""
        return "-" if math.isnan(self.accuracy) else f"{self.accuracy:.1f}, {self.f1:.3f}"


def recipe_row(name: str, text: str, recipe: str, f1: float, accuracy: float) -> Row:
    """A row whose network and training are those of a recipe.

    Args:
        name: of the row
        text: in the tables
        recipe: its name
        f1: the paper's, 0 to 1
        accuracy: the paper's, %

    Returns:
        the row
    """
    published = find_recipe(recipe)
    return Row(name, text, published.network, published.training, f1=f1, accuracy=accuracy)


MLP_32 = recipe_row("mlp_32", "FFT, MLP 32", "piezo_mlp", 0.7913, 88.76)
GRU_32 = recipe_row("gru_32", "FFT, GRU 32", "piezo_fft_gru", 0.9781, 98.70)


@dataclass(frozen=True)
class Size:
    """The size of a study.

    Attributes:
        recordings: at each level of the motors
        full: 200 epochs, and the state that is best on a fifth of the recordings trained on; else a row's own training,
            and its last state
    """

    recordings: int
    full: bool

    def training(self, row: Row) -> Training:
        """How a row's network is trained."""
        if not self.full:
            return row.training
        epoch = max(int(SHOWN * KEPT * self.recordings) // PUBLISHED_TRAINING.batch, 1)
        return replace(PUBLISHED_TRAINING, steps=EPOCHS * epoch, validate_every=epoch)

    @property
    def validated(self) -> float:
        """The share of the recordings trained on that choose the best state."""
        return 1.0 - KEPT if self.full else 0.0


def size_of(options: Options, usual: int) -> Size:
    """The size that was asked for.

    Args:
        options: data, trials, full
        usual: recordings by default

    Returns:
        the size

    Raises:
        InputError: --trials with --data, an odd number of recordings, or too few for the folds
    """
    if options.data and options.trials:
        raise InputError("reproduce: --trials is for recordings that are made; allowed: --data alone")
    size = Size(options.trials or (PUBLISHED_RECORDINGS if options.full else usual), options.full)
    if size.recordings < 2 * FOLDS or size.recordings % 2:
        raise InputError(
            f"reproduce: --trials {size.recordings}: half of the recordings of a level have contact, and {FOLDS} folds "
            f"need one each; allowed: even numbers, {2 * FOLDS} or more")
    return size


def recordings_for(options: Options, size: Size, levels: Iterable[float], inputs: Sequence[Input],
                   others_too: bool = True) -> list[Recording]:
    """The recordings of --data, or those of the bench.

    Args:
        options: data, seed, jobs
        size: of the study
        levels: of the motors, as run_recordings() takes them
        inputs: what networks read
        others_too: as run_recordings() takes it

    Returns:
        the recordings

    Raises:
        InputError: of a trial or of the dataset, or where too few recordings slip for the folds
    """
    if options.data:
        recordings = read_recordings(options.data, inputs)
    else:
        recordings = run_recordings(levels, size.recordings, inputs, options, others_too)
    counts = {"with contact": sum(not one.motors_only for one in recordings)}
    for rule in ("micro", "paper"):
        counts[f"that slip by the {RULES[rule]} label"] = sum(
            bool(one.inputs[0].labels[rule].any()) for one in recordings)
    for what, count in counts.items():
        if count < FOLDS:
            raise InputError(f"{count} recordings {what} make no {FOLDS} folds; allowed: {FOLDS} or more")
    return recordings


class Padded(NamedTuple):
    """A recording as a network reads it.

    Attributes:
        features: [T, values] frames, of which the first and the last are repeated
        labels: [T] MASKED before the first answer
    """

    features: Floats
    labels: Labels


def padded(recordings: Iterable[Recording], row: Row, rule: str) -> list[Padded]:
    """Recordings as a row's network is trained on them and judges them.

    A convolution reads copies of the first frame before a recording, and copies of the last one after it: so all frames
    are judged. An answer that has seen `later` frames stands so many frames after the one that it judges.

    Args:
        recordings: of the bench
        row: whose network it is
        rule: a name of RULES

    Returns:
        each recording
    """
    found = []
    repeated = -1
    for recording in recordings:
        features, labels = row.features(recording), recording.inputs[row.input].labels[rule]
        if repeated < 0:
            repeated = history_of(row.network(features.shape[1], CLASSES)) - 1
        ends = (repeated - row.later, row.later)
        masked = np.pad(labels, (repeated, 0), constant_values=MASKED)
        found.append(Padded(np.pad(features, (ends, (0, 0)), mode="edge"), masked))
    return found


def groups_of(recordings: Iterable[Recording]) -> list[int]:
    """WITH_SLIP or MOTORS_ALONE, of each recording."""
    return [MOTORS_ALONE if one.motors_only else WITH_SLIP for one in recordings]


Counts = NDArray[np.int64]  # [folds, group, true, called] frames
MeanSd = tuple[float, float]  # of the folds; NaN where there are too few


class Figures(NamedTuple):
    """Mean and standard deviation of the folds.

    Attributes:
        accuracy: balanced, %
        f1: of slip, 0 to 1
    """

    accuracy: MeanSd
    f1: MeanSd

    def json(self) -> dict[str, float]:
        """balanced_accuracy (0 to 1) and f1, with their deviations."""
        return {
            "balanced_accuracy": self.accuracy[0] / 100.0, "balanced_accuracy_sd": self.accuracy[1] / 100.0,
            "f1": self.f1[0], "f1_sd": self.f1[1]
        }

    def cell(self) -> str:
        """As "96.2 +- 0.8, 0.885"; "-" where there is nothing to judge."""
        return "-" if math.isnan(self.accuracy[0]) else f"{cell(self.accuracy)}, {self.f1[0]:.3f}"


def cell(percent: MeanSd) -> str:
    """As "96.2 +- 0.8", of one fold as "96.2"; "-" of NaN."""
    mean, sd = percent
    return "-" if math.isnan(mean) else f"{mean:.1f}" if math.isnan(sd) else f"{mean:.1f} +- {sd:.1f}"


def _share(part: int, whole: int) -> float:
    return part / whole if whole else math.nan


def _figures(folds_of: Iterable[NDArray[np.int64]]) -> Figures:
    """Returns the figures of [true, called] frames of each fold."""
    accuracy, f1 = [], []
    for (held, alarmed), (missed, seen) in folds_of:
        accuracy.append(50.0 * (_share(seen, missed + seen) + _share(held, held + alarmed)))
        f1.append(_share(2 * seen, missed + seen + alarmed + seen))
    return Figures(mean_sd(accuracy), mean_sd(f1))


def on_slip(counts: Counts) -> Figures:
    """On the recordings with contact."""
    return _figures(counts[:, WITH_SLIP])


def on_all(counts: Counts) -> Figures:
    """On all recordings."""
    return _figures(counts.sum(axis=1))


def motors_right(counts: Counts) -> MeanSd:
    """The share of the frames of motors alone that are called hold, %."""
    return mean_sd([100.0 * _share(held, held + alarmed) for held, alarmed in counts[:, MOTORS_ALONE, 0]])


def figures_of(counts: Counts) -> dict[str, Any]:
    """on_slip_and_noise, on_slip and motors_right, for the JSON of a study."""
    return {
        "on_slip_and_noise": on_all(counts).json(), "on_slip": on_slip(counts).json(),
        "motors_right": motors_right(counts)[0] / 100.0
    }


class _Plan(NamedTuple):
    recordings: Sequence[Recording]
    fold_of: NDArray[np.int64]
    row: Row
    rule: str
    slip_alone: bool


class Validations:
    """Rows that are judged by folds: queued first, then trained together, each network in a process of its own.

    Args:
        options: seed, jobs, output, resume
        size: of the study
    """
    def __init__(self, options: Options, size: Size) -> None:
        self._options, self._size = options, size
        self._plans: list[_Plan] = []
        self._tasks: list[tuple[int, int]] = []  # number of the plan, fold
        self._called: list[list[Labels]] = []  # of each task: of each recording in the fold

    def queue(self, recordings: Sequence[Recording], fold_of: ArrayLike, row: Row, rule: str,
              slip_alone: bool = False) -> int:
        """Each fold is judged by a network that is trained on the others.

        Args:
            recordings: of the bench
            fold_of: number of each recording's fold, from 0 on
            row: what is trained
            rule: a name of RULES
            slip_alone: whether it is trained on the recordings with contact alone

        Returns:
            a number to ask with
        """
        plan = _Plan(recordings, np.asarray(fold_of), row, rule, slip_alone)
        self._tasks += [(len(self._plans), fold) for fold in range(int(plan.fold_of.max()) + 1)]
        self._plans.append(plan)
        return len(self._plans) - 1

    def queue_folds(self, recordings: Sequence[Recording], row: Row, rule: str, slip_alone: bool = False) -> int:
        """The same by FOLDS folds, over which recordings with contact and of motors alone are dealt out separately."""
        return self.queue(recordings, folds(groups_of(recordings), FOLDS, self._options.draws_seed), row, rule,
                          slip_alone)

    def run(self, name: str) -> None:
        """Trains all that is queued.

        Args:
            name: PAPER/TABLE

        Raises:
            InputError: as train_all()
        """
        subjects = [
            f"{self._plans[number].row.text}, {RULES[self._plans[number].rule]} label" for number, _ in self._tasks
        ]
        said = train_all(name, subjects, self._options, lambda index: self._judge(*self._tasks[index]))
        self._called = [[np.array(one, dtype=np.uint8) for one in of_fold] for of_fold in said]

    def counts(self, validation: int) -> Counts:
        """Frames of a validation by fold, group, true and called class, after run()."""
        plan = self._plans[validation]
        found = np.zeros((int(plan.fold_of.max()) + 1, 2, CLASSES, CLASSES), dtype=np.int64)
        groups = groups_of(plan.recordings)
        for number, called in enumerate(self.calls(validation)):
            truth = plan.recordings[number].inputs[plan.row.input].labels[plan.rule]
            np.add.at(found[plan.fold_of[number], groups[number]], (truth, called), 1)
        return found

    def calls(self, validation: int) -> list[Labels]:
        """Each recording's frames [T] as the network that is not trained on it calls them, 1: slip. After run()."""
        fold_of = self._plans[validation].fold_of
        called: list[Labels] = [np.zeros(0, np.uint8)] * len(fold_of)
        for (number, fold), of_fold in zip(self._tasks, self._called, strict=True):
            if number == validation:
                for recording, one in zip(np.flatnonzero(fold_of == fold), of_fold, strict=True):
                    called[recording] = one
        return called

    def _judge(self, number: int, fold: int) -> list[Labels]:
        plan = self._plans[number]
        trained_on, judged = [], []
        for one, group, of_it in zip(padded(plan.recordings, plan.row, plan.rule), groups_of(plan.recordings),
                                     plan.fold_of, strict=True):
            if of_it == fold:
                judged.append(one.features)
            elif group == WITH_SLIP or not plan.slip_alone:
                trained_on.append((one.features, one.labels))
        seed, validating = self._options.draws_seed, []
        random = RandomStream(seed, fold, "validated")
        for _ in range(int(self._size.validated * len(trained_on))):
            validating.append(trained_on.pop(random.integer(len(trained_on))))
        inputs = judged[0].shape[1]
        logits = train_and_answer(partial(plan.row.network, inputs, CLASSES), trained_on, judged,
                                  self._size.training(plan.row), classes=CLASSES, seed=seed, validating=validating)
        return [one.argmax(axis=1).astype(np.uint8) for one in logits]


def setup_of(options: Options, size: Size, recordings: int) -> list[str]:
    """How it was measured, the same for all tables.

    Args:
        options: data, seed
        size: of the study
        recordings: how many there are

    Returns:
        a sentence each
    """
    source = options.data or (f"{SCENE} (paper: {PUBLISHED_RECORDINGS}), half with contact, "
                              f"seed {options.draws_seed}")
    trained = "Learnt as the recipes say (`slipbench describe piezo_fft_gru`); the last state is judged."
    if size.full:
        trained = ("200 epochs of 32 clips of 128 frames a step by RMSProp; a fifth of the recordings learnt from "
                   "chooses the state.")
    return [
        f"{recordings} recordings of {source}.",
        "Frames of 20 ms every 10 ms, log power in bins of 50 Hz, standardised on the recordings that are learnt.",
        f"{FOLDS} folds by recording; mean and standard deviation of the folds. {trained}",
        "Labels: position, that the bench's 100 Hz position has changed since its last reading; true, that a part of "
        "the contact slips.",
    ]
