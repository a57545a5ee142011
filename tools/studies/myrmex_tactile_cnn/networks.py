"""Networks trained on windows of the Myrmex bench, and their tests."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from slipbench import InputError, RandomStream, Trial
from slipbench.bin import _core
from slipbench.learning import MASKED, Training, find_recipe
from slipbench_studies.grid import Cell, run_grid
from slipbench_studies.myrmex_tactile_cnn.bench import (
    APART,
    SCENE,
    SETTLED,
    SINKS,
    SlipSpan,
    contact_end,
    decrease_onset,
    pad_of,
    placed_of,
    sum_end,
    sum_of_contacts,
    true_slip,
)
from slipbench_studies.network_training import Floats, Labels, folds, train_all, train_and_answer
from slipbench_studies.result import Options
from slipbench_studies.statistics import mean_sd
from torch import nn

KINDS = ("stable", "translation", "rotation")
# Sources of the labels of slip and of its class.
WORDS = (
    "true",  # from the true onset to the end of contact; class by the object's placement
    "bench",  # the paper's: from the onset by the third sensor to the end of contact by the arrays; class by placement
    "motion",  # as true, with the class of the slipping taxels' motion
)
LAST_SECONDS = 0.5  # before the true onset: the windows that are hard to distinguish
OBJECTS = ("cylinder", "remote", "glass")
TAXELS, BINS = 144, 32
CUT_BINS = 4  # of 15.625 Hz: 0 to 46.9 Hz, below the paper's 60 Hz
ROTATIONS = 12  # of an image, by 30 degrees each
AT_MOST = 60  # windows drawn of each class, array and word
USUAL_DRAWS = 8  # 64 trials, the paper's
PUBLISHED_STEPS = 700000  # "converges after around 700000 iterations" of 64 windows
PUBLISHED = {
    1: (91.01, 92.65),
    2: (96.12, 96.5),
    3: (97.45, 97.89),
}  # accuracy of the nets, %, without and with the high pass
TRIAL_FOLDS = 5
RECIPE = "myrmex_net3"  # recipe whose input and training all networks use


@dataclass
class Windows:
    """Windows of 64 ms of both arrays of one trial; class and time are those of their last sample.

    Attributes:
        object: one of OBJECTS
        rotational: True if its centre of mass is off the grip, sideways
        slips: True if it truly slips
        time: [W] s
        to_onset: [W] s, time until the true onset; NaN: the object is held
        label: [W, words] class by each of WORDS, or MASKED after the end
        drawn: [W, words] True if it is drawn for training and test
        turn: [W] rotation of its images in multiples of 30 degrees; turned copies are for training
            only
        spectra: [W, taxels, bins] amplitudes
    """

    object: str
    rotational: bool
    slips: bool
    time: NDArray[np.float64]
    to_onset: NDArray[np.float64]
    label: Labels
    drawn: NDArray[np.bool_]
    turn: NDArray[np.uint8]
    spectra: Floats

    @property
    def late(self) -> NDArray[np.bool_]:
        """[W] True within the last half second before the true onset."""
        return (self.to_onset > 0.0) & (self.to_onset <= LAST_SECONDS)


def kinds_at(time: NDArray[np.float64], span: SlipSpan, kind: Labels | int) -> Labels:
    """Class at given times of a trial.

    Args:
        time: [W] s
        span: slip of the object
        kind: class of the slip, or [W] at each time

    Returns:
        [W] 0 before the onset, then the kind; MASKED after the end
    """
    begun = time >= span.onset  # False for NaN
    return np.where(time > span.end, MASKED, np.where(begun, kind, 0)).astype(np.uint8)


def draw_windows(label: Labels, at_most: int, random: RandomStream) -> NDArray[np.bool_]:
    """Draws windows of one array.

    Args:
        label: [W] class or MASKED
        at_most: maximum number of each class
        random: random stream

    Returns:
        [W] True if drawn
    """
    drawn = np.zeros(len(label), dtype=bool)
    for one in np.unique(label[label != MASKED]):
        drawn[_first_drawn(np.flatnonzero(label == one).tolist(), at_most, random)] = True
    return drawn


def _first_drawn(items: list[Any], count: int, random: RandomStream) -> list[Any]:
    """Draws at most `count` items, one by one."""
    for i in range(min(count, len(items))):
        other = i + random.integer(len(items) - i)
        items[i], items[other] = items[other], items[i]
    return items[:count]


def windows_of(trial: Trial, turned: int, seed: int) -> Windows:
    """The windows of both arrays: the drawn ones, and all late ones.

    Args:
        trial: a full record of SCENE
        turned: number of copies of each window with a turned image, 0 to 11; the angles are drawn
            by trial
        seed: key of RandomStream(seed, trial, "windows")

    Returns:
        the trial's windows
    """
    left, right, top = (pad_of(trial, name) for name in ("left", "right", "top"))
    real = true_slip(left, right)
    end = contact_end(left, right, sum_end())
    # For a held object there is no onset, although the third sensor may drift below a threshold.
    onset = (
        math.nan
        if math.isnan(real.onset)
        else decrease_onset(top.time, sum_of_contacts(top.counts), SINKS, SETTLED, APART, end)
    )
    labelled = SlipSpan(onset, end)
    placed = placed_of(trial.params)
    placed_kind = 2 if placed.rotational else 1
    text = find_recipe(RECIPE).input.text()
    random = RandomStream(seed, trial.trial, "windows")
    parts: list[dict[str, NDArray[Any]]] = []
    for name in ("left", "right"):

        def example(turn: int, name: str = name) -> dict[str, Any]:
            return _core.example_of(trial._simulated, name, text, "micro", "kind", turn)

        plain = example(0)
        time = plain["time"]
        # While half of the load slips there is motion, except in a single sample without slipping
        # units.
        moves = np.where(plain["labels"] == 0, MASKED, plain["labels"])
        label = np.stack(
            [
                kinds_at(time, real, placed_kind),
                kinds_at(time, labelled, placed_kind),
                kinds_at(time, real, moves),
            ],
            axis=1,
        )
        drawn = np.stack(
            [draw_windows(label[:, word], AT_MOST, random) for word in range(len(WORDS))], axis=1
        )
        to_onset = real.onset - time
        kept = drawn.any(axis=1) | ((to_onset > 0.0) & (to_onset <= LAST_SECONDS))
        turns = [0, *_first_drawn(list(range(1, ROTATIONS)), turned, random)]
        for turn in turns:
            features = plain["features"] if turn == 0 else example(turn)["features"]
            parts.append(
                {
                    "time": time[kept],
                    "to_onset": to_onset[kept],
                    "label": label[kept],
                    "drawn": drawn[kept],
                    "turn": np.full(int(kept.sum()), turn, np.uint8),
                    "spectra": features[kept].reshape(-1, TAXELS, BINS),
                }
            )
    return Windows(
        placed.name,
        placed.rotational,
        not math.isnan(real.onset),
        **{key: np.concatenate([part[key] for part in parts]) for key in parts[0]},
    )


class Place(NamedTuple):
    """Position of a window: index of its trial, and of itself in the trial."""

    trial: int
    window: int


def balanced_windows(trials: Sequence[Windows], word: str, late: bool, seed: int) -> list[Place]:
    """Equal numbers of drawn, unturned windows of each class.

    All of the rarest class; the others are drawn.

    Args:
        trials: with their windows
        word: one of WORDS
        late: True: the stable windows are those of the last half second
        seed: key of RandomStream(seed, 0, "balance")

    Returns:
        the positions, in order
    """
    by = WORDS.index(word)
    of_class: list[list[Place]] = [[] for _ in KINDS]
    for number, trial in enumerate(trials):
        label = trial.label[:, by]
        taken = (trial.turn == 0) & np.where((label == 0) & late, trial.late, trial.drawn[:, by])
        for kind in range(len(KINDS)):
            of_class[kind] += [
                Place(number, int(window)) for window in np.flatnonzero(taken & (label == kind))
            ]
    least = min(map(len, of_class))
    random = RandomStream(seed, 0, "balance")
    return sorted(place for places in of_class for place in _first_drawn(places, least, random))


def window_folds(
    trials: Sequence[Windows], places: Sequence[Place], word: str, split: str, count: int, seed: int
) -> list[int]:
    """Assigns windows to folds.

    Args:
        trials: with their windows
        places: windows for training and test
        word: one of WORDS
        split: "window" (the paper's: of each class every `count`-th window in turn, although the
            training set contains its neighbours, which share 56 of its 64 ms), "trial" (distributed
            by object, placement and slip) or "object"
        count: number of folds; for objects, the number of objects
        seed: as for folds()

    Returns:
        the fold of each window
    """
    if split == "window":
        seen = dict.fromkeys(range(len(KINDS)), -1)
        fold_of = []
        for place in places:
            kind = int(trials[place.trial].label[place.window, WORDS.index(word)])
            seen[kind] += 1
            fold_of.append(seen[kind] % count)
        return fold_of
    groups = [
        trial.object if split == "object" else (trial.object, trial.rotational, trial.slips)
        for trial in trials
    ]
    numbers = {group: number for number, group in enumerate(dict.fromkeys(groups))}
    of_trial = np.array([numbers[group] for group in groups])
    if split == "trial":
        of_trial = folds(of_trial, count, seed)
    return [int(of_trial[place.trial]) for place in places]


BINS_OF = {"spectra": (0, BINS), "high_pass": (CUT_BINS, BINS), "static_image": (0, 1)}


def network_input(trial: Windows, chosen: NDArray[Any], what: str) -> Floats:
    """Input of a network for windows.

    Args:
        trial: trial of the windows
        chosen: indices or mask of the windows
        what: "spectra" (32 bins of each taxel, 0 to 484 Hz), "high_pass" (those from 62.5 Hz),
            "static_image" (bin 0 only: the sum of each taxel's counts), "load" (its mean over the
            taxels), "clock", "placement" (the object and its placement) or "clock_placement"

    Returns:
        [windows, values]
    """
    spectra = trial.spectra[chosen]
    count = len(spectra)
    if what in BINS_OF:
        first, end = BINS_OF[what]
        return np.ascontiguousarray(spectra[:, :, first:end]).reshape(count, TAXELS * (end - first))
    if what == "load":
        return np.asarray(
            spectra[:, :, 0].astype(float).mean(axis=1, keepdims=True), dtype=np.float32
        )
    clock = trial.time[chosen, None].astype(np.float32)
    placement = np.tile(
        np.array([trial.rotational, *(trial.object == one for one in OBJECTS)], np.float32),
        (count, 1),
    )
    return {
        "clock": clock,
        "placement": placement,
        "clock_placement": np.concatenate([clock, placement], axis=1),
    }[what]


@dataclass(frozen=True)
class Row:
    """A row of the tables.

    Attributes:
        name: name in --only and in the figures
        text: text in the tables
        net: number of the paper's network, with recipe myrmex_net1 to 3; 0: 32 units, tanh
        inputs: argument `what` of network_input()
        word: one of WORDS
        late: True: the stable windows for training and test are from the last half second before
            the onset
        longer: multiple of the usual steps
        published: published accuracy, %; NaN: not published
    """

    name: str
    text: str
    net: int = 0
    inputs: str = "spectra"
    word: str = "true"
    late: bool = False
    longer: int = 1
    published: float = math.nan

    def network(self, inputs: int) -> nn.Module:
        """The row's network, from `inputs` values to three logits."""
        if self.net == 0:
            return nn.Sequential(nn.Linear(inputs, 32), nn.Tanh(), nn.Linear(32, len(KINDS)))
        return find_recipe(f"myrmex_net{self.net}").network(inputs, len(KINDS))


