"""Networks that a study teaches: who learns and who judges, many at a time."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipbench import RandomStream
from slipbench.learning import Training, answers, fit, scale_of
from slipbench.learning._fit import reproducible
from slipbench_studies.grid import jobs_of
from slipbench_studies.kept import KeptNetworks
from slipbench_studies.result import Options, plain
from torch import nn, set_num_threads

Floats = NDArray[np.float32]
Labels = NDArray[np.uint8]
Sequences = Sequence[tuple[Floats, Labels]]

TOLD_EVERY = 10  # networks


def folds(groups: ArrayLike, count: int, seed: int) -> NDArray[np.int64]:
    """Who learns and who judges. Each group is shuffled and dealt out in turn, so that all folds have as many of each, to within one.

    Args:
        groups: [N] number of each item's group
        count: folds
        seed: of RandomStream(seed, 0, "folds")

    Returns:
        [N] number of each item's fold

    Raises:
        ValueError: for fewer than two folds
    """
    if count < 2:
        raise ValueError(f"{count} folds; allowed: two or more")
    of_item = np.asarray(groups)
    fold_of = np.zeros(len(of_item), dtype=np.int64)
    random = RandomStream(seed, 0, "folds")
    for group in np.unique(of_item):
        items = np.flatnonzero(of_item == group).tolist()
        random.shuffle(items)
        fold_of[items] = np.arange(len(items)) % count
    return fold_of


def learn_and_answer(network: Callable[[], nn.Module], learnt: Sequences, judged: Iterable[Floats], training: Training, *, classes: int, seed: int,
                     scaling: str = "standard", validating: Sequences = ()) -> list[Floats]:
    """Teaches one network and asks it.

    Args:
        network: makes it
        learnt: features [T, inputs], not scaled, and labels [T] of each sequence
        judged: [T, inputs] of each sequence that is asked for, not scaled
        training: how it learns
        classes: that it tells
        seed: of its first weights and of the draws
        scaling: of features, by those that are learnt from: "standard", "common" or "range"
        validating: sequences that choose the best state; none: the last state answers

    Returns:
        [T - history + 1, classes] logits of each sequence that is judged

    Raises:
        InputError: where a class has no frame to learn from
    """
    offset, scale = scale_of([features for features, _ in learnt], scaling)

    def scaled(features: Floats) -> Floats:
        return np.asarray((features - offset) * scale, dtype=np.float32)

    with reproducible(seed):
        module = network()
    fit(module, [(scaled(one), labels) for one, labels in learnt], [(scaled(one), labels) for one, labels in validating], training, classes=classes,
        seed=seed)
    with reproducible(seed):
        return [answers(module, scaled(one)) for one in judged]


_work: Callable[[int], Any] | None = None  # of the processes at hand, which are copies of this one


def _begin() -> None:
    """Of a process: Ctrl-C is for the one that started it, which ends it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    set_num_threads(1)


def _do(index: int) -> Any:
    assert _work is not None
    return plain(_work(index))


def teach_all(name: str, subjects: Sequence[str], options: Options, work: Callable[[int], Any]) -> list[Any]:
    """Teaches networks, options.jobs at a time, each in a process of its own. With a page each is kept beside it as soon as it is done.

    Args:
        name: PAPER/TABLE
        subjects: what is said of each network while it learns
        options: jobs, output, resume, and who hears of progress
        work: teaches network `index` and returns what it says, as JSON has it

    Returns:
        what each has said, in this order, the same whatever options.jobs

    Raises:
        InputError: of a network, or as KeptNetworks
        KeyboardInterrupt: after Ctrl-C; its text says what is kept
    """
    global _work
    kept = KeptNetworks(options, name) if options.output else None
    said: list[Any] = [None if kept is None else kept.find(index) for index in range(len(subjects))]
    left = [index for index, one in enumerate(said) if one is None]
    _work = work
    set_num_threads(1)
    try:
        with ProcessPoolExecutor(min(jobs_of(options), max(len(left), 1)), multiprocessing.get_context("fork"), _begin) as pool:
            running: dict[Future[Any], int] = {}
            try:
                for number, index in enumerate(left):
                    if number % TOLD_EVERY == 0 or subjects[index] != subjects[left[number - 1]]:
                        options.say(f"{subjects[index]} ({number} of {len(left)} begun)")
                    running[pool.submit(_do, index)] = index
                    if len(running) == jobs_of(options):
                        _collect(running, said, kept)
                while running:
                    _collect(running, said, kept)
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                for process in multiprocessing.active_children():
                    process.terminate()
                raise
    except KeyboardInterrupt:
        if kept is not None and kept.size:
            raise KeyboardInterrupt(f"interrupted; {kept.size} networks are kept in {kept.path}; the same command with --resume goes on") from None
        raise
    finally:
        _work = None
        if kept is not None:
            kept.remove_if_empty()
    return said


def _collect(running: dict[Future[Any], int], said: list[Any], kept: KeptNetworks | None) -> None:
    """Takes what has been said, at least by one network."""
    for future in wait(running, return_when=FIRST_COMPLETED).done:
        index = running.pop(future)
        said[index] = future.result()
        if kept is not None:
            kept.keep(index, said[index])
