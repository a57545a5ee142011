"""Conversion of Python, numpy and pandas values for scenes; quantities; random streams."""

from __future__ import annotations

import decimal
import json
import numbers
import operator
import os
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from slipbench.bin import _core

Item = TypeVar("Item")


def plain(value: Any, key: str) -> Any:
    """Converts a value to a JSON type: None, bool, int, float, str, list or dict.

    Args:
        value: a number of Python or numpy, a Fraction, a Decimal, text, a path, a list, tuple,
            range or array of such values, or a mapping of names to them. A float16 or float32
            becomes the shortest decimal that reads back as it, as in numpy's output: float32(0.004)
            is 0.004.
        key: name of the value in messages

    Returns:
        The converted value.

    Raises:
        InputError: the value has another type; the message begins with the key.
    """
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, (numbers.Real, decimal.Decimal)):
        number = float(str(value)) if isinstance(value, np.floating) else float(value)
        return number if np.isfinite(number) else str(number)  # as the program writes them: inf
    if isinstance(value, os.PathLike):
        return plain(os.fspath(value), key)
    if isinstance(value, Mapping):
        return {_name(name, key): plain(one, f"{key}.{name}") for name, one in value.items()}
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray, memoryview)):
        return [plain(one, f"{key}.{index}") for index, one in enumerate(value)]
    if hasattr(value, "__array__") and not isinstance(value, np.generic):
        array = np.asarray(value)
        return plain(list(array) if array.ndim else array[()], key)
    raise _core.InputError(
        f"{key}: expected a number, a text, a list or a dict, found {shown(value)}"
    )


def _name(name: Any, key: str) -> str:
    if not isinstance(name, str):
        raise _core.InputError(f"{key}: expected names as keys, found {shown(name)}")
    return name


def shown(value: Any) -> str:
    """Type and value for a message, truncated."""
    text = repr(value)
    return f"{type(value).__name__} {text if len(text) <= 80 else text[:77] + '...'}"


def yaml(value: Any, key: str) -> str:
    """A value as YAML, which includes JSON; a text is unchanged: "4 mm/s". Raises as `plain()`."""
    converted = plain(value, key)
    return converted if isinstance(converted, str) else json.dumps(converted)


def index(value: Any, key: str) -> int:
    """A whole number of Python or numpy. Raises InputError, naming `key`, for anything else."""
    try:
        return operator.index(value)
    except TypeError:
        raise _core.InputError(f"{key}: expected a whole number, found {shown(value)}") from None


def parse_quantity(text: str, unit: str | None = None) -> float:
    """Parses a quantity as in scenes and options: `parse_quantity("4 mm/s", "m/s")` is 0.004.

    Args:
        text: a number with or without a unit; a plain number is in SI
        unit: a unit of the required quantity, such as "m/s" or "mm"; "" for a pure number; None:
            any quantity

    Returns:
        The value in SI.

    Raises:
        InputError: the text is not a number, or its unit belongs to another quantity.
    """
    return _core.parse_quantity(str(text), unit)


class RandomStream:
    """Random numbers of the program.

    Bit-identical to the C++ class `RandomStream` with the same key.

    Streams with different keys are independent, so each purpose has its own stream:
    `RandomStream(seed, trial, "split")`. A stream cannot be pickled or copied, since a copy would
    draw the same numbers again.
    """

    def __init__(self, seed: int, trial: int = 0, name: str = "") -> None:
        """Starts the stream of `seed`, `trial` and `name`, the purpose.

        Both numbers are 0 to 2^64 - 1.
        """
        numbers_of = (index(seed, "seed"), index(trial, "trial"))
        for key, number in zip(("seed", "trial"), numbers_of, strict=True):
            if not 0 <= number < 2**64:
                raise _core.InputError(f"{key} {number}; allowed: 0 to 2^64 - 1")
        self._key = (*numbers_of, name)
        self._core = _core.RandomStream(*self._key)

    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """Draws a number in [low, high); `low` if both are equal.

        Raises InputError if low exceeds high or is not finite.
        """
        self._check_interval(low, high)
        return self._core.uniform(low, high)

    def uniforms(self, count: int, low: float = 0.0, high: float = 1.0) -> NDArray[np.float64]:
        """Draws `count` numbers in [low, high), one by one as `uniform()` does. Returns [count].

        Raises InputError if `count` is not a whole number of 0 or more, or low exceeds high or is
        not finite.
        """
        self._check_interval(low, high)
        return self._core.uniforms(low, high, self._checked_count(count))

    def normal(self, mean: float = 0.0, sd: float = 1.0) -> float:
        """Draws from the normal distribution of mean `mean` and standard deviation `sd`."""
        return self._core.normal(mean, sd)

    def normals(self, count: int, mean: float = 0.0, sd: float = 1.0) -> NDArray[np.float64]:
        """Draws `count` numbers from the normal distribution of `mean` and `sd`.

        They are drawn one by one, as `normal()` does. Returns [count].

        Raises InputError if `count` is not a whole number of 0 or more.
        """
        return self._core.normals(mean, sd, self._checked_count(count))

    def integer(self, bound: int) -> int:
        """Draws a whole number in [0, bound). Raises InputError if `bound` is below 1."""
        if not 1 <= index(bound, "bound") < 2**64:
            raise _core.InputError(f"bound {bound}; allowed: 1 to 2^64 - 1")
        return self._core.integer(index(bound, "bound"))

    def permutation(self, count: int) -> NDArray[np.int64]:
        """Draws a permutation of the numbers 0 to `count` - 1 (Fisher-Yates). Returns [count].

        Raises InputError if `count` is not a whole number of 0 or more.
        """
        return self._core.permutation(self._checked_count(count))

    def shuffle(self, items: list[Item]) -> None:
        """Shuffles the list `items` in place (Fisher-Yates)."""
        items[:] = [items[at] for at in self.permutation(len(items))]

    @staticmethod
    def _checked_count(count: int) -> int:
        number = index(count, "count")
        if not 0 <= number < 2**64:
            raise _core.InputError(f"count {number}; allowed: 0 to 2^64 - 1")
        return number

    @staticmethod
    def _check_interval(low: float, high: float) -> None:
        if not low <= high or not np.isfinite(high - low):
            raise _core.InputError(
                f"low {low}, high {high}; allowed: finite numbers, low at most high"
            )

    def __reduce__(self) -> Any:
        raise TypeError(
            f"{self!r} cannot be pickled or copied; create a new one there: RandomStream({', '.join(map(repr, self._key))})"
        )

    def __repr__(self) -> str:
        return f"<slipbench.RandomStream seed={self._key[0]} trial={self._key[1]} name={self._key[2]!r}>"
