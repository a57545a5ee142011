"""Scenes and their simulation."""

from __future__ import annotations

import json
import math
import multiprocessing
import os
import re
import sys
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from slipbench._trial import Trial
from slipbench._values import index, plain, shown, yaml
from slipbench.bin import _core

DICT = "<dict>"  # replaces the file's name in a scene of from_dict()
_MOST_TRIALS = 1_000_000  # of a sweep


def located(path: str | os.PathLike[str]) -> str:
    """Path of the scene `path`: a file, or one of the package's scenes."""
    name = os.fspath(path)
    if not os.path.exists(name) and not os.path.isabs(name) and (scenes() / name).exists():
        return str(scenes() / name)
    return name


def overrides_of(values: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """Pairs of dotted path and YAML text, as for `--set`."""
    for path in values or {}:
        if not isinstance(path, str):
            raise _core.InputError(
                f"expected dotted paths as keys, such as 'motion.speed', found {path!r}"
            )
    return [(path, yaml(value, path)) for path, value in (values or {}).items()]


@contextmanager
def naming_unknown_classes() -> Iterator[None]:
    """Extends the program's message in a worker process.

    Python classes must be registered in each process.
    """
    try:
        yield
    except _core.InputError as error:
        unknown = re.search(r"unknown (?:sensor|detector|controller|type) '(\w+)'", str(error))
        if unknown is None or multiprocessing.parent_process() is None:
            raise
        raise _core.InputError(
            f"{error}. If {unknown[1]!r} is a Python class, this worker process does not know it: register it in a module that the "
            "worker imports, not in a script below `if __name__ == '__main__'`"
        ) from None


def _key_paths(value: Any, path: str = "") -> Iterator[str]:
    """Yields the dotted path of the content of each line of json.dumps(value, indent=2).

    The path of the whole is "".
    """
    yield path
    if isinstance(value, (dict, list)) and value:
        for key, one in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _key_paths(one, f"{path}.{key}" if path else str(key))
        yield path


def warn(texts: Iterable[str]) -> None:
    """Issues the program's warnings as Python warnings.

    Their place is the line outside of the package that caused them.
    """
    here = os.path.join(os.path.dirname(__file__), "")
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_code.co_filename.startswith(here):
        frame, level = frame.f_back, level + 1
    for text in texts:
        warnings.warn(text, stacklevel=level)


@dataclass(frozen=True)
class Check:
    """Results of a scene's expectations.

    Attributes:
        verdict: "passed", "failed", "tests nothing", "not checked"
        expectations: for each a dict of name, limit, kept, trials, needed, passed, worst,
            worst_trial, replay
        table: output of `slipbench check`, without colours
        failures: reasons of trials that failed to run
        files: files that a failed check wrote
    """

    verdict: str
    expectations: list[dict[str, Any]]
    table: str
    failures: list[str]
    files: list[str]

    @property
    def passed(self) -> bool:
        """True if the scene has expectations and all were kept."""
        return self.verdict == "passed"


class Sweep(Iterator[Trial]):
    """Iterator over trials in the order of their numbers, which threads simulate in advance.

    `len()` is the number of trials.

    Attributes:
        done: number of trials returned so far
    """

    def __init__(self, one: Callable[[int, _core.Stop], Trial], count: int, jobs: int) -> None:
        self._stop = _core.Stop()
        self._pool = ThreadPoolExecutor(jobs)
        self._one, self._count, self._next = one, count, 0
        self._ahead: deque[Future[Trial]] = deque()
        self._converters = _core.Converters()
        self._depth = 2 * jobs
        self.done = 0

    def __len__(self) -> int:
        return self._count

    def __next__(self) -> Trial:
        while self._next < self._count and len(self._ahead) < self._depth:
            self._ahead.append(self._pool.submit(self._one, self._next, self._stop))
            self._next += 1
        if not self._ahead:
            self.close()
            warn(text for _, text in self._converters.warnings())
            self._converters = _core.Converters()
            raise StopIteration
        try:
            trial = self._ahead.popleft().result()
        except BaseException:
            self.close()
            raise
        if trial._record:
            self._converters.add(trial._record)
        self.done += 1
        return trial

    def close(self) -> None:
        """Stops the running trials."""
        self._stop.set()
        self._ahead.clear()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def __del__(self) -> None:
        self.close()


class Scene:
    """A scene with its overrides.

    Immutable. Created by `Scene.load()`, `Scene.from_text()` and `Scene.from_dict()`.

    Scenes can be pickled and deep-copied. In a process that cannot read the scene's file, the copy
    contains its text.

    Warnings of `slipbench run` are Python warnings (UserWarning) here, with the same text: `load()`
    and `set()` warn of values, such as a speed of more than 1 m/s without a unit, `run()`,
    `sweep()`, `write()` and `check()` of everything else.

    Attributes:
        path: path of the file; "<text>" or "<dict>" in its folder for a scene without a file
        overrides: pairs of dotted path and YAML text, as for `--set`
    """

    def __init__(
        self,
        path: str,
        overrides: list[tuple[str, str]],
        issued: dict[str, str] | None = None,
        text: str | None = None,
    ) -> None:
        """`issued`: warnings issued so far, by subject.

        `text`: text of a scene that is not read from the file at `path`.
        """
        self.path = path
        self.overrides = overrides
        self._text = text
        with naming_unknown_classes(), self._naming_keys():
            self._core = _core.Scene(path, overrides, text)
        self._issued: dict[str, str] = {}
        # User classes are only instantiated when trials run, which may be in other processes.
        if not self._has_own_parts():
            found = self._warnings(0, 0, None, False, "", False, math.inf)
            self._issued.update(found)
            warn(text for about, text in found.items() if (issued or {}).get(about) != text)

    def _warn(
        self,
        draws: int = 0,
        trials: int = 0,
        seed: int | None = None,
        output: str = "",
        isolation: tuple[bool, float] = (False, math.inf),
    ) -> None:
        """Issues the program's warnings for these trials, once each."""
        found = {
            about: text
            for about, text in self._warnings(draws, trials, seed, True, output, *isolation).items()
            if about not in self._issued
        }
        self._issued.update(found)
        warn(found.values())

    def _warnings(
        self,
        draws: int,
        trials: int,
        seed: int | None,
        build: bool,
        output: str,
        isolate: bool,
        limit: float,
    ) -> dict[str, str]:
        """The program's warnings, by subject."""
        with self._naming_keys():
            return {
                about: self._with_keys(text)
                for about, text in self._core.warnings(
                    draws, trials, seed, build, output, isolate, limit
                )
            }

    @contextmanager
    def _naming_keys(self) -> Iterator[None]:
        """For a scene from a dict, replaces lines by keys in the program's InputError."""
        try:
            yield
        except _core.InputError as error:
            if os.path.basename(self.path) != DICT:
                raise
            raise _core.InputError(self._with_keys(str(error))) from None

    def _with_keys(self, text: str) -> str:
        """Replaces lines of the JSON text by keys of the dict in a message."""
        if os.path.basename(self.path) != DICT or self._text is None:
            return text
        keys = list(_key_paths(json.loads(self._text)))
        named = re.sub(
            rf"{re.escape(self.path)}:(\d+)", lambda found: keys[int(found[1]) - 1] or DICT, text
        )
        return re.sub(
            r"^(\S+): (?=\1(?![\w.]))", "", named
        )  # "motion.tilt: motion.tilt has 3 entries"

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Reads a scene.

        Args:
            path: a file, or one of the package's scenes: `Scene.load("papillarray/stage.yaml")`

        Returns:
            The scene.

        Raises:
            InputError: "stage.yaml:12: unknown key 'sped' in motion; did you mean 'speed'? allowed:
                ..."
        """
        return cls(located(path), [])

    @classmethod
    def from_text(cls, text: str, *, folder: str | os.PathLike[str] = "") -> Scene:
        """Reads a scene from YAML in a string.

        Args:
            text: content of a scene file
            folder: base of relative paths in the scene; empty: the current folder

        Returns:
            The scene. It behaves like one from a file, except for `check()`, which needs a file.

        Raises:
            InputError: as `load()`, with "<text>" as the file's name; or `text` is not a str.
        """
        if not isinstance(text, str):
            raise _core.InputError(
                f"text: expected a scene's YAML as str, found {shown(text)}; Scene.load() reads a file, from_dict() takes a dict"
            )
        return cls(os.path.join(os.fspath(folder), "<text>"), [], text=text)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], *, folder: str | os.PathLike[str] = "") -> Scene:
        """Creates a scene from a dict with the scene's keys.

        Example: `Scene.from_dict({"slipbench": 1, "motion": {"speed": 0.004}, ...})`.

        Args:
            values: keys of a scene file; a text such as "4 mm/s" has a unit, numbers are SI; numpy
                values and arrays are allowed
            folder: as for `from_text()`

        Returns:
            The scene, whose `text` is the dict as JSON.

        Raises:
            InputError: a value or key is invalid, "motion.sped: unknown key 'sped' in motion"; or
                `values` is not a dict.
        """
        if not isinstance(values, Mapping):
            raise _core.InputError(
                f"values: expected a dict of a scene's keys, found {shown(values)}; Scene.load() reads a file, from_text() takes YAML"
            )
        return cls(
            os.path.join(os.fspath(folder), DICT),
            [],
            text=json.dumps(plain(values, "scene"), indent=2) + "\n",
        )

    def set(self, values: Mapping[str, Any] | None = None, /, **more: Any) -> Scene:
        """Returns the scene with other values, by dotted path.

        Example: `set({"motion.speed": "8 mm/s"}, seed=3)`. Sweeps of a set path, or of paths below
        it, are removed.

        Args:
            values: values by dotted path. Text is YAML, other values are SI. Numbers, arrays and
                ranges may be numpy's, paths Path objects, which start from the current folder. None
                removes a key
            more: likewise, by single words

        Returns:
            The new scene.

        Raises:
            InputError: an invalid value; the message names the key
        """
        return Scene(
            self.path,
            self.overrides + overrides_of({**(values or {}), **more}),
            self._issued,
            self._text,
        )

    @property
    def text(self) -> str:
        """Text of the scene file."""
        return self._core.text

    @property
    def seed(self) -> int:
        """The scene's seed."""
        return self._core.seed

    def trials(self, draws: int = 0) -> int:
        """Number of trials of the scene's sweep.

        Args:
            draws: draws of each cell of its grid; 0: as in the scene

        Returns:
            The number.
        """
        with self._naming_keys():
            return self._core.trials(draws)

    def run(self, trial: int = 0, *, seed: int | None = None, record: str = "full") -> Trial:
        """Simulates a trial.

        It equals that of `slipbench run SCENE --trials N` with the least N that includes it. Other
        threads of the interpreter keep running; Ctrl-C ends the trial.

        Args:
            trial: number of the trial
            seed: replaces the scene's; None: the scene's own
            record: "full"; "outcome" omits the arrays; "contact" adds `Trial.contacts`, the force
                and displacement of units in the pad frame

        Returns:
            The trial.

        Raises:
            InputError: the trial fails, or an argument is out of range
        """
        trial = index(trial, "trial")
        if trial < 0:
            raise _core.InputError(f"trial {trial}; allowed: 0 or more")
        check_counts(seed=seed)
        chosen = self.seed if seed is None else index(seed, "seed")
        _check_record(record)
        self._warn()
        made = self._simulate(trial, 0, trial + 1, chosen, record, None)
        converters = _core.Converters()
        if made._record:
            converters.add(made._record)
        warn(text for _, text in converters.warnings())
        return made

    def _run_episode(self, episode: int, seed: int) -> Trial:
        """Simulates the trial of an environment's episode.

        Episodes cycle through the cells of the grid, from a cell of the seed.
        """
        cells = self.trials(1)
        draws = _MOST_TRIALS // cells
        self._warn()
        return self._simulate(
            _core.trial_of_episode(cells, draws, seed, episode), draws, 0, seed, "full", None
        )

    def _simulate(
        self, trial: int, draws: int, limit: int, seed: int, record: str, stop: _core.Stop | None
    ) -> Trial:
        with self._naming_keys():
            if record == "contact":
                made, contacts = self._core.run_with_contact(trial, draws, limit, seed, stop)
                return Trial(made, contacts)
            return Trial(self._core.run(trial, draws, limit, seed, record == "full", stop))

    def sweep(
        self, *, draws: int = 0, seed: int | None = None, jobs: int = 0, record: str = "full"
    ) -> Sweep:
        """Iterates over all trials of the scene's sweep, in order: `for trial in scene.sweep()`.

        Args:
            draws: draws of each cell of the grid; 0: as in the scene
            seed: as for `run()`
            jobs: number of threads; 0: one per core
            record: as for `run()`

        Returns:
            An iterator over the trials.
        """
        check_counts(draws=draws, seed=seed, jobs=jobs)
        chosen = self.seed if seed is None else index(seed, "seed")
        _check_record(record)
        count = self.trials(draws)
        self._warn(draws, seed=seed)
        return Sweep(
            lambda trial, stop: self._simulate(trial, draws, 0, chosen, record, stop),
            count,
            jobs or os.cpu_count() or 1,
        )

    def write(
        self,
        path: str | os.PathLike[str],
        *,
        draws: int = 0,
        trials: int = 0,
        seed: int | None = None,
        jobs: int = 0,
        record: str = "full",
        resume: bool = False,
        progress: Callable[[int, int], None] | None = None,
        isolate: bool | None = None,
        trial_limit: float | None = None,
    ) -> dict[str, Any]:
        """Runs the sweep and writes it as a dataset.

        The content is that of `slipbench sweep`, or with `trials` that of `slipbench run --trials`.

        Args:
            path: file to write
            draws: draws of each cell of the grid; 0: as in the scene
            trials: as `slipbench run --trials`; 0: all trials of the sweep
            seed: replaces the scene's; None: the scene's own
            jobs: number of threads; 0: one per core
            record: "full" or "outcome"
            resume: continues with a file that an interrupted call left
            progress: `progress(done, total)` is called from time to time, and at the end
            isolate: runs each trial in its own process, a copy of this one. If a class crashes,
                ends the process or never returns, only its trial fails. State that a class keeps
                outside of its objects is not visible to other trials. None: isolates if several
                trials run a user class or a plugin, unless torch or a notebook is loaded, whose
                threads a copied process lacks
            trial_limit: time after which a trial fails [s]; this implies `isolate`. None: no limit

        Returns:
            The summary that `--json` prints.

        Raises:
            InputError: the program's own message
            KeyboardInterrupt: after Ctrl-C, with the finished trials kept for `resume=True`
        """
        check_counts(draws=draws, trials=trials, seed=seed, jobs=jobs)
        if draws and trials:
            raise _core.InputError(f"draws={draws} and trials={trials}; give only one of them")
        _check_record(record, ("full", "outcome"))
        isolation = self._isolation(isolate, trial_limit, trials or self.trials(draws))
        self._warn(draws, trials, seed, os.fspath(path), isolation)
        with self._naming_keys():
            summary: dict[str, Any] = json.loads(
                self._core.write(
                    os.fspath(path),
                    draws,
                    trials,
                    seed,
                    jobs,
                    record == "full",
                    resume,
                    progress,
                    *isolation,
                )
            )
        warn(one["text"] for one in summary["warnings"])
        if summary.get("interrupted"):
            raise KeyboardInterrupt
        if progress is not None:
            progress(summary["planned"], summary["planned"])
        return summary

    def check(
        self,
        *,
        draws: int = 0,
        seed: int | None = None,
        jobs: int = 0,
        folder: str = "",
        isolate: bool | None = None,
        trial_limit: float | None = None,
    ) -> Check:
        """Compares the scene's `expect` with its trials, like `slipbench check`.

        Args:
            draws: as for `sweep()`
            seed: as for `sweep()`
            jobs: as for `sweep()`
            folder: for the files of a failed check; empty: none
            isolate: as for `write()`
            trial_limit: as for `write()`

        Returns:
            What held, and what did not.

        Raises:
            InputError: the scene has no file, or the program's own message
        """
        if self._text is not None:
            raise _core.InputError(
                f"{self.path}: check() needs a scene in a file, for its replay command; use Scene.load()"
            )
        check_counts(draws=draws, seed=seed, jobs=jobs)
        isolation = self._isolation(isolate, trial_limit, self.trials(draws))
        self._warn(draws, seed=seed, isolation=isolation)
        result = self._core.check(draws, seed, jobs, folder, *isolation)
        warn(text for _, text in result.pop("warnings"))
        return Check(**result)

    def __reduce__(self) -> Any:
        return _restored, (self.path, self.overrides, self._issued, self.text)

    def _has_own_parts(self) -> bool:
        """True if the scene may name a user's Python class or a plugin."""
        return any(
            name in text
            for name in _core.users_types()
            for text in [self.text, *(value for _, value in self.overrides)]
        )

    def _isolation(
        self, isolate: bool | None, time: float | None, trials: int
    ) -> tuple[bool, float]:
        """Returns whether trials run in separate processes, and the time limit of each [s].

        `write()` documents this for `trials` trials.
        """
        if time is not None and not time > 0:
            raise _core.InputError(f"trial_limit={time}; allowed: more than 0 s")
        if time is not None and isolate is False:
            raise _core.InputError("isolate=False cannot be combined with trial_limit")
        if isolate is None:
            own = (
                trials > 1
                and self._has_own_parts()
                and not {"torch", "ipykernel"} & sys.modules.keys()
            )
            isolate = time is not None or own
        if isolate and sys.stdout is not None:
            sys.stdout.flush()  # otherwise each process would print the buffer
        return isolate, math.inf if time is None else time

    def __repr__(self) -> str:
        return f"<slipbench.Scene {self.path}{''.join(f' {path}={value}' for path, value in self.overrides)}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self).strip('<>'))}</p><pre>{escape(self.text)}</pre>"


def _restored(
    path: str, overrides: list[tuple[str, str]], issued: dict[str, str], text: str
) -> Scene:
    """Restores a pickled scene.

    Reads its file again if it is unchanged, else uses the pickled text.
    """
    try:
        same = Path(path).read_text(encoding="utf-8") == text
    except (OSError, ValueError):
        same = False
    return Scene(path, overrides, issued, None if same else text)


def check_counts(**counts: int | None) -> None:
    """Raises InputError, naming the count, for a number that is not whole or is negative."""
    for name, value in counts.items():
        if value is not None and not 0 <= index(value, name) < 2**64:
            raise _core.InputError(f"{name}={value}; allowed: 0 or more")


def _check_record(record: str, allowed: tuple[str, ...] = ("full", "outcome", "contact")) -> None:
    if record not in allowed:
        raise _core.InputError(f"record={record!r}; allowed: {', '.join(map(repr, allowed))}")


def scenes() -> Path:
    """Folder of the package's scenes."""
    return Path(_core.project_file("scenes"))


def describe(name: str) -> list[dict[str, Any]]:
    """Output of `slipbench describe NAME --json`.

    Args:
        name: name of a sensor, effect, detector or another part

    Returns:
        Law, source, parameters with unit, default and allowed values, of everything of this name.

    Raises:
        InputError: an unknown name; the message has the nearest one
    """
    described: list[dict[str, Any]] = json.loads(_core.describe(name))
    return described


def list_names() -> dict[str, Any]:
    """Names that a scene may use, by catalogue: `list_names()["detectors"]`.

    The names are those of `slipbench list --json`.
    """
    listed: dict[str, Any] = json.loads(_core.list_names())
    return listed


def evaluate(
    detector: str,
    dataset: str | os.PathLike[str],
    *,
    parameters: Mapping[str, Any] | None = None,
    labels: str = "",
    sensor: str = "",
    split: str = "",
    all_trials: bool = False,
    resample: bool = False,
) -> dict[str, Any]:
    """Evaluates a detector on the trials of a dataset.

    The recordings are read, and the detector run, in a child process.

    Args:
        detector: a name in a scene, including custom ones, FILE.onnx, or a folder of memories
        dataset: path of the dataset's first file
        parameters: parameters of the detector, by name
        labels: rule of the truth for evaluation (docs/concepts/labels.md); empty: recorded for
            recordings, else the rule of a network's training, or strict
        sensor: the one that the detector reads; empty: the only one
        split: "train", "valid" or "test" of the dataset's masks; empty: all trials
        all_trials: includes trials that the detector was trained on
        resample: interpolates recordings that are slower than the detector reads, and across gaps
            of more than 0.1 s

    Returns:
        The output of `slipbench eval DETECTOR DATASET --json`.

    Raises:
        InputError: the program's own message
    """
    pairs = overrides_of(parameters)
    result: dict[str, Any] = json.loads(
        _core.evaluate(
            detector, pairs, os.fspath(dataset), labels, sensor, split, all_trials, resample
        )
    )
    return result
