"""Networks of the BioTac study: their training, test and figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import slipbench
from numpy.typing import NDArray
from slipbench import InputError
from slipbench._program import counted
from slipbench.learning import MASKED, Training, find_recipe
from slipbench.learning.networks import each_frame, windows
from slipbench_studies.network_training import Floats, Labels, folds, train_all, train_and_answer
from slipbench_studies.result import Options
from slipbench_studies.statistics import auc, mean_sd
from torch import nn

PAPER = '"Tactile-Driven Grasp Stability and Slip Prediction" (Robotics 2019)'
RECIPE = "biotac_lstm"  # recipe whose training all networks use, except for the steps
LONGER = 4  # multiple of the steps with --full
# Note on a figure of a network trained on real recordings; ours is that of the same network trained
# on the scene.
JUDGED_HERE = "not published: real recordings, evaluated here"

Folds = NDArray[np.int64]


class RowsNetwork(nn.Module):
    """Classifies all rows of a window at once.

    | layer | logistic regression | MLP 128 |
    |---|---|---|
    | rows of a window | rows x inputs | rows x inputs |
    | linear, batch norm, ReLU | | 128 |
    | linear | classes | classes |

    Args:
        inputs: values per row
        classes: number of classes
        rows: rows per window
        hidden: number of units in the hidden layer; 0: none
    """

    def __init__(self, inputs: int, classes: int, rows: int = 1, hidden: int = 0) -> None:
        super().__init__()
        self.history = rows
        layers: list[nn.Module] = (
            [nn.Linear(rows * inputs, hidden), nn.BatchNorm1d(hidden), nn.ReLU()] if hidden else []
        )
        self.layers = nn.Sequential(*layers, nn.Linear(hidden or rows * inputs, classes))

    def forward(self, frames: Any) -> Any:
        """[N, T, inputs] to logits [N, T - rows + 1, classes]."""
        return each_frame(self.layers, windows(frames, self.history).flatten(2))


@dataclass(frozen=True)
class Examples:
    """Data for training and evaluating networks.

    Attributes:
        features: [N, rows, inputs] of each example, unscaled
        label: [N] class of each example, that of its last row
        fold: [N] fold of each example
    """

    features: Floats
    label: Labels
    fold: Folds


@dataclass(frozen=True)
class Network:
    """A network of a table.

    Attributes:
        name: name in --only and in the figures
        text: name in the tables
        make: creates the network
        steps: number of training steps without --full
        classes: number of classes
        scaling: scaling of features, computed from the training set: "range" or "standard"
    """

    name: str
    text: str
    make: Callable[[], nn.Module]
    steps: int
    classes: int
    scaling: str = "range"


class Answers(NamedTuple):
    """Answers of networks to A examples outside of their training.

    Attributes:
        example: [A] index of the example in the test set
        label: [A] true class
        called: [A] most probable class
        slip: [A] probability of all classes except the first
    """

    example: NDArray[np.int64]
    label: NDArray[np.int64]
    called: NDArray[np.int64]
    slip: NDArray[np.float64]

    def chosen(self, which: NDArray[Any]) -> Answers:
        """Selects answers: `which` is a mask [A] or indices."""
        return Answers(*(column[which] for column in self))


def answers_of(example: NDArray[np.int64], label: Labels, logits: Floats) -> Answers:
    """Computes answers from logits.

    Args:
        example: [A] index of each example
        label: [A] true class
        logits: [A, classes]

    Returns:
        the answers
    """
    odds = np.exp(logits.astype(float) - logits.max(axis=1, keepdims=True).astype(float))
    return Answers(
        example, label.astype(np.int64), logits.argmax(axis=1), 1.0 - odds[:, 0] / odds.sum(axis=1)
    )


def _share(part: int, whole: int) -> float:
    return part / whole if whole else math.nan


# Names of the figures in the JSON.
FIGURES = ("accuracy", "balanced_accuracy", "precision", "recall", "f1", "auc")


def figures_of(answers: Answers) -> dict[str, float]:
    """Computes the figures of answers.

    Args:
        answers: any number of answers

    Returns:
        FIGURES, each 0 to 1, NaN if undefined. balanced_accuracy is the mean recall of the classes
        that occur. precision, recall, f1 and auc are those of slip: all classes except the first.
    """
    right, slips, called = answers.label == answers.called, answers.label != 0, answers.called != 0
    both = int((slips & called).sum())
    of_class = [float(right[answers.label == one].mean()) for one in np.unique(answers.label)]
    known = slips.any() and not slips.all()
    return {
        "accuracy": _share(int(right.sum()), len(right)),
        "balanced_accuracy": mean_sd(of_class)[0],
        "precision": _share(both, int(called.sum())),
        "recall": _share(both, int(slips.sum())),
        "f1": _share(2 * both, int(slips.sum() + called.sum())),
        "auc": auc(answers.slip[slips], answers.slip[~slips]).value if known else math.nan,
    }


Scores = dict[str, tuple[float, float]]


def scores_of(answers: Answers, fold: Folds, counts: NDArray[np.bool_] | None = None) -> Scores:
    """Computes the figures over folds.

    Args:
        answers: for N examples
        fold: [N] fold of each example
        counts: [N] mask of the examples that count; None: all

    Returns:
        mean and standard deviation of each of FIGURES over the folds in which it is defined
    """
    if counts is not None:
        answers = answers.chosen(counts[answers.example])
    of_answer = fold[answers.example]
    all_folds = [figures_of(answers.chosen(of_answer == one)) for one in np.unique(of_answer)]
    return {
        name: mean_sd([one[name] for one in all_folds if not math.isnan(one[name])])
        for name in FIGURES
    }


def cell(share: tuple[float, float]) -> str:
    """Mean and standard deviation of shares as "76.5 +- 1.2".

    The mean alone for one share, "-" for none.
    """
    mean, sd = share
    if math.isnan(mean):
        return "-"
    return f"{100.0 * mean:.1f}" + ("" if math.isnan(sd) else f" +- {100.0 * sd:.1f}")


def figures_object(scores: Scores) -> dict[str, float]:
    """The scores by their JSON names: "auc" and "auc_sd"."""
    return {
        name + suffix: value
        for name, share in scores.items()
        for suffix, value in zip(("", "_sd"), share, strict=True)
    }


def folds_by_object(objects: Sequence[str], count: int, seed: int) -> Folds:
    """Divides examples into folds, with all examples of an object in the same fold.

    Args:
        objects: [N] object of each example
        count: folds
        seed: as for folds()

    Returns:
        [N] fold of each example

    Raises:
        InputError: for fewer objects than folds, or fewer than two folds
    """
    different, count = sorted(set(objects)), max(count, 2)
    if len(different) < count:
        few = "is" if len(different) == 1 else "are"
        raise InputError(
            f"{counted(len(different), 'object')} {few} too few for {count} folds; allowed: {count} or more"
        )
    dealt = dict(zip(different, folds(np.zeros(len(different)), count, seed).tolist(), strict=True))
    return np.array([dealt[one] for one in objects], dtype=np.int64)


class Validations:
    """Cross-validations of networks: queued first, then trained together.

    Args:
        options: seed, jobs, full, output, resume
    """

    def __init__(self, options: Options) -> None:
        self._options = options
        self._plans: list[tuple[Network, Examples, bool, Examples | None]] = []
        self._tasks: list[tuple[int, int]] = []  # plan and fold
        self._answers: list[list[Answers]] = []

    def queue(
        self, network: Network, judged: Examples, *, own: bool = True, other: Examples | None = None
    ) -> int:
        """Adds the networks of one validation.

        Args:
            network: network to train
            judged: test set
            own: True: train one network per fold on the other folds of `judged`; False: one network
                is tested on all folds
            other: additional training set; None: none

        Returns:
            number for answers()
        """
        self._plans.append((network, judged, own, other))
        self._tasks += [
            (len(self._plans) - 1, int(fold)) for fold in (np.unique(judged.fold) if own else [0])
        ]
        return len(self._plans) - 1

    def run(self, name: str) -> None:
        """Trains all queued networks.

        Args:
            name: PAPER/TABLE

        Raises:
            InputError: as train_all()
        """
        texts = [self._plans[plan][0].text for plan, _ in self._tasks]
        results = train_all(
            name, texts, self._options, lambda index: self._answered(*self._tasks[index])._asdict()
        )
        self._answers = [[] for _ in self._plans]
        for (plan, _), one in zip(self._tasks, results, strict=True):
            self._answers[plan].append(
                Answers(*(np.array(one[column]) for column in Answers._fields))
            )

    def answers(self, number: int) -> Answers:
        """The answers of a validation in the order of the examples; call after run()."""
        all_of_it = Answers(
            *(np.concatenate(columns) for columns in zip(*self._answers[number], strict=True))
        )
        return all_of_it.chosen(np.argsort(all_of_it.example, kind="stable"))

    def _answered(self, plan: int, fold: int) -> Answers:
        network, judged, own, other = self._plans[plan]
        judges = judged.fold == fold if own else np.ones(len(judged.fold), bool)
        trained_on = [] if other is None else _sequences(other.features, other.label)
        if own:
            trained_on = _sequences(judged.features[~judges], judged.label[~judges]) + trained_on
        training: Training = find_recipe(RECIPE).training
        steps = network.steps * (LONGER if self._options.full else 1)
        # There is no validation set to select a state: the last state is used.
        logits = train_and_answer(
            network.make,
            trained_on,
            list(judged.features[judges]),
            replace(training, steps=steps, validate_every=steps),
            classes=network.classes,
            seed=self._options.draws_seed,
            scaling=network.scaling,
        )
        return answers_of(np.flatnonzero(judges), judged.label[judges], np.concatenate(logits))


def _sequences(features: Floats, labels: Labels) -> list[tuple[Floats, Labels]]:
    """Each example as a sequence with a label on the last row only."""
    of_rows = np.full(features.shape[:2], MASKED, np.uint8)
    of_rows[:, -1] = labels
    return list(zip(features, of_rows, strict=True))


def truth_of(path: str) -> str:
    """Note that replaces the truth in a dataset of recordings; empty if the dataset was simulated.

    Args:
        path: path of the dataset

    Returns:
        "none: imported from bts3v2"

    Raises:
        InputError: an incomplete dataset
    """
    import h5py

    slipbench.open(path).close()  # throws for anything but a dataset
    with h5py.File(path) as file:
        return str(file.attrs.get("truth", ""))


def check_data(options: Options, made: str) -> None:
    """Checks --data.

    Args:
        options: data, trials
        made: unit of --trials: "grasps"

    Raises:
        InputError: together with --trials, or for imported recordings, which the tables would
            present as synthetic
    """
    if not options.data:
        return
    if options.trials:
        raise InputError(
            f"reproduce: --trials applies to simulated {made}; use --data without --trials"
        )
    truth = truth_of(options.data)
    if truth:
        raise InputError(
            f"{options.data}: reproduce --data needs the truth, which it does not contain ({truth}); use --real for imported recordings"
        )


def without_real(format: str, source: str) -> str:
    """Explains how to get recordings for --real, for a study without it.

    Args:
        format: format of `slipbench import`
        source: repository of the recordings

    Returns:
        two sentences
    """
    return (
        f"Without --real there are no real recordings, and the rows that need them are omitted. Source: {source}: `slipbench import FOLDER --format {format} -o "
        "real.h5`, then --real real.h5."
    )


def object_count(objects: Iterable[str]) -> int:
    """Number of different objects."""
    return len(set(objects))
