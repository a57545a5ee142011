"""Blocks of a map: YAML checked by the table of keys, with file and line in every error."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Callable
from typing import Any, NoReturn

from slipbench import InputError, parse_quantity
from slipbench._import.keys import BLOCKS, TIME_UNITS, Key
from slipbench.bin import _core

LARGEST = 1_000_000  # lines that a list may skip, components
LONGEST = 60  # letters of a listed name


class Node:
    """A node of the YAML file: its text, items or keys, and its line.

    Args:
        path: path of the file
        parts: a node of `_core.read_yaml`: key, line of the key, kind, line, text, children
    """

    def __init__(self, path: str, parts: tuple[Any, ...]) -> None:
        self.path = path
        self.key: str = parts[0]
        self.kind: str = parts[2]
        self.line: int = parts[3]
        self.text: str = parts[4]
        self.children = [Node(path, child) for child in parts[5]]

    def fail(self, message: str) -> NoReturn:
        """Raises InputError with file and line."""
        raise InputError(f"{self.path}:{max(self.line, 1)}: {message}")

    @property
    def described(self) -> str:
        """Describes the value as written: a text in quotes, "a map", "a list", "nothing"."""
        return {"scalar": repr(self.text), "sequence": "a list", "map": "a map"}.get(
            self.kind, "nothing"
        )


def quoted(text: str) -> str:
    """A text from a file for a message: in quotes, with escapes, cut after LONGEST characters."""
    return repr(text if len(text) <= LONGEST else text[:LONGEST] + "…")


def character_text(character: str) -> str:
    """Code and name of a character: "U+00A0 (no-break space)"."""
    return f"U+{ord(character):04X} ({unicodedata.name(character, 'without a name').lower()})"


def folded(text: str) -> str:
    """The text with characters replaced that look like others.

    Spaces of any kind, minus signs and dashes, full-width forms; and without invisible characters.
    """
    plain = "".join(
        " "
        if unicodedata.category(one) == "Zs"
        else "-"
        if unicodedata.category(one) == "Pd" or one == "\N{MINUS SIGN}"
        else one
        for one in unicodedata.normalize("NFKC", text)
        if unicodedata.category(one) != "Cf"
    )
    return plain.strip()


def unlike_ascii(text: str) -> list[str]:
    """The characters of a text that look like others, such as a no-break space, or like nothing."""
    return [
        one for one in dict.fromkeys(text) if ord(one) > 127 and folded(f"a{one}a") != f"a{one}a"
    ]


def nearest(name: str, known: list[str]) -> str:
    """The end of an error about an unknown name: "; did you mean 'b'? found: a, b, c".

    Lists at most ten names, and names the character that distinguishes `name` from a known name
    that looks alike.
    """
    short = (
        [one for one in known if len(one) <= 3 * LONGEST] if len(name) <= 3 * LONGEST else []
    )  # comparing is quadratic
    close = [one for one in short if folded(one) == folded(name)] or difflib.get_close_matches(
        name, short, 1
    )
    close = close or [one for one in short if one.lower() == name.lower()]
    names = [one if len(one) <= LONGEST else one[:LONGEST] + "…" for one in known[:10]]
    shown = ", ".join(names) + (f" and {len(known) - 10} more" if len(known) > 10 else "")
    if not close:
        return f"; found: {shown}"
    odd = [
        f"{one!r} has {character_text(other)}"
        for one in (close[0], name)
        for other in unlike_ascii(one)
    ]
    return f"; did you mean {close[0]!r}?{f' {odd[0]};' if odd else ''} found: {shown}"


def _scalar(node: Node, where: str, expected: str) -> str:
    if node.kind != "scalar":
        node.fail(f"{where}: expected {expected}, found {node.described}")
    return node.text


def _number(node: Node, where: str) -> float:
    try:
        value = float(_scalar(node, where, "a number"))
    except ValueError:
        value = 0.0
    if not 1e-30 < abs(value) < 1e30:
        node.fail(f"{where}: expected a number other than 0, found {node.described}")
    return value


def _factor(node: Node, where: str) -> tuple[float, str]:
    """A factor and its unit: "0.01 N" is 0.01 and "N"; the unit of a plain number is empty."""
    number, _, unit = (
        _scalar(node, where, "a number, or a number with a unit such as '0.01 N'")
        .strip()
        .partition(" ")
    )
    try:
        value = float(number)
    except ValueError:
        value = 0.0
    if not 1e-30 < abs(value) < 1e30 or not _core.is_plain_name(unit.strip() or number):
        node.fail(
            f"{where}: expected a number other than 0, or with a unit as '0.01 N', found {node.described}"
        )
    return value, unit.strip()


def _integer(node: Node, where: str) -> int:
    text = _scalar(node, where, "a whole number")
    if not re.fullmatch(r"[0-9]{1,7}", text) or not 1 <= int(text) <= LARGEST:
        node.fail(f"{where}: expected a whole number from 1 to {LARGEST}, found {node.described}")
    return int(text)


def _duration(node: Node, where: str) -> float:
    """Seconds of a text such as "1 day", "12 h" or "500 ms"."""
    text = _scalar(node, where, "a time such as '1 day'")
    try:
        if long := re.fullmatch(r"([0-9]++(?:\.[0-9]++)?|\.[0-9]++) *(days?|h)", text):
            seconds = float(long[1]) * (TIME_UNITS["h"] if long[2] == "h" else 24 * TIME_UNITS["h"])
        else:
            seconds = parse_quantity(text, "s")
    except InputError as error:
        node.fail(f"{where}: {error}; or in day or h")
    if not 1e-9 <= seconds <= 1e10:
        node.fail(f"{where}: expected a time such as '1 day', found {text!r}")
    return seconds


def _blocks(node: Node, key: Key, where: str) -> dict[str, Block]:
    if node.kind != "map" or not node.children:
        node.fail(f"{where}: expected blocks by their names, found {node.described}")
    return {child.key: Block(child, key.block, f"{where}.{child.key}") for child in node.children}


def _texts(node: Node, where: str) -> list[str]:
    if node.kind != "sequence" or not node.children:
        node.fail(f"{where}: expected a list of texts, found {node.described}")
    return [_scalar(child, where, "a text") for child in node.children]


def _words(node: Node, where: str) -> dict[str, str]:
    if node.kind != "map" or not node.children:
        node.fail(f"{where}: expected pairs TEXT: TEXT, found {node.described}")
    return {child.key: _scalar(child, f"{where}.{child.key}", "a text") for child in node.children}


def _lines(node: Node, where: str) -> int | list[int]:
    if node.kind == "sequence":
        return [_integer(child, where) for child in node.children]
    return _integer(node, where)


def _factors(node: Node, where: str) -> list[tuple[float, str]]:
    if node.kind == "sequence" and node.children:
        return [_factor(child, where) for child in node.children]
    return [_factor(node, where)]


def _boolean(node: Node, where: str) -> bool:
    text = _scalar(node, where, "true or false")
    if text not in ("true", "false"):
        node.fail(f"{where}: expected true or false, found {text!r}")
    return text == "true"


def _rate(node: Node, where: str) -> float:
    text = _scalar(node, where, "a rate such as '100 Hz'")
    try:
        rate = parse_quantity(text, "Hz")
    except InputError as error:
        node.fail(f"{where}: {error}")
    if not 1e-6 <= rate <= 1e9:
        node.fail(f"{where}: expected a rate such as '100 Hz', found {text!r}")
    return rate


def _text(node: Node, key: Key, where: str) -> str:
    """A text of one line: a name, one of the key's choices, or any."""
    text = _scalar(node, where, f"a text ({key.description})")
    if key.kind == "name" and not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", text):
        node.fail(f"{where}: expected letters, digits and '_', no digit first, found {text!r}")
    if key.choices and text not in key.choices:
        node.fail(f"{where}: expected {' or '.join(key.choices)}, found {text!r}")
    if not text or not _core.is_plain_name(text):
        node.fail(f"{where}: expected a text of one line, found {text!r}")
    return text


