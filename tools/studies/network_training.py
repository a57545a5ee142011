"""Training of a study's networks: folds, one network, and many in parallel."""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from slipbench import RandomStream
from slipbench.learning import Recipe, Trained, Training, fit, scale_of, train
from slipbench.learning._fit import answers_to_all, reproducible
from slipbench_studies.grid import jobs_of
from slipbench_studies.kept import KeptNetworks
from slipbench_studies.result import Options, plain
from torch import nn, set_num_threads

Floats = NDArray[np.float32]
Labels = NDArray[np.uint8]
Sequences = Sequence[tuple[Floats, Labels]]

REPORT_EVERY = 10  # networks between two lines of progress


def folds(groups: ArrayLike, count: int, seed: int) -> NDArray[np.int64]:
    """Divides items into folds. Each group is shuffled and dealt out in turn, so that its shares of the folds differ by one item at most.

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


def train_and_answer(network: Callable[[], nn.Module], trained_on: Sequences, judged: Iterable[Floats], training: Training, *, classes: int, seed: int,
                     scaling: str = "standard", validating: Sequences = ()) -> list[Floats]:
    """Trains one network and evaluates it.

    Args:
        network: makes it
        trained_on: features [T, inputs], not scaled, and labels [T] of each sequence
        judged: features [T, inputs] of each sequence to evaluate, not scaled
        training: how it learns
        classes: number of classes
        seed: of the initial weights and of the clips drawn
        scaling: of features, computed from `trained_on`: "standard", "common" or "range"
        validating: sequences that choose the best state; none: the last state answers

    Returns:
        [T - history + 1, classes] logits of each sequence that is judged

    Raises:
        InputError: where a class has no frame to learn from
    """
    offset, scale = scale_of([features for features, _ in trained_on], scaling)

    def scaled(features: Floats) -> Floats:
        return np.asarray((features - offset) * scale, dtype=np.float32)

    with reproducible(seed):
        module = network()
    fit(module, [(scaled(one), labels) for one, labels in trained_on], [(scaled(one), labels) for one, labels in validating], training, classes=classes,
        seed=seed)
    with reproducible(seed):
        return answers_to_all(module, [scaled(one) for one in judged])


def train_detector(name: str, recipe: str | Recipe, dataset: str, output: str, options: Options, labels: str) -> Trained:
    """Trains a recipe on all trials of a dataset, which are divided anew. Each frame is called by itself, with the threshold of the greatest balanced
    accuracy in validation.

    Args:
        name: in lines of progress
        recipe: as slipbench.learning.train() takes it
        dataset: its path
        output: ONNX file to write
        options: seed, and who hears of progress
        labels: rule of the labels

    Returns:
        the trained detector

    Raises:
        InputError: as slipbench.learning.train()
    """
    return train(dataset, output=output, recipe=recipe, labels=labels, every_trial=True, seed=options.draws_seed, alarms=math.inf,
                 progress=lambda _, report: options.say(f"{name}: step {report.step} of {report.steps}"))


_work: Callable[[int], Any] | None = None  # inherited by the worker processes, which are forks of this one


def _end(*_: object) -> None:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # the pool may send another, which would stop the removal of files
    raise SystemExit


def _begin() -> None:
    """Prepares a worker process: its parent handles Ctrl-C and ends it by SIGTERM, after which it removes its temporary files."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    set_num_threads(1)


def _do(index: int) -> Any:
    assert _work is not None
    try:
        return plain(_work(index))
    except SystemExit:  # the pool would keep it and wait for more work
        os._exit(1)


def train_all(name: str, subjects: Sequence[str], options: Options, work: Callable[[int], Any]) -> list[Any]:
    """Trains networks, options.jobs at a time, each in its own process. With options.output each result is saved beside the page at once.

    Args:
        name: PAPER/TABLE
        subjects: name of each network in lines of progress
        options: jobs, output, resume, and who hears of progress
        work: trains network `index` and returns its result, which must be valid JSON

    Returns:
        the result of each network, in order; it does not depend on options.jobs

    Raises:
        InputError: of a network, or as KeptNetworks
        KeyboardInterrupt: after Ctrl-C; its text says what is kept
    """
    global _work
    kept = KeptNetworks(options, name) if options.output else None
    results: list[Any] = [None if kept is None else kept.find(index) for index in range(len(subjects))]
    left = [index for index, one in enumerate(results) if one is None]
    _work = work
    set_num_threads(1)
    try:
        with ProcessPoolExecutor(min(jobs_of(options), max(len(left), 1)), multiprocessing.get_context("fork"), _begin) as pool:
            running: dict[Future[Any], int] = {}
            try:
                for number, index in enumerate(left):
                    if number % REPORT_EVERY == 0 or subjects[index] != subjects[left[number - 1]]:
                        options.say(f"{subjects[index]} ({number} of {len(left)} begun)")
                    running[pool.submit(_do, index)] = index
                    if len(running) == jobs_of(options):
                        _collect(running, results, kept)
                while running:
                    _collect(running, results, kept)
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
    return results


def _collect(running: dict[Future[Any], int], results: list[Any], kept: KeptNetworks | None) -> None:
    """Waits until at least one network is done and takes the results."""
    for future in wait(running, return_when=FIRST_COMPLETED).done:
        index = running.pop(future)
        results[index] = future.result()
        if kept is not None:
            kept.keep(index, results[index])
