"""MCAP: one file per trial, for Foxglove, Lichtblick, PlotJuggler and Rerun.

It has topics for each sensor, its labels, the bodies and the loop.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO, Any

import numpy as np
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorSet
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import build_file_descriptor_set
from numpy.typing import NDArray

from slipbench import Arrays, Dataset, InputError, StoredTrial
from slipbench._export.card import CARDS, check_card, without_folders, write_card
from slipbench._export.request import Output, Progress, Request, split_of
from slipbench._export.series import Series, body_series, control_series, sensor_at
from slipbench.bin import _core

CELL = 1e-3  # m, cell size of an image whose units have unknown positions
LAYOUT = "foxglove-layout.json"
MAGIC = b"\x89MCAP0\r\n"
# Arrays of states, which a viewer draws over time.
STATES = ("state", "state_micro", "state_paper", "state_recorded", "detector_class")
CHUNK = 1 << 20  # approximate number of bytes before compression that a viewer reads at once

Rows = NDArray[np.uint8]  # [messages, bytes]: protobuf, with equal length of all messages


@dataclass(frozen=True)
class Topic:
    """Content of one channel.

    Attributes:
        name: name of the topic
        type: full name of the messages' protobuf type
        schema: FileDescriptorSet with that type
        times: [messages] ns, strictly ascending
        messages: each encoded in protobuf
        about: the channel's metadata
    """

    name: str
    type: str
    schema: bytes
    times: NDArray[np.uint64]
    messages: list[bytes]
    about: dict[str, str]


def _varint(value: int) -> bytes:
    low, high = value & 127, value >> 7
    return bytes([low | 128]) + _varint(high) if high else bytes([low])


def _key(number: int, wire: int) -> bytes:
    return _varint(number << 3 | wire)


def _same(rows: int, text: bytes) -> Rows:
    return np.broadcast_to(np.frombuffer(text, np.uint8), (rows, len(text)))


def _bytes(values: NDArray[Any]) -> Rows:
    return np.ascontiguousarray(values).reshape(len(values), -1).view(np.uint8)


def _varints(values: NDArray[Any], size: int) -> Rows:
    """Encodes each value in exactly `size` bytes, so that all messages have equal length."""
    flat = values.reshape(len(values), -1).astype(np.uint64)[..., np.newaxis]
    parts = flat >> np.arange(0, 7 * size, 7, dtype=np.uint64) & np.uint64(127)
    parts[..., :-1] |= np.uint64(128)
    return parts.astype(np.uint8).reshape(len(values), -1)


def _within(number: int, body: Rows) -> Rows:
    """Encodes a field that holds a message, a text or a list."""
    return np.concatenate(
        [_same(len(body), _key(number, 2) + _varint(body.shape[1])), body], axis=1
    )


def _doubles(values: NDArray[Any]) -> Rows:
    """Encodes a field for each column, numbered from 1."""
    parts = [
        part
        for i in range(values.shape[1])
        for part in (_same(len(values), _key(i + 1, 1)), _bytes(values[:, i].astype("<f8")))
    ]
    return np.concatenate(parts, axis=1)


def _stamp(times: NDArray[np.uint64]) -> Rows:
    """The messages google.protobuf.Timestamp of these times [ns]."""
    second, part = np.divmod(times, np.uint64(10**9))
    return np.concatenate(
        [
            _same(len(times), _key(1, 0)),
            _varints(second, 5),
            _same(len(times), _key(2, 0)),
            _varints(part, 5),
        ],
        axis=1,
    )


def _messages(rows: Rows) -> list[bytes]:
    return np.ascontiguousarray(rows).view(f"V{rows.shape[1]}").reshape(-1).tolist()


def nanoseconds(t: NDArray[np.float64], what: str) -> NDArray[np.uint64]:
    """Times of messages [ns], strictly ascending."""
    times = np.round(t * 1e9)
    if np.any(times < 0) or np.any(np.diff(times) <= 0):
        raise InputError(
            f"{what}: the times do not ascend from 0 by at least 1 ns, as MCAP requires; use --format parquet"
        )
    return times.astype(np.uint64)


def _camel(words: str) -> str:
    return "".join(word.capitalize() for word in words.split("_"))


def _own_schema(name: str, series: list[Series]) -> bytes:
    """Schema of the type slipbench.`name` with these series as fields, numbered from 1.

    A series with one value per row is not a list.
    """
    files = FileDescriptorSet()
    file = files.file.add(name=f"slipbench/{name}.proto", package="slipbench", syntax="proto3")
    message = file.message_type.add(name=name)
    enums: dict[str, str] = {}
    for number, one in enumerate(series, 1):
        field = message.field.add(name=one.name, number=number, json_name=one.name)
        field.label = (
            FieldDescriptorProto.LABEL_REPEATED
            if one.shape
            else FieldDescriptorProto.LABEL_OPTIONAL
        )
        field.type = {"f": FieldDescriptorProto.TYPE_FLOAT, "u": FieldDescriptorProto.TYPE_UINT32}[
            one.values.dtype.kind
        ]
        if one.codes:
            if one.codes not in enums:
                enums[one.codes] = _camel(one.name)
                enum = message.enum_type.add(name=enums[one.codes])
                for word, code in json.loads(one.codes).items():
                    enum.value.add(name=f"{one.name}_{word}".upper(), number=code)
            field.type, field.type_name = (
                FieldDescriptorProto.TYPE_ENUM,
                f".slipbench.{name}.{enums[one.codes]}",
            )
    return files.SerializeToString(deterministic=True)  # type: ignore[no-any-return]


def _own_rows(series: list[Series]) -> Rows:
    parts: list[Rows] = []
    for number, one in enumerate(series, 1):
        fraction = one.values.dtype.kind == "f"
        body = _bytes(one.values) if fraction else _varints(one.values, 2)
        parts.append(
            _within(number, body)
            if one.shape
            else np.concatenate(
                [_same(len(body), _key(number, 5 if fraction else 0)), body], axis=1
            )
        )
    return np.concatenate(parts, axis=1)


def _text(value: Any) -> str:
    """An attribute as JSON, with null for NaN."""
    plain = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
    return json.dumps(
        [None if one != one else one for one in plain] if isinstance(plain, list) else plain
    )


def _about(series: list[Series], attrs: dict[str, Any]) -> dict[str, str]:
    """Metadata of a channel.

    Attributes of the dataset's group, and unit and value names of each array.
    """
    attributes = {
        key: value if isinstance(value, str) else _text(value)
        for key, value in attrs.items()
        if key not in ("channels", "channel_names")
    }
    return attributes | {
        one.name: json.dumps({"unit": one.unit, "shape": one.shape, "names": one.columns})
        for one in series
    }


def _series_topic(topic: str, name: str, series: list[Series], attrs: dict[str, Any]) -> Topic:
    return Topic(
        topic,
        f"slipbench.{name}",
        _own_schema(name, series),
        nanoseconds(series[0].t, topic),
        _messages(_own_rows(series)),
        _about(series, attrs),
    )


def _frame(trial: StoredTrial, sensor: str) -> str:
    """Name of the body that carries a sensor."""
    bodies, carrier = trial.bodies, str(trial.sensors[sensor].attrs.get("follows", sensor))
    return carrier if carrier in bodies or "pad" not in bodies else "pad"


def _picture(
    topic: str, one: Series, trial: StoredTrial, sensor: str, attrs: dict[str, Any]
) -> Topic:
    """foxglove.Grid in the frame of the pad, with the first row at the top, as in the array."""
    rows, columns = one.shape if len(one.shape) == 2 else (1, one.shape[0])
    times = nanoseconds(one.t, topic)
    corner, cell = np.zeros(2), np.full(2, CELL)
    labels = trial.labels.get(sensor)
    if labels is not None and len(one.shape) == 2 and "unit_positions" in labels.attrs:
        places = np.asarray(labels.attrs["unit_positions"])
        cell = np.ptp(places, axis=0) / np.maximum([columns - 1, rows - 1], 1) + CELL * (
            np.array([columns, rows]) == 1
        )
        corner = places[0] + cell * [-0.5, 0.5]
    grid = Grid(
        frame_id=_frame(trial, sensor),
        column_count=columns,
        row_stride=4 * columns,
        cell_stride=4,
        fields=[PackedElementField(name=one.unit, offset=0, type=PackedElementField.FLOAT32)],
    )
    grid.pose.position.x, grid.pose.position.y = corner
    grid.pose.orientation.x = 1  # half a turn about x: columns along +x, rows along -y
    grid.cell_size.x, grid.cell_size.y = cell
    constant = _same(len(times), grid.SerializeToString(deterministic=True))
    body = np.concatenate(
        [
            _within(Grid.TIMESTAMP_FIELD_NUMBER, _stamp(times)),
            constant,
            _within(Grid.DATA_FIELD_NUMBER, _bytes(one.values)),
        ],
        axis=1,
    )
    return Topic(
        topic,
        "foxglove.Grid",
        build_file_descriptor_set(Grid).SerializeToString(deterministic=True),
        times,
        _messages(body),
        _about([one], attrs),
    )


def _sensor_topics(
    trial: StoredTrial, sensor: str, channels: list[Series], rate: float | None
) -> Iterator[Topic]:
    """One topic for all channels with common times.

    Channels with their own times, and images, have separate topics.
    """
    group, together = trial.sensors[sensor], []
    kind, attrs = (
        str(group.attrs["type"]),
        group.attrs | ({} if rate is None else {"rate_hz": rate}),
    )
    for one in channels:
        topic = f"/sensors/{sensor}/{one.name}"
        if _core.is_image(kind, one.name):
            yield _picture(topic, one, trial, sensor, attrs)
        elif f"{one.name}_t" in group:
            yield _series_topic(topic, _camel(f"{kind}_{one.name}"), [one], attrs)
        else:
            together.append(one)
    if together:
        yield _series_topic(f"/sensors/{sensor}", _camel(kind), together, attrs)


def _list_schema(
    of: str, plural: str, fields: dict[str, tuple[int, int]], codes: str = ""
) -> bytes:
    """Schema of the type slipbench.`plural`, a list of slipbench.`of` with these fields.

    Each field is a label and a type. `codes`: words of an enum.
    """
    files = FileDescriptorSet()
    file = files.file.add(name=f"slipbench/{plural}.proto", package="slipbench", syntax="proto3")
    each, message = file.message_type.add(name=of), file.message_type.add(name=plural)
    message.field.add(
        name=plural.lower(),
        number=1,
        label=FieldDescriptorProto.LABEL_REPEATED,
        type=FieldDescriptorProto.TYPE_MESSAGE,
        type_name=f".slipbench.{of}",
        json_name=plural.lower(),
    )
    for number, (name, (label, kind)) in enumerate(fields.items(), 1):
        field = each.field.add(name=name, number=number, label=label, type=kind, json_name=name)
        if kind == FieldDescriptorProto.TYPE_ENUM:
            enum = each.enum_type.add(name=_camel(name))
            field.type_name = f".slipbench.{of}.{enum.name}"
            for word, code in json.loads(codes).items():
                enum.value.add(name=word.upper(), number=code)
    return files.SerializeToString(deterministic=True)  # type: ignore[no-any-return]


def _velocities(series: list[Series]) -> Topic:
    """Velocities of all bodies in one message."""
    field, times = FieldDescriptorProto, nanoseconds(series[0].t, "/velocities")
    floats = (field.LABEL_REPEATED, field.TYPE_FLOAT)
    schema = _list_schema(
        "Velocity",
        "Velocities",
        {"body": (field.LABEL_OPTIONAL, field.TYPE_STRING), "linear": floats, "angular": floats},
    )
    parts = [
        _within(
            1,
            np.concatenate(
                [
                    _within(1, _same(len(times), one.owner.encode())),
                    _within(2, _bytes(one.values[:, :3])),
                    _within(3, _bytes(one.values[:, 3:])),
                ],
                axis=1,
            ),
        )
        for one in series
    ]
    return Topic(
        "/velocities",
        "slipbench.Velocities",
        schema,
        times,
        _messages(np.concatenate(parts, axis=1)),
        {"unit": series[0].unit},
    )


def _events(sensor: str, events: Arrays) -> Topic:
    """One message for each instant at which units changed their states."""
    field = FieldDescriptorProto
    schema = _list_schema(
        "Event",
        "Events",
        {
            "t": (field.LABEL_OPTIONAL, field.TYPE_DOUBLE),
            "unit": (field.LABEL_OPTIONAL, field.TYPE_UINT32),
            "kind": (field.LABEL_OPTIONAL, field.TYPE_ENUM),
        },
        str(events["events/kind"].attrs["codes"]),
    )
    t, unit, code = (events[f"events/{name}"][:] for name in ("t", "unit", "kind"))
    key = _same(len(t), _key(1, 1)), _same(len(t), _key(2, 0)), _same(len(t), _key(3, 0))
    each = (
        _messages(
            _within(
                1,
                np.concatenate(
                    [key[0], _bytes(t), key[1], _varints(unit, 5), key[2], _varints(code, 1)],
                    axis=1,
                ),
            )
        )
        if len(t)
        else []
    )
    times, first = np.unique(np.round(t * 1e9), return_index=True)
    topic = f"/labels/{sensor}/events"
    return Topic(
        topic,
        "slipbench.Events",
        schema,
        nanoseconds(times / 1e9, topic),
        [
            b"".join(each[begin:end])
            for begin, end in zip(first, [*first[1:], len(t)], strict=False)
        ],
        {"t": '{"unit": "s"}'},
    )


def _body_topics(trial: StoredTrial) -> Iterator[Topic]:
    """Topics for poses and velocities of all bodies, which share their times."""
    series = list(body_series(trial))
    poses, velocities = (
        [one for one in series if one.name == name] for name in ("pose", "velocity")
    )
    if not poses:
        return
    times = nanoseconds(poses[0].t, "/poses")
    stamp = _within(1, _stamp(times))
    parts = []
    for one in poses:
        frames = [
            _within(2, _same(len(times), b"world")),
            _within(3, _same(len(times), one.owner.encode())),
        ]
        turn = one.values[:, [4, 5, 6, 3]]  # x, y, z, w
        parts.append(
            _within(
                1,
                np.concatenate(
                    [
                        stamp,
                        *frames,
                        _within(4, _doubles(one.values[:, :3])),
                        _within(5, _doubles(turn)),
                    ],
                    axis=1,
                ),
            )
        )
    yield Topic(
        "/poses",
        "foxglove.FrameTransforms",
        build_file_descriptor_set(FrameTransforms).SerializeToString(deterministic=True),
        times,
        _messages(np.concatenate(parts, axis=1)),
        {"unit": poses[0].unit},
    )
    yield _velocities(velocities)


def _topics(number: int, trial: StoredTrial, request: Request) -> Iterator[Topic]:
    yield from _body_topics(trial)
    for sensor in request.sensors:
        channels, labels = sensor_at(number, trial, sensor, request.labels, request.rate)
        yield from _sensor_topics(trial, sensor, channels, request.rate)
        if labels:
            yield _series_topic(f"/labels/{sensor}", "Labels", labels, trial.labels[sensor].attrs)
            if "events" in trial.labels[sensor]:
                yield _events(sensor, trial.labels[sensor])
    if trial.control is not None:
        yield _series_topic("/control", "Control", list(control_series(trial)), trial.control.attrs)


def _layout(topics: list[Topic]) -> str:
    """Layout for Foxglove and Lichtblick.

    The scene, a plot of the first values of each sensor, the states of pads and loop over time.
    """
    panels: dict[str, dict[str, Any]] = {
        "3D!scene": {
            "followTf": "world",
            "followMode": "follow-none",
            "topics": {
                topic.name: {"visible": True}
                for topic in topics
                if topic.type.startswith("foxglove.")
            },
        }
    }
    states = []
    for topic in topics:
        if topic.type == "slipbench.Labels" or topic.name == "/control":
            states += [f"{topic.name}.{name}" for name in topic.about if name in STATES]
        elif topic.name.startswith("/sensors/") and not topic.type.startswith("foxglove."):
            panels[f"Plot!{topic.name.removeprefix('/sensors/')}"] = _plot(topic)
    if states:
        panels["StateTransitions!states"] = {
            "isSynced": True,
            "paths": [{"value": path, "timestampMethod": "receiveTime"} for path in states],
        }
    about = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _arranged(list(panels)),
    }
    return json.dumps(about, indent=1) + "\n"


def _plot(topic: Topic) -> dict[str, Any]:
    """The panel of a sensor's topic, with the first three values of each array."""
    paths = []
    for name, text in topic.about.items():
        if text.startswith('{"unit"'):
            about = json.loads(text)
            paths += [
                {
                    "value": f"{topic.name}.{name}" + (f"[{i}]" if about["shape"] else ""),
                    "label": about["names"][i],
                    "enabled": True,
                    "timestampMethod": "receiveTime",
                }
                for i in range(min(3, len(about["names"])))
            ]
    return {
        "title": topic.name,
        "paths": paths,
        "xAxisVal": "timestamp",
        "isSynced": True,
        "showLegend": True,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "legendDisplay": "floating",
        "showPlotValuesInLegend": False,
        "sidebarDimension": 240,
    }