# Readers of the values of some kinds.
_READERS: dict[str, Callable[[Node, str], Any]] = {
    "boolean": _boolean,
    "duration": _duration,
    "factors": _factors,
    "integer": _integer,
    "lines": _lines,
    "number": _number,
    "rate": _rate,
    "texts": _texts,
    "words": _words,
}


def _value(node: Node, key: Key, where: str) -> Any:
    """The value of a key, by its kind."""
    if key.kind == "blocks":
        return _blocks(node, key, where)
    if key.kind == "block":
        return Block(node, key.block, where)
    if read := _READERS.get(key.kind):
        return read(node, where)
    return _text(node, key, where)


class Block:
    """A block whose keys are checked against BLOCKS.

    Args:
        node: node of the file
        kind: name of the block in BLOCKS
        where: path of its keys, for messages; empty for the whole map
    """

    def __init__(self, node: Node, kind: str, where: str = "") -> None:
        self.node, self.where = node, where
        keys = {key.name: key for key in BLOCKS[kind]}
        if node.kind != "map":
            node.fail(
                f"{where or 'the map'}: expected the keys {', '.join(keys)}, found {node.described}"
            )
        self._values: dict[str, Any] = {}
        self._nodes = {child.key: child for child in node.children}
        for child in node.children:
            if child.key not in keys:
                child.fail(
                    f"unknown key {child.key!r} in {where or 'the map'}{nearest(child.key, list(keys))}".replace(
                        " found: ", " allowed: "
                    )
                )
            self._values[child.key] = _value(child, keys[child.key], self.path(child.key))
        for key in keys.values():
            if key.required:
                self.need(key.name)

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def get(self, key: str, default: Any = None) -> Any:
        """The value of a key, or the default."""
        return self._values.get(key, default)

    def need(self, key: str) -> Any:
        """The value of a key. Raises InputError if the map lacks it."""
        if key not in self._values:
            self.node.fail(f"{self.where or 'the map'} has no key {key!r}")
        return self._values[key]

    def path(self, key: str) -> str:
        """The key with its parent keys."""
        return f"{self.where}.{key}" if self.where else key

    def fail(self, message: str, key: str = "") -> NoReturn:
        """Raises InputError with file and line of the key, or of the block."""
        self._nodes.get(key, self.node).fail(message)

    def only_one(self, keys: tuple[str, ...]) -> str:
        """The one of several keys that the block has.

        Raises InputError unless it has exactly one.
        """
        found = [key for key in keys if key in self]
        if len(found) != 1:
            self.fail(
                f"{self.where or 'the map'}: expected one of {', '.join(keys)}, found {' and '.join(found) or 'none of them'}"
            )
        return found[0]


def read_map(path: str) -> Block:
    """Reads and checks a map.

    Args:
        path: YAML file

    Returns:
        The block "map" of the file.

    Raises:
        InputError: file:line, the key, what was found and what is expected.
    """
    return Block(Node(path, _core.read_yaml(path)), "map")
