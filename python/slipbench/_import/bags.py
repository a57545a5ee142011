"""Bags of ROS 1 and ROS 2, and MCAP files of ROS 2, by the library rosbags."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from slipbench import InputError
from slipbench._import.arrays import Columns
from slipbench._import.block import Block, nearest
from slipbench._import.limits import MEMORY_OF_BAG, check_inside, memory_limit, unpacked_limit
from slipbench._program import counted

MOST_VALUES = 100_000  # of one list in a message
MOST_IN_TOPIC = 100_000_000
BLOCK = 1_000_000  # values kept as Python objects


def flatten(message: Any, title: str, into: dict[str, Any]) -> None:
    """Adds the numbers and texts of a message by their titles.

    Titles are such as "header.stamp" [s], "pillars[3].fX" and "data[7]".
    """
    fields = getattr(message, "__dataclass_fields__", None)
    if fields is not None:
        names = [name for name in fields if not name.startswith("__")]
        if set(names) == {"sec", "nanosec"}:
            into[title] = float(message.sec) + 1e-9 * float(message.nanosec)
            return
        for name in names:
            flatten(getattr(message, name), f"{title}.{name}" if title else name, into)
    elif isinstance(message, np.ndarray | list | tuple):
        if len(message) > MOST_VALUES:
            return
        for k, item in enumerate(message):
            flatten(item, f"{title}[{k}]", into)
    else:
        into[title] = message


def _columns(rows: list[dict[str, Any]], titles: list[str]) -> dict[str, np.ndarray]:
    return {title: np.array([row[title] for row in rows]) for title in titles}


class Topic(Columns):
    """The messages of one topic: one column for each value of a message."""

    def __init__(self, path: str, name: str, times: list[int], columns: dict[str, Any]) -> None:
        super().__init__(path, columns)
        self.name = name
        self._times = np.array(times, dtype=np.int64)

    def clock(self) -> np.ndarray | None:
        return self._times

    def place(self, row: int) -> str:
        return f"{self.path}: topic {self.name}, {self.row_text(row)}"

    def row_text(self, row: int) -> str:
        return f"message {row + 1}"

    def title_place(self) -> str:
        return f"{self.path}: topic {self.name}"

    def items(self, each: str) -> list[Topic]:
        """The items of a list in each message as separate topics."""
        topics: list[Topic] = []
        while True:
            start = f"{each}[{len(topics)}]."
            found = {
                title.removeprefix(start): column
                for title, column in self._columns.items()
                if title.startswith(start)
            }
            if not found:
                break
            # A field of the item takes precedence over a field of the message with the same name.
            found = {
                one: column
                for one, column in self._columns.items()
                if not one.startswith(f"{each}[")
            } | found
            topics.append(
                Topic(self.path, f"{self.name}, {each}[{len(topics)}]", self._times.tolist(), found)
            )
        if not topics:
            raise InputError(
                f"{self.title_place()}: the messages have no list {each!r} of messages{nearest(each, self.titles)}"
            )
        return topics


def read_definitions(map: Block, folders: list[Path]) -> dict[str, Any]:
    """The messages of a map's key `definitions`.

    Args:
        map: the whole map
        folders: folders of the recordings, in which the definitions may be, too

    Returns:
        rosbags' definition of each message, by its type "PACKAGE/msg/NAME".

    Raises:
        InputError: a file is missing or is not a definition.
    """
    from rosbags.typesys import get_types_from_msg

    types: dict[str, Any] = {}
    for given in map.get("definitions", []):
        map_folder = Path(map.node.path).absolute().parent
        path = map_folder / given
        try:
            check_inside(path, [map_folder, *folders])
            files = sorted(path.rglob("*.msg")) if path.is_dir() else [path]
            for file in files:
                check_inside(file, [map_folder, *folders])
        except InputError as error:
            map.fail(f"definitions: {error}", "definitions")
        if not path.exists() or not files:
            map.fail(
                f"definitions: expected a .msg file or a folder with such files next to the map, found {given!r}, which "
                f"{'has none' if path.exists() else 'is not there'}",
                "definitions",
            )
        for file in files:
            package = file.parents[1] if file.parent.name == "msg" else file.parent
            try:
                types |= get_types_from_msg(
                    file.read_text(encoding="utf-8"), f"{package.name}/msg/{file.stem}"
                )
            except Exception as error:  # noqa: BLE001  the parser raises many kinds, whose texts quote the file
                raise InputError(
                    f"{file}: cannot be read as the definition of a message in the syntax of ROS"
                ) from error
    return types


def missing_types(kind: str, known: dict[str, Any]) -> list[str]:
    """Types in messages of the type `kind` that `known`, by rosbags, lacks."""
    from rosbags.interfaces import Nodetype

    found: dict[str, None] = {kind: None}
    waiting = [kind]
    while waiting:
        for _, (node, content) in known.get(waiting.pop(), ([], []))[1]:
            if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                node, content = content[0]
            if node == Nodetype.NAME and content not in found:
                found[content] = None
                waiting.append(content)
    return [one for one in found if one not in known]


MCAP_MAGIC = b"\x89MCAP0\r\n"
MCAP_CHANNEL, MCAP_FOOTER = 4, 37  # code of a record; bytes at the end of a file
LARGEST_SUMMARY = 100_000_000  # bytes


def check_encoding(path: str) -> None:
    """Raises InputError for an MCAP file whose messages are not those of ROS 2.

    Other messages, such as protobuf, are listed in the summary at the file's end.
    """
    if not Path(path).is_file():
        return
    with open(path, "rb") as file:
        size = file.seek(0, 2)
        file.seek(0)
        if file.read(len(MCAP_MAGIC)) != MCAP_MAGIC or size < MCAP_FOOTER:
            return
        file.seek(-MCAP_FOOTER, 2)
        start = int.from_bytes(file.read(MCAP_FOOTER)[9:17], "little")
        if not 0 < start < size or size - start > LARGEST_SUMMARY:
            return
        file.seek(start)
        summary = file.read()
    encodings: set[str] = set()
    at = 0
    while at + 9 <= len(summary):
        length = int.from_bytes(summary[at + 1 : at + 9], "little")
        record = summary[at + 9 : at + 9 + length]
        if summary[at] == MCAP_CHANNEL:
            topic = int.from_bytes(record[4:8], "little")  # its length
            end = 12 + topic + int.from_bytes(record[8 + topic : 12 + topic], "little")
            encodings.add(record[12 + topic : end].decode("utf-8", "replace"))
        at += 9 + length
    if others := sorted(encodings - {"cdr"}):
        raise InputError(
            f"{path}: is an MCAP file with messages in {' and '.join(map(repr, others))}; expected those of ROS 2 in 'cdr', as "
            "`slipbench export --format rosbag2` and `ros2 bag record` write them"
        )


class Bag:
    """A bag, whose topics are read on demand.

    Args:
        path: a .bag or .mcap file, or the folder of a bag of ROS 2
        definitions: additional message definitions for a bag without definitions, from
            read_definitions()

    Raises:
        InputError: the bag is unreadable.
    """

    def __init__(self, path: str, definitions: dict[str, Any]) -> None:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        self.path = path
        # Definitions in the bag take precedence over those of the map and of ROS 2.
        others = get_typestore(Stores.LATEST).fielddefs | definitions
        self._reader = AnyReader([Path(path)], default_typestore=get_typestore(Stores.EMPTY))
        try:
            with unpacked_limit(path), memory_limit(path, MEMORY_OF_BAG):
                self._reader.open()
            store = self._reader.typestore
            if any(missing_types(one.msgtype, store.fielddefs) for one in self._reader.connections):
                store.register(
                    {name: one for name, one in others.items() if name not in store.fielddefs}
                )
        except InputError:
            raise
        except Exception as error:  # noqa: BLE001  rosbags and its decompressors raise many kinds on damaged files
            check_encoding(path)
            raise InputError(f"{path}: cannot be read as a bag: {error}") from error
        self.topics = {
            connection.topic: connection.msgtype for connection in self._reader.connections
        }

    def close(self) -> None:
        """Closes the files."""
        self._reader.close()

    def find(self, topic: str, message: str) -> list[str]:
        """The topics selected by a map: one by its name, all of a message type, or the only one.

        Args:
            topic: its name; empty: by `message`
            message: type, "papillarray_interfaces/msg/SensorState", or its last part; empty: any

        Raises:
            InputError: there is no such topic, or several topics and neither name nor type are
                given.
        """
        listed = ", ".join(f"{name} ({kind})" for name, kind in list(self.topics.items())[:10])
        if topic:
            if topic not in self.topics:
                raise InputError(
                    f"{self.path}: has no topic {topic!r}{nearest(topic, list(self.topics))}"
                )
            return [topic]
        if message:
            found = [
                name
                for name, kind in self.topics.items()
                if kind == message or kind.rsplit("/", 1)[-1] == message
            ]
            if not found:
                raise InputError(
                    f"{self.path}: has no topic of the type {message!r}; found: {listed}"
                )
            return sorted(found)
        if len(self.topics) != 1:
            raise InputError(
                f"{self.path}: has {len(self.topics)} topics, so the map needs the key 'topic'; found: {listed}"
            )
        return list(self.topics)

    def _decoded(self, name: str) -> Iterator[tuple[int, Any]]:
        """Receipt times [ns] and messages of a topic. Raises InputError if one is unreadable."""
        count = 0
        try:
            for connection, time, raw in self._reader.messages(
                [one for one in self._reader.connections if one.topic == name]
            ):
                yield time, self._reader.deserialize(raw, connection.msgtype)
                count += 1
        except MemoryError:
            raise
        except Exception as error:  # noqa: BLE001
            raise InputError(
                f"{self.path}: topic {name}, message {count + 1}: cannot be read: {error}"
            ) from error

    def read(self, name: str) -> Topic:
        """All messages of a topic.

        Raises InputError if one is unreadable, their lengths differ, or they need too much memory.
        """
        with memory_limit(self.path, MEMORY_OF_BAG):
            return self._read(name)

    def _read(self, name: str) -> Topic:
        if missing := missing_types(self.topics[name], self._reader.typestore.fielddefs):
            raise InputError(
                f"{self.path}: topic {name}: the bag has no definition of {' and '.join(missing)}; name the .msg file, or a "
                "folder of such files, in the map: definitions: [PATH]"
            )
        times: list[int] = []
        rows: list[dict[str, Any]] = []  # of messages that are not in `blocks` yet
        blocks: list[dict[str, np.ndarray]] = []
        titles: list[str] = []
        for time, message in self._decoded(name):
            row: dict[str, Any] = {}
            flatten(message, "", row)
            titles = titles or list(row)
            if list(row) != titles:
                raise InputError(
                    f"{self.path}: topic {name}, message {len(times) + 1}: has {counted(len(row), 'value')} and the first message "
                    f"{len(titles)}; expected lists of the same length"
                )
            times.append(time)
            if len(times) * len(titles) > MOST_IN_TOPIC:
                raise InputError(
                    f"{self.path}: topic {name} has more than {MOST_IN_TOPIC} values; split the bag"
                )
            rows.append(row)
            if len(rows) * len(titles) >= BLOCK:
                blocks.append(_columns(rows, titles))
                rows = []
        if not times:
            raise InputError(f"{self.path}: topic {name} has no message")
        if not titles:
            raise InputError(
                f"{self.path}: topic {name}: the messages have no values, or only lists of more than {MOST_VALUES}"
            )
        if rows:
            blocks.append(_columns(rows, titles))
        return Topic(
            self.path,
            name,
            times,
            {title: np.concatenate([one[title] for one in blocks]) for title in titles},
        )