def network_row(net: int, what: str = "spectra", word: str = "true") -> Row:
    """The paper's net 1, 2 or 3, with its published accuracy."""
    passed = what == "high_pass"
    return Row(
        f"net_{net}{'_high_pass' if passed else ''}{'' if word == 'true' else '_' + word}",
        f"net {net}{', from 62.5 Hz' if passed else ''}",
        net,
        what,
        word,
        published=PUBLISHED[net][passed],
    )


def share(counts: NDArray[np.int64], label: int, called: int) -> float:
    """Share of the windows of a class that are assigned to a class.

    Args:
        counts: [true, called] windows
        label: true class
        called: assigned class

    Returns:
        0 to 1; NaN without windows
    """
    whole = counts[label].sum()
    return float(counts[label, called] / whole) if whole else math.nan


def accuracy(counts: NDArray[np.int64]) -> float:
    """Mean recall of the classes that occur; NaN if there are none.

    `counts`: [true, called] windows.
    """
    recalls = np.array([share(counts, kind, kind) for kind in range(len(KINDS))])
    return mean_sd(recalls[~np.isnan(recalls)])[0]


STABLE = (
    "late",
    "earlier",
    "holds",
)  # stable windows: all of the last half second before the onset; drawn ones: earlier, of trials that hold


@dataclass(frozen=True)
class Judged:
    """Results of the networks of a validation.

    Attributes:
        folds: [folds, true, called] windows
        stable: {one of STABLE: (called slip, all)}
    """

    folds: NDArray[np.int64]
    stable: dict[str, tuple[int, int]]

    @property
    def all(self) -> NDArray[np.int64]:
        """[true, called] windows of all folds."""
        return np.asarray(self.folds.sum(axis=0))

    def called_slip(self, which: str) -> float:
        """Share of stable windows called slip; NaN without windows. `which`: one of STABLE."""
        wrong, whole = self.stable[which]
        return wrong / whole if whole else math.nan


