"""The program's commands on dataset files, as functions that run in this process.

What a command prints as a note or warning is a Python warning (UserWarning) here;
import_recordings() also returns them under "warnings". Ctrl-C, SIGTERM or SIGHUP ends the work with
KeyboardInterrupt, and no file is left half-written. If the signal comes while the complete files get
their names, they remain.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from slipbench._program import counted, input_error_text
from slipbench._scene import check_counts, warn
from slipbench._values import index, plain, shown, yaml
from slipbench.bin import _core

PathLike = str | os.PathLike[str]
_MOST_WARNINGS = 10  # of an import, as the program prints


def _given(value: Any, key: str) -> Any:
    """The value of an option, as `plain()`; None for an empty text. Raises InputError for a bool."""
    converted = plain(value, key)
    if isinstance(converted, bool):
        raise _core.InputError(f"{key}: expected a number or a text, found {converted}")
    return None if converted == "" else converted


def _whole(value: Any, key: str) -> int | None:
    """A whole number of 0 or more, or None."""
    if _given(value, key) is None:
        return None
    check_counts(**{key: value})
    return index(value, key)


def _speed(value: Any, key: str) -> float | None:
    """A speed in m/s, from a number or a text such as "0.1 mm/s"; None if it is not given."""
    return None if _given(value, key) is None else _core.speed(key, yaml(value, key))


def _frequency(value: Any, key: str) -> float | None:
    """A frequency in Hz, from a number or a text such as "1 kHz"; None if it is not given."""
    return None if _given(value, key) is None else _core.frequency(key, yaml(value, key))


@contextlib.contextmanager
def _input_errors(needs: str, extra: str, target: str) -> Iterator[None]:
    """Turns errors of the system and missing packages into InputError, with the program's message.

    Args:
        needs: the feature that needs further packages
        extra: these packages, as `pip install slipbench[EXTRA]`
        target: path that is named if an error of the system names none
    """
    try:
        yield
    except (OSError, ModuleNotFoundError) as error:
        text = input_error_text(error, needs, f"pip install 'slipbench[{extra}]'", target)
        if not text:
            raise
        raise _core.InputError(text) from error


def _result(text: str) -> dict[str, Any]:
    """The result of a command, which `--json` prints as `text`."""
    result: dict[str, Any] = json.loads(text)
    return result


def _text(value: Any, key: str, expected: str = "a text") -> str:
    """A text. Raises InputError, naming `key` and what is `expected`, for anything else."""
    if not isinstance(value, str):
        raise _core.InputError(f"{key}: expected {expected}, found {shown(value)}")
    return value


def _path(value: Any, key: str) -> str:
    """A path as text. Raises InputError, naming `key`, for anything else."""
    if not isinstance(value, (str, os.PathLike)):
        raise _core.InputError(f"{key}: expected a path, found {shown(value)}")
    return os.fsdecode(value)


def _items(values: Any) -> list[Any]:
    """One value or several as a list."""
    several = isinstance(values, Iterable) and not isinstance(values, (str, bytes, os.PathLike))
    return list(values) if several else [values]


def _paths(files: Any, key: str) -> list[str]:
    """One path or several as a list. Raises InputError, naming `key`, for anything else."""
    found = _items(files)
    if not found:
        raise _core.InputError(f"{key}: expected a path or a list of paths, found an empty list")
    for one in found:
        if not isinstance(one, (str, os.PathLike)) or not os.fspath(one):
            raise _core.InputError(f"{key}: expected a path or a list of paths, found {shown(one)}")
    return [os.fsdecode(one) for one in found]


def report(dataset: PathLike, output: PathLike = "", *, trial: int | None = None) -> dict[str, Any]:
    """Converts a dataset to an HTML page, like `slipbench report`.

    Args:
        dataset: path of the dataset's first file
        output: page to write; empty: the dataset's name with .html
        trial: number of the trial to show in full; None: the first

    Returns:
        The object that `--json` prints.

    Raises:
        InputError: the program's own message.
    """
    path = _path(dataset, "dataset")
    page = _core.report(path, _path(output, "output"), _whole(trial, "trial"))
    _warn_of_failures(path)
    return {"report": page}


def export(
    dataset: PathLike,
    output: PathLike,
    *,
    format: str,
    labels: str = "",
    label_speed: str | float = "",
    sensors: str | Sequence[str] = (),
    rate: str | float = "",
    split: str = "",
    trial: int | None = None,
    licence: str = "",
    points: bool = False,
    compress: bool = False,
) -> dict[str, Any]:
    """Writes a dataset in another format, like `slipbench export`.

    Args:
        dataset: path of the dataset's first file
        output: folder to write into
        format: csv, npz, robomimic, lerobot, parquet, mcap, rosbag2, or another one listed by
            `slipbench export --help`
        labels: rule by which a unit slips, listed by `slipbench export --help`; empty: the states
            by every rule
        label_speed: tip speed above which a unit slips by paper and has_slipped, "0.1 mm/s" or m/s;
            empty: 0.1 mm/s
        sensors: names of the sensors to export; empty: all
        rate: rate of the rows, "100 Hz" or in Hz; each row has the latest values; empty: sensor's
            own rate
        split: only the trials of train, valid or test; empty: all
        trial: number of the only trial to export; None: all trials
        licence: licence of the data, for the dataset card, such as "cc-by-4.0"; empty: not stated
        points: add position and force of each unit to lerobot, as the feature
            observation.tactile.<sensor> [units, 6]
        compress: write .csv.gz instead of .csv, and the arrays of robomimic compressed

    Returns:
        The object that `--json` prints.

    Raises:
        InputError: the program's own message.
    """
    from slipbench._export import write
    from slipbench._export.request import Progress, Request

    path, folder = _path(dataset, "dataset"), _path(output, "output")
    options = _core.export_options(
        _text(format, "format", "the name of a format, such as 'npz'"),
        _text(labels, "labels", "the name of a rule, such as 'strict', or an empty text"),
        _speed(label_speed, "label_speed"),
        [_text(name, "sensors", "a name or a list of names") for name in _items(sensors)],
        _whole(trial, "trial"),
        _frequency(rate, "rate"),
        _text(split, "split", "'train', 'valid', 'test' or an empty text"),
        bool(points),
        _text(licence, "licence", "a text, such as 'cc-by-4.0'"),
        bool(compress),
    )
    with (
        _input_errors(f"export: --format {format}", "export", folder),
        _core.Interrupt("stopping after this trial") as interrupt,
    ):
        request = Request(**json.loads(_core.export_files(path, folder, options)))
        files = write(request, Progress(request, interrupt, lambda note: warn([note])))
        interrupt.check()
    _warn_of_failures(path)
    return {"files": files}


def import_recordings(
    sources: PathLike | Sequence[PathLike],
    output: PathLike = "",
    *,
    format: str = "",
    map: PathLike = "",
    rate: str | float = "",
    seed: int | None = None,
) -> dict[str, Any]:
    """Imports recordings of real sensors into a dataset, like `slipbench import`.

    While a source is read by a map, the limits of memory and of unpacked files
    (tools/formats/import/README.md) apply to the whole process, and other threads wait with their
    sources.

    Args:
        sources: a file, a folder whose recordings are all imported, or several of them
        output: dataset to write; empty: only check the sources
        format: bts3v2, biotacsp-dos, papillarray-csv or training-csv; empty: the format that `map`
            describes
        map: a YAML file that describes tables, arrays or bags, or the name of an included map,
            listed by `slipbench import --help`
        rate: resampling rate, "100 Hz" or in Hz, by linear interpolation without a filter; empty:
            as recorded
        seed: seed of the split into training, validation and test; None: 1

    Returns:
        The object that `--json` prints. The first ten of its "warnings" are also Python
        warnings.

    Raises:
        InputError: the program's own message.
    """
    options = _core.import_options(
        _paths(sources, "sources"),
        _text(
            format, "format", "the name of a format, such as 'papillarray-csv', or an empty text"
        ),
        _path(map, "map"),
        _path(output, "output"),
        1 if (chosen := _whole(seed, "seed")) is None else chosen,
        _frequency(rate, "rate"),
    )
    if options.map:
        result = _import_mapped(options, _path(output, "output"))
    else:
        result = _result(_core.import_recordings(options))
    warnings = [one["text"] for one in result["warnings"]]
    if len(warnings) > _MOST_WARNINGS:
        rest = counted(len(warnings) - _MOST_WARNINGS, "more warning")
        warnings[_MOST_WARNINGS:] = [f'{rest} of this kind; the result has all under "warnings"']
    warn(warnings)
    return result


def _import_mapped(options: _core.ImportOptions, output: str) -> dict[str, Any]:
    from slipbench._import import read_mapped

    with (
        _input_errors("import --map", "import", output),
        _core.Interrupt("stopping; nothing is kept") as interrupt,
    ):
        result = _result(read_mapped(options, interrupt).summary())
        interrupt.check()
        return result


def verify(datasets: PathLike | Sequence[PathLike]) -> dict[str, Any]:
    """Verifies datasets, like `slipbench verify`.

    Checks digests, order, times, events and Coulomb's law, and shards also against each other.

    Args:
        datasets: path of a dataset's first file, or several of them

    Returns:
        The object that `--json` prints. Its "holds" is False if a check fails.

    Raises:
        InputError: a file cannot be read.
    """
    return _result(_core.verify(_paths(datasets, "datasets")))


def merge(shards: PathLike | Sequence[PathLike], output: PathLike) -> dict[str, Any]:
    """Merges the shards of a sweep, like `slipbench merge`.

    Args:
        shards: paths of the shards' first files, all of one sweep; or a single path
        output: dataset to write

    Returns:
        The object that `--json` prints.

    Raises:
        InputError: the program's own message.
    """
    return _result(_core.merge(_paths(shards, "shards"), _path(output, "output")))


def _warn_of_failures(dataset: str) -> None:
    """Warns of trials that the dataset lacks, because they failed."""
    if text := _core.failed_trials(dataset):
        warn([text])
