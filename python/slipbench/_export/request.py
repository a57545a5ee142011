"""Request of the program, and progress output."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import shutil
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from slipbench import Dataset, InputError
from slipbench._output import RUNNING, NewFiles, create_locked, partial_path
from slipbench._program import Interrupt, counted, printable, say

LINE_PERIOD = 5.0  # s, between lines if stderr is not a terminal
BAR_PERIOD = 0.1  # s, between redraws
MOST_NOTES = 10
ALLOWED = "expected a folder, or a new name in an existing folder"


@dataclass(frozen=True)
class Request:
    """Request of the program, from JSON. The program has checked all values.

    Attributes:
        format: name on the command line
        dataset: path of the dataset's first file
        out: folder to write into
        trials: numbers of the trials
        sensors: names of sensors that every trial has
        rate: Hz, of the rows; None: each sensor's own rate
        labels: rule of the pad's state, "strict", "micro" or "paper"; None: all three. In the
            PapillArray's logs, the rule of a pillar's slip
        label_speed: m/s, tip speed from which a pillar slips by that rule; None: not used
        points: True: LeRobot gets position and force of each unit as one feature
        licence: licence of the data, for its card, such as "cc-by-4.0"; empty: not stated
        json: True: print one JSON object on stdout and no progress on stderr
        install: command that installs the formats' requirements
        files: paths of files that the program has written and that only need the card; empty: none
        quiet: True: print neither progress nor a summary
        verbose: True: name every file in the summary
    """

    format: str
    dataset: str
    out: str
    trials: list[int]
    sensors: list[str]
    rate: float | None
    labels: str | None
    label_speed: float | None
    points: bool
    licence: str
    json: bool
    install: str
    files: list[str]
    quiet: bool = False
    verbose: bool = False


def split_of(data: Dataset) -> dict[int, str]:
    """The part of each trial; a killed run has no parts."""
    return {trial: part for part in ("train", "valid", "test") for trial in data.mask(part)}


def size_text(count: float) -> str:
    """ "318 MB"."""
    for unit in ("B", "kB", "MB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} GB"


def make_folder(folder: Path) -> bool:
    """Creates a folder, but not its parent. True if it did not exist."""
    try:
        folder.mkdir()
        return True
    except FileExistsError:
        if not folder.is_dir():
            raise InputError(f"cannot create the folder {folder}: File exists; {ALLOWED}") from None
        return False
    except OSError as error:
        raise InputError(
            f"cannot create the folder {folder}: {error.strerror}; {ALLOWED}"
        ) from error


def check_replaceable(path: Path, allowed: str, *beginnings: bytes) -> None:
    """Raises InputError if `path` exists and does not begin with one of `beginnings`. Empty files
    may be replaced. `allowed`: allowed kind of file."""
    if not path.is_symlink() and not path.exists():
        return
    if path.is_symlink() or not path.is_file():
        raise InputError(f"{path}: is not a plain file; choose a new name, or {allowed}")
    with path.open("rb") as file:
        beginning = file.read(4096)
    if beginning and not beginning.startswith(beginnings):
        raise InputError(f"{path}: would be replaced, but is not {allowed}; choose another folder")


class Progress:
    """Progress on stderr: a bar on a terminal, else plain lines. After the first trial it reports
    the expected size, and raises InputError if the disk lacks space."""

    def __init__(self, request: Request, interrupt: Interrupt) -> None:
        self._interrupt = interrupt
        self._total, self._out, self._quiet = (
            len(request.trials),
            request.out,
            request.json or request.quiet,
        )
        self._bar = sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._start = self._drawn = time.monotonic()
        self._notes = 0

    def check(self) -> None:
        """Raises Interrupted after a signal. Call before the files get their names; afterwards they
        are kept."""
        self._interrupt.check()

    def update(self, done: int, written: int) -> None:
        """Reports that `done` trials are `written` bytes. Raises Interrupted after a signal."""
        self.check()
        if done == 1:
            expected, free = written * self._total, shutil.disk_usage(self._out).free
            if expected - written > free:
                raise InputError(
                    f"{self._out}: {counted(self._total, 'trial')} would need about {size_text(expected)}, but {size_text(free)} are "
                    f"free; export fewer trials (--split, --trial), fewer --sensors or a lower --rate"
                )
            if self._total > 1:
                self._say(f"{self._total} trials, about {size_text(expected)}\n")
        now = time.monotonic()
        if self._total < 2 or (
            done < self._total and now - self._drawn < (BAR_PERIOD if self._bar else LINE_PERIOD)
        ):
            return
        self._drawn, elapsed = now, now - self._start
        left = (
            f"{elapsed:.0f} s"
            if done == self._total
            else f"ETA {elapsed * (self._total - done) / done:.0f} s"
        )
        text = f"{done}/{self._total}  {done / max(elapsed, 1e-9):.0f} trials/s  {left}"
        if self._bar:
            filled = 30 * done // self._total
            self._say(
                f"\r\033[K[{'#' * filled}{'-' * (30 - filled)}] {100 * done / self._total:3.0f} % {text}"
                + ("\n" if done == self._total else "")
            )
        elif done < self._total:
            self._say(text + "\n")

    def note(self, text: str) -> None:
        """Prints a note about the files on stderr, even with --json. The first MOST_NOTES are
        shown, then their number."""
        self._notes += 1
        if self._notes <= MOST_NOTES:
            self.clear()
            say(f"slipbench: note: {printable(text)}\n")

    def end_notes(self) -> None:
        """Prints the number of notes that were not shown."""
        if self._notes > MOST_NOTES:
            say(f"slipbench: note: {counted(self._notes - MOST_NOTES, 'more note')}\n")

    def clear(self) -> None:
        """Removes an unfinished bar, so that a message starts on an empty line."""
        if self._bar:
            self._say("\r\033[K")

    def _say(self, text: str) -> None:
        if not self._quiet:
            say(text)


@contextlib.contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Locks a folder against other exports, by the empty file export.partial in it. Raises
    InputError if another export is writing into the folder, or if a file of this name has content,
    so that it is not such a lock."""
    path = folder / "export.partial"
    if path.is_file() and not path.is_symlink() and path.stat().st_size:
        raise InputError(
            f"{path}: would be replaced by the lock of this export, but has content; rename it, or choose another folder"
        )
    try:
        file = create_locked(path)
    except InputError as error:
        if RUNNING not in str(error):
            raise
        raise InputError(f"cannot write into {folder}: another export is writing into it") from None
    with file:
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


