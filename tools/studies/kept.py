"""Results of a study's networks, saved as soon as each is done."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path
from typing import Any

import slipbench
import slipbench_studies
from slipbench import InputError
from slipbench._output import write_whole
from slipbench._program import counted
from slipbench.bin import _core
from slipbench_studies.result import Options

BEGINNING = "slipbench networks of a study, "
IDENTITY = "identity.txt"


def kept_path(output: str) -> Path:
    """Folder next to a page that keeps networks until the page is written: FILE.networks."""
    return Path(output).with_suffix(".networks")


def _count(folder: Path) -> int:
    """Number of networks in the folder."""
    return len(list(folder.glob("*.json")))


class KeptNetworks:
    """Results of a study's networks, one file each.

    So an interrupted or killed study need not train them again.

    The folder's identity file identifies the run. A file is written under another name and then
    renamed, so it is always complete.

    Args:
        options: their output, FILE.html, determines the folder FILE.networks
        name: PAPER/TABLE

    Raises:
        InputError: the folder is not writable, belongs to another command, data, scenes or program,
            or has networks without options.resume
    """

    def __init__(self, options: Options, name: str) -> None:
        self.path = kept_path(options.output)
        identity = self.path / IDENTITY
        line = BEGINNING + identity_of(options, name) + "\n"
        try:
            if self.path.exists():
                there = identity.read_text() if identity.is_file() else ""
                if not there.startswith(BEGINNING):
                    raise InputError(
                        f"{self.path} exists, but does not contain networks of a study; choose another -o"
                    )
                if options.resume and there != line:
                    raise InputError(
                        f"{self.path} belongs to other options, data, scenes or another build; repeat the same command with --resume, "
                        f"or delete the folder"
                    )
                if not options.resume and self.size:
                    raise InputError(
                        f"{self.path} contains {counted(self.size, 'network')} of an unfinished run; continue with --resume, or delete the folder"
                    )
            self.path.mkdir(exist_ok=True)
            write_whole(identity, line.encode())
        except OSError as error:
            raise InputError(f"cannot write {self.path}: {error.strerror}") from error
        if self.size:
            options.say(f"reused of an earlier run: {counted(self.size, 'network')}")
        elif options.resume:
            options.say(
                f"no network of an earlier run is in {self.path}; starting from the beginning"
            )

    @property
    def size(self) -> int:
        """Number of saved networks."""
        return _count(self.path)

    def find(self, index: int) -> Any:
        """The result of network `index`; None if it is not saved.

        Raises:
            InputError: the file is damaged
        """
        file = self.path / f"{index}.json"
        if not file.exists():
            return None
        digest, _, result = file.read_text().partition("\n")
        if digest != hashlib.sha256(result.encode()).hexdigest():
            raise InputError(f"{file}: is damaged; delete it, and its network is trained again")
        return json.loads(result)

    def keep(self, index: int, result: Any) -> None:
        """Saves the result of network `index`; it is on the disk on return.

        Raises:
            InputError: with the system's reason
        """
        text = json.dumps(result)
        path = self.path / f"{index}.json"
        try:
            write_whole(path, f"{hashlib.sha256(text.encode()).hexdigest()}\n{text}".encode())
        except OSError as error:
            raise InputError(f"cannot write {path}: {error.strerror}") from error

    def remove_if_empty(self) -> None:
        """Removes the folder if it holds no network."""
        if not self.size:
            remove_kept(str(self.path))


def interrupted_text(output: str) -> str:
    """States what an interrupted study has kept.

    Args:
        output: FILE.html; empty: the study writes no page and keeps nothing
    """
    path = kept_path(output) if output else None
    if path is None or not (path / IDENTITY).is_file() or not (count := _count(path)):
        return "interrupted; nothing is kept"
    verb = "is" if count == 1 else "are"
    return f"interrupted; {counted(count, 'network')} {verb} kept in {path}; continue by the same command with --resume"


def remove_kept(output: str) -> None:
    """Removes the saved networks of a finished study.

    Args:
        output: FILE.html
    """
    if (kept_path(output) / IDENTITY).is_file():
        shutil.rmtree(kept_path(output))


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def identity_of(options: Options, name: str) -> str:
    """Digest of everything that a study's networks depend on.

    The command, the data, the scenes, the program and the Python interpreter.

    Args:
        options: data, real, seed, full, trials, only
        name: PAPER/TABLE

    Returns:
        64 hexadecimal digits
    """
    files = {
        str(path): _digest(path)
        for path in (Path(options.data), Path(options.real))
        if path.is_file()
    }
    for package in (slipbench, slipbench_studies):
        root = Path(str(package.__file__)).parent
        files |= {str(path.relative_to(root)): _digest(path) for path in sorted(root.rglob("*.py"))}
    scenes = slipbench.scenes()
    files |= {
        str(path.relative_to(scenes)): _digest(path)
        for path in sorted(scenes.rglob("*"))
        if path.is_file()
    }
    files["program"] = _digest(Path(_core.__file__))
    return hashlib.sha256(
        json.dumps(
            [name, options.draws_seed, options.full, options.trials, options.only, files]
        ).encode()
    ).hexdigest()
