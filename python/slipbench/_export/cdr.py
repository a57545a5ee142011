"""Messages of ROS 2 in CDR, encoded by numpy for all rows of a topic at once.

CDR (OMG DDSI-RTPS 2.2, 10.5; XCDR version 1, little-endian): four bytes for the encapsulation, then
the fields in order. A number of n bytes is aligned to n bytes, counted after the encapsulation. A
string is its length as uint32 including the closing NUL, its bytes, and NUL. A sequence is its
length as uint32, then its elements.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

ENCAPSULATION = bytes([0, 1, 0, 0])  # CDR_LE


class Messages:
    """The messages of one topic, field by field. All have the same length, since strings and
    lengths are constant.

    Args:
        count: number of messages
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._parts: list[
            tuple[int, NDArray[np.uint8]]
        ] = []  # offset after the encapsulation, bytes [count or 1, n]
        self._end = 0

    @property
    def size(self) -> int:
        """Bytes of a message."""
        return len(ENCAPSULATION) + self._end

    def numbers(self, values: Any, kind: str) -> None:
        """Adds numbers of the numpy type `kind` ("<f4"): [count, ...], or a single number for all
        messages."""
        array = np.asarray(values, kind)
        rows = np.ascontiguousarray(
            array.reshape(1 if array.ndim == 0 else self.count, int(np.prod(array.shape[1:])))
        )
        self._end += -self._end % array.itemsize
        self._parts.append((self._end, rows.view(np.uint8)))
        self._end += rows.shape[1] * array.itemsize

    def structures(self, values: NDArray[Any]) -> None:
        """Adds structures [count, n] with a numpy type of native alignment. It equals CDR's
        alignment
        if they begin at a multiple of it."""
        self._end += -self._end % values.dtype.alignment
        rows = values.reshape(self.count, -1).view(np.uint8)
        self._parts.append((self._end, rows))
        self._end += rows.shape[1]

    def text(self, value: str) -> None:
        """Adds a string that all messages share."""
        encoded = value.encode() + b"\0"
        self.numbers(len(encoded), "<u4")
        self._parts.append((self._end, np.frombuffer(encoded, np.uint8).reshape(1, -1)))
        self._end += len(encoded)

    def sequence(self, values: NDArray[Any], kind: str) -> None:
        """Adds a sequence of numbers: [count, elements]."""
        self.numbers(int(np.prod(values.shape[1:])), "<u4")
        self.numbers(values, kind)

    def stamp(self, times: NDArray[np.uint64]) -> None:
        """Adds builtin_interfaces/Time: whole seconds and remaining nanoseconds. `times`: [count]
        ns."""
        seconds, rest = np.divmod(times, np.uint64(10**9))
        self.numbers(seconds, "<i4")
        self.numbers(rest, "<u4")

    def header(self, times: NDArray[np.uint64], frame: str) -> None:
        """Adds std_msgs/Header."""
        self.stamp(times)
        self.text(frame)

    def write_to(self, rows: NDArray[np.uint8]) -> None:
        """Writes the messages to `rows` [count, size], which must hold zeros."""
        rows[:, : len(ENCAPSULATION)] = np.frombuffer(ENCAPSULATION, np.uint8)
        body = rows[:, len(ENCAPSULATION) :]
        for offset, part in self._parts:
            width = part.shape[1]
            if width:  # numpy copies a row of bytes faster as one value
                body[:, offset : offset + width].view(f"V{width}")[:] = part.view(f"V{width}")
