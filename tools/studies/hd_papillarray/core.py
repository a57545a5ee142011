"""Results of the synthesis of the register-level core.

Cycles and areas, from the file of rtl/hd/syn/report.py.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from slipbench import InputError
from slipbench.bin import _core

CLOCK = 100e6  # Hz, of the published boards
FIGURES_FILE = "rtl/hd/syn/results.json"  # path from the project's root


@dataclass(frozen=True)
class Configuration:
    """A degree of unrolling.

    Attributes:
        name: name of the unrolling
        cycles: from an accepted sample to its class
        interval: cycles between samples
        lut: look-up tables
        ff: flip-flops
        bram: blocks of 36 kbit
        dsp: multipliers
        levels: longest path in levels of logic
    """

    name: str
    cycles: int
    interval: int
    lut: float
    ff: float
    bram: float
    dsp: float
    levels: float


@dataclass(frozen=True)
class CoreFigures:
    """All unrollings.

    Attributes:
        tool: synthesis tool: "Yosys 0.70"
        configurations: in the order of the file
    """

    tool: str
    configurations: tuple[Configuration, ...]


def _number(entry: dict[str, Any], key: str, subject: str) -> float:
    value = entry.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or value < 0:
        found = json.dumps(value) if key in entry else "missing"
        raise InputError(f"{subject}: {key} is {found}; expected a number of 0 or more")
    return value


def _configuration(name: str, entry: object, path: str) -> Configuration:
    subject = f"{path}: unrolling '{name}'"
    if not isinstance(entry, dict):
        raise InputError(f"{subject}: is not a JSON object")
    cycles, interval = (
        int(_number(entry, key, subject)) for key in ("latency_cycles", "interval_cycles")
    )
    return Configuration(
        name,
        cycles,
        interval,
        *(float(_number(entry, key, subject)) for key in ("lut", "ff", "bram36", "dsp", "levels")),
    )


def read_figures(path: str) -> CoreFigures:
    """Reads a file of rtl/hd/syn/report.py.

    Args:
        path: {"tools": {"yosys"}, "unrollings": {NAME: {"latency_cycles", "interval_cycles", "lut",
            "ff", "bram36", "dsp", "levels"}}}; other keys are ignored

    Returns:
        its figures

    Raises:
        InputError: for an invalid file, with its name
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise InputError(f"{path}: is not a JSON object: {error}") from error
    if not isinstance(content, dict):
        raise InputError(f"{path}: is not a JSON object")
    tools, unrollings = content.get("tools"), content.get("unrollings")
    if not isinstance(tools, dict):
        raise InputError(f'{path}: tools is not an object; expected {{"yosys": version}}')
    version = tools.get("yosys")
    if not isinstance(version, str):
        raise InputError(f"{path}: tools: yosys is not a text")
    if not isinstance(unrollings, dict) or not unrollings:
        raise InputError(
            f"{path}: unrollings is not an object; expected one entry for each degree of unrolling"
        )
    tool = version.split(" (")[0]  # "Yosys 0.70 (git sha1 ..."
    return CoreFigures(
        tool, tuple(_configuration(name, entry, path) for name, entry in unrollings.items())
    )


def stored_figures() -> CoreFigures:
    """Returns the figures of FIGURES_FILE.

    Raises:
        InputError: if the project has no such file, or it is invalid
    """
    return read_figures(_core.project_file(FIGURES_FILE))