@dataclass(frozen=True)
class Size:
    """The size of a study.

    Attributes:
        draws: trials of each of the scene's eight cells
        steps: number of a row's usual training steps
        turned: number of turned copies of each window
    """

    draws: int
    steps: int
    turned: int


def size_of(options: Options) -> Size:
    """Returns the requested size.

    Args:
        options: trials, full

    Returns:
        the size

    Raises:
        InputError: for too few trials
    """
    size = Size(
        options.trials or USUAL_DRAWS,
        PUBLISHED_STEPS if options.full else find_recipe(RECIPE).training.steps,
        ROTATIONS - 1 if options.full else 0,
    )
    if size.draws < 2:
        raise InputError(
            "reproduce: --trials 1: one trial of each object and placement leaves no trial for the test; allowed: 2 or more"
        )
    return size


def run_trials(options: Options, size: Size) -> list[Windows]:
    """The windows of SCENE's trials.

    Args:
        options: seed, jobs
        size: size of the study

    Returns:
        one element per trial

    Raises:
        InputError: if a trial fails, or if a class has no window
    """
    seed = options.draws_seed
    trials = run_grid(
        [Cell("trials", SCENE, draws=size.draws)],
        options,
        lambda _, trial: windows_of(trial, size.turned, seed),
    )[0]
    if not all(balanced_windows(trials, word, False, seed) for word in WORDS):
        raise InputError(
            f"reproduce: {len(trials)} trials have no window of one of stable, translation and rotation; use more --trials"
        )
    return trials


