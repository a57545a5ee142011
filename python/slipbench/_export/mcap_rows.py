"""MCAP files of topics with messages of equal length: numpy encodes a chunk at once, while
`mcap.writer` adds message by message.

The records around the messages are those of the package mcap. Format: https://mcap.dev/spec.
"""

from __future__ import annotations

import zlib
from collections import defaultdict
from dataclasses import dataclass, field
from typing import IO, Any

import numpy as np
import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)
from numpy.typing import NDArray

from slipbench._export.cdr import Messages

MAGIC = b"\x89MCAP0\r\n"
CHUNK = 1 << 20  # bytes before compression, approximate
LEVEL = -1  # zstd level; the default, 3, takes twice the time for 5 % less
MESSAGE = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])  # of a message index
OPCODE_AND_LENGTH = 9  # bytes at the beginning of each record


@dataclass
class Topic:
    """One channel of the file.

    Attributes:
        name: name of the topic
        type: full name of the messages' type
        definition: definition of that type, in `encoding`
        times: [messages] ns, ascending
        messages: in the channel's encoding
        about: the channel's metadata
    """

    name: str
    type: str
    definition: str
    times: NDArray[np.uint64]
    messages: Messages
    about: dict[str, str] = field(default_factory=dict)

    @property
    def record_size(self) -> int:
        """Bytes of a Message record."""
        return MESSAGE.itemsize + self.messages.size

    def write_records(self, channel: int, rows: NDArray[np.uint8]) -> None:
        """Writes a Message record to each of the `rows` [messages, record_size], which must hold
        zeros."""
        head = np.empty(len(self.times), MESSAGE)
        head["opcode"] = Opcode.MESSAGE
        head["length"] = self.record_size - OPCODE_AND_LENGTH
        head["channel"] = channel
        head["sequence"] = np.arange(len(self.times))
        head["log_time"] = head["publish_time"] = self.times
        rows[:, : MESSAGE.itemsize] = head.view(np.uint8).reshape(len(rows), MESSAGE.itemsize)
        self.messages.write_to(rows[:, MESSAGE.itemsize :])


@dataclass(frozen=True)
class _Block:
    """Topics with common times: each row holds one record of every topic."""

    times: NDArray[np.uint64]
    rows: NDArray[np.uint8]
    places: dict[int, int]  # offset of a channel's record in a row


def _blocks(topics: list[Topic]) -> list[_Block]:
    together: dict[bytes, list[int]] = defaultdict(list)
    for number, topic in enumerate(topics):
        together[topic.times.tobytes()].append(number)
    blocks = []
    for numbers in together.values():
        sizes = [topics[number].record_size for number in numbers]
        rows = np.zeros((len(topics[numbers[0]].times), sum(sizes)), np.uint8)
        places = {number + 1: sum(sizes[:place]) for place, number in enumerate(numbers)}
        for number, size in zip(numbers, sizes, strict=True):
            place = places[number + 1]
            topics[number].write_records(number + 1, rows[:, place : place + size])
        blocks.append(_Block(topics[numbers[0]].times, rows, places))
    return blocks


def _index_record(channel: int, entries: NDArray[Any]) -> bytes:
    """A MessageIndex record; `mcap.records` would write it entry by entry."""
    content = (
        channel.to_bytes(2, "little") + entries.nbytes.to_bytes(4, "little") + entries.tobytes()
    )
    return bytes([Opcode.MESSAGE_INDEX]) + len(content).to_bytes(8, "little") + content


