"""Request of an export, its progress, and its files."""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from slipbench import Dataset, InputError
from slipbench._output import RUNNING, NewFiles, create_locked, partial_path
from slipbench._program import counted
from slipbench.bin import _core

MOST_NOTES = 10
ALLOWED = "expected a folder, or a new name in an existing folder"


@dataclass(frozen=True)
class Request:
    """An export. C++ has checked all values (export_request() in tools/formats/export).

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
        files: paths of files that C++ has written and that only need the card; empty: none
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
    files: list[str]


def split_of(data: Dataset) -> dict[int, str]:
    """The part of each trial; a killed run has no parts."""
    return {trial: part for part in ("train", "valid", "test") for trial in data.mask(part)}


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
    """Raises InputError if `path` exists and does not begin with one of `beginnings`.

    Empty files may be replaced. `allowed`: allowed kind of file.
    """
    if not path.is_symlink() and not path.exists():
        return
    if path.is_symlink() or not path.is_file():
        raise InputError(f"{path}: is not a plain file; choose a new name, or {allowed}")
    with path.open("rb") as file:
        beginning = file.read(4096)
    if beginning and not beginning.startswith(beginnings):
        raise InputError(f"{path}: would be replaced, but is not {allowed}; choose another folder")


class Progress:
    """Progress and notes of an export.

    After the first trial it raises InputError if the disk lacks space.

    Args:
        request: the export
        interrupt: its check() is called after each trial
        note: receives notes about the files
        quiet: True: no progress on stderr
    """

    def __init__(
        self,
        request: Request,
        interrupt: _core.Interrupt,
        note: Callable[[str], None],
        quiet: bool = True,
    ) -> None:
        self._interrupt, self._note = interrupt, note
        self._total, self._out = len(request.trials), request.out
        self._bar = _core.ExportBar(quiet)
        self._notes = 0

    def check(self) -> None:
        """Raises KeyboardInterrupt after a signal.

        Call before the files get their names; afterwards they are kept.
        """
        self._interrupt.check()

    def update(self, done: int, written: int) -> None:
        """Reports that `done` trials are `written` bytes.

        Raises KeyboardInterrupt after a signal.
        """
        self.check()
        if done == 1:
            expected, free = written * self._total, shutil.disk_usage(self._out).free
            if expected - written > free:
                raise InputError(
                    f"{self._out}: {counted(self._total, 'trial')} would need about "
                    f"{_core.size_text(expected)}, but {_core.size_text(free)} are free; export "
                    f"fewer trials (--split, --trial), fewer --sensors or a lower --rate"
                )
        self._bar.update(done, self._total, written)

    def note(self, text: str) -> None:
        """Reports a note about the files. The first MOST_NOTES are reported, then their number."""
        self._notes += 1
        if self._notes <= MOST_NOTES:
            self.end()
            self._note(text)

    def end_notes(self) -> None:
        """Reports the number of notes that were left out."""
        if self._notes > MOST_NOTES:
            self._note(counted(self._notes - MOST_NOTES, "more note"))

    def end(self) -> None:
        """Removes an unfinished bar, so that a message starts on an empty line."""
        self._bar.clear()


@contextlib.contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Locks a folder against other exports, by the empty file export.partial in it.

    Raises InputError if another export is writing into the folder, or if a file of this name has
    content, so that it is not such a lock.
    """
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
    """The files of an export.

    They get their names together once all are complete; on an error all are removed.

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