class Output:
    """The files of an export. They get their names together once all are complete; on an error all
    are removed.

    Only files that begin with one of `beginnings` are replaced. Another export into the same folder
    is refused in the meantime.
    """

    def __init__(self, folder: str, allowed: str, *beginnings: bytes) -> None:
        self._folder, self._allowed, self._beginnings = Path(folder), allowed, beginnings
        self._made: list[Path] = []
        self._paths: list[Path] = []
        self._stack = contextlib.ExitStack()
        self._new = NewFiles()

    def __enter__(self) -> Output:
        self._make(self._folder)
        try:
            self._stack.enter_context(locked_folder(self._folder))
        except BaseException:
            self._remove_folders()
            raise
        self._stack.enter_context(self._new)
        return self

    def create(self, name: str) -> BinaryIO:
        """Creates FOLDER/`name` for writing. Close the file once it is complete."""
        if not name.isprintable() or ".." in Path(name).parts or Path(name).is_absolute():
            raise InputError(
                f"cannot write a file called {name!r}; names in the dataset must not have control characters or lead out of {self._folder}"
            )
        path = self._folder / name
        for folder in reversed(path.relative_to(self._folder).parents[:-1]):
            self._make(self._folder / folder)
        for found in (path, partial_path(path)):
            check_replaceable(found, self._allowed, *self._beginnings)
        file = self._new.create(path)
        self._paths.append(path)
        return file

    def write(self, name: str, text: str) -> None:
        """Writes the text file FOLDER/`name`."""
        with self.create(name) as file:
            file.write(text.encode())

    def files(self) -> list[tuple[str, str]]:
        """The files so far: name relative to the folder, and path of the content."""
        return [
            (path.relative_to(self._folder).as_posix(), str(partial_path(path)))
            for path in self._paths
        ]

    def size(self) -> int:
        """Bytes of the files so far."""
        return sum(os.path.getsize(path) for _, path in self.files())

    def publish(self) -> list[str]:
        """Renames the files to their final names and returns these."""
        self._new.publish()
        self._made = []
        return [str(path) for path in self._paths]

    def __exit__(self, *error: Any) -> None:
        self._stack.__exit__(*error)
        self._remove_folders()

    def _remove_folders(self) -> None:
        for folder in reversed(self._made):
            try:
                folder.rmdir()
            except OSError as error:
                if error.errno != errno.ENOTEMPTY:
                    raise

    def _make(self, folder: Path) -> None:
        if make_folder(folder):
            self._made.append(folder)


def tell(request: Request, files: list[str]) -> None:
    """Prints the closing line, or with --json the names of the files."""
    if request.json:
        print(json.dumps({"files": files}, separators=(",", ":")))
        return
    if request.quiet:
        return
    if request.verbose:
        for file in files:
            print(f"written: {printable(file)}")
    size = size_text(sum(os.path.getsize(file) for file in files))
    print(
        f"written: {printable(files[0])}, {size}"
        if len(files) == 1
        else f"written: {len(files)} files, {size}, in {printable(request.out)}"
    )
