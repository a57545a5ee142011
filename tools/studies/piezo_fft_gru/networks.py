"""Networks trained on recordings of the piezoelectric skin's bench, and their tests."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from slipbench import InputError, RandomStream
from slipbench._program import counted
from slipbench.learning import MASKED, Input, Training, find_recipe
from slipbench.learning._fit import history_of
from slipbench_studies.network_training import Floats, Labels, folds, train_all, train_and_answer
from slipbench_studies.piezo_fft_gru import SCENE
from slipbench_studies.piezo_fft_gru.bench import RULES, Recording, read_recordings, run_recordings
from slipbench_studies.result import Options
from slipbench_studies.statistics import mean_sd
from torch import nn

SOURCE = (
    '"Spectro-Temporal Recurrent Neural Network for Robotic Slip Detection with Piezoelectric Tactile Sensor". '
    "Cells are balanced accuracy in % and F1 of slip."
)
PUBLISHED_RECORDINGS, USUAL_RECORDINGS = 3200, 200
FOLDS = 5
CLASSES = 2  # hold, slip
WITH_SLIP, MOTORS_ALONE = 0, 1  # groups of recordings
EPOCHS = 200  # published
SHOWN, KEPT = (
    0.8,
    0.8,
)  # shares: recordings in the training set, and those of them that are not for validation
# The number of steps depends on the number of recordings.
PUBLISHED_TRAINING = Training(batch=32, clip=128, learning_rate=8e-4, optimiser="rmsprop")
SHORTCUTS = ("time", "contact", "motors", "kind")  # kind: True for a recording of motors only


@dataclass(frozen=True)
class Row:
    """A row of a table: a network, its input and its published figures.

    Attributes:
        name: name in --only and in the figures
        text: text in the tables
        network: creates the module from the numbers of values per frame and of classes
        training: training of the usual size
        input: index into Recording.inputs
        shortcuts: those of SHORTCUTS that replace the input
        later: number of frames after the judged one that the network sees
        f1: published, 0 to 1; NaN: not published
        accuracy: published, %; NaN: not published
    """

    name: str
    text: str
    network: Callable[[int, int], nn.Module]
    training: Training = Training()
    input: int = 0
    shortcuts: tuple[str, ...] = ()
    later: int = 0
    f1: float = math.nan
    accuracy: float = math.nan

    def features(self, recording: Recording) -> Floats:
        """[T, values] input of the network for a recording, before padding."""
        if not self.shortcuts:
            return recording.inputs[self.input].features
        kind = np.full(len(recording.time), recording.motors_only)
        columns: dict[str, NDArray[Any]] = {
            "time": recording.time,
            "contact": recording.contact,
            "motors": recording.motors,
            "kind": kind,
        }
        return np.stack([columns[one] for one in self.shortcuts], axis=1).astype(np.float32)

    def parameters(self, inputs: int) -> int:
        """The number of the network's weights for `inputs` values per frame."""
        return sum(one.numel() for one in self.network(inputs, CLASSES).parameters())

    def published(self) -> str:
        """The paper's figures as "98.7, 0.978"; "-" if not published."""
        return "-" if math.isnan(self.accuracy) else f"{self.accuracy:.1f}, {self.f1:.3f}"


