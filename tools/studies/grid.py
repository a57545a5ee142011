"""Simulations of studies: scenes of the project with changes, many trials at a time."""

from __future__ import annotations

import difflib
import os
import threading
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TypeVar

from slipbench import InputError, Scene, Sweep, Trial
from slipbench_studies.result import Options

Outcome = TypeVar("Outcome")
LEAST_LINES = 50  # trials between two lines of progress


@dataclass(frozen=True)
class Cell:
    """A scene under one set of changes.

    Attributes:
        name: name in progress and errors
        scene: path from the project's root: "scenes/grasp/lift.yaml"
        overrides: texts by dotted path, as for `--set`
        draws: trials of each cell of the scene's own sweep; 0: as in the scene
        change: function that changes the scene's text, beyond the overrides; None: no change
    """

    name: str
    scene: str
    overrides: dict[str, str] = field(default_factory=dict)
    draws: int = 0
    change: Callable[[str], str] | None = None

    def load(self) -> Scene:
        """The scene with its changes.

        Raises:
            InputError: for an invalid scene or override
        """
        scene = Scene.load(self.scene.removeprefix("scenes/"))
        if self.change is not None:
            scene = Scene.from_text(self.change(scene.text), folder=os.path.dirname(scene.path))
        return scene.set(dict(self.overrides)) if self.overrides else scene

    def command(self, seed: int) -> str:
        """The command that runs the scene with its overrides.

        Append an option that selects the trials.
        """
        sets = "".join(f" --set '{path}={value}'" for path, value in self.overrides.items())
        return f"slipbench run {self.scene}{sets} --seed {seed}"


def jobs_of(options: Options) -> int:
    """Number of threads: options.jobs, or one per core."""
    return options.jobs or os.cpu_count() or 1


def run_grid(
    cells: Sequence[Cell],
    options: Options,
    reduce: Callable[[Cell, Trial], Outcome],
    record: str = "full",
) -> list[list[Outcome]]:
    """Runs all trials of a grid with the options' seed and number of threads.

    The draws of a trial depend only on the seed and its number, not on its cell. If there are at
    least as many cells as threads, each thread runs whole cells; otherwise all threads share the
    trials of one cell after the other.

    Args:
        cells: cells to simulate
        options: seed, jobs, progress output
        reduce: reduces a trial to the data that the study keeps; called by several threads at a
            time
        record: "full", "contact" or "outcome", as for Scene.sweep()

    Returns:
        [cell][trial] results of `reduce`

    Raises:
        InputError: a trial fails; with the cell's name, the trial's number and the command that
            runs
            it
        KeyboardInterrupt: after Ctrl-C, once the running trials have ended
    """
    seed = options.draws_seed
    scenes = [cell.load() for cell in cells]
    total = sum(scene.trials(cell.draws) for scene, cell in zip(scenes, cells, strict=True))
    by_cell = len(cells) >= jobs_of(options) > 1
    progress = _Progress(total, options.say)
    running: set[Sweep] = set()
    ended = threading.Event()

    def run(k: int) -> list[Outcome]:
        cell, kept = cells[k], list[Outcome]()
        if ended.is_set():
            return kept
        sweep = scenes[k].sweep(
            draws=cell.draws, seed=seed, jobs=1 if by_cell else options.jobs, record=record
        )
        running.add(sweep)
        try:
            for trial in sweep:
                progress.begin(cell.name)
                kept.append(reduce(cell, trial))
                progress.end()
                if ended.is_set():
                    break
        except InputError as error:
            changed = "" if cell.change is None else ", but for what the name says"
            raise InputError(
                f"{cell.name}, trial {len(kept)}: {error}; the same{changed}: "
                f"{cell.command(seed)} --trials {len(sweep)} --trial {len(kept)}"
            ) from error
        finally:
            sweep.close()
            running.discard(sweep)
        return kept

    if not by_cell:
        return [run(k) for k in range(len(cells))]
    with ThreadPoolExecutor(jobs_of(options)) as pool:
        tasks = [pool.submit(run, k) for k in range(len(cells))]
        try:
            return [task.result() for task in tasks]
        except BaseException:
            ended.set()
            for sweep in list(running):
                sweep.close()
            raise


def make_dataset(path: str, cell: Cell, options: Options, what: str = "") -> None:
    """Runs a scene's sweep into a dataset, with the options' seed and number of threads.

    Args:
        path: file to write
        cell: the scene, its changes and its draws
        options: seed, jobs, progress output
        what: simulated items in lines of progress: "sequences"; empty: no lines

    Raises:
        InputError: a trial fails
        KeyboardInterrupt: after Ctrl-C
    """
    printed = 0

    def progress(done: int, total: int) -> None:
        nonlocal printed
        if what and done >= printed + LEAST_LINES:
            printed = done
            options.say(f"{what} ({done} of {total} done)")

    cell.load().write(
        path, draws=cell.draws, seed=options.draws_seed, jobs=options.jobs, progress=progress
    )


class _Progress:
    """Reports subject and progress at each change of the subject, and at each 50th trial.

    Thread-safe.
    """

    def __init__(self, total: int, say: Callable[[str], None]) -> None:
        self._total, self._say = total, say
        self._lock, self._done, self._said, self._name = threading.Lock(), 0, -LEAST_LINES, ""

    def begin(self, name: str) -> None:
        """Starts a trial of the cell `name`."""
        with self._lock:
            if name != self._name or self._done - self._said >= LEAST_LINES:
                self._name, self._said = name, self._done
                self._say(f"{name} ({self._done} of {self._total} done)")

    def end(self) -> None:
        """Finishes a trial."""
        with self._lock:
            self._done += 1


def check_only(only: Iterable[str], names: Sequence[str]) -> None:
    """Checks the names of `--only`.

    Args:
        only: requested names
        names: known names

    Raises:
        InputError: for an unknown name, with the nearest one
    """
    for name in only:
        if name not in names:
            near = difflib.get_close_matches(name, names, 1, 0.7)
            meant = f" did you mean '{near[0]}'?" if near else ""
            raise InputError(
                f"reproduce: --only: unknown name '{name}';{meant} allowed: {', '.join(names)}"
            )


def chosen(names: Sequence[str], only: Sequence[str]) -> list[str]:
    """The names of an axis that are in `only`; all of them if none is."""
    return [name for name in names if name in only] or list(names)
