"""Bags of ROS 1 and ROS 2, and MCAP files of ROS 2, by the library rosbags."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from slipbench import InputError
from slipbench._import.arrays import Columns
from slipbench._import.block import nearest

MOST_VALUES = 100_000  # of one message


def flatten(message: Any, title: str, into: dict[str, Any]) -> None:
    """Adds the numbers and texts of a message by their titles: "header.stamp" [s], "pillars[3].fX", "data[7]"."""
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


class Topic(Columns):
    """The messages of one topic: a column for each value of a message."""

    def __init__(self, path: str, name: str, times: list[int], columns: dict[str, Any]) -> None:
        super().__init__(path, columns)
        self.name = name
        self._times = np.array(times, dtype=np.int64)

    def clock(self) -> np.ndarray | None:
        return self._times

    def place(self, row: int) -> str:
        return f"{self.path}: topic {self.name}, message {row + 1}"

    def title_place(self) -> str:
        return f"{self.path}: topic {self.name}"

    def items(self, each: str) -> list[Topic]:
        """The items of a list of each message as topics of their own."""
        topics: list[Topic] = []
        while True:
            start = f"{each}[{len(topics)}]."
            found = {
                title.removeprefix(start): column for title, column in self._columns.items() if title.startswith(start)
            }
            if not found:
                break
            found |= {title: column for title, column in self._columns.items() if not title.startswith(f"{each}[")}
            topics.append(Topic(self.path, f"{self.name}, {each}[{len(topics)}]", self._times.tolist(), found))
        if not topics:
            raise InputError(
                f"{self.title_place()}: the messages have no list {each!r} of messages{nearest(each, self.titles)}"
            )
        return topics


class Bag:
    """A bag, whose topics are read when they are asked for.

    Args:
        path: a .bag or .mcap file, or the folder of a bag of ROS 2

    Raises:
        InputError: the bag cannot be read.
    """

    def __init__(self, path: str) -> None:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        self.path = path
        # Definitions of messages are those in the bag; a bag of ROS 2 that has none is read by those of ROS 2 itself.
        self._reader = AnyReader([Path(path)], default_typestore=get_typestore(Stores.LATEST))
        try:
            self._reader.open()
        except Exception as error:  # noqa: BLE001  rosbags and its decompressors raise many kinds on damaged files
            raise InputError(f"{path}: cannot be read as a bag: {error}") from error
        self.topics = {connection.topic: connection.msgtype for connection in self._reader.connections}

    def close(self) -> None:
        """Closes the files."""
        self._reader.close()

    def find(self, topic: str, message: str) -> list[str]:
        """The topics that a map means: one by its name, all of a type of message, or the only one.

        Args:
            topic: its name; empty: by `message`
            message: type, "papillarray_interfaces/msg/SensorState", or its last part; empty: any

        Raises:
            InputError: there is no such topic, or more than one and neither name nor type are given.
        """
        listed = ", ".join(f"{name} ({kind})" for name, kind in list(self.topics.items())[:10])
        if topic:
            if topic not in self.topics:
                raise InputError(f"{self.path}: has no topic {topic!r}{nearest(topic, list(self.topics))}")
            return [topic]
        if message:
            found = [
                name for name, kind in self.topics.items() if kind == message or kind.rsplit("/", 1)[-1] == message
            ]
            if not found:
                raise InputError(f"{self.path}: has no topic of the type {message!r}; found: {listed}")
            return sorted(found)
        if len(self.topics) != 1:
            raise InputError(
                f"{self.path}: has {len(self.topics)} topics, so that the map needs the key 'topic'; found: {listed}"
            )
        return list(self.topics)

    def read(self, name: str) -> Topic:
        """All messages of a topic. Raises InputError where one cannot be read or they differ in their lengths."""
        times: list[int] = []
        rows: list[dict[str, Any]] = []
        try:
            for connection, time, raw in self._reader.messages(
                [one for one in self._reader.connections if one.topic == name]
            ):
                row: dict[str, Any] = {}
                flatten(self._reader.deserialize(raw, connection.msgtype), "", row)
                times.append(time)
                rows.append(row)
        except Exception as error:  # noqa: BLE001
            raise InputError(f"{self.path}: topic {name}, message {len(rows) + 1}: cannot be read: {error}") from error
        if not rows:
            raise InputError(f"{self.path}: topic {name} has no message")
        titles = list(rows[0])
        for k, row in enumerate(rows):
            if row.keys() != rows[0].keys():
                raise InputError(
                    f"{self.path}: topic {name}, message {k + 1}: has {len(row)} values and the first message {len(titles)}; "
                    "expected lists of one length"
                )
        return Topic(self.path, name, times, {title: np.array([row[title] for row in rows]) for title in titles})