def recipe_row(name: str, text: str, recipe: str, f1: float, accuracy: float) -> Row:
    """A row with the network and training of a recipe.

    Args:
        name: name of the row
        text: text in the tables
        recipe: name of the recipe
        f1: published, 0 to 1
        accuracy: published, %

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
        recordings: number at each level of the motors
        full: True: 200 epochs, and the state that is best on a fifth of the training recordings;
            False: the row's own training, and its last state
    """

    recordings: int
    full: bool

    def training(self, row: Row) -> Training:
        """Training of a row's network."""
        if not self.full:
            return row.training
        epoch = max(int(SHOWN * KEPT * self.recordings) // PUBLISHED_TRAINING.batch, 1)
        return replace(PUBLISHED_TRAINING, steps=EPOCHS * epoch, validate_every=epoch)

    @property
    def validated(self) -> float:
        """Share of the training recordings that select the best state."""
        return 1.0 - KEPT if self.full else 0.0


def size_of(options: Options, usual: int) -> Size:
    """Returns the requested size.

    Args:
        options: data, trials, full
        usual: default number of recordings

    Returns:
        the size

    Raises:
        InputError: --trials with --data, an odd number of recordings, or too few for the folds
    """
    if options.data and options.trials:
        raise InputError(
            "reproduce: --trials applies to simulated recordings; use --data without --trials"
        )
    size = Size(options.trials or (PUBLISHED_RECORDINGS if options.full else usual), options.full)
    if size.recordings < 2 * FOLDS or size.recordings % 2:
        raise InputError(
            f"reproduce: --trials {size.recordings}: half of the recordings of a level have contact, and {FOLDS} folds "
            f"need one each; allowed: even numbers, {2 * FOLDS} or more"
        )
    return size


def recordings_for(
    options: Options,
    size: Size,
    levels: Iterable[float],
    inputs: Sequence[Input],
    others_too: bool = True,
) -> list[Recording]:
    """Reads the recordings of --data, or simulates the bench.

    Args:
        options: data, seed, jobs
        size: size of the study
        levels: levels of the motors, as for run_recordings()
        inputs: input definitions
        others_too: as for run_recordings()

    Returns:
        the recordings

    Raises:
        InputError: if a trial fails, the dataset is invalid, or too few recordings have slip for
            the folds
    """
    if options.data:
        recordings = read_recordings(options.data, inputs)
    else:
        recordings = run_recordings(levels, size.recordings, inputs, options, others_too)
    counts = {"with contact": sum(not one.motors_only for one in recordings)}
    for rule in ("micro", "paper"):
        counts[f"that slip by the {RULES[rule]} label"] = sum(
            bool(one.inputs[0].labels[rule].any()) for one in recordings
        )
    for what, count in counts.items():
        if count < FOLDS:
            raise InputError(
                f"{count} recordings {what} are too few for {FOLDS} folds; allowed: {FOLDS} or more"
            )
    return recordings


class Padded(NamedTuple):
    """A recording in the form that a network reads.

    Attributes:
        features: [T, values] frames, padded with copies of the first and the last
        labels: [T] MASKED before the first answer
    """

    features: Floats
    labels: Labels


def padded(recordings: Iterable[Recording], row: Row, rule: str) -> list[Padded]:
    """Recordings for the training and test of a row's network.

    A convolution gets copies of the first frame before a recording, and copies of the last one
    after it, so that all frames are judged. An answer that depends on `later` frames is delayed by
    this number of frames.

    Args:
        recordings: recordings of the bench
        row: row of the network
        rule: name of a rule in RULES

    Returns:
        one element per recording
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
    """WITH_SLIP or MOTORS_ALONE for each recording."""
    return [MOTORS_ALONE if one.motors_only else WITH_SLIP for one in recordings]


Counts = NDArray[np.int64]  # [folds, group, true, called] frames
MeanSd = tuple[float, float]  # over the folds; NaN for too few


class Figures(NamedTuple):
    """Mean and standard deviation over the folds.

    Attributes:
        accuracy: balanced accuracy, %
        f1: F1 of slip, 0 to 1
    """

    accuracy: MeanSd
    f1: MeanSd

    def json(self) -> dict[str, float]:
        """balanced_accuracy (0 to 1) and f1, with their deviations."""
        return {
            "balanced_accuracy": self.accuracy[0] / 100.0,
            "balanced_accuracy_sd": self.accuracy[1] / 100.0,
            "f1": self.f1[0],
            "f1_sd": self.f1[1],
        }

    def cell(self) -> str:
        """As "96.2 +- 0.8, 0.885"; "-" without data."""
        return "-" if math.isnan(self.accuracy[0]) else f"{cell(self.accuracy)}, {self.f1[0]:.3f}"


def cell(percent: MeanSd) -> str:
    """As "96.2 +- 0.8", for one fold "96.2"; "-" for NaN."""
    mean, sd = percent
    return (
        "-" if math.isnan(mean) else f"{mean:.1f}" if math.isnan(sd) else f"{mean:.1f} +- {sd:.1f}"
    )


def _share(part: int, whole: int) -> float:
    return part / whole if whole else math.nan


def _figures(folds_of: Iterable[NDArray[np.int64]]) -> Figures:
    """Computes the figures from [true, called] frames of each fold."""
    accuracy, f1 = [], []
    for (held, alarmed), (missed, seen) in folds_of:
        accuracy.append(50.0 * (_share(seen, missed + seen) + _share(held, held + alarmed)))
        f1.append(_share(2 * seen, missed + seen + alarmed + seen))
    return Figures(mean_sd(accuracy), mean_sd(f1))


def on_slip(counts: Counts) -> Figures:
    """Figures on the recordings with contact."""
    return _figures(counts[:, WITH_SLIP])


def on_all(counts: Counts) -> Figures:
    """Figures on all recordings."""
    return _figures(counts.sum(axis=1))


def motors_right(counts: Counts) -> MeanSd:
    """Share of the frames of motors only that are called hold, %."""
    return mean_sd(
        [100.0 * _share(held, held + alarmed) for held, alarmed in counts[:, MOTORS_ALONE, 0]]
    )


def figures_of(counts: Counts) -> dict[str, Any]:
    """on_slip_and_noise, on_slip and motors_right for the JSON of a study."""
    return {
        "on_slip_and_noise": on_all(counts).json(),
        "on_slip": on_slip(counts).json(),
        "motors_right": motors_right(counts)[0] / 100.0,
    }


class _Plan(NamedTuple):
    recordings: Sequence[Recording]
    fold_of: NDArray[np.int64]
    row: Row
    rule: str
    slip_alone: bool


class Validations:
    """Cross-validations of rows.

    They are queued first, then trained together, each network in its own process.

    Args:
        options: seed, jobs, output, resume
        size: size of the study
    """

    def __init__(self, options: Options, size: Size) -> None:
        self._options, self._size = options, size
        self._plans: list[_Plan] = []
        self._tasks: list[tuple[int, int]] = []  # index of the plan, fold
        self._called: list[list[Labels]] = []  # per task: for each recording in the fold

    def queue(
        self,
        recordings: Sequence[Recording],
        fold_of: ArrayLike,
        row: Row,
        rule: str,
        slip_alone: bool = False,
    ) -> int:
        """Queues one network per fold, trained on the other folds.

        Args:
            recordings: recordings of the bench
            fold_of: fold of each recording, from 0
            row: row to train
            rule: name of a rule in RULES
            slip_alone: True: train only on the recordings with contact

        Returns:
            number for counts() and calls()
        """
        plan = _Plan(recordings, np.asarray(fold_of), row, rule, slip_alone)
        self._tasks += [(len(self._plans), fold) for fold in range(int(plan.fold_of.max()) + 1)]
        self._plans.append(plan)
        return len(self._plans) - 1

    def queue_folds(
        self, recordings: Sequence[Recording], row: Row, rule: str, slip_alone: bool = False
    ) -> int:
        """As queue() with FOLDS folds.

        Recordings with contact and of motors only are distributed separately over them.
        """
        return self.queue(
            recordings,
            folds(groups_of(recordings), FOLDS, self._options.draws_seed),
            row,
            rule,
            slip_alone,
        )

    def run(self, name: str) -> None:
        """Trains all queued networks.

        Args:
            name: PAPER/TABLE

        Raises:
            InputError: as train_all()
        """
        subjects = [
            f"{self._plans[number].row.text}, {RULES[self._plans[number].rule]} label"
            for number, _ in self._tasks
        ]
        results = train_all(
            name, subjects, self._options, lambda index: self._judge(*self._tasks[index])
        )
        self._called = [[np.array(one, dtype=np.uint8) for one in of_fold] for of_fold in results]

    def counts(self, validation: int) -> Counts:
        """Frames of a validation by fold, group, true and called class; call after run()."""
        plan = self._plans[validation]
        found = np.zeros((int(plan.fold_of.max()) + 1, 2, CLASSES, CLASSES), dtype=np.int64)
        groups = groups_of(plan.recordings)
        for number, called in enumerate(self.calls(validation)):
            truth = plan.recordings[number].inputs[plan.row.input].labels[plan.rule]
            np.add.at(found[plan.fold_of[number], groups[number]], (truth, called), 1)
        return found

    def calls(self, validation: int) -> list[Labels]:
        """Each recording's frames [T] as classified by the network that was not trained on it.

        1 is slip. Call after run().
        """
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
        for one, group, of_it in zip(
            padded(plan.recordings, plan.row, plan.rule),
            groups_of(plan.recordings),
            plan.fold_of,
            strict=True,
        ):
            if of_it == fold:
                judged.append(one.features)
            elif group == WITH_SLIP or not plan.slip_alone:
                trained_on.append((one.features, one.labels))
        seed, validating = self._options.draws_seed, []
        random = RandomStream(seed, fold, "validated")
        for _ in range(int(self._size.validated * len(trained_on))):
            validating.append(trained_on.pop(random.integer(len(trained_on))))
        inputs = judged[0].shape[1]
        logits = train_and_answer(
            partial(plan.row.network, inputs, CLASSES),
            trained_on,
            judged,
            self._size.training(plan.row),
            classes=CLASSES,
            seed=seed,
            validating=validating,
        )
        return [one.argmax(axis=1).astype(np.uint8) for one in logits]


def setup_of(options: Options, size: Size, recordings: int) -> list[str]:
    """Setup of the measurement, for all tables.

    Args:
        options: data, seed
        size: size of the study
        recordings: number of recordings

    Returns:
        one sentence per line
    """
    source = options.data or (
        f"{SCENE} (paper: {PUBLISHED_RECORDINGS}), half with contact, seed {options.draws_seed}"
    )
    trained = "Training as in the recipes (`slipbench describe piezo_fft_gru`); the last state is evaluated."
    if size.full:
        trained = "200 epochs of 32 clips of 128 frames per step by RMSProp; a fifth of the training recordings selects the state."
    return [
        f"{counted(recordings, 'recording')} of {source}.",
        "Frames of 20 ms every 10 ms, log power in bins of 50 Hz, standardised on the training recordings.",
        f"{FOLDS} folds by recording; mean and standard deviation of the folds. {trained}",
        "Labels: position: the 100 Hz position of the bench has changed since its last reading; true: a part of the contact slips.",
    ]