def _arranged(panels: list[str]) -> Any:
    """The first panel on the left, the others below each other on the right, of equal heights."""
    first, *others = panels
    if not others:
        return first
    column: Any = others[-1]
    for number, panel in enumerate(reversed(others[:-1]), 2):
        column = {
            "direction": "column",
            "first": panel,
            "second": column,
            "splitPercentage": 100 / number,
        }
    return {"direction": "row", "first": first, "second": column, "splitPercentage": 40}


def _write_messages(
    file: IO[bytes], topics: list[Topic], library: str, about: dict[str, str]
) -> None:
    """Writes the messages in order of time; messages of equal time in the order of the topics."""
    writer = Writer(file, chunk_size=CHUNK, compression=CompressionType.ZSTD, enable_data_crcs=True)
    writer.start(library=library)
    writer.add_metadata("slipbench", about)
    schemas: dict[tuple[str, bytes], int] = {}
    channels = []
    for topic in topics:
        kind = (topic.type, topic.schema)
        if kind not in schemas:
            schemas[kind] = writer.register_schema(topic.type, "protobuf", topic.schema)
        channels.append(writer.register_channel(topic.name, "protobuf", schemas[kind], topic.about))
    times = np.concatenate([topic.times for topic in topics])
    numbers = np.repeat(channels, [len(topic.times) for topic in topics])
    messages = [message for topic in topics for message in topic.messages]
    order = np.argsort(times, kind="stable")
    for i, time, channel in zip(
        order.tolist(), times[order].tolist(), numbers[order].tolist(), strict=True
    ):
        writer.add_message(channel, time, messages[i], time)
    finish: Any = writer.finish  # lacks type annotations
    finish()


def write(data: Dataset, request: Request, progress: Progress) -> list[str]:
    """Writes demo_<k>.mcap for each trial, a layout for viewers and a card; returns their names."""
    parts, library = split_of(data), f"slipbench {data.version}"
    kind = "an MCAP file, or a layout for Foxglove"
    check_card(request)
    with Output(request.out, kind, MAGIC, b'{\n "configById"', *CARDS) as output:
        written = 0
        for done, number in enumerate(request.trials, 1):
            trial = data[number]
            topics = list(_topics(number, trial, request))
            about = {
                "trial": str(number),
                "seed": str(trial.seed),
                "sha256": trial.sha256,
                "split": parts.get(number, ""),
                "params": json.dumps(trial.params),
                "outcome": json.dumps(trial.outcome),
                "command": without_folders(data.command),
                "scene": data.scene,
            }
            if done == 1:
                output.write(LAYOUT, _layout(topics))
            with output.create(f"demo_{number}.mcap") as file:
                _write_messages(file, topics, library, about)
                written += file.tell()
            progress.update(done, written)
        write_card(data, request, output)
        progress.check()
        return output.publish()