class Validations:
    """Cross-validations of rows: queued first, then trained together.

    Args:
        options: seed, jobs, output, resume
        size: size of the study
        trials: with their windows
    """

    def __init__(self, options: Options, size: Size, trials: Sequence[Windows]) -> None:
        self._options, self._size, self._trials = options, size, trials
        self._plans: list[tuple[Row, str, list[Place], list[int]]] = []
        self._tasks: list[tuple[int, int]] = []  # validation and fold
        self._results: list[dict[str, Any]] = []

    def queue(self, row: Row, split: str, count: int, last: int) -> int:
        """Queues folds 0 to `last` - 1 for the test, with one network each.

        Args:
            row: row to validate
            split: as for window_folds()
            count: folds, as for window_folds()
            last: the first fold that is not tested

        Returns:
            number for figures()
        """
        places = balanced_windows(self._trials, row.word, row.late, self._options.draws_seed)
        fold_of = window_folds(
            self._trials, places, row.word, split, count, self._options.draws_seed
        )
        self._plans.append((row, split, places, fold_of))
        # A small set of trials may leave a fold empty.
        self._tasks += [
            (len(self._plans) - 1, fold) for fold in sorted(set(fold_of)) if fold < last
        ]
        return len(self._plans) - 1

    def run(self, name: str) -> None:
        """Trains all queued networks.

        Args:
            name: PAPER/TABLE

        Raises:
            InputError: as train_all()
        """
        self._results = train_all(
            name,
            [self._plans[plan][0].text for plan, _ in self._tasks],
            self._options,
            lambda index: self._judged(*self._tasks[index]),
        )

    def figures(self, validation: int) -> Judged:
        """Results of a validation; call after run()."""
        of_it = [
            result
            for (plan, _), result in zip(self._tasks, self._results, strict=True)
            if plan == validation
        ]
        counts = np.array([result["counts"] for result in of_it], dtype=np.int64).reshape(
            -1, len(KINDS), len(KINDS)
        )
        return Judged(
            counts,
            {
                which: (
                    sum(result[which][0] for result in of_it),
                    sum(result[which][1] for result in of_it),
                )
                for which in STABLE
            },
        )

    def _judged(self, plan: int, fold: int) -> dict[str, Any]:
        row, split, places, fold_of = self._plans[plan]
        by = WORDS.index(row.word)
        learn: dict[int, list[int]] = {}
        judge: dict[int, list[int]] = {}
        for place, of_place in zip(places, fold_of, strict=True):
            (judge if of_place == fold else learn).setdefault(place.trial, []).append(place.window)
        if row.inputs in BINS_OF:
            for number, trial in enumerate(self._trials):
                copies = (
                    (trial.turn != 0)
                    & (trial.label[:, by] != MASKED)
                    & np.isin(trial.time, trial.time[learn.get(number, [])])
                )
                if copies.any():
                    learn.setdefault(number, []).extend(np.flatnonzero(copies).tolist())
        drawn = _gathered(self._trials, judge, row)
        late = (
            {
                number: np.flatnonzero(
                    (self._trials[number].turn == 0)
                    & self._trials[number].late
                    & (self._trials[number].label[:, by] == 0)
                ).tolist()
                for number in sorted(judge)
            }
            if split != "window"
            else {}
        )
        asked = [drawn, _gathered(self._trials, late, row)]
        learnt = _gathered(self._trials, learn, row)
        inputs = learnt.features.shape[1]
        training: Training = replace(
            find_recipe(RECIPE).training, steps=self._size.steps * row.longer
        )
        # Each window is a sequence of one frame for a network without state.
        logits = train_and_answer(
            partial(row.network, inputs),
            [(learnt.features, learnt.label)],
            [one.features for one in asked if len(one.label)],
            training,
            classes=len(KINDS),
            seed=self._options.draws_seed,
        )
        called = [one.argmax(axis=1) for one in logits] + [np.zeros(0, np.int64)] * 2
        counts = np.zeros((len(KINDS), len(KINDS)), dtype=np.int64)
        np.add.at(counts, (drawn.label, called[0]), 1)
        stable = drawn.label == 0
        return {
            "counts": counts,
            "late": _wrong(called[1]),
            "earlier": _wrong(called[0][stable & (drawn.to_onset > LAST_SECONDS)]),
            "holds": _wrong(called[0][stable & np.isnan(drawn.to_onset)]),
        }