class _File:
    """A file being written."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._chunks: list[ChunkIndex] = []
        self._compressor = zstandard.ZstdCompressor(level=LEVEL, write_checksum=True)

    def write(self, *records: McapRecord) -> None:
        builder: Any = RecordBuilder()  # some methods lack type annotations
        for record in records:
            record.write(builder)
        self._file.write(builder.end())

    def metadata(self, name: str, about: dict[str, str]) -> MetadataIndex:
        begin = self._file.tell()
        self.write(Metadata(name=name, metadata=about))
        return MetadataIndex(offset=begin, length=self._file.tell() - begin, name=name)

    def chunk(self, parts: list[tuple[_Block, slice]]) -> None:
        """Writes the messages of a time span. Those of a block are consecutive; the index gives
        their order in time."""
        data, indexes = [], {}
        begin = 0
        for block, span in parts:
            rows, times = block.rows[span], block.times[span]
            for channel, place in block.places.items():
                entries = np.empty(len(times), ENTRY)
                entries["time"] = times
                entries["offset"] = begin + place + rows.shape[1] * np.arange(len(times))
                indexes[channel] = _index_record(channel, entries)
            data.append(rows.reshape(-1).data)
            begin += rows.size
        plain = b"".join(data)
        packed = self._compressor.compress(
            plain
        )  # zstd's checksum takes a tenth of the time of a chunk's CRC
        first = int(min(block.times[span][0] for block, span in parts))
        last = int(max(block.times[span][-1] for block, span in parts))
        start = self._file.tell()
        self.write(
            Chunk(
                compression="zstd",
                data=packed,
                message_start_time=first,
                message_end_time=last,
                uncompressed_crc=0,
                uncompressed_size=len(plain),
            )
        )
        end = self._file.tell()
        places = {}
        for channel, record in indexes.items():
            places[channel] = self._file.tell()
            self._file.write(record)
        self._chunks.append(
            ChunkIndex(
                chunk_length=end - start,
                chunk_start_offset=start,
                compression="zstd",
                compressed_size=len(packed),
                message_end_time=last,
                message_index_length=self._file.tell() - end,
                message_index_offsets=places,
                message_start_time=first,
                uncompressed_size=len(plain),
            )
        )

    def finish(
        self,
        topics: list[Topic],
        schemas: list[Schema],
        channels: list[Channel],
        metadata: list[MetadataIndex],
    ) -> None:
        """Writes the summary section and the footer."""
        self.write(DataEnd(0))  # no checksum of the data section: each chunk has one
        statistics = Statistics(
            attachment_count=0,
            channel_count=len(channels),
            channel_message_counts={number: len(one.times) for number, one in enumerate(topics, 1)},
            chunk_count=len(self._chunks),
            message_count=sum(len(one.times) for one in topics),
            metadata_count=len(metadata),
            message_start_time=min((one.message_start_time for one in self._chunks), default=0),
            message_end_time=max((one.message_end_time for one in self._chunks), default=0),
            schema_count=len(schemas),
        )
        start = self._file.tell()
        summary: Any = RecordBuilder()
        offsets = []
        groups: list[tuple[Opcode, list[Any]]] = [
            (Opcode.SCHEMA, schemas),
            (Opcode.CHANNEL, channels),
            (Opcode.STATISTICS, [statistics]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.METADATA_INDEX, metadata),
        ]
        for opcode, records in groups:
            begin = summary.count
            for record in records:
                record.write(summary)
            if records:
                offsets.append(
                    SummaryOffset(
                        group_opcode=opcode,
                        group_start=start + begin,
                        group_length=summary.count - begin,
                    )
                )
        offset_start = start + summary.count
        for offset in offsets:
            offset.write(summary)
        data = summary.end()
        footer: Any = RecordBuilder()
        Footer(summary_start=start, summary_offset_start=offset_start, summary_crc=0).write(footer)
        content = footer.end()
        crc = zlib.crc32(
            content[:-4], zlib.crc32(data)
        )  # excludes the CRC field itself, which is last
        self._file.write(data + content[:-4] + crc.to_bytes(4, "little") + MAGIC)


def write_mcap(
    file: IO[bytes],
    topics: list[Topic],
    profile: str,
    library: str,
    encoding: tuple[str, str],
    about: dict[str, str],
) -> None:
    """Writes a file with chunks of about 1 MB, compressed by zstd, each with an index of its
    messages.

    Args:
        file: opened for binary writing, empty
        topics: in the order of their channels, numbered from 1
        profile: profile in the file's header, such as "ros2"
        library: library in the file's header
        encoding: encoding of the schemas and of the messages, such as "ros2msg" and "cdr"
        about: the file's metadata, under the name "slipbench"
    """
    numbers: dict[tuple[str, str], int] = {}
    for topic in topics:
        numbers.setdefault((topic.type, topic.definition), len(numbers) + 1)
    schemas = [
        Schema(id=number, name=name, encoding=encoding[0], data=text.encode())
        for (name, text), number in numbers.items()
    ]
    channels = [
        Channel(
            id=number,
            topic=topic.name,
            message_encoding=encoding[1],
            metadata=topic.about,
            schema_id=numbers[topic.type, topic.definition],
        )
        for number, topic in enumerate(topics, 1)
    ]
    blocks = [block for block in _blocks(topics) if len(block.times)]
    growing = _File(file)
    file.write(MAGIC)
    growing.write(Header(profile, library))
    metadata = growing.metadata("slipbench", about)
    growing.write(*schemas, *channels)
    first, last = (
        min(int(block.times[0]) for block in blocks),
        max(int(block.times[-1]) for block in blocks),
    )
    count = -(-sum(block.rows.size for block in blocks) // CHUNK)
    edges = np.linspace(first, last + 1, count + 1).astype(np.uint64)
    bounds = [np.searchsorted(block.times, edges) for block in blocks]
    for i in range(count):
        parts = [
            (block, slice(bound[i], bound[i + 1]))
            for block, bound in zip(blocks, bounds, strict=True)
            if bound[i] < bound[i + 1]
        ]
        if parts:
            growing.chunk(parts)
    growing.finish(topics, schemas, channels, [metadata])
