"""The program's commands on dataset files, as functions. Each runs the program and returns its
output of `--json`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from slipbench._values import plain, shown
from slipbench.bin import _core

PathLike = str | os.PathLike[str]
_SWITCHES = ("all", "compress", "points")  # options without a value


def _run(
    command: str, files: Sequence[PathLike], options: dict[str, Any], good: tuple[int, ...] = (0,)
) -> dict[str, Any]:
    """Runs `slipbench command files --option value`. Options that are None, False, an empty text or
    an empty list are omitted; 0 is passed.

    `good`: exit statuses with a result.
    """
    words = [command, *(os.fspath(file) for file in files), "--json"]
    for name, value in options.items():
        given = plain(value, name)
        if isinstance(given, bool) and name not in _SWITCHES:
            raise _core.InputError(
                f"{name.replace('-', '_')}: expected a number or a text, found {given}"
            )
        if given is True:
            words.append(f"--{name}")
        elif given is not None and given is not False and given not in ("", []):
            words.append(f"--{name}={','.join(given) if isinstance(given, list) else given}")
    place = os.pathsep.join(
        filter(None, [str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH")])
    )
    done = subprocess.run(
        [sys.executable, "-m", "slipbench", *words],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": place},
    )
    if done.returncode not in good:
        raise _core.InputError(
            done.stderr.strip().removeprefix("slipbench: ")
            or f"{command} ended with exit status {done.returncode}"
        )
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def _several(files: PathLike | Sequence[PathLike]) -> list[PathLike]:
    return [files] if isinstance(files, (str, os.PathLike)) else list(files)


def _paths(files: Any, key: str) -> list[PathLike]:
    """One path or several as a list. Raises InputError, naming `key`, for anything else."""
    several = isinstance(files, Iterable) and not isinstance(files, (str, bytes, os.PathLike))
    found = list(files) if several else [files]
    for one in found:
        if not isinstance(one, (str, os.PathLike)):
            raise _core.InputError(f"{key}: expected a path or a list of paths, found {shown(one)}")
    return found


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
    return _run("report", [dataset], {"output": output, "trial": trial})


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
    return _run(
        "export",
        [dataset],
        {
            "output": output,
            "format": format,
            "labels": labels,
            "label-speed": label_speed,
            "sensors": _several(sensors),
            "rate": rate,
            "split": split,
            "trial": trial,
            "licence": licence,
            "points": points,
            "compress": compress,
        },
    )


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

    Args:
        sources: a file, a folder whose recordings are all imported, or several of them
        output: dataset to write; empty: only check the sources
        format: bts3v2, biotacsp-dos, papillarray-csv or training-csv; empty: the format that `map`
            describes
        map: a YAML file that describes tables, arrays or bags, or the name of a map of the program:
            papillarray_ros, papillarray_ros2, xela_ros, biotac_ros, weiss_ros, uskin_boxes,
            uskin_flat, biotac_slide or fabric_slide
        rate: resampling rate, "100 Hz" or in Hz, by linear interpolation without a filter; empty:
            as recorded
        seed: seed of the split into training, validation and test; None: 1

    Returns:
        The object that `--json` prints.

    Raises:
        InputError: the program's own message.
    """
    return _run(
        "import",
        _paths(sources, "sources"),
        {"output": output, "format": format, "map": map, "rate": rate, "seed": seed},
    )


def verify(datasets: PathLike | Sequence[PathLike]) -> dict[str, Any]:
    """Verifies datasets, like `slipbench verify`: digests, order, times, events, Coulomb's law;
    shards also against each other.

    Args:
        datasets: path of a dataset's first file, or several of them

    Returns:
        The object that `--json` prints. Its "holds" is False if a check fails.

    Raises:
        InputError: a file cannot be read.
    """
    return _run("verify", _paths(datasets, "datasets"), {}, (0, 1))


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
    return _run("merge", _paths(shards, "shards"), {"output": output})