class _Gathered(NamedTuple):
    features: Floats
    label: Labels
    to_onset: NDArray[np.float64]


def _gathered(trials: Sequence[Windows], chosen: dict[int, list[int]], row: Row) -> _Gathered:
    """Windows of some trials, concatenated."""
    by = WORDS.index(row.word)
    some = [
        (trials[number], np.array(windows, dtype=np.intp)) for number, windows in chosen.items()
    ] or [(trials[0], np.zeros(0, np.intp))]
    return _Gathered(
        np.concatenate([network_input(trial, windows, row.inputs) for trial, windows in some]),
        np.concatenate([trial.label[windows, by] for trial, windows in some]),
        np.concatenate([trial.to_onset[windows] for trial, windows in some]),
    )


def _wrong(called: NDArray[np.int64]) -> tuple[int, int]:
    return int((called != 0).sum()), len(called)


def percent(value: float) -> str:
    """A share as "96.4"; "-" for NaN."""
    return "-" if math.isnan(value) else f"{100.0 * value:.1f}"


def setup_of(options: Options, size: Size, trials: Sequence[Windows]) -> list[str]:
    """Setup of the measurement, for both tables.

    Args:
        options: seed
        size: size of the study
        trials: with their windows

    Returns:
        one sentence per line
    """
    seed = options.draws_seed
    true, bench, motion = (len(balanced_windows(trials, word, False, seed)) for word in WORDS)
    turned = (
        f"; {size.turned} rotated copies of each are used for training too"
        if size.turned
        else "; images as recorded"
    )
    return [
        f"{SCENE}, seed {seed}: {len(trials)} trials (paper: 64), {sum(not trial.slips for trial in trials)} of them held to the end; both arrays.",
        f"Windows of 64 ms at 1 kHz every 8 ms, amplitudes of 12 x 12 x 32, at most 60 per class, trial and array, then equal numbers of each class: {true} by "
        f"the true label, {bench} by the label of the bench, {motion} by the motion{turned}.",
        f"{size.steps} steps of 64 windows by Adam (paper: about {PUBLISHED_STEPS}); the last state is evaluated.",
        "Label true: slip from the time at which slipping taxels carry half of the load on both pads until one pad has lost contact; class by the placement"
        " of the object.",
        "Label bench, as in the paper: slip from the time at which the sum of the third sensor falls (mean of 100 ms, 3 sd) until the sums of the arrays "
        "are at rest; class by the placement.",
        "Label motion: as true, but with the class of the rigid motion that fits the slip of the taxels: the component with more energy.",
        f"The class by motion equals the class by placement in {percent(_as_placed(trials))} % of the true slip.",
        "Accuracy: mean of the recalls of stable, translation and rotation, over all folds together. High pass: only the bins from 62.5 Hz on.",
    ]


def _as_placed(trials: Iterable[Windows]) -> float:
    """Share of slipping windows whose class by motion equals that by placement."""
    right = []
    for trial in trials:
        label = trial.label[(trial.turn == 0), WORDS.index("motion")]
        slips = label[(label != 0) & (label != MASKED)]
        right.append((slips == 2) == trial.rotational)
    return mean_sd(np.concatenate(right))[0]
