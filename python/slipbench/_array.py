"""Arrays of dataset files.

Imported on first use: h5py takes as long to load as the rest of the package.
"""

from __future__ import annotations

from typing import Any

import h5py

from slipbench._data import reading


class Array(h5py.Dataset):  # type: ignore[misc]  # h5py has no types
    """An array that reports damage as an InputError with the file's name."""

    def __getitem__(self, *args: Any, **options: Any) -> Any:
        with reading(self, (OSError, RuntimeError)):  # other exceptions report a wrong index
            return super().__getitem__(*args, **options)

    def read_direct(self, *args: Any, **options: Any) -> None:
        with reading(self, (OSError, RuntimeError)):
            super().read_direct(*args, **options)

    @property
    def attrs(self) -> dict[str, Any]:
        with reading(self):
            return dict(super().attrs)
