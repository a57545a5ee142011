"""Training of a study's networks: folds, one network, and many in parallel."""

from __future__ import annotations

import math
import multiprocessing
import signal
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkProcess
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
END_WITHIN = 10  # s, for a terminated process to remove its files; then it is killed


def folds(groups: ArrayLike, count: int, seed: int) -> NDArray[np.int64]:
    """Divides items into folds.

    Each group is shuffled and distributed in turn, so that its shares of the folds differ by at
    most one item.

    Args:
        groups: [N] group number of each item
        count: folds
        seed: key of RandomStream(seed, 0, "folds")

    Returns:
        [N] fold of each item

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


def train_and_answer(
    network: Callable[[], nn.Module],
    trained_on: Sequences,
    judged: Iterable[Floats],
    training: Training,
    *,
    classes: int,
    seed: int,
    scaling: str = "standard",
    validating: Sequences = (),
) -> list[Floats]:
    """Trains one network and evaluates it.

    Args:
        network: creates the network
        trained_on: features [T, inputs], unscaled, and labels [T] of each sequence
        judged: features [T, inputs] of each test sequence, unscaled
        training: parameters of the training
        classes: number of classes
        seed: seed of the initial weights and of the drawn clips
        scaling: scaling of features, computed from `trained_on`: "standard", "common" or "range"
        validating: sequences that select the best state; empty: the last state is used

    Returns:
        [T - history + 1, classes] logits of each test sequence

    Raises:
        InputError: a class has no frame for training
    """
    offset, scale = scale_of([features for features, _ in trained_on], scaling)

    def scaled(features: Floats) -> Floats:
        return np.asarray((features - offset) * scale, dtype=np.float32)

    with reproducible(seed):
        module = network()
    fit(
        module,
        [(scaled(one), labels) for one, labels in trained_on],
        [(scaled(one), labels) for one, labels in validating],
        training,
        classes=classes,
        seed=seed,
    )
    with reproducible(seed):
        return answers_to_all(module, [scaled(one) for one in judged])


def train_detector(
    name: str, recipe: str | Recipe, dataset: str, output: str, options: Options, labels: str
) -> Trained:
    """Trains a recipe on all trials of a dataset, ignoring its own split.

    Single frames are classified, with the threshold of the greatest balanced accuracy in
    validation.

    Args:
        name: name in lines of progress
        recipe: as for slipbench.learning.train()
        dataset: path of the dataset
        output: ONNX file to write
        options: seed, progress output
        labels: rule of the labels

    Returns:
        the trained detector

    Raises:
        InputError: as slipbench.learning.train()
    """
    return train(
        dataset,
        output=output,
        recipe=recipe,
        labels=labels,
        every_trial=True,
        seed=options.draws_seed,
        alarms=math.inf,
        progress=lambda _, report: options.say(f"{name}: step {report.step} of {report.steps}"),
    )


def _end(*_: object) -> None:
    raise SystemExit(1)


def _run(work: Callable[[int], Any], index: int, connection: Connection) -> None:
    """Runs the work of a process and sends its result, or its error with the traceback.

    The parent handles Ctrl-C, and ends the process by SIGTERM, after which the process removes its
    temporary files.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _end)
    try:
        connection.send((plain(work(index)), None, ""))
    except Exception as error:
        connection.send((None, error, traceback.format_exc()))


def train_all(
    name: str, subjects: Sequence[str], options: Options, work: Callable[[int], Any]
) -> list[Any]:
    """Trains networks, options.jobs at a time, each in its own process.

    With options.output each result is saved next to the page at once.

    Args:
        name: PAPER/TABLE
        subjects: name of each network in lines of progress
        options: jobs, output, resume, progress output
        work: trains network `index` and returns its result, which must be valid JSON

    Returns:
        the result of each network, in order; it does not depend on options.jobs

    Raises:
        InputError: a network fails, or as KeptNetworks
        KeyboardInterrupt: after Ctrl-C; interrupted_text() states what is saved
    """
    kept = KeptNetworks(options, name) if options.output else None
    results: list[Any] = [
        None if kept is None else kept.find(index) for index in range(len(subjects))
    ]
    left = [index for index, one in enumerate(results) if one is None]
    set_num_threads(1)  # for the processes, which are forks of this one
    processes = _Processes(work)
    try:
        for number, index in enumerate(left):
            if number % REPORT_EVERY == 0 or subjects[index] != subjects[left[number - 1]]:
                options.say(f"{subjects[index]} ({number} of {len(left)} begun)")
            processes.start(index)
            if len(processes) == jobs_of(options):
                _collect(processes, results, kept)
        while processes:
            _collect(processes, results, kept)
    finally:
        processes.end()
        if kept is not None:
            kept.remove_if_empty()
    return results


class _Processes:
    """Processes that each train one network."""

    def __init__(self, work: Callable[[int], Any]) -> None:
        self._work = work
        self._context = multiprocessing.get_context("fork")
        self._running: dict[Connection, tuple[int, ForkProcess]] = {}

    def __len__(self) -> int:
        return len(self._running)

    def start(self, index: int) -> None:
        """Starts the process of network `index`."""
        ours, theirs = self._context.Pipe(duplex=False)
        process = self._context.Process(target=_run, args=(self._work, index, theirs))
        process.start()
        theirs.close()  # so that reading ends when the process ends
        self._running[ours] = index, process

    def take(self) -> Iterator[tuple[int, Any]]:
        """Waits until at least one network is done.

        Yields:
            index and result of each finished network

        Raises:
            Exception: the error of a network
            RuntimeError: if a process was killed
        """
        for connection in wait(list(self._running)):
            assert isinstance(connection, Connection)
            index, process = self._running.pop(connection)
            with connection:
                try:
                    result, error, text = connection.recv()
                except EOFError:
                    process.join()
                    raise RuntimeError(
                        f"the process of network {index} ended with exit status {process.exitcode}"
                    ) from None
            process.join()
            if error is not None:
                raise error from RuntimeError(text)
            yield index, result

    def end(self) -> None:
        """Terminates the running processes; returns after they have removed their files."""
        for _, process in self._running.values():
            process.terminate()
        for connection, (_, process) in self._running.items():
            process.join(END_WITHIN)
            process.kill()
            process.join()
            connection.close()
        self._running.clear()


def _collect(processes: _Processes, results: list[Any], kept: KeptNetworks | None) -> None:
    """Waits until at least one network is done and stores the results."""
    for index, result in processes.take():
        results[index] = result
        if kept is not None:
            kept.keep(index, result)
