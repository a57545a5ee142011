"""Formats of `slipbench export` that are written in Python, and the dataset card of every format."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from slipbench._data import open as open_dataset

if TYPE_CHECKING:
    from slipbench._export.request import Progress, Request


def write(request: Request, progress: Progress) -> list[str]:
    """Writes the trials of a dataset, or the card of the files that C++ has written.

    Args:
        request: the export
        progress: receives progress and notes; raises KeyboardInterrupt after a signal

    Returns:
        The names of all files of the export.

    Raises:
        InputError, OSError: as the writers; no file remains
        ModuleNotFoundError: the format needs a package that is not installed
    """
    try:
        writer = importlib.import_module(
            f"slipbench._export.{'card' if request.files else request.format}"
        )
        with open_dataset(request.dataset, check=False) as data:  # C++ has checked the digests
            files: list[str] = writer.write(data, request, progress)
        progress.end_notes()
    finally:
        progress.end()
    return files
